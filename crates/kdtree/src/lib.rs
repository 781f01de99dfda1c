//! placeholder
#![forbid(unsafe_code)]

mod build;
mod node;
mod options;
mod statistics;
mod traverse;
mod tree;
mod validate;

pub use options::{AxisChoice, BuildError, KdTreeOptions, SplitPolicy};
pub use statistics::ExpectedVisits;
pub use tree::KdTree;
pub use validate::ValidationError;
