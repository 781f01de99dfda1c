use std::fs;
use std::path::PathBuf;

use crate::load::{LoadError, load_scene};
use crate::scene::{Light, Scene};

/// Writes a scene file and loads it.
fn load(text: &str) -> Result<Scene, LoadError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.ron");
    fs::write(&path, text).unwrap();
    load_scene(&path).map(|(scene, _)| scene)
}

/// The message of a scene file that is refused, without the folder.
fn refusal(text: &str) -> String {
    let message = load(text).expect_err("must be refused").to_string();
    message
        .split_once("scene.ron")
        .expect("the file is named")
        .1
        .to_owned()
}

#[test]
fn an_empty_scene_is_a_scene_with_a_camera_and_a_light() {
    let scene = load("Scene()").unwrap();
    assert!(scene.mesh().is_empty(), "no objects");
    assert_eq!(scene.lights().len(), 1);
}

#[test]
fn polygons_become_fans_and_transforms_apply_in_order() {
    let scene = load(
        "Scene(objects: [(
            shape: Polygons([[(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]]),
            transform: [Translate(1, 0, 0), Scale(2, 2, 2), Rotate(axis: (0, 0, 1), degrees: 90)],
        )])",
    )
    .unwrap();
    assert_eq!(scene.mesh().indices(), [[0, 1, 2], [0, 2, 3]]);
    let corner = scene.mesh().vertices()[0];
    assert!(
        (corner - glam::Vec3::new(0.0, 2.0, 0.0)).length() < 1e-6,
        "{corner}"
    );
}

#[test]
fn a_sphere_is_given_by_its_centre_and_a_point_on_it() {
    let scene = load(
        "Scene(objects: [(shape: Sphere(center: (1, 2, 3), surface_point: (1, 4, 3), detail: 2))])",
    )
    .unwrap();
    assert_eq!(scene.mesh().len(), 20 * 16);
    let center = glam::Vec3::new(1.0, 2.0, 3.0);
    assert!(
        scene
            .mesh()
            .vertices()
            .iter()
            .all(|v| ((*v - center).length() - 2.0).abs() < 1e-5),
        "radius 2"
    );
    assert!(
        scene
            .mesh()
            .triangles()
            .all(|t| t.scaled_normal().dot((t.a - center).as_dvec3()) > 0.0),
        "fronts are outside"
    );
}

#[test]
fn mesh_files_are_found_beside_the_scene_and_take_its_material() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("mesh.obj"),
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    )
    .unwrap();
    let path = folder.path().join("scene.ron");
    fs::write(
        &path,
        "Scene(
            materials: {\"red\": (color: (1, 0, 0))},
            objects: [(shape: Mesh(\"mesh.obj\"), material: \"red\")],
        )",
    )
    .unwrap();
    let (scene, _) = load_scene(&path).unwrap();
    let hit = tahko_geometry::Hit {
        t: 1.0,
        u: 0.1,
        v: 0.1,
        primitive: 0,
    };
    assert_eq!(scene.color_at(&hit), glam::Vec3::X);
}

#[test]
fn generated_objects_bring_camera_and_lights_only_where_the_scene_has_none() {
    let plain = load("Scene(objects: [(shape: Generate(generator: tetra, size: 2))])").unwrap();
    assert!(
        plain
            .lights()
            .iter()
            .all(|light| matches!(light, Light::Point { .. })),
        "the suggested lights"
    );
    let own = load(
        "Scene(
            camera: Orthographic(eye: (9, 0, 0), target: (0, 0, 0), height: 4),
            lights: [Directional(direction: (0, -2, 0), irradiance: (1, 1, 1))],
            objects: [(shape: Generate(generator: tetra, size: 2))],
        )",
    )
    .unwrap();
    assert_eq!(own.camera().position(), glam::DVec3::X * 9.0);
    assert_eq!(own.lights().len(), 1);
}

#[test]
fn syntax_errors_and_unknown_fields_name_their_place() {
    let syntax = refusal("Scene(\n  objects: [(]");
    assert!(syntax.contains(": 2:"), "{syntax}");
    let unknown = refusal("Scene(\n  colour: 3,\n)");
    assert!(
        unknown.contains(": 2:") && unknown.contains("colour"),
        "{unknown}"
    );
}

#[test]
fn faults_name_the_object_and_the_reason() {
    let object = |object: &str| refusal(&format!("Scene(objects: [(shape: {object})])"));
    for (message, expected) in [
        (
            object("Polygons([[(0,0,0), (1,0,0)]])"),
            "object 0, polygon 0: a polygon needs at least 3",
        ),
        (
            object("Polygons([[(0,0,0), (2,0,0), (0.1,0.1,0), (0,2,0)]])"),
            "not convex",
        ),
        (
            object("Triangles(vertices: [(0,0,0)], indices: [(0,0,1)])"),
            "vertex 1",
        ),
        (
            object("Sphere(center: (0,0,0), surface_point: (0,0,0))"),
            "radius would be 0",
        ),
        (
            object("Sphere(center: (0,0,0), surface_point: (1,0,0), detail: 99)"),
            "detail of 99",
        ),
        (object("Mesh(\"other.ron\")"), "a scene inside a scene"),
        (object("Generate(generator: tetra, size: 4000)"), "object 0"),
        (
            object("Polygons([]), material: \"blue\""),
            "no material 'blue'",
        ),
        (
            object("Polygons([]), transform: [Scale(1, 0, 1)]"),
            "transform 0",
        ),
        (
            refusal("Scene(materials: {\"a\": (mirror: 2)})"),
            "material 'a', mirror: 2 is not between 0 and 1",
        ),
        (refusal("Scene(background: (0, -1, 0))"), "background"),
        (
            refusal("Scene(camera: Perspective(eye: (0,0,0), target: (0,0,0), vertical_fov: 40))"),
            "camera: ",
        ),
        (
            refusal("Scene(lights: [Directional(direction: (0,0,0), irradiance: (1,1,1))])"),
            "light 0",
        ),
    ] {
        assert!(
            message.contains(expected),
            "'{message}' should contain '{expected}'"
        );
    }
}

#[test]
fn a_missing_mesh_file_is_named() {
    let error = load("Scene(objects: [(shape: Mesh(\"nowhere.ply\"))])").unwrap_err();
    assert!(error.to_string().contains("nowhere.ply"), "{error}");
}

#[test]
fn every_shipped_scene_loads() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut loaded = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "ron") {
            load_scene(&path).unwrap_or_else(|error| panic!("{error}"));
            loaded += 1;
        }
    }
    assert!(loaded >= 6, "{loaded} scenes");
}
