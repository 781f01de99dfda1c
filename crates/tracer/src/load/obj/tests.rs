use glam::{Vec2, Vec3};

use super::*;
use crate::load::test_files::{mesh, refusal, scene};
use crate::scene::Material;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn indices(text: &[u8]) -> Vec<[u32; 3]> {
    let (mesh, report) = mesh(&[("a.obj", text)]).unwrap();
    assert_eq!(report.notes().len(), 0, "{report:?}");
    mesh.indices().to_vec()
}

#[test]
fn encodings_line_ends_and_continued_lines_are_read() {
    let text = format!("# path C:\\\n{SQUARE}f 1 2 \\\n 3 \\\n4 # a quad");
    let expected = [[0, 1, 2], [0, 2, 3]];
    assert_eq!(indices(text.as_bytes()), expected);
    assert_eq!(indices(text.replace('\n', "\r\n").as_bytes()), expected);
    assert_eq!(indices(text.replace('\n', "\r").as_bytes()), expected);
    assert_eq!(indices(format!("\u{feff}{text}").as_bytes()), expected);
    let utf16: Vec<_> = format!("\u{feff}{text}").encode_utf16().collect();
    let little: Vec<_> = utf16.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    let big: Vec<_> = utf16.iter().flat_map(|unit| unit.to_be_bytes()).collect();
    assert_eq!(indices(&little), expected);
    assert_eq!(indices(&big), expected);
}

#[test]
fn indices_count_from_either_end_and_may_point_ahead() {
    assert_eq!(
        indices(format!("{SQUARE}f -4 -3 -2").as_bytes()),
        [[0, 1, 2]]
    );
    assert_eq!(
        indices(format!("f 1 3 4\n{SQUARE}").as_bytes()),
        [[0, 1, 2]]
    );
    let late = format!("{SQUARE}f -1 -2 -3\nv 9 9 9\nf -1 -2 -3");
    assert_eq!(indices(late.as_bytes()), [[0, 1, 2], [3, 0, 1]]);
}

#[test]
fn normals_and_texture_coordinates_follow_their_corners() {
    let text = "mtllib a.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0.25 0.25\nvt 1\nvn 0 0 2\n\
                f 1/1/1 2/2/1 3/1/1\nf 2 4 3\n";
    let library = b"newmtl red\nmap_Kd -clamp on -s 2 2 my image.png\n";
    let mut png = Vec::new();
    image::RgbImage::from_pixel(1, 1, image::Rgb([255, 0, 0]))
        .write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png)
        .unwrap();
    let files: [(&str, &[u8]); 3] = [
        ("a.obj", text.as_bytes()),
        ("a.mtl", library),
        ("my image.png", &png),
    ];
    let (scene, report) = scene(&files).unwrap();
    assert_eq!(report.notes().len(), 1, "{report:?}");
    assert!(
        report.notes()[0].ends_with("the option -s of map_Kd is left out"),
        "{report:?}"
    );
    let part = &scene.parts[0];
    let (up, none) = (Vec3::new(0.0, 0.0, 1.0), Vec3::ZERO);
    assert_eq!(
        part.normals.as_deref(),
        Some([up, up, up, none, none, none].as_slice())
    );
    let coordinates = part.texture_coordinates.as_ref().unwrap();
    assert_eq!(
        coordinates[..2],
        [Vec2::new(0.25, 0.75), Vec2::new(1.0, 1.0)]
    );
    let material = &scene.materials()[0];
    assert_eq!(
        material.color,
        Vec3::ONE,
        "the texture alone gives the colour"
    );
    assert!(material.texture.is_some());
}

#[test]
fn without_a_texture_corners_differ_only_by_position_and_normal() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 2/2 4/2 3/2\n";
    assert_eq!(indices(text.as_bytes()), [[0, 1, 2], [1, 3, 2]]);
}

