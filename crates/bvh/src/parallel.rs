//! The only place that knows of threads. Nothing here lets their number reach a result.

use std::cmp::Ordering;
use std::ops::Range;

use crate::huge_pages;

/// Runs two tasks, at the same time where the `parallel` feature is on.
#[cfg(feature = "parallel")]
fn join<A: Send, B: Send>(
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    rayon::join(first, second)
}

/// Runs two tasks, one after the other without the `parallel` feature.
#[cfg(not(feature = "parallel"))]
fn join<A, B>(first: impl FnOnce() -> A, second: impl FnOnce() -> B) -> (A, B) {
    (first(), second())
}

/// The values of a function for `0..count`, in order.
pub(crate) fn collect<T: Send>(count: usize, value: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    collect_with_room(count, count, value)
}

/// The same in a list with room for `capacity` values, as many or more.
#[cfg(feature = "parallel")]
pub(crate) fn collect_with_room<T: Send>(
    count: usize,
    capacity: usize,
    value: impl Fn(usize) -> T + Sync + Send,
) -> Vec<T> {
    use rayon::prelude::*;
    let mut list = huge_pages::with_capacity(capacity);
    let values = (0..count).into_par_iter().with_min_len(CHUNK);
    values.map(value).collect_into_vec(&mut list);
    list
}

/// The same in a list with room for `capacity` values, as many or more.
#[cfg(not(feature = "parallel"))]
pub(crate) fn collect_with_room<T>(
    count: usize,
    capacity: usize,
    value: impl Fn(usize) -> T,
) -> Vec<T> {
    let mut list = huge_pages::with_capacity(capacity);
    list.extend((0..count).map(value));
    list
}

/// The values of a function for each item, in order; a value takes about a microsecond.
#[cfg(feature = "parallel")]
pub(crate) fn collect_each<T: Sync, R: Send>(
    items: &[T],
    value: impl Fn(&T) -> R + Sync + Send,
) -> Vec<R> {
    use rayon::prelude::*;
    items.par_iter().with_min_len(64).map(value).collect()
}

/// The values of a function for each item, in order.
#[cfg(not(feature = "parallel"))]
pub(crate) fn collect_each<T, R>(items: &[T], value: impl Fn(&T) -> R) -> Vec<R> {
    items.iter().map(value).collect()
}

/// Sorts by a total order in which no two items are equal.
#[cfg(feature = "parallel")]
pub(crate) fn sort<T: Send>(items: &mut [T], order: impl Fn(&T, &T) -> Ordering + Sync) {
    use rayon::prelude::*;
    items.par_sort_unstable_by(order);
}

/// Sorts by a total order in which no two items are equal.
#[cfg(not(feature = "parallel"))]
pub(crate) fn sort<T>(items: &mut [T], order: impl Fn(&T, &T) -> Ordering) {
    items.sort_unstable_by(order);
}

/// How many tasks can run at the same time.
#[cfg(feature = "parallel")]
pub(crate) fn task_count() -> usize {
    rayon::current_num_threads()
}

/// How many tasks can run at the same time.
#[cfg(not(feature = "parallel"))]
pub(crate) fn task_count() -> usize {
    1
}

/// The values of a function for some items, each a task of its own, in order.
pub(crate) fn map<T: Sync, R: Send>(items: &[T], value: impl Fn(&T) -> R + Sync) -> Vec<R> {
    map_range(items.len(), |index| value(&items[index]))
}

/// The values of a function for `0..count`, each a task of its own, in order.
#[cfg(feature = "parallel")]
pub(crate) fn map_range<R: Send>(count: usize, value: impl Fn(usize) -> R + Sync + Send) -> Vec<R> {
    use rayon::prelude::*;
    (0..count).into_par_iter().map(value).collect()
}

/// The values of a function for `0..count`, in order.
#[cfg(not(feature = "parallel"))]
pub(crate) fn map_range<R>(count: usize, value: impl Fn(usize) -> R) -> Vec<R> {
    (0..count).map(value).collect()
}

/// Does something with each of some items, each a task of its own.
#[cfg(feature = "parallel")]
pub(crate) fn for_each<T: Send>(items: Vec<T>, action: impl Fn(T) + Sync + Send) {
    use rayon::prelude::*;
    items.into_par_iter().for_each(action);
}

/// Does something with each of some items, in order.
#[cfg(not(feature = "parallel"))]
pub(crate) fn for_each<T>(items: Vec<T>, action: impl Fn(T)) {
    items.into_iter().for_each(action);
}

/// Runs two tasks, at the same time if they are `large` enough to be worth it.
pub(crate) fn join_if<A: Send, B: Send>(
    large: bool,
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    if large {
        join(first, second)
    } else {
        (first(), second())
    }
}

/// Items that one task works on in [`reduce`], [`reduce_range`] and [`collect`]: some 50 microseconds of work.
const CHUNK: usize = 1 << 14;

/// Maps chunks of a slice and merges the results pairwise, in an order that depends on the length alone.
pub(crate) fn reduce<T: Sync, R: Send>(
    items: &[T],
    map: &(impl Fn(&[T]) -> R + Sync),
    merge: &(impl Fn(R, R) -> R + Sync),
) -> R {
    if items.len() <= CHUNK {
        return map(items);
    }
    let (front, back) = items.split_at(items.len() / 2);
    let (front, back) = join(|| reduce(front, map, merge), || reduce(back, map, merge));
    merge(front, back)
}

/// Maps chunks of a range and merges the results pairwise, in an order that depends on the range alone.
pub(crate) fn reduce_range<R: Send>(
    range: Range<usize>,
    map: &(impl Fn(Range<usize>) -> R + Sync),
    merge: &(impl Fn(R, R) -> R + Sync),
) -> R {
    if range.len() <= CHUNK {
        return map(range);
    }
    let middle = range.start + range.len() / 2;
    let (front, back) = join(
        || reduce_range(range.start..middle, map, merge),
        || reduce_range(middle..range.end, map, merge),
    );
    merge(front, back)
}

/// Sums a function over a range, at most `chunk` values in a task, in an order that depends on the range alone.
pub(crate) fn sum(
    range: Range<usize>,
    chunk: usize,
    value: &(impl Fn(usize) -> f64 + Sync),
) -> f64 {
    if range.len() <= chunk {
        return range.map(value).sum();
    }
    let middle = range.start + range.len() / 2;
    let (front, back) = join(
        || sum(range.start..middle, chunk, value),
        || sum(middle..range.end, chunk, value),
    );
    front + back
}
