//! The camera: the first one in the scene.

use glam::{DAffine3, DMat3, DVec3};
use gltf::json::camera::Camera as Source;
use tahko_geometry::Transform;

use super::Document;
use super::fault::{Fault, named};
use super::nodes::PlacedNode;
use super::notes::skipped;
use crate::load::Import;
use crate::scene::{Camera, FieldOfView, Projection};

/// Sets the camera of the scene to the first one that a node has, unless the scene has a camera already.
///
/// As the specification asks, the scale of the node does not change the view. The shape of the picture is that of the
/// film, so the aspect ratio is not used, and nothing is clipped by distance.
///
/// # Errors
/// If the first camera sees an angle that no camera can.
pub(super) fn read(
    document: &Document<'_>,
    nodes: &[PlacedNode<'_>],
    import: &mut Import,
) -> Result<(), Fault> {
    let mut others = Vec::new();
    for placed in nodes {
        let Some(index) = placed.node.camera else {
            continue;
        };
        let Some(source) = document.root.cameras.get(index.value()) else {
            continue;
        };
        let name = named("camera", index.value(), source.name.as_deref());
        if import.builder.has_camera() {
            others.push(name);
            continue;
        }
        let to_world = placed.to_file.then(&import.placement);
        let view = without_scale(&to_world)
            .ok_or_else(|| Fault::Unsupported(format!("{name} at its place out of range")))?;
        let camera = Camera::new(view, projection(source))
            .map_err(|error| Fault::Unsupported(format!("{name}: {error}; such a view")))?;
        import.builder.set_camera(camera);
        let note = format!(
            "clipping planes and aspect ratio of {name} are skipped: all distances are shown, in the shape of the film"
        );
        import.report.note(note);
    }
    skipped(
        &others,
        "the scene has a camera already",
        &mut import.report,
    );
    Ok(())
}

fn projection(source: &Source) -> Projection {
    match (&source.perspective, &source.orthographic) {
        (_, Some(view)) => Projection::Orthographic {
            height: 2.0 * f64::from(view.ymag.abs()),
        },
        (view, None) => Projection::Perspective(FieldOfView {
            degrees: view
                .as_ref()
                .map_or(0.0, |view| f64::from(view.yfov).to_degrees()),
            spans_shorter_side: false,
        }),
    }
}

/// The place and the view direction of a camera's coordinates, with `up` as near to theirs as it goes.
fn without_scale(to_world: &Transform) -> Option<Transform> {
    let backward = to_world.vector(DVec3::Z).try_normalize()?;
    let right = to_world.vector(DVec3::Y).cross(backward).try_normalize()?;
    let axes = DMat3::from_cols(right, backward.cross(right), backward);
    Transform::from_affine(DAffine3::from_mat3_translation(
        axes,
        to_world.point(DVec3::ZERO),
    ))
}
