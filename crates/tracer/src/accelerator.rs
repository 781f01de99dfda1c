//! The structures behind one type, for programs that let their user choose.

use std::fmt;
use std::time::{Duration, Instant};

use tahko_bsp::{BspOptions, BspTree};
use tahko_bvh::{Bvh, BvhOptions};
use tahko_geometry::{BruteForce, Precision, RayQuery, TreeStatistics, TriangleMesh};
use tahko_kdtree::{KdTree, KdTreeOptions};
use thiserror::Error;

/// The structures to choose from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum StructureKind {
    /// Every triangle is tested.
    Brute,
    /// A BSP tree.
    Bsp,
    /// A kd-tree.
    KdTree,
    /// A bounding volume hierarchy.
    #[default]
    Bvh,
}

impl StructureKind {
    /// All structures.
    pub const ALL: [Self; 4] = [Self::Brute, Self::Bsp, Self::KdTree, Self::Bvh];

    /// The name on the command line: `brute`, `bsp`, `kdtree` or `bvh`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Brute => "brute",
            Self::Bsp => "bsp",
            Self::KdTree => "kdtree",
            Self::Bvh => "bvh",
        }
    }
}

/// A structure over the triangles of a mesh, built with its default options.
pub struct Accelerator {
    structure: Structure,
    statistics: TreeStatistics,
    build_time: Duration,
}

enum Structure {
    Brute(BruteForce),
    Bsp(BspTree),
    KdTree(KdTree),
    Bvh(Bvh),
}

/// Why a structure could not be built.
#[derive(Debug, Error)]
#[error("cannot build the {}: {source}", kind.name())]
pub struct AcceleratorError {
    kind: StructureKind,
    source: Box<dyn std::error::Error + Send + Sync>,
}

impl AcceleratorError {
    fn new(kind: StructureKind, source: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self {
            kind,
            source: Box::new(source),
        }
    }
}

impl Accelerator {
    /// Builds a structure with the current thread pool of rayon.
    ///
    /// # Errors
    /// If the structure refuses the mesh.
    pub fn build(
        kind: StructureKind,
        precision: Precision,
        mesh: &TriangleMesh,
    ) -> Result<Self, AcceleratorError> {
        let start = Instant::now();
        let structure = Structure::build(kind, precision, mesh)?;
        let build_time = start.elapsed();
        Ok(Self {
            statistics: structure.statistics(),
            structure,
            build_time,
        })
    }

    /// The structure, to ask.
    #[must_use]
    pub fn query(&self) -> &dyn RayQuery {
        match &self.structure {
            Structure::Brute(structure) => structure,
            Structure::Bsp(structure) => structure,
            Structure::KdTree(structure) => structure,
            Structure::Bvh(structure) => structure,
        }
    }

    /// The end-point overlap of a bounding volume hierarchy ([`Bvh::end_point_overlap`]); `None` for other structures, which do not know it.
    #[must_use]
    pub fn end_point_overlap(&self) -> Option<f64> {
        match &self.structure {
            Structure::Bvh(structure) => Some(structure.end_point_overlap()),
            Structure::Brute(_) | Structure::Bsp(_) | Structure::KdTree(_) => None,
        }
    }

    /// What the structure looks like.
    #[must_use]
    pub const fn statistics(&self) -> TreeStatistics {
        self.statistics
    }

    /// How long the build took, from the mesh until rays can be asked.
    #[must_use]
    pub const fn build_time(&self) -> Duration {
        self.build_time
    }
}

impl Structure {
    fn build(
        kind: StructureKind,
        precision: Precision,
        mesh: &TriangleMesh,
    ) -> Result<Self, AcceleratorError> {
        Ok(match kind {
            StructureKind::Brute => Self::Brute(BruteForce::new(mesh, precision)),
            StructureKind::Bsp => {
                let options = BspOptions::default().with_precision(precision);
                let structure = BspTree::build(mesh, &options);
                Self::Bsp(structure.map_err(|source| AcceleratorError::new(kind, source))?)
            }
            StructureKind::KdTree => {
                let options = KdTreeOptions::default().with_precision(precision);
                let structure = KdTree::build(mesh, &options);
                Self::KdTree(structure.map_err(|source| AcceleratorError::new(kind, source))?)
            }
            StructureKind::Bvh => {
                let options = BvhOptions::default().with_precision(precision);
                let structure = Bvh::build(mesh, &options);
                Self::Bvh(structure.map_err(|source| AcceleratorError::new(kind, source))?)
            }
        })
    }

    fn statistics(&self) -> TreeStatistics {
        match self {
            Self::Brute(structure) => structure.statistics(),
            Self::Bsp(structure) => structure.statistics(),
            Self::KdTree(structure) => structure.statistics(),
            Self::Bvh(structure) => structure.statistics(),
        }
    }
}

impl fmt::Debug for Accelerator {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("Accelerator")
            .field("statistics", &self.statistics)
            .field("build_time", &self.build_time)
            .finish_non_exhaustive()
    }
}
