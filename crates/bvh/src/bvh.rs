//! The public type.

use tahko_geometry::simd::{AvailableSimd, SimdLevel};
use tahko_geometry::{Aabb, Precision, TriangleMesh};

use crate::build::BinaryTree;
use crate::report::Stopwatch;
use crate::wide::{Costs, WideBvh};
use crate::{BuildControl, BuildError, BuildPhase, BuildReport, BvhOptions};

/// The work per triangle that the layout counts as, where the binary tree is [`BinaryTree::WORK`].
const LAYOUT_WORK: u64 = BinaryTree::WORK / 4;

/// A bounding volume hierarchy over a triangle mesh.
///
/// Ask it through [`RayQuery`](tahko_geometry::RayQuery). It owns a copy of the triangles and does not borrow from the
/// mesh. Every triangle is listed, degenerate ones included: once, or by several leaves where
/// [spatial splits](BvhOptions::spatial_split_budget) or [pieces](BvhOptions::presplit_budget) are allowed. Two trees are equal if they have equal nodes,
/// triangles and options, whatever instructions they are asked with.
#[derive(Clone, Debug)]
pub struct Bvh {
    layout: WideBvh,
    options: BvhOptions,
    simd: AvailableSimd,
}

impl PartialEq for Bvh {
    fn eq(&self, other: &Self) -> bool {
        self.layout == other.layout && self.options == other.options
    }
}

impl Bvh {
    /// Builds the tree of a mesh by the [method](crate::BuildMethod) that the options name.
    ///
    /// The same mesh and options give the same tree, whatever the number of threads and with or without
    /// the `parallel` feature. No way from the root to a leaf has more than 64 nodes.
    ///
    /// Cost: O(n log n) time; memory as [`BvhOptions::build_memory`] estimates it, and after the build 67 to 90
    /// bytes per triangle on the meshes that were measured, or that for each piece where triangles were [cut in pieces](BvhOptions::presplit_budget).
    ///
    /// # Errors
    /// If an option is out of its range.
    pub fn build(mesh: &TriangleMesh, options: &BvhOptions) -> Result<Self, BuildError> {
        Self::build_timed(mesh, options, &BuildControl::new()).map(|(bvh, ..)| bvh)
    }

    /// Builds the tree of a mesh as [`build`](Self::build) does, while another thread may watch and cancel it, and
    /// within a limit of memory; and reports what it took. The tree depends on the limit only where that leaves fewer [pieces](BvhOptions::presplit_budget) than
    /// the build would make without.
    ///
    /// # Errors
    /// If an option is out of its range, the build is cancelled, or it would need more memory than allowed.
    pub fn build_with(
        mesh: &TriangleMesh,
        options: &BvhOptions,
        control: &BuildControl,
    ) -> Result<(Self, BuildReport), BuildError> {
        let (bvh, stopwatch, pieces) = Self::build_timed(mesh, options, control)?;
        let memory = options.build_memory_in_pieces(mesh.len(), pieces);
        let report = BuildReport::new(&bvh, stopwatch, memory);
        Ok((bvh, report))
    }

