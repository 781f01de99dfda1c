use super::*;
use crate::BspOptions;
use tahko_geometry::glam::Vec3;
use tahko_geometry::test_support::soup;

fn tree() -> BspTree {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let stacked = (0..64u8).map(|i| triangle.map(|corner| corner + Vec3::Z * f32::from(i)));
    let options = BspOptions::default().with_max_leaf_size(1);
    let tree = BspTree::build(&soup(stacked.collect()), &options).expect("options in range");
    assert_eq!(tree.validate(), Ok(()));
    assert!(!tree.nodes.is_empty(), "64 triangles are split");
    tree
}

#[test]
fn a_child_that_does_not_exist_is_found() {
    let mut tree = tree();
    tree.nodes[3].children[FRONT] = Child::inner(1000);
    let error = tree.validate().unwrap_err();
    let is_named = matches!(
        error,
        ValidationError::ChildOutOfRange {
            node: 3,
            index: 1000,
            ..
        }
    );
    assert!(is_named, "{error}");
}

#[test]
fn a_loop_is_found() {
    let mut tree = tree();
    let last = tree.nodes.len() - 1;
    tree.nodes[last].children[BACK] = tree.root;
    let error = tree.validate().unwrap_err();
    let is_named = matches!(
        error,
        ValidationError::NodeNotReachedOnce { node: 0, times: 2 }
    );
    assert!(is_named, "{error}");
}

#[test]
fn a_lost_leaf_is_found() {
    let mut tree = tree();
    tree.leaves.push(List::default());
    let error = tree.validate().unwrap_err();
    assert!(
        matches!(error, ValidationError::LeafNotReachedOnce { times: 0, .. }),
        "{error}"
    );
}

#[test]
fn a_wrong_depth_is_found() {
    let mut tree = tree();
    tree.depth += 1;
    let error = tree.validate().unwrap_err();
    assert!(matches!(error, ValidationError::Depth { .. }), "{error}");
}

#[test]
fn a_plane_that_is_not_finite_is_found() {
    let mut tree = tree();
    tree.nodes[0].plane.offset = f64::NAN;
    let error = tree.validate().unwrap_err();
    assert!(
        matches!(error, ValidationError::InvalidPlane { node: 0, .. }),
        "{error}"
    );
}

#[test]
fn a_reference_that_leads_nowhere_is_found() {
    let mut tree = tree();
    tree.references[5] = 64;
    let error = tree.validate().unwrap_err();
    assert!(
        matches!(error, ValidationError::ReferenceOutOfRange { .. }),
        "{error}"
    );
}

#[test]
fn a_triangle_in_the_wrong_list_is_found() {
    let mut tree = tree();
    let last = tree.references.len() - 1;
    tree.references.swap(0, last);
    let error = tree.validate().unwrap_err();
    assert!(
        matches!(error, ValidationError::NotListed { .. }),
        "{error}"
    );
}

#[test]
fn a_superfluous_reference_is_found() {
    let mut tree = tree();
    tree.references.push(0);
    assert_eq!(
        tree.validate(),
        Err(ValidationError::Superfluous {
            references: 65,
            places: 64
        })
    );
}
