//! Mesh files of other projects, legal and broken. They lie outside the repository: without them nothing is tested.

use std::collections::HashMap;
use std::fs;
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};

use tahko_tracer::geometry::TriangleMesh;
use tahko_tracer::load::{LoadError, load_mesh};

/// Legal files in `mesh-invalid`: triangles, and why they are legal.
const LEGAL: [(&str, usize, &str); 18] = [
    (
        "assimp/empty_mat.obj",
        256,
        "only its material library is missing",
    ),
    (
        "assimp/regr_3429812.obj",
        4,
        "only its material library is missing",
    ),
    (
        "assimp/triangle_with_empty_solid.stl",
        1,
        "a solid may be empty",
    ),
    ("magnum-ply/colors-not-all.ply", 0, "colours are not read"),
    (
        "magnum-ply/colors-not-tightly-packed.ply",
        0,
        "properties may have any order",
    ),
    (
        "magnum-ply/colors4-not-same-type.ply",
        0,
        "properties may have any type",
    ),
    (
        "magnum-ply/custom-components-duplicate.ply",
        3,
        "only properties that are not read have equal names",
    ),
    (
        "magnum-ply/normals-not-tightly-packed.ply",
        0,
        "properties may have any order",
    ),
    (
        "magnum-ply/objectid-unsupported-type.ply",
        0,
        "other properties may have any type",
    ),
    (
        "magnum-ply/positions-not-tightly-packed.ply",
        0,
        "properties may have any order",
    ),
    (
        "magnum-ply/texcoords-not-all.ply",
        0,
        "texture coordinates are not read",
    ),
    (
        "magnum-ply/texcoords-not-tightly-packed.ply",
        0,
        "properties may have any order",
    ),
    (
        "tinyobjloader/issue-161-inconsistent-f.obj",
        12,
        "each face for itself is consistent",
    ),
    (
        "tinyobjloader/issue-319-002.obj",
        14,
        "polygons may be concave or degenerate",
    ),
    (
        "tinyobjloader/issue-330.obj",
        3,
        "polygons may be concave or degenerate",
    ),
    (
        "tinyobjloader/missing_material_file.obj",
        36,
        "materials may be undefined",
    ),
    ("trimesh/empty.stl", 0, "a solid may be empty"),
    ("trimesh/nancolor.obj", 12, "colours are not read"),
];

/// As [`LEGAL`]: files that are only unusual.
const UNUSUAL: [(&str, usize, &str); 3] = [
    (
        "trimesh/obj_with_no_face_in_chunk.obj",
        1,
        "groups may be empty",
    ),
    ("trimesh/points_emptyface.ply", 0, "points need no faces"),
    (
        "trimesh/singlevn.obj",
        2,
        "only its material library is missing",
    ),
];

