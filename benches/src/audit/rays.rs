//! Rays over a mesh, of the kinds on which structures err.

use tahko_tracer::geometry::{
    Aabb, Axis, Ray, TriangleMesh,
    glam::{DVec3, Vec3},
};

use crate::random::Random;

/// What rays are aimed at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// Through two random points.
    Random,
    /// Through a point of an edge, as nearly as f32 allows.
    Edge,
    /// Through a vertex, as nearly as f32 allows or, where the digits suffice, exactly.
    Vertex,
    /// At an angle of `1e-1` to `1e-7` to the plane of a triangle, through its inside or along an edge.
    Grazing,
    /// Along an axis, with zeros of both signs, exactly through vertices, middles of edges and the faces of the box around the mesh.
    AxisParallel,
}

impl RayKind {
    /// All kinds.
    pub const ALL: [Self; 5] = [
        Self::Random,
        Self::Edge,
        Self::Vertex,
        Self::Grazing,
        Self::AxisParallel,
    ];

    /// The name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Edge => "edge",
            Self::Vertex => "vertex",
            Self::Grazing => "grazing",
            Self::AxisParallel => "axis-parallel",
        }
    }

    /// The kind of the ray at a place of the set: they take turns.
    pub(super) const fn of_place(place: usize) -> Self {
        Self::ALL[place % Self::ALL.len()]
    }
}

/// A set of rays in which the kinds take turns; all are [valid](Ray::is_valid). The same seed gives the same rays, and a larger
/// set begins with the smaller one. None for a mesh without triangles.
#[must_use]
pub fn rays(mesh: &TriangleMesh, count: usize, seed: u64) -> Vec<Ray> {
    if mesh.is_empty() {
        return Vec::new();
    }
    let mut aim = Aim::new(mesh, seed);
    (0..count)
        .map(|place| match RayKind::of_place(place) {
            RayKind::Random => aim.random_ray(),
            RayKind::Edge => aim.ray_at_edge(),
            RayKind::Vertex => aim.ray_at_vertex(),
            RayKind::Grazing => aim.grazing_ray(),
            RayKind::AxisParallel => aim.ray_along_axis(),
        })
        .collect()
}

/// Picks targets on a mesh and origins around it.
struct Aim<'a> {
    mesh: &'a TriangleMesh,
    bounds: Aabb,
    center: DVec3,
    /// Length of the diagonal of the bounds.
    size: f64,
    random: Random,
}

impl<'a> Aim<'a> {
    fn new(mesh: &'a TriangleMesh, seed: u64) -> Self {
        let bounds = mesh.aabb();
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let size = (max - min).length();
        Self {
            mesh,
            bounds,
            center: min.midpoint(max),
            // A mesh of one point has no size of its own.
            size: if size > 0.0 { size } else { 1.0 },
            random: Random::new(seed),
        }
    }

    fn random_ray(&mut self) -> Ray {
        let target = self.point_in_bounds();
        let origin = if self.random.below(2) == 0 {
            self.point_in_bounds()
        } else {
            self.point_around(1.0)
        };
        self.aimed(origin, target)
    }

    fn ray_at_edge(&mut self) -> Ray {
        let [from, to, _] = self.corners();
        let target = match self.random.below(2) {
            0 => from.midpoint(to),
            _ => from.lerp(to, self.unit()),
        };
        let origin = self.origin();
        self.aimed(origin, target)
    }

    fn ray_at_vertex(&mut self) -> Ray {
        let [target, ..] = self.corners();
        if self.random.below(4) == 0 {
            return self.ray_exactly_at(target);
        }
        let origin = self.origin();
        self.aimed(origin, target)
    }

    /// A direction of few digits: origin + direction is the target exactly unless the origin has too few digits for that.
    fn ray_exactly_at(&mut self, target: DVec3) -> Ray {
        let step = self.size.log2().floor().exp2() / 16.0;
        let steps = [(); 3].map(|()| self.random.below(33) as f64 - 16.0);
        let direction = DVec3::from(steps) * step;
        let origin = to_f32(target - direction);
        let interval = self.interval();
        ray(origin, direction, interval)
    }

    fn grazing_ray(&mut self) -> Ray {
        // Nearly all triangles have an area.
        for _ in 0..16 {
            let [a, b, c] = self.corners();
            let Some(normal) = (b - a).cross(c - a).try_normalize() else {
                continue;
            };
            let along_edge = (b - a).normalize();
            let angle = 10f64.powf(-1.0 - 6.0 * self.unit());
            let (target, in_plane) = if self.random.below(2) == 0 {
                (a.lerp(b, self.unit()), along_edge)
            } else {
                let turn = std::f64::consts::TAU * self.unit();
                let across = normal.cross(along_edge);
                let inside = a.lerp(b, self.unit()).lerp(c, self.unit());
                (inside, turn.cos() * along_edge + turn.sin() * across)
            };
            let direction = in_plane + angle * normal;
            let way = 2.0 * self.unit() * self.size * direction;
            return self.aimed(target - way, target);
        }
        self.random_ray()
    }

