//! Deterministic sets of rays over a scene.

use tahko_bench::random::Random;
use tahko_tracer::geometry::{
    Aabb, Hit, Precision, Ray, RayQuery, SurfacePoint,
    glam::{DVec3, Vec3},
};
use tahko_tracer::scene::{Light, Scene};

use crate::report::RayClass;

impl RayClass {
    pub(crate) const ALL: [Self; 6] = [
        Self::Primary,
        Self::Shadow,
        Self::Diffuse,
        Self::Random,
        Self::Edge,
        Self::Vertex,
    ];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Diffuse => "diffuse",
            Self::Random => "random",
            Self::Edge => "edge",
            Self::Vertex => "vertex",
        }
    }

    /// Whether any hit will do.
    pub(crate) const fn asks_any(self) -> bool {
        matches!(self, Self::Shadow)
    }

    /// A set of about `count` rays. `query` finds the hits that shadow and bounced rays start from.
    pub(crate) fn rays(self, scene: &Scene, query: &dyn RayQuery, count: usize) -> Vec<Ray> {
        match self {
            Self::Primary => primary(scene, count),
            Self::Shadow => shadow(scene, query, count),
            Self::Diffuse => diffuse(scene, query, count),
            Self::Random => random(&scene.mesh().aabb(), count),
            Self::Edge => aimed(scene, count, 2, |[a, b]| a.midpoint(b)),
            Self::Vertex => aimed(scene, count, 3, |[a, _]| a),
        }
    }
}

/// The side of a tile of primary rays: neighbours in a tile are neighbours in the set.
const TILE: u32 = 8;

/// As many rays as the largest square of whole tiles that is not above `count`, at least one tile.
fn primary(scene: &Scene, count: usize) -> Vec<Ray> {
    let tiles = u32::try_from(count.isqrt()).unwrap_or(u32::MAX) / TILE;
    let tiles = tiles.clamp(1, u32::from(u16::MAX) / TILE);
    let side = tiles * TILE;
    let square = |side: u32| (0..side).flat_map(move |y| (0..side).map(move |x| (x, y)));
    let pixels = square(tiles)
        .flat_map(|(left, top)| square(TILE).map(move |(x, y)| (left * TILE + x, top * TILE + y)));
    pixels
        .map(|(x, y)| {
            scene
                .camera()
                .ray(f64::from(x) + 0.5, f64::from(y) + 0.5, side, side)
        })
        .collect()
}

/// The points that the primary rays hit, with the rays. The same for all precisions: what leaves from them leaves its triangle at the coarsest, and
/// so at all of them.
fn primary_points<'a>(
    scene: &'a Scene,
    query: &'a dyn RayQuery,
    count: usize,
) -> impl Iterator<Item = (Ray, Hit, SurfacePoint)> + 'a {
    primary(scene, count).into_iter().filter_map(|ray| {
        let hit = query.closest_hit(&ray)?;
        let triangle = scene.mesh().triangle(hit.primitive as usize);
        Some((
            ray,
            hit,
            SurfacePoint::new(&hit, &triangle, Precision::Fast),
        ))
    })
}

fn shadow(scene: &Scene, query: &dyn RayQuery, count: usize) -> Vec<Ray> {
    let Some(light) = scene.lights().first() else {
        return Vec::new();
    };
    primary_points(scene, query, count)
        .map(|(_, _, point)| match *light {
            Light::Point { position, .. } | Light::Spot { position, .. } => {
                point.spawn_ray_to(position.as_vec3())
            }
            Light::Directional { direction, .. } => point.spawn_ray(-direction.as_vec3()),
        })
        .collect()
}

fn diffuse(scene: &Scene, query: &dyn RayQuery, count: usize) -> Vec<Ray> {
    let mut random = Random::new(4);
    let mut rays: Vec<Ray> = primary_points(scene, query, count)
        .filter_map(|(ray, hit, point)| {
            let normal = scene
                .mesh()
                .triangle(hit.primitive as usize)
                .scaled_normal();
            let normal = normal.try_normalize()?;
            let seen = if normal.dot(ray.direction.as_dvec3()) > 0.0 {
                -normal
            } else {
                normal
            };
            Some(point.spawn_ray(cosine_distributed(seen, &mut random).as_vec3()))
        })
        .collect();
    // Fisher and Yates: a renderer that follows many paths at once sees bounced rays without order.
    for last in (1..rays.len()).rev() {
        rays.swap(last, random.below(last + 1));
    }
    rays
}

/// A direction around a normal, with a density in proportion to the cosine of the angle between them: a point on the unit sphere around the tip of the
/// normal.
fn cosine_distributed(normal: DVec3, random: &mut Random) -> DVec3 {
    let height = 1.0 - 2.0 * f64::from(random.unit());
    let turn = std::f64::consts::TAU * f64::from(random.unit());
    let radius = (1.0 - height * height).max(0.0).sqrt();
    let direction = normal + DVec3::new(radius * turn.cos(), radius * turn.sin(), height);
    // The one point of the sphere that gives no direction.
    direction.try_normalize().unwrap_or(normal)
}

