//! How build time, memory and rays grow with the number of triangles.

use crate::report::{GrowthCurve, GrowthPoint};
use crate::table::{markdown, three_digits};
use crate::{check, fit};

/// The points and the fitted exponents, generator by generator; `None` for none.
pub(super) fn section(curves: &[GrowthCurve]) -> Option<String> {
    let mut text = "## Growth\n\nRandom rays on one thread, at the exact precision. Exponents are powers of the number of triangles, with half of the 95 % \
        confidence interval.\n"
        .to_owned();
    for curves in curves.chunk_by(|one, other| one.generator == other.generator) {
        let mut header = vec![
            "structure",
            "triangles",
            "build s",
            "nodes",
            "depth",
            "references/triangle",
            "bytes/triangle",
            "SAH cost",
            "ns/ray",
            "nodes/ray",
            "triangles/ray",
        ];
        header.extend(check::ERROR_COLUMNS);
        let points = markdown(&header, curves.iter().flat_map(rows).collect(), 1);
        text += &format!("\n### {}\n\n{points}", curves[0].generator);
        if curves.iter().any(|curve| curve.build_exponent.is_some()) {
            let header = ["structure", "exponent of build time", "of time per ray"];
            let exponents = markdown(&header, curves.iter().map(exponents).collect(), 1);
            text += &format!("\n{exponents}");
        }
    }
    (!curves.is_empty()).then_some(text)
}

fn rows(curve: &GrowthCurve) -> impl Iterator<Item = Vec<String>> {
    let structure = &curve.contender.structure;
    curve.points.iter().map(|point| row(structure, point))
}

fn row(structure: &str, point: &GrowthPoint) -> Vec<String> {
    let mut row = vec![
        structure.to_owned(),
        point.triangles.to_string(),
        three_digits(point.build_seconds),
        point.nodes.to_string(),
        point.depth.to_string(),
        three_digits(point.references_per_triangle),
        three_digits(point.bytes_per_triangle),
        three_digits(point.sah_cost),
        three_digits(point.ray_nanoseconds),
        three_digits(point.ray_node_visits),
        three_digits(point.ray_triangle_tests),
    ];
    row.extend(check::error_cells(&point.errors));
    row
}

fn exponents(curve: &GrowthCurve) -> Vec<String> {
    vec![
        curve.contender.structure.clone(),
        fit::text(curve.build_exponent),
        fit::text(curve.ray_exponent),
    ]
}