    fn ray_along_axis(&mut self) -> Ray {
        let mut point = self.point_for_axes();
        let axis = Axis::ALL[self.random.below(3)] as usize;
        let signs = self.random.bits();
        let zero = |bit: usize| if signs >> bit & 1 == 0 { 0.0 } else { -0.0 };
        let mut direction = Vec3::new(zero(0), zero(1), zero(2));
        let sign = if signs >> 3 & 1 == 0 { 1.0 } else { -1.0 };
        let length = [0.25, 1.0, 1.0, 3.0][self.random.below(4)];
        direction[axis] = sign * length;
        if self.random.below(4) > 0 {
            let distance = self.size * (0.5 + 2.0 * self.unit());
            let mut moved = point.as_dvec3();
            moved[axis] -= f64::from(sign) * distance;
            point = to_f32(moved);
        }
        let [t_min, t_max] = self.interval();
        Ray::with_interval(point, direction, t_min, t_max)
    }

    /// A vertex, the middle of an edge, or a point in a face of the box around the mesh.
    fn point_for_axes(&mut self) -> Vec3 {
        let [from, to, _] = self.corners();
        match self.random.below(4) {
            0 | 1 => to_f32(from),
            2 => to_f32(from.midpoint(to)),
            _ => {
                let mut point = to_f32(self.point_in_bounds());
                let axis = self.random.below(3);
                let face = [self.bounds.min, self.bounds.max][self.random.below(2)];
                point[axis] = face[axis];
                point
            }
        }
    }

    /// The vertices of a random triangle, beginning with a random one.
    fn corners(&mut self) -> [DVec3; 3] {
        let triangle = self.mesh.triangle(self.random.below(self.mesh.len()));
        let mut corners = triangle.vertices().map(Vec3::as_dvec3);
        corners.rotate_left(self.random.below(3));
        corners
    }

    /// Around the mesh, inside its bounds, or far away.
    fn origin(&mut self) -> DVec3 {
        match self.random.below(3) {
            0 => self.point_around(1.0),
            1 => self.point_in_bounds(),
            _ => {
                let distance = 10f64.powf(2.0 + 3.0 * self.unit());
                self.point_around(distance)
            }
        }
    }

    fn point_in_bounds(&mut self) -> DVec3 {
        self.random.point_in(&self.bounds).as_dvec3()
    }

    /// A point in some direction at once or twice a distance, in sizes of the mesh.
    fn point_around(&mut self, distance: f64) -> DVec3 {
        let direction = DVec3::from([(); 3].map(|()| 2.0 * self.unit() - 1.0));
        let direction = direction.try_normalize().unwrap_or(DVec3::X);
        self.center + direction * self.size * distance * (1.0 + self.unit())
    }

    /// The ray with a target at about t = 1.
    fn aimed(&mut self, origin: DVec3, target: DVec3) -> Ray {
        let origin = to_f32(origin);
        let interval = self.interval();
        ray(origin, target - origin.as_dvec3(), interval)
    }

    /// Mostly the half-line from the origin; now and then an interval that ends or begins at t = 1, or the whole line.
    fn interval(&mut self) -> [f32; 2] {
        let infinity = f32::INFINITY;
        match self.random.below(16) {
            0 => [0.0, 1.0],
            1 => [1.0, infinity],
            2 => [-infinity, infinity],
            _ => [0.0, infinity],
        }
    }

    fn unit(&mut self) -> f64 {
        self.random.unit().into()
    }
}

/// A valid ray: the direction is scaled by a power of two if it does not fit f32 as it is.
fn ray(origin: Vec3, direction: DVec3, [t_min, t_max]: [f32; 2]) -> Ray {
    let largest = direction.abs().max_element();
    let fits = largest > f32::MIN_POSITIVE.into() && largest <= f32::MAX.into();
    let direction = if largest == 0.0 {
        Vec3::X
    } else if fits {
        direction.as_vec3()
    } else {
        (direction / largest.log2().floor().exp2()).as_vec3()
    };
    Ray::with_interval(origin, direction, t_min, t_max)
}

/// The nearest f32 point; coordinates beyond f32 become the largest.
fn to_f32(point: DVec3) -> Vec3 {
    let largest = DVec3::splat(f32::MAX.into());
    point.clamp(-largest, largest).as_vec3()
}