fn random(bounds: &Aabb, count: usize) -> Vec<Ray> {
    let mut random = Random::new(1);
    if bounds.is_empty() {
        return Vec::new();
    }
    (0..count)
        .map(|_| {
            let [from, through] = [(); 2].map(|()| random.point_in(bounds));
            Ray::new(from, through - from)
        })
        .collect()
}

/// From random points of the bounds through a point of an edge of a random triangle, as nearly as f32 allows: rays like these find the cracks.
fn aimed(scene: &Scene, count: usize, seed: u64, target: fn([Vec3; 2]) -> Vec3) -> Vec<Ray> {
    let mesh = scene.mesh();
    let bounds = mesh.aabb();
    let mut random = Random::new(seed);
    if mesh.is_empty() {
        return Vec::new();
    }
    (0..count)
        .map(|_| {
            let mut corners = mesh.triangle(random.below(mesh.len())).vertices();
            corners.rotate_left(random.below(3));
            let from = random.point_in(&bounds);
            Ray::new(from, target([corners[0], corners[1]]) - from)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use tahko_tracer::geometry::{BruteForce, Transform};
    use tahko_tracer::scene::{Material, MeshPart, SceneBuilder};

    use super::*;

    /// A square of two triangles, seen by the default camera.
    fn square() -> Scene {
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(Material::default());
        let part = MeshPart {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y],
            indices: vec![[0, 1, 2], [0, 2, 3]],
            ..MeshPart::default()
        };
        builder
            .add_part(part, material, &Transform::IDENTITY)
            .unwrap();
        builder.finish().unwrap()
    }

    fn set(class: RayClass, count: usize) -> Vec<Ray> {
        let scene = square();
        class.rays(
            &scene,
            &BruteForce::new(scene.mesh(), Precision::Exact),
            count,
        )
    }

    #[test]
    fn every_class_has_valid_rays_and_the_same_ones_again() {
        for class in RayClass::ALL {
            let rays = set(class, 300);
            assert!(
                rays.len() > 50 && rays.len() <= 300,
                "{class:?}: {}",
                rays.len()
            );
            assert!(rays.iter().all(Ray::is_valid), "{class:?}");
            assert_eq!(rays, set(class, 300), "{class:?}");
        }
    }

    #[test]
    fn primary_rays_come_in_tiles_and_each_pixel_once() {
        let scene = square();
        let rays = primary(&scene, 32 * 32);
        assert_eq!(rays.len(), 32 * 32);
        let pixel = |x: f64, y: f64| scene.camera().ray(x + 0.5, y + 0.5, 32, 32);
        assert_eq!(
            rays[TILE as usize],
            pixel(0.0, 1.0),
            "the second row of the first tile"
        );
        assert_eq!(
            rays[(TILE * TILE) as usize],
            pixel(8.0, 0.0),
            "the second tile"
        );
        for (index, ray) in rays.iter().enumerate() {
            assert!(!rays[..index].contains(ray), "{index}");
        }
    }

    #[test]
    fn bounced_rays_leave_on_the_side_that_is_seen_and_more_so_upwards() {
        let scene = square();
        let query = BruteForce::new(scene.mesh(), Precision::Exact);
        let towards_camera = (scene.camera().position().z - 0.0).signum();
        let rays = diffuse(&scene, &query, 4096);
        let heights: Vec<f64> = rays
            .iter()
            .map(|ray| f64::from(ray.direction.z) * towards_camera)
            .collect();
        assert!(
            heights.iter().all(|height| *height >= 0.0),
            "none goes through"
        );
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        // The mean of the cosine under a density in proportion to it is 2/3; the deviation of a mean of n is below 0.24 / sqrt(n).
        let tolerance = 5.0 * 0.24 / (heights.len() as f64).sqrt();
        assert!((mean - 2.0 / 3.0).abs() < tolerance, "{mean}");
        assert!(
            rays.iter().all(|ray| !query.any_hit(ray)),
            "a square has nothing to bounce to"
        );
    }

    #[test]
    fn aimed_rays_pass_their_targets() {
        for (class, distance) in [(RayClass::Vertex, 0.0), (RayClass::Edge, 0.5)] {
            for ray in set(class, 100) {
                let target = ray.origin + ray.direction;
                let nearest = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y]
                    .map(|corner| corner.distance(target))
                    .into_iter()
                    .fold(f32::INFINITY, f32::min);
                let expected = [distance, distance * 2f32.sqrt()];
                assert!(
                    expected.iter().any(|d| (d - nearest).abs() < 1e-6),
                    "{class:?} {nearest}"
                );
            }
        }
    }
}