/// Triangles of the files in `mesh-variants`. `None`: broken all the same, as the header ends too early.
const VARIANTS: [(&str, Option<usize>); 36] = [
    ("obj/box.obj", Some(12)),
    ("obj/box_longline.obj", Some(944)),
    ("obj/box_without_lineending.obj", Some(12)),
    ("obj/cornell_box.obj", Some(36)),
    ("obj/cube-vertexcol.obj", Some(12)),
    ("obj/cube_compressed.obj", Some(12)),
    ("obj/cube_mtllib_after_g.obj", Some(12)),
    ("obj/cube_with_vertexcolors.obj", Some(12)),
    ("obj/issue-235-usemtl-then-o.obj", Some(2)),
    ("obj/issue-356-leading-spaces-newmtl.obj", Some(0)),
    (
        "obj/leading-zero-in-exponent-notation-issue-210.obj",
        Some(1),
    ),
    ("obj/no_material.obj", Some(36)),
    ("obj/point_cloud.obj", Some(0)),
    ("obj/skin-weight.obj", Some(12)),
    ("obj/testline.obj", Some(0)),
    ("obj/tube.obj", Some(120)),
    ("ply/ascii.ply", Some(1)),
    ("ply/cube.ply", Some(12)),
    ("ply/cube_binary_header_with_RN_newline.ply", Some(12)),
    ("ply/cube_uv.ply", Some(12)),
    ("ply/custom-components-be.ply", Some(3)),
    ("ply/metadata.ply", Some(2)),
    ("ply/per-face-colors-be.ply", Some(3)),
    ("ply/points.ply", Some(0)),
    ("ply/points_bin.ply", Some(0)),
    (
        "ply/positions-char-colors4-ushort-texcoords-uchar-indices-short-be.ply",
        Some(3),
    ),
    (
        "ply/positions-colors-normals-texcoords-float-objectid-uint-indices-int.ply",
        Some(3),
    ),
    (
        "ply/positions-colors4-normals-texcoords-float-indices-int-be-unaligned.ply",
        Some(3),
    ),
    (
        "ply/positions-short-colors-uchar-texcoords-ushort-indices-char.ply",
        Some(3),
    ),
    (
        "ply/positions-ushort-normals-short-objectid-uchar-indices-uchar-be.ply",
        Some(3),
    ),
    ("ply/unknown-element.ply", None),
    ("stl/20mm-xyz-cube.stl", Some(260)),
    ("stl/3DSMaxExport.STL", Some(2000)),
    ("stl/Spider_binary.stl", Some(1368)),
    ("stl/triangle.stl", Some(1)),
    ("stl/two_objects_mixed_case_names.stl", Some(24)),
];

#[expect(clippy::print_stdout, reason = "a test that does nothing says so")]
fn scenes() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
    if !folder.is_dir() {
        println!("skipped: there is no {}", folder.display());
        return None;
    }
    Some(folder)
}

