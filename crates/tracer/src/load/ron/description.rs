//! The scene format: what a `.ron` file may say. Every field is read by the loader; unknown ones are refused.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::generate::Generator;

/// Three numbers in parentheses: a point, a direction or a linear RGB colour.
pub(super) type Triple<T> = (T, T, T);

/// A whole scene file.
#[derive(Debug, Deserialize)]
#[serde(rename = "Scene", deny_unknown_fields)]
pub(super) struct SceneDescription {
    /// Frames the whole scene if left out.
    pub(super) camera: Option<CameraDescription>,
    /// Radiance of rays that hit nothing.
    pub(super) background: Option<Triple<f32>>,
    /// Radiance that arrives from everywhere.
    pub(super) ambient: Option<Triple<f32>>,
    /// Factor from radiance to display values, 1 if left out.
    pub(super) exposure: Option<f32>,
    /// A light at or behind the camera if there are none, here and in the files of the objects.
    #[serde(default)]
    pub(super) lights: Vec<LightDescription>,
    #[serde(default)]
    pub(super) materials: BTreeMap<String, MaterialDescription>,
    #[serde(default)]
    pub(super) objects: Vec<ObjectDescription>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) enum CameraDescription {
    /// All rays start at the eye.
    Perspective {
        eye: Triple<f64>,
        target: Triple<f64>,
        #[serde(default = "y_axis")]
        up: Triple<f64>,
        /// Degrees.
        vertical_fov: f64,
    },
    /// All rays are parallel.
    Orthographic {
        eye: Triple<f64>,
        target: Triple<f64>,
        #[serde(default = "y_axis")]
        up: Triple<f64>,
        /// Height of the part of the world that is seen.
        height: f64,
    },
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) enum LightDescription {
    /// Intensity: the irradiance at distance 1.
    Point {
        position: Triple<f64>,
        intensity: Triple<f32>,
    },
    /// The direction is the way the light travels.
    Directional {
        direction: Triple<f64>,
        irradiance: Triple<f32>,
    },
    /// Angles are in degrees from the axis of the cone.
    Spot {
        position: Triple<f64>,
        target: Triple<f64>,
        intensity: Triple<f32>,
        #[serde(default)]
        inner_angle: f64,
        outer_angle: f64,
    },
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialDescription {
    /// Diffuse reflectance; also the tint of metal and glass.
    #[serde(default = "white")]
    pub(super) color: Triple<f32>,
    /// Part that is mirrored, 0 to 1.
    #[serde(default)]
    pub(super) mirror: f32,
    /// Whether mirrored light takes the colour of the surface.
    #[serde(default)]
    pub(super) metallic: bool,
    /// Part that is refracted, 0 to 1.
    #[serde(default)]
    pub(super) transmission: f32,
    /// Index of refraction, at least 1.
    #[serde(default = "glass")]
    pub(super) ior: f32,
    /// Light that the surface emits.
    #[serde(default)]
    pub(super) emission: Triple<f32>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObjectDescription {
    pub(super) shape: ShapeDescription,
    /// A name from `materials`. If left out, the file's or the generator's own materials, or a light grey.
    pub(super) material: Option<String>,
    /// Applied in order, the first one first.
    #[serde(default)]
    pub(super) transform: Vec<TransformStep>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) enum ShapeDescription {
    /// A glTF, GLB, OBJ, PLY or STL file, relative to the scene file.
    Mesh(String),
    /// Triples of indices into the vertices, counter-clockwise seen from the front.
    Triangles {
        vertices: Vec<Triple<f32>>,
        indices: Vec<Triple<u32>>,
    },
    /// Convex polygons, counter-clockwise seen from the front.
    Polygons(Vec<Vec<Triple<f32>>>),
    /// A sphere by its centre and a point on its surface.
    Sphere {
        center: Triple<f64>,
        surface_point: Triple<f64>,
        /// How often the 20 triangles of the icosahedron are divided into four: 0 to 8.
        #[serde(default = "sphere_detail")]
        detail: u32,
    },
    /// A procedural scene by its name.
    Generate {
        generator: Generator,
        /// The generator's default if left out.
        size: Option<u32>,
        #[serde(default)]
        seed: u64,
    },
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) enum TransformStep {
    Translate(f64, f64, f64),
    Scale(f64, f64, f64),
    /// Counter-clockwise when the axis points at the viewer.
    Rotate {
        axis: Triple<f64>,
        degrees: f64,
    },
}

const fn y_axis() -> Triple<f64> {
    (0.0, 1.0, 0.0)
}

const fn white() -> Triple<f32> {
    (1.0, 1.0, 1.0)
}

const fn glass() -> f32 {
    1.5
}

const fn sphere_detail() -> u32 {
    4
}
