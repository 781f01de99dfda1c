//! The reference: every triangle is tested.

use crate::{
    ExpectedVisits, HitCollector, Precision, Ray, TraversalCounter, Traverse, TreeStatistics,
    Triangle, TriangleKernel, TriangleMesh, query::test_triangle,
};

/// Tests every triangle: the structure without structure, which all others are held against.
///
/// Cost: `n` triangle tests per ray, 36 bytes per triangle.
///
/// ```
/// use tahko_geometry::{BruteForce, Precision, Ray, RayQuery, TriangleMesh, glam::Vec3};
///
/// let mesh = TriangleMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])?;
/// let structure = BruteForce::new(&mesh, Precision::default());
/// let hit = structure.closest_hit(&Ray::new(Vec3::new(0.25, 0.25, 2.0), Vec3::NEG_Z));
/// assert_eq!(hit.map(|hit| (hit.t, hit.primitive)), Some((2.0, 0)));
/// # Ok::<(), tahko_geometry::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct BruteForce {
    triangles: Vec<Triangle>,
    precision: Precision,
}

impl BruteForce {
    /// Copies the triangles of a mesh.
    #[must_use]
    pub fn new(mesh: &TriangleMesh, precision: Precision) -> Self {
        Self {
            triangles: mesh.triangles().collect(),
            precision,
        }
    }

    /// The same triangles with another precision of the queries.
    #[must_use]
    pub const fn with_precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }

    /// One list, no nodes; a ray costs one test per triangle.
    #[must_use]
    pub fn statistics(&self) -> TreeStatistics {
        let count = self.triangles.len();
        let expected_visits = ExpectedVisits {
            triangle_tests: count as f64,
            ..ExpectedVisits::default()
        };
        TreeStatistics {
            primitives: count,
            references: count,
            bytes: size_of_val(self.triangles.as_slice()),
            expected_visits,
            sah_cost: expected_visits.cost(0.0),
            ..TreeStatistics::default()
        }
    }
}

impl Traverse for BruteForce {
    fn precision(&self) -> Precision {
        self.precision
    }

    fn traverse<K: TriangleKernel, H: HitCollector, C: TraversalCounter>(
        &self,
        ray: &Ray,
        collector: &mut H,
        counter: &mut C,
    ) {
        let kernel = K::new(ray);
        for (primitive, triangle) in (0..).zip(&self.triangles) {
            if test_triangle(&kernel, triangle, primitive, collector, counter).is_break() {
                return;
            }
        }
    }
}
