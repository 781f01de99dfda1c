//! From material libraries to the materials of the scene.
//!
//! `Kd` and the other colours are taken as linear. The illumination models (`illum`) 3, 5 and 8 mirror the part `Ks`; 4, 6,
//! 7 and 9 are glass, refracting what `d`, `Tr` or `Tf` let pass. All others are diffuse: highlights are
//! left out.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::mtl::{self, Definition};
use super::statements::Document;
use super::texture::Map;
use crate::load::text::{decode, quoted};
use crate::load::{Import, LoadError};
use crate::scene::{Material, MaterialId, TextureId};

/// A material, and whether texture coordinates matter to it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resolved {
    pub(super) id: MaterialId,
    pub(super) is_textured: bool,
}

/// The materials of a document, in its order. Those that no library defines become the default material.
pub(super) fn resolve(
    path: &Path,
    document: &Document,
    import: &mut Import,
) -> Result<Vec<Resolved>, LoadError> {
    let definitions = read_libraries(path, document, import)?;
    let mut textures = HashMap::new();
    let mut undefined = Vec::new();
    let mut resolved = Vec::with_capacity(document.materials.len());
    let mut default = None;
    for name in &document.materials {
        let found = name
            .as_ref()
            .and_then(|name| definitions.get_key_value(name));
        let Some((name, (library, definition))) = found else {
            undefined.extend(name.as_deref().map(quoted));
            resolved.push(*default.get_or_insert_with(|| Resolved {
                id: import.material_or_default(),
                is_textured: false,
            }));
            continue;
        };
        let (mut material, notes) = convert(name, definition);
        for note in notes {
            import.note(library, &format!("material {}: {note}", quoted(name)));
        }
        if let Some(statement) = &definition.diffuse_map {
            let map = Map::parse(statement);
            for option in &map.left_out {
                import.note(
                    library,
                    &format!(
                        "material {}: the option {option} of map_Kd is left out",
                        quoted(name)
                    ),
                );
            }
            material.texture = *textures
                .entry((library.clone(), map.file.clone(), map.clamp))
                .or_insert_with(|| load_texture(library, &map, import));
        }
        resolved.push(Resolved {
            is_textured: material.texture.is_some(),
            id: import.builder.add_material(material),
        });
    }
    if !undefined.is_empty() {
        const LIMIT: usize = 20;
        let more = if undefined.len() > LIMIT { ", ..." } else { "" };
        undefined.truncate(LIMIT);
        import.note(
            path,
            &format!(
                "materials without a definition get a default one: {}{more}",
                undefined.join(", ")
            ),
        );
    }
    Ok(resolved)
}

fn load_texture(library: &Path, map: &Map, import: &mut Import) -> Option<TextureId> {
    let folder = library.parent().unwrap_or(Path::new(""));
    match map.load(folder) {
        Ok(texture) => Some(import.builder.add_texture(texture)),
        Err(reason) => {
            import.note(library, &format!("{reason}; it is left out"));
            None
        }
    }
}

type Definitions = HashMap<String, (PathBuf, Definition)>;

fn read_libraries(
    path: &Path,
    document: &Document,
    import: &mut Import,
) -> Result<Definitions, LoadError> {
    let mut definitions = HashMap::new();
    let mut seen = HashSet::new();
    for (name, file) in document
        .libraries
        .iter()
        .flat_map(|names| files(path, names))
    {
        if !seen.insert(file.clone()) {
            continue;
        }
        if !file.is_file() {
            import.note(
                path,
                &format!("the material library {} is not there", quoted(name)),
            );
            continue;
        }
        let bytes = std::fs::read(&file).map_err(|source| LoadError::io(&file, source))?;
        let library = mtl::parse(&decode(&bytes))
            .map_err(|(line, reason)| LoadError::invalid(&file, format!("line {line}"), reason))?;
        for note in &library.notes {
            import.note(&file, note);
        }
        for (name, definition) in library.definitions {
            // Of libraries that define the same name, the first one counts.
            definitions
                .entry(name)
                .or_insert_with(|| (file.clone(), definition));
        }
    }
    Ok(definitions)
}

