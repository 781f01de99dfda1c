//! Watching and stopping a build from another thread.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crate::BuildError;

/// A handle on a build for [`Bvh::build_with`](crate::Bvh::build_with): its progress, the means to cancel it, and the
/// memory it may take. Other threads use it while the build runs.
///
/// ```
/// use tahko_bvh::{BuildControl, BuildError, Bvh, BvhOptions};
/// use tahko_geometry::TriangleMesh;
///
/// let control = BuildControl::new();
/// control.cancel();
/// let result = Bvh::build_with(&TriangleMesh::default(), &BvhOptions::default(), &control);
/// assert_eq!(result.err(), Some(BuildError::Cancelled));
/// ```
#[derive(Debug, Default)]
pub struct BuildControl {
    is_cancelled: AtomicBool,
    /// Work done and to be done, in units that say nothing to others.
    done: AtomicU64,
    total: AtomicU64,
    memory_limit: Option<u64>,
}

impl BuildControl {
    /// A handle on a build that has not begun, without a limit of memory.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            is_cancelled: AtomicBool::new(false),
            done: AtomicU64::new(0),
            total: AtomicU64::new(0),
            memory_limit: None,
        }
    }

    /// The same handle with a limit in bytes: a build that is [estimated](crate::BvhOptions::build_memory) to need more ends with an error
    /// before it takes any. One that would cut triangles in [pieces](crate::BvhOptions::presplit_budget) makes as many as fit.
    #[must_use]
    pub const fn with_memory_limit(mut self, bytes: u64) -> Self {
        self.memory_limit = Some(bytes);
        self
    }

    /// The limit in bytes of the memory that a build may take.
    #[must_use]
    pub const fn memory_limit(&self) -> Option<u64> {
        self.memory_limit
    }

    /// Makes the build end with [`BuildError::Cancelled`] within the time of one pass over the triangles; one that
    /// has not begun, at its beginning. [Reinsertion](crate::BvhOptions::reinsertion_rounds) ends with the round that it is in.
    pub fn cancel(&self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether [`cancel`](Self::cancel) was called.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }

    /// The part of the work that is done, from 0 to 1; it never falls during a build. The parts are weighted by what they
    /// take on typical meshes; reinsertion does not count.
    #[must_use]
    pub fn progress(&self) -> f64 {
        let total = self.total.load(Ordering::Relaxed);
        let done = self.done.load(Ordering::Relaxed).min(total);
        if total == 0 {
            0.0
        } else {
            done as f64 / total as f64
        }
    }

    /// Begins a build of some work that needs some memory.
    pub(crate) fn begin(&self, total: u64, needed: u64) -> Result<(), BuildError> {
        self.done.store(0, Ordering::Relaxed);
        self.total.store(total.max(1), Ordering::Relaxed);
        match self.memory_limit {
            Some(allowed) if needed > allowed => Err(BuildError::MemoryLimit { needed, allowed }),
            _ => self.check(),
        }
    }

    /// Some work is done.
    pub(crate) fn advance(&self, work: u64) {
        self.done.fetch_add(work, Ordering::Relaxed);
    }

    /// All work is done.
    pub(crate) fn finish(&self) {
        self.done
            .store(self.total.load(Ordering::Relaxed), Ordering::Relaxed);
    }

    /// An error if the build was cancelled.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        if self.is_cancelled() {
            Err(BuildError::Cancelled)
        } else {
            Ok(())
        }
    }
}

/// A phase of a build as its tasks report what they have done.
#[derive(Clone, Copy)]
pub(crate) struct Work<'a> {
    pub(crate) control: &'a BuildControl,
    /// What one reference counts.
    pub(crate) weight: u64,
}

impl Work<'_> {
    pub(crate) fn done(&self, references: usize) {
        self.control.advance(self.weight * references as u64);
    }

    pub(crate) fn is_cancelled(&self) -> bool {
        self.control.is_cancelled()
    }
}
