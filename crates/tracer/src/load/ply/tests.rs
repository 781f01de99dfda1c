use glam::Vec3;

use super::*;
use crate::load::load_mesh;
use crate::load::test_files::{mesh, refusal};

const TEXT: &str = "ply
format ascii 1.0
comment M\u{fc}ller
element vertex 5
property float x
property float y
property char gap
property double z
property uchar gap
element face 2
property list uchar int vertex_indices
end_header
0 .5 1 1. 2
1e0 0 1 0 2
1 1 -1 +0 2

0 1 1 0.1 2
0 0 1 1.00000017881393432617187501 2
4 0 1 2 3
3 0 1 4
";

#[test]
fn text_is_read_with_every_form_of_number() {
    for text in [
        TEXT.to_owned(),
        TEXT.replace('\n', "\r\n"),
        TEXT.trim_end().to_owned(),
    ] {
        let (mesh, report) = mesh(&[("a.ply", text.as_bytes())]).unwrap();
        assert_eq!(mesh.indices(), [[0, 1, 2], [0, 2, 3], [0, 1, 4]]);
        assert_eq!(mesh.vertices()[0], Vec3::new(0.0, 0.5, 1.0));
        assert_eq!(
            mesh.vertices()[4].z,
            1.0 + 2.0 * f32::EPSILON,
            "rounded once"
        );
        assert_eq!(report.notes().len(), 0, "{report:?}");
    }
}

/// A triangle at (1, 2, 3), (4, 2, 3), (1, 5, 3), with faces before vertices.
fn binary(big_endian: bool, position: &str, count: &str, index: &str) -> Vec<u8> {
    let format = if big_endian { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{format}_endian 1.0\nelement face 1\nproperty list {count} {index} vertex_index\n\
         element vertex 3\nproperty {position} x\nproperty {position} y\nproperty {position} z\nend_header\n"
    )
    .into_bytes();
    let mut push = |value: u8, kind: &str| {
        let mut value = match kind {
            "char" | "uint8" => vec![value],
            "int16" | "ushort" => u16::from(value).to_le_bytes().to_vec(),
            "float" => f32::from(value).to_le_bytes().to_vec(),
            "float64" => f64::from(value).to_le_bytes().to_vec(),
            _ => u32::from(value).to_le_bytes().to_vec(),
        };
        if big_endian {
            value.reverse();
        }
        bytes.extend(value);
    };
    push(3, count);
    (0..3).for_each(|corner| push(corner, index));
    for coordinate in [1, 2, 3, 4, 2, 3, 1, 5, 3] {
        push(coordinate, position);
    }
    bytes
}

#[test]
fn binary_files_are_read_in_both_byte_orders_with_every_type() {
    const TYPES: [&str; 8] = [
        "char", "uint8", "int16", "ushort", "int", "uint32", "float", "float64",
    ];
    for big_endian in [false, true] {
        for position in TYPES {
            for index in TYPES {
                for count in &TYPES[..6] {
                    let bytes = binary(big_endian, position, count, index);
                    let (mesh, report) = mesh(&[("a.ply", &bytes)]).unwrap();
                    assert_eq!(mesh.indices(), [[0, 1, 2]], "{position} {count} {index}");
                    let expected = [[1.0, 2.0, 3.0], [4.0, 2.0, 3.0], [1.0, 5.0, 3.0]];
                    assert_eq!(mesh.vertices(), expected.map(Vec3::from_array));
                    assert_eq!(report.notes().len(), 0);
                }
            }
        }
    }
}

#[test]
fn strips_are_unrolled_with_their_winding() {
    let text = "ply\nformat ascii 1.0\nelement vertex 5\nproperty int x\nproperty int y\nproperty int z\n\
                element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
                0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 0\n8 0 1 2 3 -1 2 3 4\n";
    let (mesh, _) = mesh(&[("a.ply", text.as_bytes())]).unwrap();
    assert_eq!(mesh.indices(), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
}

#[test]
fn points_without_faces_are_an_empty_mesh_and_noted() {
    let text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
                property uchar red\nend_header\n1 2 3 4\n";
    let (mesh, report) = mesh(&[("a.ply", text.as_bytes())]).unwrap();
    assert_eq!((mesh.len(), mesh.vertices().len()), (0, 0));
    assert!(report.notes()[0].contains("only 1 points"), "{report:?}");
    assert!(report.notes()[1].contains("colours"), "{report:?}");
}

#[test]
fn normals_are_kept_and_texture_coordinates_only_where_the_material_is_given() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n\
                element face 1\nproperty list uchar int vertex_indices\nend_header\n\
                0 0 0 0 0 2 0 0\n1 0 0 0 2 0 1 0\n0 1 0 nan 0 0 0 1\n3 0 1 2\n";
    let file = tempfile::NamedTempFile::with_suffix(".ply").unwrap();
    std::fs::write(file.path(), text).unwrap();
    let mut import = Import::default();
    read(file.path(), &mut import).unwrap();
    let texture = crate::scene::Texture::new(1, 1, vec![[9; 3]]).unwrap();
    let texture = Some(import.builder.add_texture(texture));
    import.material = Some(import.builder.add_material(crate::scene::Material {
        texture,
        ..Default::default()
    }));
    read(file.path(), &mut import).unwrap();
    assert!(import.report.notes()[0].contains("1 normals are not finite"));
    let scene = import.builder.finish().unwrap();
    let normals = scene.parts[0].normals.as_deref();
    assert_eq!(normals, Some([Vec3::Z, Vec3::Y, Vec3::ZERO].as_slice()));
    assert!(
        scene.parts[0].texture_coordinates.is_none(),
        "nothing reads them"
    );
    let coordinates = scene.parts[1].texture_coordinates.as_ref().unwrap();
    assert_eq!(coordinates[2], glam::Vec2::ZERO, "v is turned over");
}

