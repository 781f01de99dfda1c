//! Timing tasks against each other.

use std::time::Instant;

use crate::report::Sample;

/// Seconds that each of `N` tasks takes, one value a round; `run` runs one of them. The tasks take turns, so that what disturbs a round
/// disturbs all of them. A round before the first one warms up.
pub(super) fn seconds<const N: usize>(rounds: usize, mut run: impl FnMut(usize)) -> [Sample; N] {
    let mut samples = [(); N].map(|()| Sample::default());
    for round in 0..=rounds {
        for (task, sample) in samples.iter_mut().enumerate() {
            let start = Instant::now();
            run(task);
            let seconds = start.elapsed().as_secs_f64();
            if round > 0 {
                sample.push(seconds);
            }
        }
    }
    samples
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tasks_take_turns_after_a_round_to_warm_up() {
        let mut order = Vec::new();
        let samples = seconds::<2>(2, |task| order.push(task));
        assert_eq!(order, [0, 1, 0, 1, 0, 1]);
        assert!(samples.iter().all(|sample| sample.values().len() == 2));
    }
}