    /// The tree, the times of the phases, and how many pieces of triangles the build began with.
    fn build_timed(
        mesh: &TriangleMesh,
        options: &BvhOptions,
        control: &BuildControl,
    ) -> Result<(Self, Stopwatch, usize), BuildError> {
        options.check()?;
        let needed = options.build_memory(mesh.len());
        let work = BinaryTree::WORK + LAYOUT_WORK;
        control.begin(work * mesh.len() as u64, needed)?;
        let mut stopwatch = Stopwatch::start();
        let tree = BinaryTree::build(mesh, options, control, &mut stopwatch)?;
        let bvh = Self {
            layout: WideBvh::new(
                &tree,
                mesh,
                &Costs::new(options),
                options.node_format,
                control,
            )?,
            options: options.clone(),
            simd: AvailableSimd::best(),
        };
        stopwatch.end(BuildPhase::Layout);
        control.finish();
        Ok((bvh, stopwatch, tree.pieces))
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

    /// The same tree, asked with other instructions than the best ones that the processor has, which are the default. `None` if the processor
    /// does not have them. The answers are the same, bit for bit.
    #[must_use]
    pub fn with_simd(mut self, level: SimdLevel) -> Option<Self> {
        self.simd = level.available()?;
        Some(self)
    }

    /// The instructions that queries use.
    #[must_use]
    pub const fn simd_level(&self) -> SimdLevel {
        self.simd.level()
    }

    /// The smallest box around all triangles; empty for none.
    #[must_use]
    pub const fn bounds(&self) -> Aabb {
        self.layout.bounds
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

    pub(crate) const fn layout(&self) -> &WideBvh {
        &self.layout
    }

    pub(crate) const fn simd(&self) -> AvailableSimd {
        self.simd
    }
}

#[cfg(test)]
mod tests {
    use tahko_geometry::glam::Vec3;

    use super::*;
    use crate::NodeFormat;
    use crate::wide::Child;

    /// Triangles between neighbouring points of a sequence whose coordinates are exact in f32.
    fn mesh() -> TriangleMesh {
        let points = (0u32..40_002).map(|i| {
            let [x, y, z] = [48_271, 69_621, 16_807].map(|factor| i.wrapping_mul(factor) % 8191);
            Vec3::from([x, y, z].map(|coordinate| coordinate as f32))
        });
        let indices = (0..40_000).map(|i| [i, i + 1, i + 2]);
        TriangleMesh::new(points.collect(), indices.collect()).expect("finite vertices")
    }

    /// FNV-1a over all bits of the layout but the vertices.
    fn fingerprint(layout: &WideBvh) -> u64 {
        let nodes = layout.nodes.iter().flat_map(|node| {
            let lanes = node.bounds.into_iter().flatten();
            let bounds = lanes.flat_map(|lanes| lanes.0.map(f32::to_bits));
            bounds.chain(node.children.map(Child::bits))
        });
        let blocks = layout.blocks.iter().flat_map(|block| {
            let numbers = block.triangles().map(|(number, _)| number);
            numbers.chain([u32::from(block.continues())])
        });
        let root = std::iter::once(layout.root.bits());
        root.chain(nodes)
            .chain(blocks)
            .fold(0xcbf2_9ce4_8422_2325, |hash, word| {
                (hash ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3)
            })
    }

    /// The expected values are the same with and without the `parallel` feature. They change with the
    /// build's decisions: that is no fault, if the cost of the tree did not grow.
    #[test]
    fn threads_do_not_show_in_the_tree() {
        let mesh = mesh();
        let presets = [
            BvhOptions::fast(),
            BvhOptions::balanced(),
            BvhOptions::high_quality(),
            BvhOptions::fast().with_node_format(NodeFormat::Quantised),
        ];
        let found = presets.map(|options| {
            let bvh = Bvh::build(&mesh, &options).expect("options in range");
            (fingerprint(bvh.layout()), bvh.statistics().sah_cost)
        });
        let expected = [
            0x655f_71a5_4384_9c1b,
            0xdd0a_28e7_462d_eb3e,
            0xfca8_0f05_ef2f_1e06,
            0x8645_094e_f228_b7b3,
        ];
        assert_eq!(found.map(|(hash, _)| hash), expected, "{found:x?}");
    }

    #[test]
    fn a_tree_answers_at_every_level_that_it_is_given() {
        let bvh = Bvh::build(&mesh(), &BvhOptions::default()).expect("options in range");
        assert_eq!(bvh.simd_level(), AvailableSimd::best().level());
        for level in SimdLevel::ALL {
            let found = bvh.clone().with_simd(level);
            assert_eq!(found.is_some(), level.is_available(), "{level:?}");
            if let Some(found) = found {
                assert_eq!(found.simd_level(), level);
                assert!(found == bvh, "the tree is the same");
            }
        }
    }
}
