//! What a tree is expected to cost, and what random rays measured.

use maud::{Markup, html};

use super::super::chart::scatter::{Point, against_diagonal, scatter};
use super::super::chart::{Axis, Frame, figure};
use super::super::context::Context;
use super::super::format::{NOTHING, count, number, short};
use super::super::mark::{Mark, Shape};
use super::super::mistakes::Mistakes;
use super::super::scale::Domain;
use super::super::table::{Cell, Column, Row, folded, table};
use super::key;
use crate::report::{BuildRow, RayClass, SceneReport, TraceRow, TreeRow, Work};

/// A tree and the random rays through it.
#[derive(Clone, Copy, Debug)]
struct Tree<'a> {
    scene: &'a SceneReport,
    build: &'a BuildRow,
    tree: &'a TreeRow,
    /// Of the most exact precision, whose boxes are widened least.
    traced: Option<(&'a TraceRow, &'a Work)>,
}

pub(super) fn body(context: &Context<'_>) -> Option<Markup> {
    let trees = trees(context);
    if trees.is_empty() {
        return None;
    }
    let nodes = |tree: &TreeRow| tree.expected_inner_nodes + tree.expected_leaves;
    let charts = [
        plot(
            context,
            &trees,
            [
                "Node visits",
                "expected, of a line →",
                "measured, of a random ray",
            ],
            nodes,
            |_, work| work.node_visits,
        ),
        plot(
            context,
            &trees,
            [
                "Triangle tests",
                "expected, of a line →",
                "measured, of a random ray",
            ],
            |tree| tree.expected_triangle_tests,
            |_, work| work.triangle_tests,
        ),
        plot(
            context,
            &trees,
            [
                "Surface area heuristic",
                "expected cost in triangle tests →",
                "nanoseconds per random ray",
            ],
            |tree| tree.sah_cost,
            |row, _| 1e3 / row.rate.median(),
        ),
    ];
    Some(html! {
        p {
            "The surface area heuristic predicts a tree’s cost from its shape alone: for lines that pass all the way through the scene’s bounds. "
            "The measured rays begin inside and end at the closest hit, so they should cost less than expected; what matters is whether the "
            "order is right. "
            "On the diagonal, both are equal."
        }
        (key::colours(context, trees.iter().map(|tree| &tree.build.contender)))
        div.charts { @for chart in charts.iter().flatten() { (chart) } }
        (folded(&html! { "The figures" }, false, &figures(context, &trees)))
    })
}

fn trees<'a>(context: &Context<'a>) -> Vec<Tree<'a>> {
    let mut trees = Vec::new();
    for scene in &context.report.scenes {
        for build in &scene.builds {
            let Some(tree) = &build.tree else { continue };
            let rows = context.traces_of(scene, build, RayClass::Random);
            let traced = rows
                .filter_map(|row| Some((row, row.work.as_ref()?)))
                .min_by_key(|(row, _)| {
                    (
                        Shape::of(&row.contender.precision),
                        row.contender.interface != "single",
                    )
                });
            trees.push(Tree {
                scene,
                build,
                tree,
                traced,
            });
        }
    }
    trees
}

/// Expected against measured; with a diagonal where both have the same unit.
fn plot(
    context: &Context<'_>,
    trees: &[Tree<'_>],
    [heading, expected_name, measured_name]: [&str; 3],
    expected: impl Fn(&TreeRow) -> f64,
    measured: impl Fn(&TraceRow, &Work) -> f64,
) -> Option<Markup> {
    let points: Vec<Point> = trees
        .iter()
        .filter_map(|tree| {
            let (row, work) = tree.traced?;
            let (x, y) = (expected(tree.tree), measured(row, work));
            let name = context.names.build(&tree.build.contender);
            Some(Point {
                x,
                y,
                mark: Mark {
                    shape: Shape::Circle,
                    is_hollow: false,
                    ..context.mark(&tree.build.contender)
                },
                title: format!(
                    "{name}, {}: expected {}, measured {}",
                    tree.scene.name,
                    number(x),
                    number(y)
                ),
                label: None,
                is_strong: false,
            })
        })
        .collect();
    let frame = Frame {
        title: &format!("{heading}: expected against measured"),
        description: "A point for each scene and structure; the table of figures below has the same values.",
        x: Axis {
            name: expected_name,
            domain: Domain::logarithmic(points.iter().map(|point| point.x))?,
            tick: short,
        },
        y: Axis {
            name: measured_name,
            domain: Domain::logarithmic(points.iter().map(|point| point.y))?,
            tick: short,
        },
        band: None,
    };
    let is_same_unit = expected_name.contains("of a line");
    let chart = if is_same_unit {
        against_diagonal(&frame, &points)
    } else {
        scatter(&frame, &points)
    };
    Some(figure(heading, &chart, &html! {}))
}

fn figures(context: &Context<'_>, trees: &[Tree<'_>]) -> Markup {
    let columns = [
        Column::text("tree", "Structure and preset"),
        Column::text("scene", "Scene"),
        Column::number("nodes", "Nodes of the tree"),
        Column::number("depth", "Longest way from the root to a leaf"),
        Column::number(
            "refs / triangle",
            "References to triangles in leaves, per triangle",
        ),
        Column::number(
            "SAH cost",
            "Expected cost by the surface area heuristic, in triangle tests",
        ),
        Column::number(
            "overlap",
            "End-point overlap (Aila, Karras, Laine 2013), in triangle tests",
        ),
        Column::number(
            "inner nodes, expected",
            "Inner nodes that a random line is expected to visit",
        ),
        Column::number(
            "leaves, expected",
            "Leaves that a random line is expected to visit",
        ),
        Column::number("nodes, measured", "Node visits per random ray"),
        Column::number(
            "tests, expected",
            "Triangle tests of a random line, expected",
        ),
        Column::number("tests, measured", "Triangle tests per random ray"),
        Column::number("ns per ray", "Nanoseconds per random ray"),
        Column::number("wrong / M", "Wrong answers per million audited random rays"),
    ];
    let rows: Vec<Row> = trees
        .iter()
        .map(|tree| Row {
            cells: cells(context, tree),
            is_best: false,
        })
        .collect();
    table(
        "Shape of the trees, expected and measured cost",
        &columns,
        &rows,
    )
}

fn cells(
    context: &Context<'_>,
    Tree {
        scene,
        build,
        tree,
        traced,
    }: &Tree<'_>,
) -> Vec<Cell> {
    let measured = |of: &dyn Fn(&TraceRow, &Work) -> String| {
        Cell::from(traced.map_or_else(|| NOTHING.to_owned(), |(row, work)| of(row, work)))
    };
    vec![
        Cell::new(context.badge(&build.contender, &context.names.build(&build.contender))),
        Cell::text(&scene.name),
        count(tree.nodes).into(),
        count(tree.depth).into(),
        number(tree.references_per_triangle).into(),
        number(tree.sah_cost).into(),
        tree.end_point_overlap
            .map_or_else(|| NOTHING.to_owned(), number)
            .into(),
        number(tree.expected_inner_nodes).into(),
        number(tree.expected_leaves).into(),
        measured(&|_, work| number(work.node_visits)),
        number(tree.expected_triangle_tests).into(),
        measured(&|_, work| number(work.triangle_tests)),
        measured(&|row, _| number(1e3 / row.rate.median())),
        measured(&|row, _| Mistakes::of(&row.errors).short()),
    ]
}
