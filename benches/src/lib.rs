//! Speed against error: what the benchmark program and `tahko verify` share.
//!
//! [`audit`](audit::audit) holds all structures at all precisions against exact answers, on the user's own mesh.
#![forbid(unsafe_code)]

pub mod audit;
pub mod random;
