//! The nodes as a forest: each has at most one parent, and none is its own ancestor.

use gltf::json::Value;

use crate::load::gltf::fault::{Fault, element_name, items, reference, references, require};

/// Where the nodes are in a depth-first walk through the forest.
#[derive(Debug)]
pub(super) struct Graph {
    parents: Vec<Option<usize>>,
    /// The root above each node.
    roots: Vec<usize>,
    /// For each node, the numbers of the steps at which the walk enters and leaves it.
    spans: Vec<(usize, usize)>,
}

enum Step {
    Enter(usize),
    Leave(usize),
}

impl Graph {
    pub(super) fn new(json: &Value) -> Result<Self, Fault> {
        let nodes = items(json, "nodes");
        let mut parents: Vec<Option<usize>> = vec![None; nodes.len()];
        for (index, node) in nodes.iter().enumerate() {
            for child in references(node, "children") {
                let Some(parent) = parents.get_mut(child) else {
                    continue;
                };
                if let Some(other) = parent.replace(index) {
                    let place = element_name("node", index, node);
                    let reason = format!("its child {child} is also a child of node {other}");
                    return Err(Fault::invalid(place, reason));
                }
            }
        }
        let mut roots = vec![usize::MAX; nodes.len()];
        let mut spans = vec![(0, 0); nodes.len()];
        let mut clock = 0;
        for root in (0..nodes.len()).filter(|index| parents.get(*index) == Some(&None)) {
            let mut steps = vec![Step::Enter(root)];
            while let Some(step) = steps.pop() {
                clock += 1;
                match step {
                    // All indices were checked to be those of nodes.
                    Step::Enter(index) => {
                        roots[index] = root;
                        spans[index].0 = clock;
                        steps.push(Step::Leave(index));
                        steps.extend(references(&nodes[index], "children").map(Step::Enter));
                    }
                    Step::Leave(index) => spans[index].1 = clock,
                }
            }
        }
        // With one parent each, what no root leads to runs in circles.
        if let Some(index) = roots.iter().position(|root| *root == usize::MAX) {
            let place = element_name("node", index, &nodes[index]);
            return Err(Fault::invalid(
                place,
                "it is its own ancestor, or below such a node",
            ));
        }
        Ok(Self {
            parents,
            roots,
            spans,
        })
    }

    /// Whether `ancestor` is `node` or above it.
    pub(super) fn is_at_or_above(&self, ancestor: usize, node: usize) -> bool {
        match (self.spans.get(ancestor), self.spans.get(node)) {
            (Some(outer), Some(inner)) => outer.0 <= inner.0 && inner.1 <= outer.1,
            _ => false,
        }
    }

    pub(super) fn root_of(&self, node: usize) -> Option<usize> {
        self.roots.get(node).copied()
    }

    /// Scenes may only list nodes without a parent, and the default scene must list some.
    pub(super) fn check_scenes(&self, json: &Value) -> Result<(), Fault> {
        let scenes = items(json, "scenes");
        for (index, scene) in scenes.iter().enumerate() {
            let place = element_name("scene", index, scene);
            for node in references(scene, "nodes") {
                if let Some(Some(parent)) = self.parents.get(node) {
                    // Strictly an error, but such files are also found among sound ones. Whether the nodes above
                    // place what is below them is open.
                    let feature = format!(
                        "{place}, which lists node {node} although that is below node {parent},"
                    );
                    return Err(Fault::Unsupported(feature));
                }
            }
        }
        let Some(index) = reference(json, "scene") else {
            return Ok(());
        };
        let lists_nodes = scenes
            .get(index)
            .is_some_and(|scene| scene.get("nodes").is_some());
        require(
            lists_nodes,
            format!("scene {index}"),
            || "it is the default scene but has no nodes",
        )
    }
}
