//! Why a scene is not generated.

use thiserror::Error;

use super::Generator;

/// Why a scene is not generated.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// The size is not one of the generator's.
    #[error(
        "size {size} of generator {generator} is out of range: choose {min} to {max} ({meaning})",
        min = generator.sizes().start(),
        max = generator.sizes().end(),
        meaning = generator.size_meaning()
    )]
    SizeOutOfRange {
        /// The generator.
        generator: Generator,
        /// The size as asked for.
        size: u32,
    },
    /// Even the largest size has fewer triangles.
    #[error("generator {generator} makes at most {most} triangles, but {target} are asked for")]
    TooManyTriangles {
        /// The generator.
        generator: Generator,
        /// The number of triangles asked for.
        target: u64,
        /// The number of triangles of the largest size.
        most: u64,
    },
}
