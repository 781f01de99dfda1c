//! Rules for meshes: which attributes there are, in which format, and what the material asks of them.

use gltf::json::Value;

use crate::load::gltf::accessor::Accessor;
use crate::load::gltf::fault::{Fault, element_name, integer, items, reference, require};
use crate::load::gltf::layout::Component;

/// The number of morph targets of a mesh.
pub(super) fn target_count(mesh: &Value) -> usize {
    items(mesh, "primitives")
        .first()
        .map_or(0, |primitive| items(primitive, "targets").len())
}

/// Checks that there is a weight for each morph target, in meshes and in nodes.
pub(super) fn check_morph_weights(json: &Value) -> Result<(), Fault> {
    let meshes = items(json, "meshes");
    let check = |element: &Value, mesh: &Value, place: &str| {
        let (weights, targets) = (items(element, "weights").len(), target_count(mesh));
        require(weights == 0 || weights == targets, place, || {
            format!("{weights} weights for {targets} morph targets")
        })
    };
    for (index, mesh) in meshes.iter().enumerate() {
        let place = element_name("mesh", index, mesh);
        check(mesh, mesh, &place)?;
        let targets = target_count(mesh);
        let same = |primitive: &Value| items(primitive, "targets").len() == targets;
        require(
            items(mesh, "primitives").iter().all(same),
            &place,
            || "its primitives have different numbers of morph targets",
        )?;
    }
    for (index, node) in items(json, "nodes").iter().enumerate() {
        let mesh = reference(node, "mesh").and_then(|mesh| meshes.get(mesh));
        let mesh = mesh.unwrap_or(&Value::Null);
        check(node, mesh, &element_name("node", index, node))?;
    }
    Ok(())
}

/// Checks all primitives of all meshes.
pub(super) fn check(json: &Value, accessors: &[Accessor<'_>]) -> Result<(), Fault> {
    let required = items(json, "extensionsRequired");
    let check = Check {
        accessors,
        materials: items(json, "materials"),
        quantized: required.contains(&Value::from("KHR_mesh_quantization")),
    };
    for (index, mesh) in items(json, "meshes").iter().enumerate() {
        for (number, primitive) in items(mesh, "primitives").iter().enumerate() {
            let place = format!("{}, primitive {number}", element_name("mesh", index, mesh));
            check.primitive(primitive, &place)?;
        }
    }
    Ok(())
}

struct Check<'a> {
    accessors: &'a [Accessor<'a>],
    materials: &'a [Value],
    /// Whether attributes may be integers.
    quantized: bool,
}