fn materials(library: &str, names: &[&str]) -> (Vec<Material>, Vec<String>) {
    let faces: String = names
        .iter()
        .map(|name| format!("usemtl {name}\nf 1 2 3\n"))
        .collect();
    let text = format!("mtllib my lib.mtl\n{SQUARE}{faces}");
    let files: [(&str, &[u8]); 2] = [
        ("a.obj", text.as_bytes()),
        ("my lib.mtl", library.as_bytes()),
    ];
    let (scene, report) = scene(&files).unwrap();
    let material = |part: &crate::scene::Part| scene.materials[part.material.0].clone();
    (
        scene.parts.iter().map(material).collect(),
        report.notes().to_vec(),
    )
}

#[test]
fn illumination_models_become_mirrors_and_glass() {
    let library = "newmtl plain\nKd .5 .25 1\nKe 4 0 0\nillum 1\nnewmtl mirror\nKd 0 0 0\nKs .5 .25 0\nillum 3\n\
                   newmtl glass\nKd 1\nd 0.25\nNi 1.3\nillum 6\nnewmtl clear\nTf 1 1 1\nillum 7\n\
                   newmtl bottle\nillum 4\nNi 0.5\nTr 0.75\n";
    let (found, notes) = materials(library, &["plain", "mirror", "glass", "clear", "bottle"]);
    let [plain, mirror, glass, clear, bottle] = found.as_slice() else {
        panic!("five materials are used");
    };
    assert_eq!(
        (plain.color, plain.emission),
        (Vec3::new(0.5, 0.25, 1.0), Vec3::new(4.0, 0.0, 0.0))
    );
    assert_eq!((plain.mirror, plain.transmission), (0.0, 0.0));
    assert_eq!(
        (mirror.mirror, mirror.metallic, mirror.color),
        (0.5, true, Vec3::new(1.0, 0.5, 0.0))
    );
    assert_eq!((glass.transmission, glass.ior), (0.75, 1.3));
    assert_eq!((clear.transmission, clear.ior), (1.0, 1.5));
    assert_eq!((bottle.transmission, bottle.ior), (0.75, 1.0));
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(
        notes[0].contains("'bottle': an index of refraction"),
        "{notes:?}"
    );
}

#[test]
fn what_materials_leave_out_is_noted() {
    let library = "newmtl a\nKd 2 0 0\nKs 1 1 1\nd 0.5\nmap_bump b.png\nnewmtl b\nmap_Kd none.png\n\
                   newmtl c\nmap_Kd my lib.mtl\n";
    let (found, notes) = materials(library, &["a", "b", "c", "d", "d"]);
    assert_eq!(found[0].color, Vec3::X);
    assert_eq!(found[3], Material::default());
    for part in [
        "'map_bump' statements are left out (the first in line 5)",
        "'a': Kd is brought into the range",
        "'a': highlights (Ks) are left out",
        "'a': transparency (d, Tr) without a glass",
        "'none.png': there is no such file; it is left out",
        "'my lib.mtl': The file extension",
        "without a definition get a default one: 'd'",
    ] {
        assert!(
            notes.iter().any(|note| note.contains(part)),
            "{part}: {notes:?}"
        );
    }
    assert_eq!(notes.len(), 7, "{notes:?}");
}

#[test]
fn a_given_material_takes_the_place_of_the_libraries() {
    let file = tempfile::NamedTempFile::with_suffix(".obj").unwrap();
    std::fs::write(
        file.path(),
        format!("mtllib none.mtl\nusemtl x\n{SQUARE}f 1 2 3\n"),
    )
    .unwrap();
    let mut import = Import::default();
    let material = import.builder.add_material(Material::default());
    import.material = Some(material);
    read(file.path(), &mut import).unwrap();
    assert_eq!(import.report.notes().len(), 0);
    assert_eq!(import.builder.finish().unwrap().materials().len(), 1);
}