/// All mesh files below a folder, sorted.
fn mesh_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("the folder can be read") {
            let path = entry.expect("the entry can be read").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_none_or(|extension| extension != "mtl") {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

fn name(file: &Path, folder: &Path) -> String {
    let name = file
        .strip_prefix(folder)
        .expect("the file is in the folder");
    name.to_string_lossy().into_owned()
}

fn load(path: &Path) -> Result<TriangleMesh, LoadError> {
    catch_unwind(|| load_mesh(path))
        .unwrap_or_else(|_| panic!("panic in {}", path.display()))
        .map(|(mesh, _)| mesh)
}

/// Positions of the corners of all triangles.
fn corners(mesh: &TriangleMesh) -> Vec<[[u32; 3]; 3]> {
    mesh.triangles()
        .map(|triangle| {
            [triangle.a, triangle.b, triangle.c].map(|corner| corner.to_array().map(f32::to_bits))
        })
        .collect()
}

#[test]
fn meshes_have_the_triangles_of_the_table_that_comes_with_them() {
    let Some(folder) = scenes() else { return };
    let table = fs::read_to_string(folder.join("README.md")).expect("the table can be read");
    let mut count = 0;
    for line in table.lines() {
        let cells: Vec<_> = line.split('|').map(str::trim).collect();
        let [_, file, triangles, ..] = cells.as_slice() else {
            continue;
        };
        let file = file.trim_matches('`');
        let extension = Path::new(file)
            .extension()
            .unwrap_or_default()
            .to_ascii_lowercase();
        let (true, Ok(triangles)) = (
            ["obj", "ply", "stl"]
                .iter()
                .any(|known| extension == *known),
            triangles.replace(',', "").parse::<usize>(),
        ) else {
            continue;
        };
        let mesh = load(&folder.join(file)).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(mesh.len(), triangles, "{file}");
        count += 1;
    }
    assert!(count > 40, "only {count} files are in the table");
}

#[test]
fn variants_load_with_every_triangle() {
    let Some(folder) = scenes().map(|scenes| scenes.join("mesh-variants")) else {
        return;
    };
    let expected: HashMap<_, _> = VARIANTS.into_iter().collect();
    for file in mesh_files(&folder) {
        let name = name(&file, &folder);
        let triangles = load(&file).ok().map(|mesh| mesh.len());
        assert_eq!(Some(&triangles), expected.get(name.as_str()), "{name}");
    }
}

#[test]
fn broken_files_are_refused_with_a_place_and_legal_ones_load() {
    let Some(folder) = scenes().map(|scenes| scenes.join("mesh-invalid")) else {
        return;
    };
    let legal: HashMap<_, _> = LEGAL
        .into_iter()
        .chain(UNUSUAL)
        .map(|(name, triangles, _)| (name, triangles))
        .collect();
    let copies = tempfile::tempdir().expect("a temporary folder can be made");
    let mut refused = 0;
    for file in mesh_files(&folder) {
        let name = name(&file, &folder);
        let known = file.extension().is_some_and(|extension| {
            ["obj", "ply", "stl"]
                .iter()
                .any(|known| extension == *known)
        });
        if !known {
            // Of another format, or without an extension: it must be refused under every name.
            let unsupported = matches!(load(&file), Err(LoadError::Unsupported { .. }));
            assert!(unsupported, "{name}");
        }
        let extensions = if known {
            [""].as_slice()
        } else {
            &["obj", "ply", "stl"]
        };
        for extension in extensions {
            let mut path = file.clone();
            if !known {
                path = copies.path().join("copy").with_extension(extension);
                fs::write(&path, fs::read(&file).expect("the file can be read"))
                    .expect("it can be copied");
            }
            match (load(&path), legal.get(name.as_str())) {
                (Ok(mesh), triangles) => {
                    assert_eq!(Some(&mesh.len()), triangles, "{name} {extension}");
                }
                (Err(LoadError::Invalid { place, reason, .. }), None) => {
                    assert!(!place.is_empty() && !reason.is_empty(), "{name}");
                    refused += 1;
                }
                (Err(error), _) => panic!("{error}"),
            }
        }
    }
    assert!(refused > 20, "only {refused} files were refused");
}

/// What the reader of another project makes of a file, where it reads it at all.
fn reference(path: &Path) -> Option<Vec<[[u32; 3]; 3]>> {
    let extension = path.extension()?.to_ascii_lowercase();
    let triangles: Vec<[[f32; 3]; 3]> = match extension.to_str()? {
        "obj" => {
            let options = tobj::LoadOptions {
                triangulate: true,
                ignore_lines: true,
                ignore_points: true,
                ..tobj::LoadOptions::default()
            };
            let (models, _) = tobj::load_obj(path, &options).ok()?;
            let corner = |mesh: &tobj::Mesh, index: u32| {
                let start = 3 * index as usize;
                [0, 1, 2].map(|axis| mesh.positions[start + axis])
            };
            models
                .iter()
                .flat_map(|model| {
                    model
                        .mesh
                        .indices
                        .chunks(3)
                        .map(|chunk| [0, 1, 2].map(|i| corner(&model.mesh, chunk[i])))
                })
                .collect()
        }
        "stl" => {
            let mut file = fs::File::open(path).ok()?;
            let mesh = stl_io::read_stl(&mut file).ok()?;
            let corner = |index: usize| mesh.vertices[index].0;
            mesh.faces
                .iter()
                .map(|face| face.vertices.map(corner))
                .collect()
        }
        _ => return None,
    };
    Some(
        triangles
            .iter()
            .map(|corners| corners.map(|corner| corner.map(f32::to_bits)))
            .collect(),
    )
}

#[test]
fn other_readers_find_the_same_triangles() {
    let Some(folder) = scenes() else { return };
    let mut compared = 0;
    for part in ["cad", "interiors", "models", "stress", "mesh-variants"] {
        for file in mesh_files(&folder.join(part)) {
            // stl_io reads only the first solid of a file, and tobj takes lines with three points for polygons.
            if file.ends_with("two_objects_mixed_case_names.stl") || file.ends_with("testline.obj")
            {
                continue;
            }
            let (Some(expected), Ok(mesh)) = (reference(&file), load(&file)) else {
                continue;
            };
            assert!(corners(&mesh) == expected, "{}", file.display());
            compared += 1;
        }
    }
    assert!(compared > 20, "only {compared} files were compared");
}
