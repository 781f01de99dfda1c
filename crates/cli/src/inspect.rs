//! `tahko inspect`.

use anyhow::Result;
use comfy_table::{CellAlignment, Table, presets};
use serde::Serialize;
use tahko_tracer::geometry::{Aabb, Precision};
use tahko_tracer::load::{LoadReport, load_scene};
use tahko_tracer::scene::Scene;

use crate::args::InspectArguments;
use crate::output;
use crate::structure::{self, StructureReport};
use crate::terminal::{Terminal, printable};

pub(crate) fn run(arguments: &InspectArguments, terminal: &Terminal) -> Result<()> {
    let progress = terminal.progress();
    let path = &arguments.scene;
    progress.phase(&format!("reading {}", path.display()));
    let (scene, notes) = load_scene(path)?;
    terminal.notes(&notes);
    let mut report = SceneReport::new(path.display().to_string(), &scene, &notes);
    for kind in &arguments.accel.0 {
        let accelerator =
            structure::build(*kind, Precision::default(), scene.mesh(), path, progress)?;
        progress.phase(&format!("measuring {}", kind.name()));
        report.structures.push(InspectedStructure {
            structure: StructureReport::new(*kind, &accelerator),
            end_point_overlap: accelerator.end_point_overlap(),
        });
    }
    progress.clear();
    let text = if arguments.json {
        serde_json::to_string_pretty(&report)?
    } else {
        report.to_table()
    };
    output::write_stdout(|writer| Ok(writeln!(writer, "{text}")?))
}

/// A scene and the structures over it, as they appear in JSON.
#[derive(Debug, Serialize)]
struct SceneReport {
    /// The scene file, as given.
    scene: String,
    triangles: usize,
    /// The box around all triangles; null if there are none.
    bounds: Option<Bounds>,
    materials: usize,
    lights: usize,
    /// What was skipped or assumed when the scene was loaded.
    notes: Vec<String>,
    /// Number of threads that built the structures.
    threads: usize,
    structures: Vec<InspectedStructure>,
}

#[derive(Debug, Serialize)]
struct InspectedStructure {
    #[serde(flatten)]
    structure: StructureReport,
    /// What a ray is expected to cost because its end lies in boxes of other triangles, in triangle tests; only a BVH has it.
    end_point_overlap: Option<f64>,
}

#[derive(Debug, Serialize)]
struct Bounds {
    min: [f32; 3],
    max: [f32; 3],
}

impl SceneReport {
    fn new(name: String, scene: &Scene, notes: &LoadReport) -> Self {
        let Aabb { min, max } = scene.mesh().aabb();
        let bounds = Bounds {
            min: min.to_array(),
            max: max.to_array(),
        };
        Self {
            scene: name,
            triangles: scene.mesh().len(),
            bounds: (!scene.mesh().is_empty()).then_some(bounds),
            materials: scene.materials().len(),
            lights: scene.lights().len(),
            notes: notes.notes().to_vec(),
            threads: rayon::current_num_threads(),
            structures: Vec::new(),
        }
    }

    fn to_table(&self) -> String {
        let bounds = self.bounds.as_ref().map_or_else(
            || "none".to_owned(),
            |Bounds { min, max }| format!("{min:?} to {max:?}"),
        );
        let mut lines = vec![
            format!("scene      {}", printable(&self.scene)),
            format!("triangles  {}", self.triangles),
            format!("bounds     {bounds}"),
            format!("materials  {}", self.materials),
            format!("lights     {}", self.lights),
            format!("notes      {}", self.notes.len()),
            String::new(),
        ];
        lines.extend(
            self.structure_table()
                .lines()
                .map(|line| line.trim_end().to_owned()),
        );
        lines.join("\n")
    }

    /// A column per structure.
    fn structure_table(&self) -> Table {
        let row = |label: &str, value: &dyn Fn(&StructureReport) -> String| {
            let structures = self.structures.iter();
            let values = structures.map(|inspected| value(&inspected.structure));
            std::iter::once(label.to_owned())
                .chain(values)
                .collect::<Vec<_>>()
        };
        let overlaps = self.structures.iter().map(|inspected| {
            let overlap = inspected.end_point_overlap;
            overlap.map_or_else(|| "-".to_owned(), |overlap| format!("{overlap:.2}"))
        });
        let mut table = Table::new();
        table
            .load_style(presets::NOTHING)
            .set_header(row("", &|report| report.name.to_owned()))
            .add_rows([
                row("build time (s)", &|report| {
                    format!("{:.3}", report.build_seconds)
                }),
                row("nodes", &|report| report.nodes.to_string()),
                row("leaves", &|report| report.leaves.to_string()),
                row("empty leaves", &|report| report.empty_leaves.to_string()),
                row("depth", &|report| report.depth.to_string()),
                row("references", &|report| report.references.to_string()),
                row("references/triangle", &|report| {
                    format!("{:.3}", report.references_per_triangle)
                }),
                row("bytes", &|report| report.bytes.to_string()),
                row("bytes/triangle", &|report| {
                    format!("{:.1}", report.bytes_per_triangle)
                }),
                row("expected inner nodes", &|report| {
                    format!("{:.2}", report.expected_visits.inner_nodes)
                }),
                row("expected leaves", &|report| {
                    format!("{:.2}", report.expected_visits.leaves)
                }),
                row("expected tests", &|report| {
                    format!("{:.2}", report.expected_visits.triangle_tests)
                }),
                row("SAH cost", &|report| format!("{:.2}", report.sah_cost)),
            ])
            .add_row(std::iter::once("end-point overlap".to_owned()).chain(overlaps));
        for (index, column) in table.column_iter_mut().enumerate() {
            let first = index == 0;
            column.set_padding(if first { (0, 1) } else { (1, 1) });
            column.set_cell_alignment(if first {
                CellAlignment::Left
            } else {
                CellAlignment::Right
            });
        }
        table
    }
}
