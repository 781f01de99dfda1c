//! The list of generators and what can be known about one without running it.

use std::fmt;
use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::{
    GenerateError, GeneratedScene, city, cylinders, gears, hairball, lattice, mount, needles,
    rings, sphereflake, teapot, terrain, tetra, tree,
};

/// A procedural scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Generator {
    /// Spheres that carry nine smaller spheres each.
    Sphereflake,
    /// A fractal island in water.
    Terrain,
    /// Towers of many heights on a street grid.
    City,
    /// Thin triangles along the diagonals of a cube, where bounding boxes are at their worst.
    Needles,
    /// The sphereflake on a ground plate.
    Balls,
    /// Meshing gears.
    Gears,
    /// A fractal mountain below four glass spheres.
    Mount,
    /// A pyramid of dodecahedra made of rings.
    Rings,
    /// The Utah teapot on a checkerboard.
    Teapot,
    /// The Sierpinski tetrahedron.
    Tetra,
    /// A fractal tree of cones and spheres.
    Tree,
    /// Spheres at grid points, joined by cylinders.
    Lattice,
    /// Curled strands that grow out of a sphere.
    Hairball,
    /// Thin cylinders along the diagonals of a cube, each a bundle of slivers as long as the scene.
    Cylinders,
}

/// What a generator's module tells about it. The functions are called with sizes in range only.
pub(super) struct Recipe {
    pub(super) name: &'static str,
    pub(super) description: &'static str,
    pub(super) size_meaning: &'static str,
    pub(super) sizes: RangeInclusive<u32>,
    pub(super) default_size: u32,
    pub(super) uses_seed: bool,
    /// Grows strictly with the size.
    pub(super) triangle_count: fn(u32) -> u64,
    pub(super) generate: fn(u32, u64) -> GeneratedScene,
}

impl Generator {
    /// All generators.
    pub const ALL: [Self; 14] = [
        Self::Sphereflake,
        Self::Terrain,
        Self::City,
        Self::Needles,
        Self::Balls,
        Self::Gears,
        Self::Mount,
        Self::Rings,
        Self::Teapot,
        Self::Tetra,
        Self::Tree,
        Self::Lattice,
        Self::Hairball,
        Self::Cylinders,
    ];

    /// No size of any generator makes more triangles.
    pub const MAX_TRIANGLES: u64 = 100_000_000;

    /// The name in files and on the command line: lower case, one word.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.recipe().name
    }

    /// The generator with a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|generator| generator.name() == name)
    }

    /// What it makes, in one phrase.
    #[must_use]
    pub fn description(self) -> &'static str {
        self.recipe().description
    }

    /// What the size counts.
    #[must_use]
    pub fn size_meaning(self) -> &'static str {
        self.recipe().size_meaning
    }

    /// The sizes that can be generated.
    #[must_use]
    pub fn sizes(self) -> RangeInclusive<u32> {
        self.recipe().sizes.clone()
    }

    /// A size that makes a good picture.
    #[must_use]
    pub fn default_size(self) -> u32 {
        self.recipe().default_size
    }

    /// Whether different seeds give different scenes.
    #[must_use]
    pub fn uses_seed(self) -> bool {
        self.recipe().uses_seed
    }

    /// The number of triangles, without generating them. Grows strictly with the size.
    ///
    /// # Errors
    /// If the size is not in [`sizes`](Self::sizes).
    pub fn triangle_count(self, size: u32) -> Result<u64, GenerateError> {
        self.check_size(size)?;
        Ok((self.recipe().triangle_count)(size))
    }

    /// The smallest size with at least `target` triangles.
    ///
    /// # Errors
    /// If no size has that many.
    pub fn size_for_triangles(self, target: u64) -> Result<u32, GenerateError> {
        let Recipe {
            sizes,
            triangle_count,
            ..
        } = self.recipe();
        let (mut low, mut high) = (*sizes.start(), *sizes.end());
        let most = triangle_count(high);
        if most < target {
            return Err(GenerateError::TooManyTriangles {
                generator: self,
                target,
                most,
            });
        }
        // Invariant: the size looked for is in low..=high.
        while low < high {
            let middle = low + (high - low) / 2;
            if triangle_count(middle) < target {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        Ok(low)
    }

    pub(super) fn check_size(self, size: u32) -> Result<(), GenerateError> {
        if self.recipe().sizes.contains(&size) {
            Ok(())
        } else {
            Err(GenerateError::SizeOutOfRange {
                generator: self,
                size,
            })
        }
    }

    pub(super) fn recipe(self) -> &'static Recipe {
        match self {
            Self::Sphereflake => &sphereflake::SPHEREFLAKE,
            Self::Terrain => &terrain::TERRAIN,
            Self::City => &city::CITY,
            Self::Needles => &needles::NEEDLES,
            Self::Balls => &sphereflake::BALLS,
            Self::Gears => &gears::GEARS,
            Self::Mount => &mount::MOUNT,
            Self::Rings => &rings::RINGS,
            Self::Teapot => &teapot::TEAPOT,
            Self::Tetra => &tetra::TETRA,
            Self::Tree => &tree::TREE,
            Self::Lattice => &lattice::LATTICE,
            Self::Hairball => &hairball::HAIRBALL,
            Self::Cylinders => &cylinders::CYLINDERS,
        }
    }
}

impl fmt::Display for Generator {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}
