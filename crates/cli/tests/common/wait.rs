//! Waiting for other programs: the one place in the tests where time passes.

use std::thread;
use std::time::{Duration, Instant};

/// No program that a test starts may take longer: it hangs.
const DEADLINE: Duration = Duration::from_secs(60);

/// Whether a condition becomes true before the deadline.
pub(crate) fn comes_true(mut condition: impl FnMut() -> bool) -> bool {
    let start = Instant::now();
    while !condition() {
        if start.elapsed() > DEADLINE {
            return false;
        }
        thread::sleep(Duration::from_millis(2));
    }
    true
}
