//! The numerically hard cases of ray casting, as a suite that every structure is held against.
//!
//! A [`HardCase`] is a mesh and rays at it that are known to break careless libraries. [`check_case`] asks all of them, after all
//! [`Transformation`]s, at [`Precision::Exact`](crate::Precision::Exact) and compares with the exact [`oracle`](crate::oracle): the closest hit, any
//! hit, both without a primitive, all hits and their order, crossings, batches, counted forms and containment. Where an answer is known by hand, the
//! oracle is held against it. The other precisions are held to what they promise. [`hard_case_tests!`](crate::hard_case_tests) makes a
//! named test of each case.
//!
//! | case | function | about |
//! |---|---|---|
//! | 1 | `planes_and_boxes::ray_in_a_splitting_plane` | the ray runs in a plane that splits the scene |
//! | 2 | `planes_and_boxes::triangle_in_a_splitting_plane` | a triangle lies in such a plane |
//! | 3 | `planes_and_boxes::origin_on_a_splitting_plane` | the origin lies on it; all signs of the direction |
//! | 4 | `planes_and_boxes::ray_in_a_box_face` | the ray runs in faces and edges of boxes |
//! | 5 | `planes_and_boxes::negative_zeros` | -0.0 in the direction |
//! | 6 | `planes_and_boxes::denormal_directions` | components of 1e-40; Rust keeps denormals, so there is one setting |
//! | 7 | `planes_and_boxes::axis_ray_on_a_rounded_face` | faces at 0.1, rays of 1e5 along them |
//! | 8 | `edges_and_vertices::shared_edges`, `closed_meshes` | grids of rays over integers; rays at all edges |
//! | 9 | `edges_and_vertices::vertices_of_high_valence`, `closed_meshes` | 3, 6, 100 triangles; rays at all vertices |
//! | 10 | `edges_and_vertices::all_hits_on_edges` | each crossing once |
//! | 11 | `edges_and_vertices::t_junction_with_a_gap` | a gap and an overlap of one ulp |
//! | 12 | `edges_and_vertices::exact_t_junction` | a vertex exactly on an edge |
//! | 13 | `needles::needle` | 1e6 long, 1e-3 wide |
//! | 14 | `needles::grazed_sliver` | half a degree, from 590 away |
//! | 15 | `needles::distant_coplanar_edges` | edges 1e5 away, seen nearly edge-on |
//! | 16 | `needles::ray_in_the_plane` | rays in planes of triangles |
//! | 17 | `duplicates_and_degenerate::coplanar_overlap` | decals |
//! | 18 | `duplicates_and_degenerate::duplicates`, [`check_many_duplicates`] | 2 to 100 000 equal triangles |
//! | 19 | `duplicates_and_degenerate::concentric_shells` | one centre for all boxes |
//! | 20 | `duplicates_and_degenerate::deep_nesting`, [`nested_triangles`], [`stacked_triangles`] | 120 halvings; depths of trees |
//! | 21 | `duplicates_and_degenerate::small_on_large`, [`check_cost_of_a_stadium`] | teapot in a stadium |
//! | 22 | `far_and_huge::moved_far` | a sphere at 1e6, 1e7 |
//! | 23 | `far_and_huge::far_origin` | origins 1e8 away |
//! | 24 | `far_and_huge::huge_coordinates` | 1e18 to 3e38; nothing finite is refused |
//! | 25 | `needles::tiny_triangles` | edges of 2^-12 to 2^-140 |
//! | 26 | `far_and_huge::denormal_vertices` | 1e-39 among 1; one setting, as for 6 |
//! | 27 | `intervals::start_on_the_surface` | t = 0, and the triangle ignored |
//! | 28 | `needles::origin_close_to_the_surface` | 1e-8 off, along the normal |
//! | 29 | `intervals::interval_ends` | t at `t_min`, at `t_max`, and between two f32 |
//! | 30 | `intervals::invalid_intervals` | empty intervals, NaN: no hit and no visit |
//! | 31 | `duplicates_and_degenerate::degenerate_triangles` | points, segments, nearly so |
//! | 32 | `duplicates_and_degenerate::dropped_triangles` | NaN and infinite vertices |
//! | 33 | `planes_and_boxes::few_triangles` | none to four triangles |
//! | 34 | `planes_and_boxes::flat_scene` | boxes without thickness |
//! | 35 | `cells::grazing_a_floor` | 1e-7 along many triangles |
//! | 36 | `cells::long_triangle` | a hit found before its cell |
//! | 37 | `cells::ray_along_a_general_plane` | rays nearly in tilted planes |
//! | 38 | `cells::acute_wedge` | planes at 1e-6 |
//! | 39 | `cells::sliver_cells` | planes 1e-7 apart |
//! | 40 | `cells::turned_prism` | planes through edges, neighbours astride by rounding |
//! | 41 | `cells::nearly_coplanar_planes` | a dome 1e-5 high |
//! | 42 | `far_and_huge::far_from_the_node` | small boxes in a coarse grid, from near and from 1e7 away |
//! | 43 | `far_and_huge::sheared` | scaled by 1e-6, sheared; the mesh itself, as there are no instances yet |
//! | 44 | `far_and_huge::directions_of_any_length` | 2^-100 to 1e38 |
//! | 45 | `intervals::close_spheres` | 4e-5 apart, starting on the outer one |

