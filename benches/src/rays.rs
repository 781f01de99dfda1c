//! Deterministic sets of rays over a scene.

use tahko_bench::random::Random;
use tahko_tracer::geometry::{Aabb, Hit, Precision, Ray, RayQuery, SurfacePoint};
use tahko_tracer::scene::{Light, Scene};

/// What kind of rays a set holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RayClass {
    /// Through the pixels of a picture, row by row: closest hit.
    Primary,
    /// From the primary hits to the first light: any hit.
    Shadow,
    /// Through two random points of the scene's bounds: closest hit.
    Random,
    /// From random points through vertices and edge midpoints: closest hit. Rays like these find the cracks.
    Aimed,
}

impl RayClass {
    pub(crate) const ALL: [Self; 4] = [Self::Primary, Self::Shadow, Self::Random, Self::Aimed];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Random => "random",
            Self::Aimed => "aimed",
        }
    }

    /// A set of at most `count` rays, every beginning of which is spread over the whole. `query` finds the hits that shadow
    /// rays start from.
    pub(crate) fn rays(self, scene: &Scene, query: &dyn RayQuery, count: usize) -> Vec<Ray> {
        let rays = match self {
            Self::Primary => primary(scene, count),
            Self::Shadow => shadow(scene, query, count),
            Self::Random => random(&scene.mesh().aabb(), count),
            Self::Aimed => aimed(scene, count),
        };
        spread(&rays)
    }
}

/// Neighbours that stay together, as coherent as they were.
const CHUNK: usize = 64;

/// The rays in another order of chunks, by the multiples of the golden ratio: slow structures trace and errors are counted on
/// a beginning of the set, which must not be the upper part of a picture.
fn spread(rays: &[Ray]) -> Vec<Ray> {
    let mut chunks: Vec<(u64, &[Ray])> = (0u64..)
        .zip(rays.chunks(CHUNK))
        .map(|(index, chunk)| (index.wrapping_mul(0x9e37_79b9_7f4a_7c15), chunk))
        .collect();
    chunks.sort_unstable_by_key(|(place, _)| *place);
    chunks
        .into_iter()
        .flat_map(|(_, chunk)| chunk)
        .copied()
        .collect()
}

fn primary(scene: &Scene, count: usize) -> Vec<Ray> {
    let side = u32::try_from(count.isqrt()).unwrap_or(u32::MAX);
    let pixels = (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
    pixels
        .map(|(x, y)| {
            scene
                .camera()
                .ray(f64::from(x) + 0.5, f64::from(y) + 0.5, side, side)
        })
        .collect()
}

fn shadow(scene: &Scene, query: &dyn RayQuery, count: usize) -> Vec<Ray> {
    let Some(light) = scene.lights().first() else {
        return Vec::new();
    };
    let to_light = |hit: Hit| {
        // The same rays for all precisions: they leave their triangle at the coarsest, and so at all of them.
        let triangle = scene.mesh().triangle(hit.primitive as usize);
        let start = SurfacePoint::new(&hit, &triangle, Precision::Fast);
        match *light {
            Light::Point { position, .. } | Light::Spot { position, .. } => {
                start.spawn_ray_to(position.as_vec3())
            }
            Light::Directional { direction, .. } => start.spawn_ray(-direction.as_vec3()),
        }
    };
    primary(scene, count)
        .into_iter()
        .filter_map(|ray| query.closest_hit(&ray).map(to_light))
        .collect()
}

fn random(bounds: &Aabb, count: usize) -> Vec<Ray> {
    let mut random = Random::new(1);
    (0..count)
        .map(|_| {
            let [from, through] = [(); 2].map(|()| random.point_in(bounds));
            Ray::new(from, through - from)
        })
        .collect()
}

fn aimed(scene: &Scene, count: usize) -> Vec<Ray> {
    let mesh = scene.mesh();
    let bounds = mesh.aabb();
    let mut random = Random::new(2);
    if mesh.is_empty() {
        return Vec::new();
    }
    (0..count)
        .map(|index| {
            let triangle = mesh.triangle(random.below(mesh.len()));
            let target = if index % 2 == 0 {
                triangle.a
            } else {
                triangle.a.midpoint(triangle.b)
            };
            let from = random.point_in(&bounds);
            Ray::new(from, target - from)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use tahko_tracer::geometry::glam::Vec3;

    use super::*;

    #[test]
    fn every_beginning_of_a_set_is_spread_over_the_whole() {
        let ray = |index: u16| Ray::new(Vec3::X * f32::from(index), Vec3::Y);
        let rays: Vec<Ray> = (0..6400).map(ray).collect();
        let spread = spread(&rays);
        let mut sorted: Vec<f32> = spread.iter().map(|ray| ray.origin.x).collect();
        let mean = |places: &[f32]| places.iter().sum::<f32>() / places.len() as f32;
        for length in [640, 1280, 3200] {
            let mean = mean(&sorted[..length]);
            assert!((mean - 3200.0).abs() < 640.0, "{length}: {mean}");
        }
        sorted.sort_by(f32::total_cmp);
        assert!(
            sorted.iter().copied().eq((0..6400u16).map(f32::from)),
            "each ray once"
        );
    }
}
