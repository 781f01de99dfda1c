//! Rules for animations. They are not read, but checked, for they refer to nodes and accessors.

use std::collections::HashSet;

use gltf::json::Value;

use super::primitives::target_count;
use crate::load::gltf::accessor::Accessor;
use crate::load::gltf::fault::{Fault, element_name, integer, items, reference, require};
use crate::load::gltf::layout::Component;

/// How far the length of a quaternion may be from one: four components of normalized bytes, each rounded by half of
/// 1/127, and as much again.
const LENGTH_TOLERANCE: f64 = 4.0 / 127.0 / 2.0 * 2.0;

pub(super) fn check(json: &Value, accessors: &[Accessor<'_>]) -> Result<(), Fault> {
    for (index, animation) in items(json, "animations").iter().enumerate() {
        let place = element_name("animation", index, animation);
        let mut targets = HashSet::new();
        for (number, channel) in items(animation, "channels").iter().enumerate() {
            let place = format!("{place}, channel {number}");
            let path = channel.pointer("/target/path").and_then(Value::as_str);
            let node = channel
                .get("target")
                .and_then(|target| reference(target, "node"));
            if let Some(node) = node {
                require(
                    targets.insert((node, path)),
                    &place,
                    || "another channel has the same target",
                )?;
            }
            check_channel(json, animation, channel, accessors, &place)?;
        }
        for (number, sampler) in items(animation, "samplers").iter().enumerate() {
            check_input(sampler, accessors, &format!("{place}, sampler {number}"))?;
        }
    }
    Ok(())
}

fn accessor<'a, 'b>(
    sampler: &Value,
    name: &str,
    accessors: &'a [Accessor<'b>],
) -> Option<&'a Accessor<'b>> {
    reference(sampler, name).and_then(|index| accessors.get(index))
}

fn is_cubic(sampler: &Value) -> bool {
    sampler.get("interpolation").and_then(Value::as_str) == Some("CUBICSPLINE")
}

fn check_input(sampler: &Value, accessors: &[Accessor<'_>], place: &str) -> Result<(), Fault> {
    let Some(input) = accessor(sampler, "input", accessors) else {
        return Ok(());
    };
    require(
        input.shape == "SCALAR" && input.component == Component::F32,
        place,
        || "its input is not of type SCALAR and FLOAT",
    )?;
    require(
        !is_cubic(sampler) || input.count >= 2,
        place,
        || "cubic interpolation needs at least two key frames",
    )
}

fn check_channel(
    json: &Value,
    animation: &Value,
    channel: &Value,
    accessors: &[Accessor<'_>],
    place: &str,
) -> Result<(), Fault> {
    let samplers = items(animation, "samplers");
    let index = integer(channel, "sampler").unwrap_or(0);
    let sampler = reference(channel, "sampler").and_then(|index| samplers.get(index));
    let sampler = sampler.ok_or_else(|| {
        let reason = format!("refers to sampler {index} of {}", samplers.len());
        Fault::invalid(place, reason)
    })?;
    let (Some(input), Some(output)) = (
        accessor(sampler, "input", accessors),
        accessor(sampler, "output", accessors),
    ) else {
        return Ok(());
    };
    let target = channel.get("target");
    let node = target.and_then(|target| reference(target, "node"));
    let (shape, values_per_frame) = match channel.pointer("/target/path").and_then(Value::as_str) {
        Some("translation" | "scale") => ("VEC3", 1),
        Some("rotation") => ("VEC4", 1),
        Some("weights") => {
            let Some(count) = node.map(|node| morph_targets(json, node)) else {
                return Ok(());
            };
            require(
                count > 0,
                place,
                || "it animates the weights of a node without morph targets",
            )?;
            ("SCALAR", count)
        }
        // Extensions animate other things.
        _ => return Ok(()),
    };
    require(output.shape == shape, place, || {
        format!("its output is of type {}, not {shape}", output.shape)
    })?;
    let per_frame = if is_cubic(sampler) { 3 } else { 1 } * values_per_frame;
    let expected = input.count.checked_mul(per_frame);
    require(expected == Some(output.count), place, || {
        format!(
            "its output has {} elements for {} key frames of {per_frame}",
            output.count, input.count
        )
    })?;
    if shape == "VEC4" {
        check_rotations(output, is_cubic(sampler), place)?;
    }
    Ok(())
}

fn morph_targets(json: &Value, node: usize) -> usize {
    let mesh = items(json, "nodes")
        .get(node)
        .and_then(|node| reference(node, "mesh"));
    mesh.and_then(|mesh| items(json, "meshes").get(mesh))
        .map_or(0, target_count)
}

/// Rotations are unit quaternions; in cubic interpolation each stands between two tangents.
fn check_rotations(output: &Accessor<'_>, cubic: bool, place: &str) -> Result<(), Fault> {
    if !output.has_data() {
        return Ok(());
    }
    let (first, step) = if cubic { (1, 3) } else { (0, 1) };
    for element in (first..output.count).step_by(step) {
        let square = |component| output.value(element, component).powi(2);
        let length = (0..4).map(square).sum::<f64>().sqrt();
        require((length - 1.0).abs() <= LENGTH_TOLERANCE, place, || {
            format!(
                "the rotation in element {element} of its output has the length {length}, not 1"
            )
        })?;
    }
    Ok(())
}
