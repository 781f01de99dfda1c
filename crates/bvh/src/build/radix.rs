//! A stable radix sort of numbers, shared among threads.

use super::node::take;
use crate::parallel::{for_each, map, task_count};

/// Bits that one pass sorts by.
const DIGIT_BITS: u32 = 11;
const DIGITS: usize = 1 << DIGIT_BITS;

/// Below this length, comparing is as fast.
const SMALL: usize = 1 << 11;

/// Parts of the list with fewer keys than this are not worth a task of their own.
const PART: usize = 1 << 15;

/// Sorts keys that differ in their lower bits by all of their bits, if the lower `sorted` bits already are in order.
///
/// Cost: O(n) per 11 bits above those, 8 bytes per key beside the list. Source: the parallel counting sort that
/// is common knowledge; each part of the list counts its digits, and writes them into places of its own.
pub(super) fn sort(mut keys: Vec<u64>, sorted: u32, bits: u32) -> Vec<u64> {
    if keys.len() <= SMALL {
        keys.sort_unstable();
        return keys;
    }
    let mut other = vec![0; keys.len()];
    let mut shift = sorted;
    while shift < bits {
        if pass(&keys, &mut other, shift) {
            std::mem::swap(&mut keys, &mut other);
        }
        shift += DIGIT_BITS;
    }
    keys
}

#[expect(clippy::cast_possible_truncation, reason = "a digit has few bits")]
fn digit(key: u64, shift: u32) -> usize {
    (key >> shift & (DIGITS as u64 - 1)) as usize
}

/// A value for each digit, in an array: its length is known where it is read.
fn by_digit<T>(value: impl FnMut(usize) -> T) -> Box<[T; DIGITS]> {
    let values: Box<[T]> = (0..DIGITS).map(value).collect();
    match values.try_into() {
        Ok(values) => values,
        Err(_) => unreachable!("as many as there are digits"),
    }
}

/// Moves keys in the order of one digit; `false` if nothing needed to be moved because all have the same.
fn pass(keys: &[u64], sorted: &mut [u64], shift: u32) -> bool {
    let parts = task_count().min(keys.len() / PART).max(1);
    let parts: Vec<&[u64]> = keys.chunks(keys.len().div_ceil(parts)).collect();
    let counts = map(&parts, |part| {
        let mut counts = by_digit(|_| 0u32);
        for key in *part {
            counts[digit(*key, shift)] += 1;
        }
        counts
    });
    let all_same = digit(keys[0], shift);
    if counts
        .iter()
        .map(|counts| counts[all_same] as usize)
        .sum::<usize>()
        == keys.len()
    {
        return false;
    }
    // Stable: the keys of a digit stand in the order of the parts that they come from.
    let mut targets: Vec<Vec<_>> = parts.iter().map(|_| Vec::with_capacity(DIGITS)).collect();
    let mut rest = sorted;
    for digit in 0..DIGITS {
        for (targets, counts) in targets.iter_mut().zip(&counts) {
            targets.push(take(&mut rest, counts[digit] as usize).iter_mut());
        }
    }
    let targets = targets.into_iter().map(|targets| {
        let mut targets = targets.into_iter();
        by_digit(|_| targets.next().expect("one for each digit"))
    });
    for_each(
        parts.into_iter().zip(targets).collect(),
        |(part, mut targets)| {
            for key in part {
                if let Some(target) = targets[digit(*key, shift)].next() {
                    *target = *key;
                }
            }
        },
    );
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keys whose lower 20 bits are their place in the list.
    fn keys(count: u64, high: impl Fn(u64) -> u64) -> Vec<u64> {
        (0..count).map(|i| high(i) << 20 | i).collect()
    }

    #[test]
    fn any_keys_are_sorted_stably() {
        let scattered = |i: u64| i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 22;
        for count in [0, 1, 2, 2048, 2049, 100_000] {
            for keys in [
                keys(count, scattered),
                keys(count, |_| 5),
                keys(count, |i| scattered(i) % 3),
                keys(count, |i| (1 << 42) - 1 - i),
            ] {
                let mut expected = keys.clone();
                expected.sort_unstable();
                assert!(sort(keys, 20, 62) == expected, "{count} keys");
            }
        }
    }
}
