//! The public type.

use tahko_geometry::{Aabb, Precision, TriangleMesh};

use crate::build::BinaryTree;
use crate::layout::Bvh2;
use crate::report::Stopwatch;
use crate::{BuildControl, BuildError, BuildPhase, BuildReport, BvhOptions};

/// The work per triangle that the layout counts as, where the binary tree is [`BinaryTree::WORK`].
const LAYOUT_WORK: u64 = 2;

/// A bounding volume hierarchy over a triangle mesh.
///
/// Ask it through [`RayQuery`](tahko_geometry::RayQuery). It owns a copy of the triangles and does not borrow from the
/// mesh. Every triangle is listed once, degenerate ones included. Two trees are equal if they have equal nodes,
/// triangles and options.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    layout: Bvh2,
    options: BvhOptions,
}

impl Bvh {
    /// Builds the tree of a mesh by the [method](crate::BuildMethod) that the options name.
    ///
    /// The same mesh and options give the same tree, whatever the number of threads and with or without
    /// the `parallel` feature. No way from the root to a leaf has more than 64 nodes.
    ///
    /// Cost: O(n log n) time; memory as [`BvhOptions::build_memory`] estimates it, and 70 to 105 bytes per triangle after
    /// the build.
    ///
    /// # Errors
    /// If an option is out of its range.
    pub fn build(mesh: &TriangleMesh, options: &BvhOptions) -> Result<Self, BuildError> {
        Self::build_with(mesh, options, &BuildControl::new()).map(|(bvh, _)| bvh)
    }

    /// Builds the tree of a mesh as [`build`](Self::build) does, while another thread may watch and cancel it, and
    /// within a limit of memory; and reports what it took.
    ///
    /// # Errors
    /// If an option is out of its range, the build is cancelled, or it would need more memory than allowed.
    pub fn build_with(
        mesh: &TriangleMesh,
        options: &BvhOptions,
        control: &BuildControl,
    ) -> Result<(Self, BuildReport), BuildError> {
        options.check()?;
        let needed = options.build_memory(mesh.len());
        let work = BinaryTree::WORK + LAYOUT_WORK;
        control.begin(work * mesh.len() as u64, needed)?;
        let mut stopwatch = Stopwatch::start();
        let tree = BinaryTree::build(mesh, options, control, &mut stopwatch)?;
        let bvh = Self {
            layout: Bvh2::new(&tree, mesh),
            options: options.clone(),
        };
        stopwatch.end(BuildPhase::Layout);
        control.finish();
        let report = BuildReport::new(&bvh, stopwatch, needed);
        Ok((bvh, report))
    }

    /// The options that the tree was built with.
    #[must_use]
    pub const fn options(&self) -> &BvhOptions {
        &self.options
    }

    /// The same tree with another precision of its queries: the build does not depend on it.
    #[must_use]
    pub const fn with_precision(mut self, precision: Precision) -> Self {
        self.options.precision = precision;
        self
    }

    /// The smallest box around all triangles; empty for none.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.layout.bounds()
    }

    /// The number of nodes, leaves included.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.layout.node_count()
    }

    /// Nodes on the longest way from the root to a leaf, both included; 0 for a tree over no triangles.
    #[must_use]
    pub const fn depth(&self) -> usize {
        self.layout.depth
    }

    pub(crate) const fn layout(&self) -> &Bvh2 {
        &self.layout
    }
}

#[cfg(test)]
mod tests {
    use tahko_geometry::glam::Vec3;

    use super::*;

    /// Triangles between neighbouring points of a sequence whose coordinates are exact in f32.
    fn mesh() -> TriangleMesh {
        let points = (0u32..40_002).map(|i| {
            let [x, y, z] = [48_271, 69_621, 16_807].map(|factor| i.wrapping_mul(factor) % 8191);
            Vec3::from([x, y, z].map(|coordinate| coordinate as f32))
        });
        let indices = (0..40_000).map(|i| [i, i + 1, i + 2]);
        TriangleMesh::new(points.collect(), indices.collect()).expect("finite vertices")
    }

    /// FNV-1a over all bits of the layout.
    fn fingerprint(layout: &Bvh2) -> u64 {
        let nodes = layout.nodes().flat_map(|node| {
            let Aabb { min, max } = node.bounds();
            let corners = [min, max].map(|corner| corner.to_array().map(f32::to_bits));
            let links = [node.first(), node.count()].map(|link| link as u64);
            corners.into_iter().flatten().map(u64::from).chain(links)
        });
        let numbers = layout.triangles.iter().map(|leaf| u64::from(leaf.number));
        nodes
            .chain(numbers)
            .fold(0xcbf2_9ce4_8422_2325, |hash, word| {
                (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3)
            })
    }

    /// The expected values are the same with and without the `parallel` feature. They change with the
    /// build's decisions: that is no fault, if the cost of the tree did not grow.
    #[test]
    fn threads_do_not_show_in_the_tree() {
        let mesh = mesh();
        for (options, expected) in [
            (BvhOptions::fast(), 0xa846_dfce_e05f_8419),
            (BvhOptions::balanced(), 0xfdec_1748_6fbe_ebbf),
            (BvhOptions::high_quality(), 0x0cf1_b591_a14b_ef3f),
        ] {
            let bvh = Bvh::build(&mesh, &options).expect("options in range");
            let found = fingerprint(bvh.layout());
            assert_eq!(found, expected, "{found:#x}, {}", bvh.statistics().sah_cost);
        }
    }
}
