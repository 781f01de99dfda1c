//! Small files, each made for one feature or one fault.

mod hostile;
mod looks;

use std::fs;

use glam::{DVec3, Vec3};
use tahko_geometry::Hit;
use tempfile::TempDir;

use crate::load::{Import, LoadError, LoadReport, load_scene};
use crate::scene::Scene;

type Loaded = Result<(Scene, LoadReport), LoadError>;

/// The corners of a unit square, in the order of a strip.
const SQUARE: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [1.0, 1.0, 0.0],
];

const POSITIONS: &str =
    r#"{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}"#;

/// Loads a file with the given properties and one external buffer.
fn load(properties: &str, buffer: &[u8]) -> Loaded {
    let folder = TempDir::new().unwrap();
    let length = buffer.len();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":"data%20%C3%A4.bin","byteLength":{length}}}],{properties}}}"#
    );
    fs::write(folder.path().join("data ä.bin"), buffer).unwrap();
    let path = folder.path().join("test.gltf");
    fs::write(&path, json).unwrap();
    load_scene(&path)
}

/// Loads a file whose buffer begins with the positions of a square. `more` is what the buffer and its views and
/// accessors go on with.
fn load_square(properties: &str, more: &More<'_>) -> Loaded {
    let mut buffer = floats(SQUARE.as_flattened());
    buffer.extend(more.buffer);
    let (views, accessors) = (more.views, more.accessors);
    load(
        &format!(
            r#"{properties},
            "bufferViews":[{{"buffer":0,"byteLength":48}}{views}],
            "accessors":[{POSITIONS}{accessors}]"#
        ),
        &buffer,
    )
}

#[derive(Default)]
struct More<'a> {
    buffer: &'a [u8],
    views: &'a str,
    accessors: &'a str,
}