mod aimed;
mod cells;
mod check;
mod closed_meshes;
mod duplicates_and_degenerate;
mod edges_and_vertices;
mod expected;
mod far_and_huge;
mod intervals;
mod named_tests;
mod needles;
mod planes_and_boxes;
mod scale;
mod shapes;
mod transformation;

use crate::oracle::RBig;

use crate::{Ray, TriangleMesh};

pub use check::{Structure, check_case, check_closed_mesh};
pub use scale::{
    check_cost_of_a_stadium, check_many_duplicates, nested_triangles, stacked_triangles,
};
pub use transformation::{Transformation, TransformedCase, TransformedQuestion};

/// A mesh and what is asked about it.
#[derive(Clone, Debug)]
pub struct HardCase {
    /// The row of the table in the module's documentation.
    pub number: u8,
    /// What is special about this configuration among those of its number.
    pub name: &'static str,
    /// The triangles.
    pub mesh: TriangleMesh,
    /// Whether the surface has no border: then crossings have a parity, and no precision that promises watertightness may miss.
    pub is_closed: bool,
    /// The rays, and what is known about them.
    pub questions: Vec<Question>,
}

/// A ray and what is known by hand about its answers.
#[derive(Clone, Debug)]
pub struct Question {
    /// The ray.
    pub ray: Ray,
    /// The closest hit.
    pub answer: Answer,
    /// The closest hit when the primitive of the closest hit is ignored.
    pub ignoring: Answer,
    /// How often the ray crosses the surface.
    pub crossings: Option<usize>,
    /// Whether the origin, which is not on the surface, is inside of the closed mesh.
    pub starts_inside: Option<bool>,
}

/// What is known by hand about a closest hit; the oracle answers the rest.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Answer {
    /// Nothing is known.
    #[default]
    Unknown,
    /// There is no hit.
    Miss,
    /// There is a hit.
    Hit {
        /// Of which triangle.
        primitive: Option<u32>,
        /// At which exact parameter.
        t: Option<RBig>,
    },
}

impl Question {
    fn new(ray: Ray) -> Self {
        Self {
            ray,
            answer: Answer::Unknown,
            ignoring: Answer::Unknown,
            crossings: None,
            starts_inside: None,
        }
    }

    fn starting_outside(mut self) -> Self {
        self.starts_inside = Some(false);
        self
    }

    fn starting_inside(mut self) -> Self {
        self.starts_inside = Some(true);
        self
    }
}

/// Cases are written as chains: a question, then what more is known about it.
impl HardCase {
    fn new(number: u8, name: &'static str, mesh: TriangleMesh) -> Self {
        Self {
            number,
            name,
            mesh,
            is_closed: false,
            questions: Vec::new(),
        }
    }

    fn closed(mut self) -> Self {
        assert!(shapes::is_closed(&self.mesh), "{} has a border", self.name);
        self.is_closed = true;
        self
    }

    fn asks_all(mut self, questions: Vec<Question>) -> Self {
        self.questions.extend(questions);
        self
    }

    fn asks(self, ray: Ray) -> Self {
        self.asks_all(vec![Question::new(ray)])
    }

    fn answers(self, ray: Ray, answer: Answer) -> Self {
        self.asks_all(vec![Question {
            answer,
            ..Question::new(ray)
        }])
    }

    fn hits(self, ray: Ray, primitive: u32, t: RBig) -> Self {
        self.answers(
            ray,
            Answer::Hit {
                primitive: Some(primitive),
                t: Some(t),
            },
        )
    }

