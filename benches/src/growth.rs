//! How build time, nodes and memory grow with the number of triangles.

use std::fmt::Write as _;

use anyhow::Result;
use tahko_tracer::accelerator::{Accelerator, StructureKind};
use tahko_tracer::generate::{self, GeneratedScene, Generator};
use tahko_tracer::geometry::{Precision, Transform, TriangleMesh};
use tahko_tracer::scene::{Material, MeshPart, SceneBuilder};

use crate::table;

const STRUCTURES: [StructureKind; 3] = [
    StructureKind::Bsp,
    StructureKind::KdTree,
    StructureKind::Bvh,
];
/// BSP trees are measured up to this number of triangles.
const LARGEST_BSP: u32 = 100_000;

/// Prints a Markdown table for each generator: n from 1000 to `largest` in steps of ten.
pub(crate) fn print(largest: u32) -> Result<()> {
    for generator in Generator::ALL {
        println!("### {}\n", generator.name());
        let mut rows = Vec::new();
        let mut last: [Option<(f64, f64)>; 3] = [None; 3];
        let mut n = 1000u32;
        while n <= largest {
            let mesh = mesh(generator, n)?;
            eprintln!("{}: {} triangles ...", generator.name(), mesh.len());
            for (kind, last) in STRUCTURES.into_iter().zip(&mut last) {
                if kind == StructureKind::Bsp && n > LARGEST_BSP {
                    continue;
                }
                rows.push(row(kind, &mesh, last)?);
            }
            n = n.saturating_mul(10);
        }
        let header = [
            "structure",
            "triangles",
            "build s",
            "time exponent",
            "nodes",
            "depth",
            "references/triangle",
            "bytes/triangle",
            "SAH cost",
        ];
        table::print(&header, rows, 1);
    }
    Ok(())
}

fn mesh(generator: Generator, triangles: u32) -> Result<TriangleMesh> {
    let size = generator.size_for_triangles(u64::from(triangles))?;
    let GeneratedScene { parts, .. } = generate::generate(generator, size, 1)?;
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material::default());
    for part in parts {
        let part = MeshPart {
            name: part.name.to_owned(),
            positions: part.positions,
            indices: part.indices,
            ..MeshPart::default()
        };
        builder.add_part(part, material, &Transform::IDENTITY)?;
    }
    Ok(builder.finish_mesh()?)
}

/// Builds three times and shows the best time; the exponent is the slope in a log-log chart since the last row.
fn row(
    kind: StructureKind,
    mesh: &TriangleMesh,
    last: &mut Option<(f64, f64)>,
) -> Result<Vec<String>> {
    let mut best = Accelerator::build(kind, Precision::default(), mesh)?;
    for _ in 0..if mesh.len() <= 200_000 { 2 } else { 0 } {
        let again = Accelerator::build(kind, Precision::default(), mesh)?;
        if again.build_time() < best.build_time() {
            best = again;
        }
    }
    let point = (mesh.len() as f64, best.build_time().as_secs_f64());
    let mut exponent = String::new();
    if let Some(last) = last {
        write!(
            exponent,
            "{:.2}",
            (point.1 / last.1).ln() / (point.0 / last.0).ln()
        )?;
    }
    *last = Some(point);
    let statistics = best.statistics();
    Ok(vec![
        kind.name().to_owned(),
        mesh.len().to_string(),
        table::three_digits(point.1),
        exponent,
        statistics.nodes.to_string(),
        statistics.depth.to_string(),
        table::three_digits(statistics.references_per_primitive()),
        table::three_digits(statistics.bytes_per_primitive()),
        table::three_digits(statistics.sah_cost),
    ])
}
