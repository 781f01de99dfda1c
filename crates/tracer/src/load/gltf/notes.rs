//! Notes on what a file has and the scene does not.

use gltf::json::Value;

use super::fault::{element_name, items, named};
use super::{Document, validate};
use crate::load::LoadReport;

/// How many names a note lists.
const NAMES: usize = 8;

/// Notes the extensions, animations, skins and scenes that are skipped.
pub(super) fn add(document: &Document<'_>, report: &mut LoadReport) {
    let json = document.json;
    for name in items(json, "extensionsUsed")
        .iter()
        .filter_map(Value::as_str)
    {
        if !validate::is_supported(name) {
            report.note(format!("extension {name} is skipped: it is not supported"));
        }
    }
    for (kind, array, reason) in [
        ("animation", "animations", "nodes stay in their rest pose"),
        ("skin", "skins", "meshes stay in their rest pose"),
    ] {
        let names = items(json, array).iter().enumerate();
        let names: Vec<String> = names
            .map(|(index, element)| element_name(kind, index, element))
            .collect();
        skipped(&names, reason, report);
    }
    let default = super::nodes::default_scene(json);
    let others = items(json, "scenes").iter().enumerate();
    let others: Vec<String> = others
        .filter(|(index, _)| Some(*index) != default)
        .map(|(index, scene)| element_name("scene", index, scene))
        .collect();
    skipped(&others, "only the default scene is shown", report);
}

/// Notes that some elements are skipped; of many, the first ones by name.
pub(super) fn skipped(names: &[String], reason: &str, report: &mut LoadReport) {
    let Some(rest) = names.len().checked_sub(NAMES) else {
        if !names.is_empty() {
            report.note(format!("skipped {}: {reason}", names.join(", ")));
        }
        return;
    };
    let first: Vec<&str> = names.iter().take(NAMES).map(String::as_str).collect();
    let more = if rest > 0 {
        format!(" and {rest} more")
    } else {
        String::new()
    };
    report.note(format!("skipped {}{more}: {reason}", first.join(", ")));
}

/// The name of a node for messages.
pub(super) fn node_name(document: &Document<'_>, index: usize) -> String {
    let node = document.root.nodes.get(index);
    named("node", index, node.and_then(|node| node.name.as_deref()))
}
