//! Materials, textures, cameras and lights.

use std::f32::consts::PI;
use std::fs;
use std::io::Cursor;

use glam::{DVec3, Vec3};
use tempfile::TempDir;

use super::{More, POSITIONS, SQUARE, floats, hit, load, load_square, one_mesh};
use crate::load::{Import, load_scene};
use crate::scene::{Light, Material};

/// A red and a blue texel.
fn png() -> Vec<u8> {
    let image = image::RgbImage::from_vec(2, 1, vec![255, 0, 0, 0, 0, 255]).unwrap();
    let mut bytes = Vec::new();
    image
        .write_to(&mut Cursor::new(&mut bytes), image::ImageFormat::Png)
        .unwrap();
    bytes
}

#[test]
fn textures_follow_their_sampler_and_transform() {
    let png = png();
    let mut buffer = floats(&[0.25, 0.5, 0.75, 0.5, 0.25, 0.5, 0.75, 0.5]);
    buffer.extend(&png);
    let views = format!(
        r#",{{"buffer":0,"byteOffset":48,"byteLength":32}},{{"buffer":0,"byteOffset":80,"byteLength":{}}}"#,
        png.len()
    );
    let more = More {
        buffer: &buffer,
        views: &views,
        accessors: r#",{"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"}"#,
    };
    let colors = |info: &str| {
        let properties =
            format!(
                r#""extensionsUsed":["KHR_texture_transform"],
            "images":[{{"bufferView":2,"mimeType":"image/png"}}],
            "samplers":[{{"magFilter":9728,"wrapS":33071}}],"textures":[{{"source":0,"sampler":0}}],
            "materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[0.5,0.5,1,1],
                "baseColorTexture":{{"index":0{info}}}}}}}],"#
            ) + &one_mesh(r#""attributes":{"POSITION":0,"TEXCOORD_0":1},"mode":5,"material":0"#);
        let (scene, _) = load_square(&properties, &more).unwrap();
        [
            scene.color_at(&hit(0, 0.0, 0.0)),
            scene.color_at(&hit(0, 1.0, 0.0)),
        ]
    };
    let [red, blue] = [Vec3::new(0.5, 0.0, 0.0), Vec3::Z];
    assert_eq!(colors(""), [red, blue]);
    let moved = r#","extensions":{"KHR_texture_transform":{"offset":[1,0],"scale":[-1,1]}}"#;
    assert_eq!(colors(moved), [blue, red], "mirrored");
    let turned =
        r#","extensions":{"KHR_texture_transform":{"rotation":3.1415927,"offset":[0.9,0]}}"#;
    assert_eq!(colors(turned), [blue, red], "turned by 180 degrees");
}

#[test]
fn an_imported_material_replaces_those_of_the_file() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("test.gltf");
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":"data.bin","byteLength":48}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}}],
        "accessors":[{POSITIONS},{{"componentType":5126,"count":4,"type":"VEC2"}}],
        "images":[{{"uri":"missing.png"}}],"textures":[{{"source":0}}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],{}}}"#,
        one_mesh(r#""attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0"#)
    );
    fs::write(
        folder.path().join("data.bin"),
        floats(SQUARE.as_flattened()),
    )
    .unwrap();
    fs::write(&path, json).unwrap();
    let error = load_scene(&path).unwrap_err().to_string();
    assert!(
        error.contains("image 0") && error.contains("missing.png"),
        "{error}"
    );

    let mut import = Import::default();
    import.material = Some(import.builder.add_material(Material::default()));
    import.placement = tahko_geometry::Transform::translation(DVec3::X);
    import.file(&path).unwrap();
    let scene = import.builder.finish().unwrap();
    assert_eq!(scene.materials().len(), 1);
    assert_eq!(scene.mesh().vertices()[0], Vec3::X);
}