impl Check<'_> {
    fn primitive(&self, primitive: &Value, place: &str) -> Result<(), Fault> {
        let none = Value::Null;
        let attributes = primitive.get("attributes").unwrap_or(&none);
        let vertex_count = self.attributes(attributes, None, place)?;
        for (index, target) in items(primitive, "targets").iter().enumerate() {
            let place = format!("{place}, morph target {index}");
            let target_count = self.attributes(target, Some(attributes), &place)?;
            require(
                target_count.is_none() || target_count == vertex_count,
                &place,
                || "it has another number of vertices than its primitive",
            )?;
        }
        if let Some(indices) = reference(primitive, "indices") {
            self.indices(indices, vertex_count, place)?;
        }
        let material = reference(primitive, "material").and_then(|at| self.materials.get(at));
        material.map_or(Ok(()), |material| {
            check_material(material, attributes, place)
        })
    }

    /// Checks attributes of a primitive, or of a morph target for the attributes in `base`, and returns the number of
    /// vertices.
    fn attributes(
        &self,
        attributes: &Value,
        base: Option<&Value>,
        place: &str,
    ) -> Result<Option<usize>, Fault> {
        let mut vertex_count = None;
        for name in attributes
            .as_object()
            .into_iter()
            .flat_map(|map| map.keys())
        {
            require(is_semantic(name), place, || {
                format!("the attribute '{name}' does not exist; own ones begin with an underscore")
            })?;
            require(
                base.is_none_or(|base| base.get(name).is_some()),
                place,
                || format!("it has the attribute {name}, which its primitive lacks"),
            )?;
            let accessor = reference(attributes, name).and_then(|at| self.accessors.get(at));
            let Some(accessor) = accessor else {
                continue;
            };
            let count = *vertex_count.get_or_insert(accessor.count);
            require(accessor.count == count, place, || {
                format!(
                    "the attribute {name} has {} elements, others {count}",
                    accessor.count
                )
            })?;
            self.format(name, accessor, base.is_some(), place)?;
        }
        Ok(vertex_count)
    }

    /// Checks the formats of the attributes that are read, and the handedness of tangents.
    fn format(
        &self,
        name: &str,
        accessor: &Accessor<'_>,
        in_target: bool,
        place: &str,
    ) -> Result<(), Fault> {
        use Component::{F32, I8, I16, U8, U16, U32};
        let set = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let (shape, fits) = match (set, accessor.component, accessor.normalized) {
            ("POSITION" | "NORMAL", F32, _) => ("VEC3", true),
            ("POSITION", component, _) => ("VEC3", self.quantized && component != U32),
            ("NORMAL", I8 | I16, true) => ("VEC3", self.quantized),
            ("NORMAL", ..) => ("VEC3", false),
            ("TEXCOORD_", F32, _) | ("TEXCOORD_", U8 | U16, true) => ("VEC2", true),
            ("TEXCOORD_", component, _) => {
                let is_delta = in_target && component != U32;
                ("VEC2", is_delta || (self.quantized && component != U32))
            }
            _ => (accessor.shape, true),
        };
        require(fits && accessor.shape == shape, place, || {
            let normalized = if accessor.normalized {
                "normalized "
            } else {
                ""
            };
            format!(
                "the attribute {name} has the format {} of {normalized}{}, which it must not have{}",
                accessor.shape,
                accessor.component.name(),
                if self.quantized {
                    ""
                } else {
                    " unless the file requires KHR_mesh_quantization"
                }
            )
        })?;
        if name == "POSITION" && (accessor.min.is_none() || accessor.max.is_none()) {
            // An error by the letter of the specification, but such files are also found among sound ones.
            let feature = format!("{place} with positions without min and max");
            return Err(Fault::Unsupported(feature));
        }
        if name == "TANGENT" && !in_target && accessor.shape == "VEC4" && accessor.has_data() {
            let handedness = |element: &usize| accessor.value(*element, 3).abs() != 1.0;
            if let Some(element) = (0..accessor.count).find(handedness) {
                let reason = format!("the fourth component of tangent {element} is not 1 or -1");
                return Err(Fault::invalid(place, reason));
            }
        }
        Ok(())
    }

    fn indices(&self, index: usize, vertex_count: Option<usize>, place: &str) -> Result<(), Fault> {
        let Some(indices) = self.accessors.get(index) else {
            return Ok(());
        };
        let is_integer = matches!(
            indices.component,
            Component::U8 | Component::U16 | Component::U32
        );
        require(
            indices.shape == "SCALAR" && is_integer && !indices.normalized,
            place,
            || {
                format!(
                    "its indices have the format {} of {}, but must be SCALAR and unsigned integers",
                    indices.shape,
                    indices.component.name()
                )
            },
        )?;
        require(
            indices.stride() == indices.component.size(),
            place,
            || "the buffer view of its indices has a byteStride",
        )?;
        let Some(vertex_count) = vertex_count else {
            return Ok(());
        };
        let restart = indices.component.largest();
        for element in 0..indices.count {
            let value = indices.index(element);
            require(value != restart, place, || {
                format!("index {element} is {value}, which glTF reserves for primitive restart")
            })?;
            require((value as usize) < vertex_count, place, || {
                format!("index {element} is {value}, but there are only {vertex_count} vertices")
            })?;
        }
        Ok(())
    }
}

/// Whether the specification names an attribute, or leaves the name to applications.
fn is_semantic(name: &str) -> bool {
    if matches!(name, "POSITION" | "NORMAL" | "TANGENT") {
        return true;
    }
    if let Some(rest) = name.strip_prefix('_') {
        return !rest.is_empty();
    }
    ["TEXCOORD_", "COLOR_", "JOINTS_", "WEIGHTS_"]
        .iter()
        .filter_map(|prefix| name.strip_prefix(prefix))
        .any(|set| {
            let is_number = !set.is_empty() && set.bytes().all(|byte| byte.is_ascii_digit());
            is_number && (set == "0" || !set.starts_with('0'))
        })
}

/// Checks that a primitive has what its material needs.
fn check_material(material: &Value, attributes: &Value, place: &str) -> Result<(), Fault> {
    let extensions = material.get("extensions").and_then(Value::as_object);
    let parts = [Some(material), material.get("pbrMetallicRoughness")]
        .into_iter()
        .flatten()
        .chain(extensions.into_iter().flat_map(|map| map.values()));
    let textures = parts
        .filter_map(Value::as_object)
        .flatten()
        .filter(|(name, info)| name.ends_with("Texture") && info.get("index").is_some());
    for (name, info) in textures {
        let moved = info
            .pointer("/extensions/KHR_texture_transform")
            .and_then(|transform| integer(transform, "texCoord"));
        let set = moved.or(integer(info, "texCoord")).unwrap_or(0);
        let attribute = format!("TEXCOORD_{set}");
        require(attributes.get(&attribute).is_some(), place, || {
            format!("the {name} of its material needs the attribute {attribute}")
        })?;
    }
    let has = |name: &str| attributes.get(name).is_some();
    let anisotropy = material.pointer("/extensions/KHR_materials_anisotropy/anisotropyTexture");
    let has_tangents = has("NORMAL") && has("TANGENT");
    require(
        anisotropy.is_none() || has_tangents || material.get("normalTexture").is_some(),
        place,
        || "its material has an anisotropyTexture, which needs tangents or a normalTexture",
    )
}