#[test]
fn broken_text_is_refused_with_line_and_element() {
    let broken = |from: &str, to: &str| refusal("a.ply", TEXT.replacen(from, to, 1).as_bytes());
    for (message, part) in [
        (
            broken("1e0", "1e99"),
            "line 14, vertex 1: a coordinate is not a finite f32",
        ),
        (
            broken("1e0", "nan"),
            "line 14, vertex 1: a coordinate is not a finite f32",
        ),
        (broken("1e0", "x"), "line 14, vertex 1: 'x' is not a number"),
        (
            broken("1e0 ", ""),
            "line 14, vertex 1: the line has too few values",
        ),
        (
            broken("1e0", "1 1"),
            "line 14, vertex 1: the line has more values",
        ),
        (
            broken("4 0 1 2 3", "4 0 1 2 3.5"),
            "line 19, face 0: '3.5' is not an integer of the declared type",
        ),
        (
            broken("4 0 1 2 3", "4 0 1 2 5"),
            "line 19, face 0: vertex 5 is not among the 5 vertices",
        ),
        (
            broken("4 0 1 2 3", "4 0 1 2 -1"),
            "line 19, face 0: vertex -1 is not",
        ),
        (
            broken("4 0 1 2 3", "2 0 1"),
            "line 19, face 0: a polygon with 2 corners",
        ),
        (
            broken("4 0 1 2 3", "-4 0"),
            "line 19, face 0: '-4' is not an integer",
        ),
        (
            broken("3 0 1 4\n", ""),
            "line 19, face 1: the file ends before",
        ),
        (
            broken("3 0 1 4\n", "3 0 1 4\n\n3 0 1 2\n"),
            "line 22: there are more lines",
        ),
        (
            broken("face 2", "face 4000000000"),
            "element 'face': the header announces 4000000000",
        ),
        (
            broken("vertex 5", "vertex 4294967295"),
            "element 'vertex': the header announces",
        ),
        (
            broken("vertex 5", "vertex 4294967296"),
            "line 4: '4294967296' is not a count",
        ),
    ] {
        assert!(message.starts_with(part), "{message}");
    }
}

#[test]
fn broken_headers_are_refused_with_their_line() {
    let broken = |from: &str, to: &str| refusal("a.ply", TEXT.replacen(from, to, 1).as_bytes());
    for (message, part) in [
        (refusal("a.ply", b""), "line 1: a PLY file starts with"),
        (
            refusal("a.ply", &[0x80; 999]),
            "line 1: a PLY file starts with",
        ),
        (
            broken("ascii 1.0", "ascii 2.0"),
            "line 2: the format is 'ascii 2.0'",
        ),
        (
            broken("ascii 1.0", "ascii"),
            "line 2: the format is 'ascii'",
        ),
        (
            broken("format ascii 1.0\n", ""),
            "line 11: the header has no 'format' line",
        ),
        (broken("comment", "remark"), "line 3: 'remark"),
        (
            broken("element vertex 5\n", ""),
            "line 4: a property stands before",
        ),
        (
            broken("float x", "float16 x"),
            "line 5: 'float16' is not a type",
        ),
        (
            broken("float x", "float w"),
            "header: the vertices need the properties x, y and z",
        ),
        (
            broken("float y", "float x"),
            "header: the vertices need the properties x, y and z",
        ),
        (
            broken("char gap", "char nx"),
            "header: the vertices need all of nx, ny and nz",
        ),
        (
            broken("list uchar", "list float"),
            "line 11: the length of a list",
        ),
        (
            broken("int vertex_indices", "int corners"),
            "header: the element 'face' needs one list",
        ),
        (
            broken("element face", "element vertex"),
            "header: the element 'vertex' is there twice",
        ),
        (
            broken("end_header", "comment"),
            "line 13: '0 .5 1 1. 2' is not a line",
        ),
    ] {
        assert!(message.starts_with(part), "{message}");
    }
}

#[test]
fn broken_binary_files_are_refused_with_their_element() {
    let good = binary(false, "float", "uint8", "int");
    for (cut, part) in [
        (1, "element 'vertex'"),
        (13, "element 'vertex'"),
        (48, "element 'face'"),
    ] {
        let message = refusal("a.ply", &good[..good.len() - cut]);
        assert!(message.starts_with(part), "{message}");
    }
    let values = good.len() - 49;
    for (offset, byte, part) in [
        (0, 2, "face 0: a polygon with 2 corners"),
        (0, 255, "face 0: vertex 1065353216 is not among"),
        (
            4,
            0x7f,
            "face 0: vertex 2130706432 is not among the 3 vertices",
        ),
    ] {
        let mut bytes = good.clone();
        bytes[values + offset] = byte;
        let message = refusal("a.ply", &bytes);
        assert!(message.starts_with(part), "{message}");
    }
    let mut bytes = good.clone();
    bytes[values + 13..values + 17].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let message = refusal("a.ply", &bytes);
    assert!(
        message.starts_with("vertex 0: a coordinate is not a finite f32"),
        "{message}"
    );
    let (_, report) = mesh(&[("a.ply", &[good.as_slice(), b"more"].concat())]).unwrap();
    assert!(report.notes()[0].contains("4 bytes after"), "{report:?}");
}

#[test]
fn a_missing_file_is_an_io_error() {
    let error = load_mesh(Path::new("/no/such/file.ply")).unwrap_err();
    assert!(matches!(error, LoadError::Io { .. }), "{error}");
}