#[test]
fn what_the_file_holds_beyond_polygons_is_noted() {
    let text = "v 0 0 0 1 0 0\nv 1 0 0 0.5\nv 0 1 0 1\nvw 1 2\nvn nan 0 0\nl 1 2\nl 2 3\np 1\ng a\nf 1//1 2//1 3//1\n";
    let (mesh, report) = mesh(&[("a.obj", text.as_bytes())]).unwrap();
    assert_eq!(mesh.len(), 1);
    for (note, part) in report.notes().iter().zip([
        "colours of vertices are left out (1, the first in line 1)",
        "weights of vertices are left out (1, the first in line 2)",
        "'vw' statements are left out (1, the first in line 4)",
        "normals that are not finite are left out (1, the first in line 5)",
        "lines are left out (2, the first in line 6)",
        "points are left out (1, the first in line 8)",
    ]) {
        assert!(note.ends_with(part), "{note}");
    }
    assert_eq!(report.notes().len(), 6);
}

#[test]
fn broken_files_are_refused_with_their_line() {
    for (more, part) in [
        ("v 1 2", "line 5: a position needs 3"),
        ("v 1 2 x", "line 5: 'x' is not a number"),
        ("v 1 2 nan", "line 5: 'nan' is not a finite f32"),
        ("v 1 2 1e39", "line 5: '1e39' is not a finite f32"),
        ("v 1 2 3 4 5", "line 5: a position has 3"),
        ("v 1 2 3 4 5 6 7 8", "line 5: a position with a colour"),
        ("vn 1 2", "line 5: a normal needs 3"),
        ("vt", "line 5: texture coordinates need"),
        (
            "f 1 2 5",
            "line 5: the face needs position 5, but the file has 4",
        ),
        (
            "f 1 2 0",
            "line 5: '0' in the corner '0' is no index of a position",
        ),
        (
            "f 1 2 -5",
            "line 5: '-5' in the corner '-5' is no index of a position",
        ),
        (
            "f 1 2 -9223372036854775808",
            "line 5: '-9223372036854775808' in the corner",
        ),
        (
            "f 1 2 9223372036854775808",
            "line 5: '9223372036854775808' in the corner",
        ),
        ("f 1 2 4294967296", "line 5: '4294967296' in the corner"),
        (
            "f 1/1 2/1 3/1",
            "line 5: the face needs texture coordinate 1, but the file has 0",
        ),
        (
            "f 1//1 2//1 3//1",
            "line 5: the face needs normal 1, but the file has 0",
        ),
        ("f 1//1 2 3", "line 5: some corners of the face"),
        ("f 1/1/1/1 2 3", "line 5: '1/1/1/1' is not a corner"),
        ("f /1 2 3", "line 5: '/1' "),
        ("f 1 2", "line 5: a face with 2 corners"),
        ("f", "line 5: a face with 0 corners"),
        ("f 1 2 \\\n\\\nx\n", "line 5: 'x' in the corner"),
        ("g a\n\0", "line 6: there is a zero byte"),
        ("mtllib", "line 5: 'mtllib' needs"),
    ] {
        let message = refusal("a.obj", format!("{SQUARE}{more}").as_bytes());
        assert!(message.starts_with(part), "{message}");
    }
    for contents in [
        b"".as_slice(),
        b"# nothing\n",
        b"solid a\nfacet normal 0 0 1\n",
        &[0x80; 99],
    ] {
        let message = refusal("a.obj", contents);
        assert!(
            message.starts_with("line 1: there is no statement"),
            "{message}"
        );
    }
}

#[test]
fn broken_libraries_are_refused_with_their_line() {
    for (library, part) in [
        ("Kd 1 1 1", "line 1: 'Kd' stands before"),
        ("newmtl a\nKd 1 1", "line 2: a colour needs"),
        ("newmtl a\nKd 1 1 x", "line 2: 'x' is not a number"),
        (
            "newmtl a\nKd xyz 1 1 1",
            "line 2: colours as 'xyz' are not supported",
        ),
        ("newmtl a\nd", "line 2: '' is not a number"),
        ("newmtl a\nNi inf", "line 2: 'inf' is not a finite"),
        (
            "newmtl a\nillum glass",
            "line 2: 'glass' is no illumination model",
        ),
    ] {
        let text = format!("mtllib a.mtl\n{SQUARE}");
        let error = mesh(&[("a.obj", text.as_bytes()), ("a.mtl", library.as_bytes())]).unwrap_err();
        let message = error.to_string();
        assert!(message.contains(&format!("a.mtl: {part}")), "{message}");
    }
}