fn floats(values: &[f32]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

/// A node that shows a mesh with one primitive of the given properties.
fn one_mesh(primitive: &str) -> String {
    format!(
        r#""nodes":[{{"mesh":0}}],"meshes":[{{"name":"wheel","primitives":[{{{primitive}}}]}}]"#
    )
}

fn square_message(primitive: &str, more: &More<'_>) -> String {
    load_square(&one_mesh(primitive), more)
        .unwrap_err()
        .to_string()
}

fn triangles(scene: &Scene) -> Vec<[[f32; 3]; 3]> {
    let triangles = scene.mesh().triangles();
    triangles
        .map(|triangle| triangle.vertices().map(<[f32; 3]>::from))
        .collect()
}

fn hit(primitive: u32, u: f32, v: f32) -> Hit {
    Hit {
        t: 1.0,
        u,
        v,
        primitive,
    }
}

#[test]
fn strips_and_fans_are_unrolled_for_every_index_type() {
    let indices: [(u32, &[u8]); 3] = [
        (5121, &[0, 1, 2, 3]),
        (5123, &[0, 0, 1, 0, 2, 0, 3, 0]),
        (5125, &[0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0]),
    ];
    for (component, buffer) in indices {
        let views = format!(
            r#",{{"buffer":0,"byteOffset":48,"byteLength":{}}}"#,
            buffer.len()
        );
        let accessors =
            format!(r#",{{"bufferView":1,"componentType":{component},"count":4,"type":"SCALAR"}}"#);
        let more = More {
            buffer,
            views: &views,
            accessors: &accessors,
        };
        let shown = |mode: u32| {
            let primitive = format!(r#""attributes":{{"POSITION":0}},"indices":1,"mode":{mode}"#);
            let (scene, report) = load_square(&one_mesh(&primitive), &more).unwrap();
            (scene.mesh().indices().to_vec(), report.notes().to_vec())
        };
        assert_eq!(shown(5).0, [[0, 1, 2], [1, 3, 2]], "strip of {component}");
        assert_eq!(shown(6).0, [[1, 2, 0], [2, 3, 0]], "fan of {component}");
        let (list, notes) = shown(4);
        assert_eq!(list, [[0, 1, 2]], "list of {component}");
        assert!(notes[0].contains("last 1 of 4 vertices"), "{notes:?}");
        let (points, notes) = shown(0);
        assert!(points.is_empty(), "points make no triangles");
        assert!(notes[0].contains("consists of points"), "{notes:?}");
    }
}

#[test]
fn nodes_place_a_shared_mesh_and_mirrors_keep_fronts() {
    let properties = r#""scene":0,"scenes":[{"nodes":[0]},{"name":"other"}],
        "nodes":[
            {"children":[1,2],"translation":[10,0,0]},
            {"mesh":0,"scale":[-1,1,1]},
            {"mesh":0,"matrix":[0,1,0,0,-1,0,0,0,0,0,1,0,0,0,5,1]},
            {"mesh":0,"name":"elsewhere"}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#;
    let (scene, report) = load_square(properties, &More::default()).unwrap();
    assert_eq!(
        triangles(&scene),
        [
            [[10.0, 0.0, 0.0], [10.0, 1.0, 0.0], [9.0, 0.0, 0.0]],
            [[10.0, 0.0, 5.0], [10.0, 1.0, 5.0], [9.0, 0.0, 5.0]],
        ]
    );
    assert!(
        report
            .notes()
            .iter()
            .any(|note| note.contains("scene 1 'other'")),
        "{report:?}"
    );
}

#[test]
fn flattened_and_deep_nodes_are_no_trouble() {
    let mut nodes = r#"{"scale":[1,0,1],"mesh":0,"name":"flat"}"#.to_owned();
    let depth = 20_000;
    for index in 1..=depth {
        let next = index + 1;
        nodes += &format!(r#",{{"children":[{next}],"translation":[1,0,0]}}"#);
    }
    nodes += r#",{"mesh":0}"#;
    let meshes = r#""meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#;
    let (scene, report) =
        load_square(&format!(r#""nodes":[{nodes}],{meshes}"#), &More::default()).unwrap();
    assert_eq!(scene.mesh().vertices()[0], Vec3::new(20_000.0, 0.0, 0.0));
    assert!(report.notes()[0].contains("node 0 'flat'"), "{report:?}");
}

#[test]
fn interleaved_quantized_and_sparse_values_are_read() {
    // Per vertex: a normal as three normalized bytes and a pad, then texture coordinates as normalized shorts.
    let mut buffer = Vec::new();
    for [x, y, _] in SQUARE {
        let coordinate = |value: f32| if value > 0.5 { u16::MAX } else { 0 };
        buffer.extend([0, 0, 127, 0]);
        buffer.extend([x, y].into_iter().flat_map(|v| coordinate(v).to_le_bytes()));
    }
    // The third position is replaced.
    buffer.extend([2, 0, 0, 0]);
    buffer.extend(floats(&[0.5, 2.0, 0.0]));
    let more = More {
        buffer: &buffer,
        views: r#",{"buffer":0,"byteOffset":48,"byteLength":32,"byteStride":8}
            ,{"buffer":0,"byteOffset":80,"byteLength":4},{"buffer":0,"byteOffset":84,"byteLength":12}"#,
        accessors: r#",{"bufferView":1,"componentType":5120,"count":4,"type":"VEC3","normalized":true}
            ,{"bufferView":1,"byteOffset":4,"componentType":5123,"count":4,"type":"VEC2","normalized":true}
            ,{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,2,0],
              "sparse":{"count":1,"indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":3}}}"#,
    };
    let primitive = r#""attributes":{"POSITION":3,"NORMAL":1,"TEXCOORD_0":2},"mode":5"#;
    let extensions = r#""extensionsUsed":["KHR_mesh_quantization"],
        "extensionsRequired":["KHR_mesh_quantization"],"#;
    let properties = extensions.to_owned() + &one_mesh(primitive);
    let (scene, report) = load_square(&properties, &more).unwrap();
    assert_eq!(scene.mesh().vertices()[2], Vec3::new(0.5, 2.0, 0.0));
    assert_eq!(scene.mesh().vertices()[3], Vec3::new(1.0, 1.0, 0.0));
    assert_eq!(scene.shading_normal(&hit(0, 0.2, 0.3)), Some(DVec3::Z));
    assert_eq!(report.notes(), [""; 0]);
    let error = load_square(&one_mesh(primitive), &more)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("NORMAL") && error.contains("KHR_mesh_quantization"),
        "{error}"
    );
}

#[test]
fn buffers_can_be_in_the_file_itself() {
    let folder = TempDir::new().unwrap();
    let rest = format!(
        r#""bufferViews":[{{"buffer":0,"byteLength":48}}],"accessors":[{POSITIONS}],{}}}"#,
        one_mesh(r#""attributes":{"POSITION":0},"mode":5"#)
    );
    let embedded = r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":48,
        "uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAACAPwAAgD8AAAAA"}],"#;
    let text = folder.path().join("embedded.gltf");
    fs::write(&text, embedded.to_owned() + &rest).unwrap();
    let text = load_scene(&text).unwrap().0;

    let mut json =
        r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":48}],"#.to_owned() + &rest;
    json += &" ".repeat(json.len().next_multiple_of(4) - json.len());
    let data = floats(SQUARE.as_flattened());
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    let length = |length: usize| u32::try_from(length).unwrap().to_le_bytes();
    bytes.extend(length(12 + 8 + json.len() + 8 + data.len()));
    for (kind, data) in [(b"JSON", json.as_bytes()), (b"BIN\0", &data)] {
        bytes.extend(length(data.len()));
        bytes.extend(kind);
        bytes.extend(data);
    }
    let binary = folder.path().join("binary.GLB");
    fs::write(&binary, bytes).unwrap();
    let binary = load_scene(&binary).unwrap().0;
    for scene in [text, binary] {
        assert_eq!(scene.mesh().vertices(), SQUARE.map(Vec3::from));
        assert_eq!(scene.mesh().indices(), [[0, 1, 2], [1, 3, 2]]);
    }
}

#[test]
fn faults_name_file_place_and_reason() {
    let attributes = r#""attributes":{"POSITION":0}"#;
    let message = square_message(r#""attributes":{}"#, &More::default());
    assert!(
        message.contains("test.gltf: mesh 0 'wheel', primitive 0: it has no attribute POSITION"),
        "{message}"
    );

    let indices = |component: u32, buffer: &[u8]| {
        let views = format!(
            r#",{{"buffer":0,"byteOffset":48,"byteLength":{}}}"#,
            buffer.len()
        );
        let accessors =
            format!(r#",{{"bufferView":1,"componentType":{component},"count":3,"type":"SCALAR"}}"#);
        let more = More {
            buffer,
            views: &views,
            accessors: &accessors,
        };
        square_message(&format!(r#"{attributes},"indices":1"#), &more)
    };
    assert!(
        indices(5121, &[0, 1, 4]).contains("index 2 is 4, but there are only 4 vertices"),
        "range"
    );
    assert!(
        indices(5121, &[0, 255, 1]).contains("primitive restart"),
        "restart"
    );
    assert!(indices(5120, &[0, 1, 2]).contains("BYTE"), "signed indices");
    assert!(
        indices(5123, &[0, 1, 2]).contains("reach over the end of its buffer view of 3 bytes"),
        "too short"
    );

    let with_accessor = |accessor: &str| {
        let accessors = format!(",{accessor}");
        let more = More {
            accessors: &accessors,
            ..More::default()
        };
        square_message(r#""attributes":{"POSITION":1}"#, &more)
    };
    let huge =
        r#"{"bufferView":0,"componentType":5126,"count":18446744073709551615,"type":"VEC3"}"#;
    assert!(
        with_accessor(huge).contains("accessor 1"),
        "a count that overflows"
    );
    let far = r#"{"bufferView":0,"byteOffset":18446744073709551612,"componentType":5126,"count":1,"type":"VEC3"}"#;
    assert!(
        with_accessor(far).contains("accessor 1"),
        "an offset that overflows"
    );
    let zeros = r#"{"componentType":5126,"count":4000000000,"type":"VEC3"}"#;
    assert!(
        with_accessor(zeros).contains("too many"),
        "gigabytes of zeros"
    );
    let cut = r#"{"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":9,
        "indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0}}}"#;
    assert!(
        with_accessor(cut).contains("9 sparse values replace only 3 elements"),
        "sparse count"
    );

    let nan = load(
        &(one_mesh(attributes)
            + r#","bufferViews":[{"buffer":0,"byteLength":36}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}]"#),
        &floats(&[0.0, 0.0, 0.0, 1.0, f32::NAN, 0.0, 0.0, 0.0, 0.0]),
    );
    let nan = nan.unwrap_err().to_string();
    assert!(
        nan.contains("accessor 0: component 1 of element 1 is NaN"),
        "{nan}"
    );
}

#[test]
fn a_small_file_that_shows_too_much_is_refused_at_once() {
    // Each of 300 nodes shows a fan over 16 million implied vertices.
    let nodes = vec![r#"{"mesh":0}"#; 300].join(",");
    let properties = format!(
        r#""nodes":[{nodes}],"meshes":[{{"primitives":[{{"mode":6,"attributes":{{"POSITION":0}}}}]}}],
        "accessors":[{{"componentType":5126,"count":16777216,"type":"VEC3","min":[0,0,0],"max":[0,0,0]}}]"#
    );
    let error = load(&properties, &[0]).unwrap_err().to_string();
    assert!(
        error.contains("triangles are more than the limit"),
        "{error}"
    );
}

#[test]
fn every_cut_of_a_file_is_refused() {
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[],"accessors":[{POSITIONS}],{}}}"#,
        one_mesh(r#""attributes":{"POSITION":0}"#)
    );
    for length in 0..json.len() {
        let mut import = Import::default();
        let result =
            super::read_bytes(&json.as_bytes()[..length], false, "x".as_ref(), &mut import);
        assert!(result.is_err(), "{length} bytes");
    }
}