    fn hits_at(self, ray: Ray, t: RBig) -> Self {
        self.answers(
            ray,
            Answer::Hit {
                primitive: None,
                t: Some(t),
            },
        )
    }

    fn hits_something(self, ray: Ray) -> Self {
        self.answers(
            ray,
            Answer::Hit {
                primitive: None,
                t: None,
            },
        )
    }

    fn misses(self, ray: Ray) -> Self {
        self.answers(ray, Answer::Miss)
    }

    fn changed(mut self, change: impl FnOnce(&mut Question)) -> Self {
        if let Some(question) = self.questions.last_mut() {
            change(question);
        }
        self
    }

    fn crosses(self, times: usize) -> Self {
        self.changed(|question| question.crossings = Some(times))
    }

    fn ignoring_it_misses(self) -> Self {
        self.changed(|question| question.ignoring = Answer::Miss)
    }

    fn ignoring_it_hits(self, primitive: u32, t: RBig) -> Self {
        self.changed(|question| {
            question.ignoring = Answer::Hit {
                primitive: Some(primitive),
                t: Some(t),
            }
        })
    }

    fn starting_outside(self) -> Self {
        self.changed(|question| question.starts_inside = Some(false))
    }

    fn starting_inside(self) -> Self {
        self.changed(|question| question.starts_inside = Some(true))
    }
}

/// The number that an f32 is.
fn exact(value: f32) -> RBig {
    RBig::try_from(value).expect("finite numbers are rational")
}

fn ratio(numerator: i64, denominator: i64) -> RBig {
    RBig::from(numerator) / RBig::from(denominator)
}

/// The configurations of a row of the table; none for other numbers.
#[must_use]
pub fn cases(number: u8) -> Vec<HardCase> {
    let make = match number {
        1 => planes_and_boxes::ray_in_a_splitting_plane,
        2 => planes_and_boxes::triangle_in_a_splitting_plane,
        3 => planes_and_boxes::origin_on_a_splitting_plane,
        4 => planes_and_boxes::ray_in_a_box_face,
        5 => planes_and_boxes::negative_zeros,
        6 => planes_and_boxes::denormal_directions,
        7 => planes_and_boxes::axis_ray_on_a_rounded_face,
        8 => edges_and_vertices::shared_edges,
        9 => edges_and_vertices::vertices_of_high_valence,
        10 => edges_and_vertices::all_hits_on_edges,
        11 => edges_and_vertices::t_junction_with_a_gap,
        12 => edges_and_vertices::exact_t_junction,
        13 => needles::needle,
        14 => needles::grazed_sliver,
        15 => needles::distant_coplanar_edges,
        16 => needles::ray_in_the_plane,
        17 => duplicates_and_degenerate::coplanar_overlap,
        18 => duplicates_and_degenerate::duplicates,
        19 => duplicates_and_degenerate::concentric_shells,
        20 => duplicates_and_degenerate::deep_nesting,
        21 => duplicates_and_degenerate::small_on_large,
        22 => far_and_huge::moved_far,
        23 => far_and_huge::far_origin,
        24 => far_and_huge::huge_coordinates,
        25 => needles::tiny_triangles,
        26 => far_and_huge::denormal_vertices,
        27 => intervals::start_on_the_surface,
        28 => needles::origin_close_to_the_surface,
        29 => intervals::interval_ends,
        30 => intervals::invalid_intervals,
        31 => duplicates_and_degenerate::degenerate_triangles,
        32 => duplicates_and_degenerate::dropped_triangles,
        33 => planes_and_boxes::few_triangles,
        34 => planes_and_boxes::flat_scene,
        35 => cells::grazing_a_floor,
        36 => cells::long_triangle,
        37 => cells::ray_along_a_general_plane,
        38 => cells::acute_wedge,
        39 => cells::sliver_cells,
        40 => cells::turned_prism,
        41 => cells::nearly_coplanar_planes,
        42 => far_and_huge::far_from_the_node,
        43 => far_and_huge::sheared,
        44 => far_and_huge::directions_of_any_length,
        45 => intervals::close_spheres,
        _ => Vec::new,
    };
    make()
}

/// The closed meshes with rays at every vertex and edge, by name.
#[must_use]
pub fn closed_meshes() -> Vec<HardCase> {
    closed_meshes::all()
}