#[test]
fn smooth_metals_become_mirrors_and_strong_emission_is_kept() {
    let properties = r#""extensionsUsed":["KHR_materials_emissive_strength","KHR_materials_transmission",
            "KHR_materials_ior","KHR_materials_unlit"],
        "materials":[
            {"pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0,1],"roughnessFactor":0.1}},
            {"pbrMetallicRoughness":{"roughnessFactor":0.8},"alphaMode":"MASK"},
            {"emissiveFactor":[1,0,0],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":7}}},
            {"extensions":{"KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_ior":{"ior":1.33},
                "KHR_materials_unlit":{}}}],
        "nodes":[{"mesh":0}],"meshes":[{"primitives":[
            {"mode":5,"attributes":{"POSITION":0},"material":0},{"mode":5,"attributes":{"POSITION":0},"material":1},
            {"mode":5,"attributes":{"POSITION":0},"material":2},{"mode":5,"attributes":{"POSITION":0},"material":3},
            {"mode":5,"attributes":{"POSITION":0}}]}]"#;
    let (scene, report) = load_square(properties, &More::default()).unwrap();
    let materials = scene.materials();
    assert_eq!(materials.len(), 5);
    assert_eq!((materials[0].mirror, materials[0].metallic), (1.0, true));
    assert_eq!(materials[0].color, Vec3::new(1.0, 0.5, 0.0));
    assert_eq!((materials[1].mirror, materials[1].metallic), (0.0, false));
    assert_eq!(materials[2].emission, Vec3::new(7.0, 0.0, 0.0));
    assert_eq!((materials[3].transmission, materials[3].ior), (1.0, 1.33));
    assert_eq!(
        [2, 3].map(|index: usize| materials[index].unlit),
        [false, true]
    );
    assert!(
        report.notes()[0].contains("alpha mode MASK of material 1"),
        "{report:?}"
    );
}

#[test]
fn the_first_camera_looks_along_its_node() {
    let properties = r#""cameras":[
            {"type":"perspective","perspective":{"yfov":1.5707963,"znear":0.1}},
            {"type":"orthographic","orthographic":{"xmag":1,"ymag":2,"znear":0,"zfar":9}}],
        "nodes":[{"camera":0,"translation":[0,0,4],"scale":[3,3,3],"children":[1]},{"camera":1}]"#;
    let (scene, report) = load(properties, &[0]).unwrap();
    let camera = scene.camera();
    assert_eq!(
        camera.ray(50.0, 25.0, 100, 50).origin,
        Vec3::new(0.0, 0.0, 4.0)
    );
    let top = camera.ray(50.0, 0.0, 100, 50).direction;
    assert!(
        (top.y + top.z).abs() < 1e-6 && top.y > 0.0,
        "45 degrees up: {top}"
    );
    assert!(
        report
            .notes()
            .iter()
            .any(|note| note.contains("skipped camera 1")),
        "{report:?}"
    );
}

#[test]
fn lights_set_the_exposure() {
    let lights = |lights: &str, nodes: &str| {
        let properties = format!(
            r#""extensionsUsed":["KHR_lights_punctual"],
            "extensions":{{"KHR_lights_punctual":{{"lights":[{lights}]}}}},"nodes":[{nodes},{{"mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"mode":5}}]}}]"#
        );
        load_square(&properties, &More::default()).unwrap().0
    };
    let light = r#""extensions":{"KHR_lights_punctual":{"light":0}}"#;
    let sun = lights(
        r#"{"type":"directional","intensity":100000,"color":[1,0.5,0]}"#,
        &format!("{{{light}}}"),
    );
    assert_eq!(
        sun.lights(),
        [Light::Directional {
            direction: DVec3::NEG_Z,
            irradiance: Vec3::new(1e5, 5e4, 0.0)
        }]
    );
    assert_eq!(sun.exposure(), PI / 1e5);
    let point = lights(
        r#"{"type":"point","intensity":400}"#,
        &format!(r#"{{{light},"translation":[0.5,0.5,10]}}"#),
    );
    assert_eq!(
        point.exposure(),
        PI / 4.0,
        "400 candela at a distance of 10"
    );
    let spot = lights(
        r#"{"type":"spot","spot":{"innerConeAngle":0.1,"outerConeAngle":0.2}}"#,
        &format!(r#"{{{light},"translation":[0.5,0.5,1],"rotation":[0,2,0,0]}}"#),
    );
    assert_eq!(spot.exposure(), PI, "as if it pointed at the middle");
    let Light::Spot { direction, .. } = spot.lights()[0] else {
        panic!("{:?}", spot.lights());
    };
    assert!((direction - DVec3::Z).length() < 1e-12, "{direction}");
}
