use super::*;
use crate::load::test_files::{mesh, refusal};

const TEXT: &str = "solid first one
  facet normal nan 0 0
    outer loop
      vertex 0 0 0
      vertex 1 0 0
      vertex 0 .5e0 -0
    endloop
  endfacet
endsolid first one
SOLID
  FACET NORMAL 0 0 1
    OUTER LOOP
      VERTEX 0 0 0
      VERTEX 1 0 0
      VERTEX 0 0.5 1
    ENDLOOP
  ENDFACET
  facet normal 0 0 1
    outer loop
      vertex 1 0 0
      vertex 0 0 0
      vertex 0 0.5 1
    endloop
  endfacet
ENDSOLID
";

fn binary(header: &[u8], count: u32, facets: &[[f32; 9]]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, b' ');
    bytes.extend(count.to_le_bytes());
    for corners in facets {
        bytes.extend([0; 12]);
        bytes.extend(corners.iter().flat_map(|value| value.to_le_bytes()));
        bytes.extend([7; 2]);
    }
    bytes
}

const FACET_VALUES: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

#[test]
fn several_solids_are_read_and_equal_corners_shared_within_each() {
    for text in [
        TEXT.to_owned(),
        TEXT.replace('\n', "\r\n"),
        TEXT.trim_end().to_owned(),
    ] {
        let (mesh, report) = mesh(&[("a.stl", text.as_bytes())]).unwrap();
        assert_eq!(mesh.indices(), [[0, 1, 2], [3, 4, 5], [4, 3, 5]]);
        assert_eq!(mesh.vertices()[2], Vec3::new(0.0, 0.5, 0.0));
        assert_eq!(mesh.vertices()[5], Vec3::new(0.0, 0.5, 1.0));
        assert_eq!(report.notes().len(), 0);
    }
}

#[test]
fn binary_files_are_known_by_their_size_whatever_their_header_says() {
    for header in [b"solid but binary".as_slice(), b"STLB"] {
        let bytes = binary(header, 2, &[FACET_VALUES; 2]);
        let (mesh, _) = mesh(&[("a.STL", &bytes)]).unwrap();
        assert_eq!((mesh.len(), mesh.vertices().len()), (2, 3));
    }
}

#[test]
fn bytes_after_the_last_facet_are_noted() {
    let bytes = binary(b"STLB", 1, &[FACET_VALUES; 2]);
    let (mesh, report) = mesh(&[("a.stl", &bytes)]).unwrap();
    assert_eq!(mesh.len(), 1);
    assert!(report.notes()[0].contains("50 bytes after"), "{report:?}");
}

#[test]
fn broken_text_is_refused_with_its_line() {
    let broken = |from: &str, to: &str| refusal("a.stl", TEXT.replacen(from, to, 1).as_bytes());
    for (message, part) in [
        (
            broken("vertex 1 0 0", "vertex 1 0"),
            "line 5: 'vertex' needs 3",
        ),
        (
            broken("vertex 1 0 0", "vertex 1 0 nan"),
            "line 5: 'nan' is not a finite f32",
        ),
        (
            broken("vertex 1 0 0", "vertex 1 0 1e40"),
            "line 5: '1e40' is not a finite f32",
        ),
        (
            broken("vertex 1 0 0", "vertex 1 0 O"),
            "line 5: 'O' is not a number",
        ),
        (
            broken("vertex 1 0 0", ""),
            "line 7: the facet has 2 corners",
        ),
        (broken("endfacet", ""), "line 9: 'endsolid' cannot stand"),
        (
            broken("ENDSOLID", ""),
            "line 26: the file ends inside a solid",
        ),
        (
            broken("endsolid first one", "junk"),
            "line 9: 'junk' cannot stand",
        ),
        (refusal("a.stl", b""), "start of the file: neither"),
        (refusal("a.stl", b"v 1 2 3\n"), "start of the file: neither"),
    ] {
        assert!(message.starts_with(part), "{message}");
    }
}

#[test]
fn broken_binary_files_are_refused_with_their_facet() {
    let mut far = FACET_VALUES;
    far[4] = f32::INFINITY;
    for (bytes, part) in [
        (
            binary(b"STLB", 3, &[FACET_VALUES; 2]),
            "facet 2: the header announces 3 facets",
        ),
        (
            binary(b"solid", 3, &[FACET_VALUES; 2]),
            "facet 2: the header announces 3 facets",
        ),
        (
            binary(b"STLB", u32::MAX, &[FACET_VALUES; 2]),
            "facet 2: the header announces",
        ),
        (
            binary(b"STLB", 0, &[FACET_VALUES; 2]),
            "header: the header announces no facets",
        ),
        (
            binary(b"STLB", 2, &[FACET_VALUES, far]),
            "facet 1: a coordinate is not finite",
        ),
    ] {
        let message = refusal("a.stl", &bytes);
        assert!(message.starts_with(part), "{message}");
    }
}
