//! The node hierarchy: which nodes are shown, and where they are.

use glam::{DAffine3, DMat4, DQuat, DVec3};
use gltf::json::{Node, Value};
use tahko_geometry::Transform;

use super::Document;
use super::fault::{items, reference, references};
use super::notes::{node_name, skipped};
use crate::load::LoadReport;

/// A node of the scene.
#[derive(Debug)]
pub(super) struct PlacedNode<'a> {
    pub(super) index: usize,
    pub(super) node: &'a Node,
    /// From the coordinates of the node to those of the file.
    pub(super) to_file: Transform,
}

/// The number of the scene that is shown: the default one, or the first. `None` if there are no scenes.
pub(super) fn default_scene(json: &Value) -> Option<usize> {
    let first = (!items(json, "scenes").is_empty()).then_some(0);
    reference(json, "scene").or(first)
}

/// The nodes of the default scene, parents before children, in the order of the file. Without any scene, all nodes
/// are shown.
///
/// Nodes whose coordinates cannot be mapped back are left out with all below them, and noted: a scale of zero makes
/// their surfaces flat or points, on which normals and reflections have no meaning.
pub(super) fn of_default_scene<'a>(
    document: &'a Document<'_>,
    report: &mut LoadReport,
) -> Vec<PlacedNode<'a>> {
    let mut placed = Vec::new();
    let mut unplaceable = Vec::new();
    let mut pending: Vec<(usize, DAffine3)> = roots(document.json)
        .into_iter()
        .rev()
        .map(|root| (root, DAffine3::IDENTITY))
        .collect();
    // Invariant: the checks made sure that no node is reached twice.
    while let Some((index, parent_to_file)) = pending.pop() {
        let Some(node) = document.root.nodes.get(index) else {
            continue;
        };
        let to_file = parent_to_file * local_transform(node);
        let Some(transform) = Transform::from_affine(to_file) else {
            unplaceable.push(node_name(document, index));
            continue;
        };
        placed.push(PlacedNode {
            index,
            node,
            to_file: transform,
        });
        let children = node.children.iter().flatten().rev();
        pending.extend(children.map(|child| (child.value(), to_file)));
    }
    let reason = "the scale of a node is zero or out of range, so it has no extent; what is below it is skipped too";
    skipped(&unplaceable, reason, report);
    placed
}

fn roots(json: &Value) -> Vec<usize> {
    if let Some(scene) = default_scene(json) {
        let scene = items(json, "scenes").get(scene);
        return scene.map_or_else(Vec::new, |scene| references(scene, "nodes").collect());
    }
    let nodes = items(json, "nodes");
    let mut is_root = vec![true; nodes.len()];
    for child in nodes.iter().flat_map(|node| references(node, "children")) {
        if let Some(is_root) = is_root.get_mut(child) {
            *is_root = false;
        }
    }
    (0..nodes.len())
        .filter(|index| is_root.get(*index) == Some(&true))
        .collect()
}

/// From the coordinates of a node to those of its parent. Rotations are brought to unit length.
fn local_transform(node: &Node) -> DAffine3 {
    if let Some(matrix) = node.matrix {
        return DAffine3::from_mat4(DMat4::from_cols_array(&matrix.map(f64::from)));
    }
    let vector = |value: Option<[f32; 3]>, default: DVec3| {
        value.map_or(default, |value| DVec3::from(value.map(f64::from)))
    };
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |rotation| {
        DQuat::from_array(rotation.0.map(f64::from)).normalize()
    });
    DAffine3::from_scale_rotation_translation(
        vector(node.scale, DVec3::ONE),
        rotation,
        vector(node.translation, DVec3::ZERO),
    )
}
