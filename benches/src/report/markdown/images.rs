//! Errors of whole pictures.

use crate::report::{ImageRow, SceneReport};
use crate::table::{markdown, three_digits};

/// The pictures of all scenes; `None` for none.
pub(super) fn section(scenes: &[SceneReport]) -> Option<String> {
    let header = [
        "scene",
        "precision",
        "structures",
        "samples",
        "seconds",
        "RMSE of the precision",
        "FLIP of the precision",
        "RMSE to the reference",
        "FLIP to the reference",
    ];
    let rows: Vec<Vec<String>> = scenes
        .iter()
        .flat_map(|scene| scene.images.iter().map(|image| cells(&scene.name, image)))
        .collect();
    (!rows.is_empty()).then(|| {
        format!(
            "## Pictures\n\nThe error of the precision is that against the exact picture of as many samples; the reference is the exact picture with many.\n\n{}",
            markdown(&header, rows, 3)
        )
    })
}

fn cells(scene: &str, image: &ImageRow) -> Vec<String> {
    let seconds: Vec<String> = image
        .seconds
        .iter()
        .map(|seconds| three_digits(*seconds))
        .collect();
    let mut cells = vec![
        scene.to_owned(),
        image.precision.clone(),
        image.structures.join(" "),
        image.samples.to_string(),
        seconds.join(" "),
    ];
    let errors = [
        image.rmse_precision,
        image.flip_precision,
        image.rmse_reference,
        image.flip_reference,
    ];
    cells.extend(errors.map(three_digits));
    cells
}
