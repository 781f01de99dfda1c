//! Rules for skins. They are not read, but checked, for they refer to nodes and accessors.

use gltf::json::Value;

use super::elements::is_affine_row;
use super::graph::Graph;
use crate::load::gltf::accessor::Accessor;
use crate::load::gltf::fault::{Fault, element_name, items, reference, references, require};
use crate::load::gltf::layout::Component;

/// Checks how the joints hang together.
pub(super) fn check(json: &Value, graph: &Graph) -> Result<(), Fault> {
    for (index, skin) in items(json, "skins").iter().enumerate() {
        let place = element_name("skin", index, skin);
        let skeleton = reference(skin, "skeleton");
        let mut root = None;
        for joint in references(skin, "joints") {
            let joint_root = graph.root_of(joint);
            if joint_root != *root.get_or_insert(joint_root) {
                // Strictly an error, but such files are also found in collections of sound ones.
                let feature = format!("{place} with joints that have no common root");
                return Err(Fault::Unsupported(feature));
            }
            if let Some(skeleton) = skeleton {
                require(graph.is_at_or_above(skeleton, joint), &place, || {
                    format!("its skeleton, node {skeleton}, is not above its joint, node {joint}")
                })?;
            }
        }
    }
    Ok(())
}

/// Checks the inverse bind matrices.
pub(super) fn check_matrices(json: &Value, accessors: &[Accessor<'_>]) -> Result<(), Fault> {
    for (index, skin) in items(json, "skins").iter().enumerate() {
        let place = element_name("skin", index, skin);
        let matrices = reference(skin, "inverseBindMatrices").and_then(|at| accessors.get(at));
        let Some(matrices) = matrices else {
            continue;
        };
        let is_matrix = matrices.shape == "MAT4" && matrices.component == Component::F32;
        require(
            is_matrix,
            &place,
            || "its inverse bind matrices are not of type MAT4 and FLOAT",
        )?;
        let joints = items(skin, "joints").len();
        require(matrices.count >= joints, &place, || {
            format!(
                "{} inverse bind matrices for {joints} joints",
                matrices.count
            )
        })?;
        if !matrices.has_data() {
            continue;
        }
        for matrix in 0..matrices.count {
            let last_row = [3, 7, 11, 15].map(|component| matrices.value(matrix, component));
            require(is_affine_row(&last_row), &place, || {
                format!("the last row of its inverse bind matrix {matrix} is not 0 0 0 1")
            })?;
        }
    }
    Ok(())
}
