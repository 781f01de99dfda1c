//! The hard cases, asked of brute force, and what holds for the suite itself.

use tahko_geometry::test_support::hard_cases::{
    Structure, Transformation, TransformedCase, cases, check_closed_mesh, check_many_duplicates,
    closed_meshes,
};
use tahko_geometry::{BruteForce, Precision, hard_case_tests};

fn structures() -> Vec<Structure> {
    vec![Structure::new("brute force", BruteForce::new)]
}

hard_case_tests!(structures);

#[test]
fn a_hundred_thousand_duplicates_are_told_apart() {
    check_many_duplicates(&structures());
}

#[test]
#[should_panic(expected = "wrong answers")]
fn a_structure_that_is_not_exact_is_found_out() {
    let fast = Structure::new("fast", |mesh, _| BruteForce::new(mesh, Precision::Fast));
    check_closed_mesh("octahedron", &[fast]);
}

#[test]
fn every_row_of_the_table_has_cases_of_its_number() {
    for number in 1..=45 {
        let cases = cases(number);
        assert!(!cases.is_empty(), "no case {number}");
        for case in cases {
            assert_eq!(case.number, number, "{}", case.name);
            assert!(!case.questions.is_empty(), "case {number} asks nothing");
        }
    }
    assert!(
        cases(0).is_empty() && cases(46).is_empty(),
        "the table has 45 rows"
    );
}

/// Nothing is left out silently: these are all transformations that do not fit into f32.
#[test]
fn only_what_overflows_is_not_asked() {
    let transformations = Transformation::all().len();
    assert_eq!(transformations, 6 * 5 + 2 * 2 + 2 * 3);
    let mut left_out = Vec::new();
    let all = (1..=45).flat_map(cases).chain(closed_meshes());
    for case in all {
        let transformed = TransformedCase::all(&case);
        let rays: usize = transformed
            .iter()
            .map(|transformed| transformed.skipped)
            .sum();
        let meshes = transformations - transformed.len();
        if meshes > 0 || rays > 0 {
            left_out.push((case.number, case.name, meshes, rays));
        }
    }
    // Case, transformations, rays of the other transformations.
    let expected = [
        (24, "size 3e38", 2, 0),
        (44, "directions of any length", 0, 12),
    ];
    assert_eq!(left_out, expected);
}
