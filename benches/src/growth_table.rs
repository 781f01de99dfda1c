//! Prints growth curves as Markdown.

use anyhow::Result;
use tahko_tracer::generate::Generator;

use crate::report::{GrowthCurve, GrowthPoint};
use crate::{check, fit, growth, table};

/// Measures all generators and prints two tables for each as soon as it is done: the points, and the fitted exponents.
pub(crate) fn print(largest: u32) -> Result<()> {
    for generator in Generator::ALL {
        let curves = growth::measure(largest, &[generator], &|what| eprintln!("{what} ..."))?;
        println!("### {generator}\n");
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
        table::print(&header, curves.iter().flat_map(rows).collect(), 1);
        if curves.iter().any(|curve| curve.build_exponent.is_some()) {
            let header = ["structure", "exponent of build time", "of time per ray"];
            table::print(&header, curves.iter().map(exponents).collect(), 1);
        }
    }
    Ok(())
}

fn rows(curve: &GrowthCurve) -> impl Iterator<Item = Vec<String>> {
    let structure = &curve.contender.structure;
    curve.points.iter().map(|point| row(structure, point))
}

fn row(structure: &str, point: &GrowthPoint) -> Vec<String> {
    let mut row = vec![
        structure.to_owned(),
        point.triangles.to_string(),
        table::three_digits(point.build_seconds),
        point.nodes.to_string(),
        point.depth.to_string(),
        table::three_digits(point.references_per_triangle),
        table::three_digits(point.bytes_per_triangle),
        table::three_digits(point.sah_cost),
        table::three_digits(point.ray_nanoseconds),
        table::three_digits(point.ray_node_visits),
        table::three_digits(point.ray_triangle_tests),
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
