//! What the words on the page mean.

use maud::{Markup, html};

use super::super::class;
use super::super::context::Context;

/// Words that several sections use.
const WORDS: [(&str, &str); 12] = [
    (
        "exact, watertight, fast",
        "Precisions. Exact gives the answer of real numbers; watertight loses no ray between neighbouring triangles; fast \
         promises neither. Other \
         libraries’ modes go by their own names.",
    ),
    (
        "single, batch, packet",
        "How rays are handed over: one in a call, many in a call, or so many traced side by side. Converting rays and hits is part of the time.",
    ),
    (
        "Mrays/s",
        "Million rays per second: the median of rounds in which the contenders took turns. The spread is the largest minus the \
         smallest round, as a \
         part of the median.",
    ),
    (
        "wrong / M",
        "Wrong answers per million rays that were compared with exact rational arithmetic: false hits, false misses and wrong \
         triangles together.",
    ),
    (
        "false hit, false miss",
        "A hit where the ray hits nothing; no hit where it hits something.",
    ),
    (
        "wrong triangle",
        "Another triangle than the closest. One at exactly the same distance is not wrong for libraries that promise nothing \
         about ties. Far off: the distance is \
         wrong by more than a thousandth.",
    ),
    (
        "none found in N rays",
        "No proof that there are none: with 95 % confidence, there are fewer than 3 in N rays of that kind.",
    ),
    (
        "ulp",
        "Unit in the last place: the step between neighbouring f32 numbers at that distance.",
    ),
    (
        "f32 / f64 / exp.",
        "Which arithmetic settled the triangle tests of the exact precision: f32, f64, or expansions of any length.",
    ),
    (
        "SAH cost",
        "Surface area heuristic: the expected cost of a ray that meets the bounds, in triangle tests.",
    ),
    (
        "bytes per triangle",
        "Memory that queries need, divided by the triangles of the mesh.",
    ),
    (
        "RMSE, FLIP",
        "Differences of pictures: root mean square of the displayed pixels from 0 to 1, and a measure of what a viewer sees when \
         flipping between both.",
    ),
];

pub(super) fn body(context: &Context<'_>) -> Markup {
    html! {
        dl.words {
            @for class in context.classes() {
                dt { (class.name()) " rays" }
                dd { (class::meaning(class)) "." }
            }
            @for (word, meaning) in WORDS {
                dt { (word) }
                dd { (meaning) }
            }
        }
    }
}