/// The files of a `mtllib` statement, as written and where they are: one whose name may hold spaces, or else several.
fn files<'a>(path: &Path, names: &'a str) -> Vec<(&'a str, PathBuf)> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let file = |name: &'a str| (name, folder.join(name.replace('\\', "/")));
    let whole = file(names);
    if whole.1.is_file() {
        return vec![whole];
    }
    names.split_whitespace().map(file).collect()
}

/// The material for a definition, and notes on what it cannot express.
fn convert(name: &str, definition: &Definition) -> (Material, Vec<&'static str>) {
    let mut notes = Vec::new();
    let default = Material::default();
    let white_below_texture = definition.diffuse_map.as_ref().map(|_| Vec3::ONE);
    let mut unit = |color: Vec3, note| {
        let clamped = color.clamp(Vec3::ZERO, Vec3::ONE);
        if clamped != color {
            notes.push(note);
        }
        clamped
    };
    let mut material = Material {
        name: name.to_owned(),
        color: unit(
            definition
                .diffuse
                .or(white_below_texture)
                .unwrap_or(default.color),
            "Kd is brought into the range 0 to 1",
        ),
        emission: definition.emission.unwrap_or(Vec3::ZERO).max(Vec3::ZERO),
        ..default
    };
    let specular = definition
        .specular
        .map(|color| unit(color, "Ks is brought into the range 0 to 1"));
    let filter = definition
        .filter
        .map(|color| unit(color, "Tf is brought into the range 0 to 1"));
    if definition
        .emission
        .is_some_and(|emission| emission != material.emission)
    {
        notes.push("negative emission (Ke) is left out");
    }
    match definition.illumination.unwrap_or(2) {
        3 | 5 | 8 => make_mirror(&mut material, specular.unwrap_or(Vec3::ONE), &mut notes),
        4 | 6 | 7 | 9 => make_glass(&mut material, definition, filter, &mut notes),
        _ => {
            if specular.is_some_and(|color| color != Vec3::ZERO)
                && definition.illumination.is_none_or(|model| model == 2)
            {
                notes.push("highlights (Ks) are left out");
            }
            if definition.opacity.is_some_and(|opacity| opacity < 1.0) {
                notes.push("transparency (d, Tr) without a glass illumination model (illum 4, 6, 7 or 9) is left out");
            }
        }
    }
    (material, notes)
}

fn make_mirror(material: &mut Material, specular: Vec3, notes: &mut Vec<&'static str>) {
    material.mirror = specular.max_element();
    if specular.min_element() == specular.max_element() {
        return;
    }
    if material.color == Vec3::ZERO && material.texture.is_none() {
        // Without a diffuse part the colour is free to tint the mirror.
        material.color = specular / material.mirror;
        material.metallic = true;
        return;
    }
    notes.push("the mirror (Ks) is taken as grey");
}

fn make_glass(
    material: &mut Material,
    definition: &Definition,
    filter: Option<Vec3>,
    notes: &mut Vec<&'static str>,
) {
    material.transmission = match (definition.opacity, filter) {
        (Some(opacity), _) if opacity < 1.0 => (1.0 - opacity).clamp(0.0, 1.0),
        (_, Some(filter)) => filter.max_element(),
        (Some(_), None) => 0.0,
        (None, None) => 1.0,
    };
    if filter.is_some_and(|filter| filter.min_element() != filter.max_element()) {
        notes.push("the colour of glass (Tf) is taken as grey");
    }
    let ior = definition.ior.unwrap_or(material.ior);
    if ior < 1.0 {
        notes.push("an index of refraction (Ni) below 1 is taken as 1");
    }
    material.ior = ior.max(1.0);
}
