//! Rules within cameras, lights, images and nodes that tables cannot express.

use std::collections::HashSet;

use gltf::json::Value;

use crate::load::gltf::fault::{Fault, element_name, items, references, require};

pub(super) fn check(json: &Value) -> Result<(), Fault> {
    for (index, camera) in items(json, "cameras").iter().enumerate() {
        check_camera(camera, &element_name("camera", index, camera))?;
    }
    for (index, image) in items(json, "images").iter().enumerate() {
        check_image(image, &element_name("image", index, image))?;
    }
    for (index, node) in items(json, "nodes").iter().enumerate() {
        check_node(node, &element_name("node", index, node))?;
    }
    let lights = json.pointer("/extensions/KHR_lights_punctual");
    for (index, light) in lights
        .map_or(&[][..], |l| items(l, "lights"))
        .iter()
        .enumerate()
    {
        check_light(light, &element_name("light", index, light))?;
    }
    for (index, mesh) in items(json, "meshes").iter().enumerate() {
        for (number, primitive) in items(mesh, "primitives").iter().enumerate() {
            let place = format!("{}, primitive {number}", element_name("mesh", index, mesh));
            check_variants(primitive, &place)?;
        }
    }
    Ok(())
}

fn number(object: &Value, name: &str) -> Option<f64> {
    object.get(name).and_then(Value::as_f64)
}

fn check_camera(camera: &Value, place: &str) -> Result<(), Fault> {
    const TYPES: [&str; 2] = ["perspective", "orthographic"];
    for kind in TYPES {
        let is_type = camera.get("type").and_then(Value::as_str) == Some(kind);
        require(camera.get(kind).is_some() == is_type, place, || {
            if is_type {
                format!("the property '{kind}' is missing")
            } else {
                format!("a camera of another type has the property '{kind}'")
            }
        })?;
    }
    for view in TYPES.iter().filter_map(|kind| camera.get(kind)) {
        if let (Some(near), Some(far)) = (number(view, "znear"), number(view, "zfar")) {
            require(far > near, place, || {
                format!("zfar {far} is not above znear {near}")
            })?;
        }
        for size in ["xmag", "ymag"] {
            require(number(view, size) != Some(0.0), place, || {
                format!("{size} is zero")
            })?;
        }
    }
    Ok(())
}

fn check_light(light: &Value, place: &str) -> Result<(), Fault> {
    let spot = light.get("spot");
    let is_spot = light.get("type").and_then(Value::as_str) == Some("spot");
    require(
        !is_spot || spot.is_some(),
        place,
        || "a spot light needs the property 'spot'",
    )?;
    let Some(spot) = spot else {
        return Ok(());
    };
    let inner = number(spot, "innerConeAngle").unwrap_or(0.0);
    let outer = number(spot, "outerConeAngle").unwrap_or(std::f64::consts::FRAC_PI_4);
    require(inner < outer, place, || {
        format!("innerConeAngle {inner} is not below outerConeAngle {outer}")
    })
}

fn check_image(image: &Value, place: &str) -> Result<(), Fault> {
    let uri = image.get("uri").is_some();
    let view = image.get("bufferView").is_some();
    require(
        uri != view,
        place,
        || "it needs either a uri or a bufferView",
    )?;
    require(
        !view || image.get("mimeType").is_some(),
        place,
        || "an image in a buffer needs a mimeType",
    )
}

fn check_node(node: &Value, place: &str) -> Result<(), Fault> {
    let matrix: Vec<f64> = numbers(node, "matrix");
    for property in ["translation", "rotation", "scale"] {
        require(
            matrix.is_empty() || node.get(property).is_none(),
            place,
            || format!("it has both a matrix and a {property}"),
        )?;
    }
    let last_row: Vec<f64> = matrix.iter().copied().skip(3).step_by(4).collect();
    require(
        matrix.is_empty() || is_affine_row(&last_row),
        place,
        || "its matrix does not consist of translation, rotation and scale: its last row is not 0 0 0 1",
    )?;
    let rotation = numbers(node, "rotation");
    let is_zero = !rotation.is_empty() && rotation.iter().all(|part| *part == 0.0);
    require(!is_zero, place, || "its rotation is zero")?;
    require(
        node.get("skin").is_none() || node.get("mesh").is_some(),
        place,
        || "it has a skin but no mesh",
    )
}

/// Whether the last row of a matrix is 0 0 0 1, up to what a few products of f32 matrices may be off.
pub(super) fn is_affine_row(row: &[f64]) -> bool {
    const TOLERANCE: f64 = 16.0 * f32::EPSILON as f64;
    let expected = [0.0, 0.0, 0.0, 1.0];
    row.len() == expected.len()
        && row
            .iter()
            .zip(expected)
            .all(|(value, expected)| (value - expected).abs() <= TOLERANCE)
}

fn numbers(object: &Value, name: &str) -> Vec<f64> {
    let numbers = items(object, name).iter().filter_map(Value::as_f64);
    numbers.collect()
}

/// Each variant may choose one material for a primitive.
fn check_variants(primitive: &Value, place: &str) -> Result<(), Fault> {
    let Some(variants) = primitive.pointer("/extensions/KHR_materials_variants") else {
        return Ok(());
    };
    let mut seen = HashSet::new();
    for mapping in items(variants, "mappings") {
        for variant in references(mapping, "variants") {
            require(seen.insert(variant), place, || {
                format!("variant {variant} has two materials")
            })?;
        }
    }
    Ok(())
}
