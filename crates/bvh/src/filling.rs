//! A list that several tasks fill, each its own part.
#![allow(
    unsafe_code,
    reason = "the list begins without values, and has them when all are counted"
)]

use std::mem::MaybeUninit;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::huge_pages;

/// A list of which the values are still to be written.
pub(crate) struct Filling<T> {
    list: Vec<T>,
    count: usize,
    /// Values that were written, as far as their parts are done.
    written: AtomicUsize,
}

/// A part of the list, filled from its end on: then a value may tell where those behind it are.
pub(crate) struct Part<'a, T> {
    /// The place of the part in the list.
    first: usize,
    free: &'a mut [MaybeUninit<T>],
    pushed: usize,
    written: &'a AtomicUsize,
}

impl<T: Copy> Filling<T> {
    /// A list of `count` values.
    pub(crate) fn new(count: usize) -> Self {
        Self::with_room(count, 0)
    }

    /// A list of `count` values with room for some more, to be added when it is finished.
    pub(crate) fn with_room(count: usize, more: usize) -> Self {
        Self {
            list: huge_pages::with_capacity(count + more),
            count,
            written: AtomicUsize::new(0),
        }
    }

    /// The whole list, nothing of it written.
    pub(crate) fn whole(&mut self) -> Part<'_, T> {
        // What was written before is written again, and counts then.
        *self.written.get_mut() = 0;
        Part {
            first: 0,
            free: &mut self.list.spare_capacity_mut()[..self.count],
            pushed: 0,
            written: &self.written,
        }
    }

    /// The list.
    ///
    /// # Panics
    /// If a value was not written.
    pub(crate) fn finish(mut self) -> Vec<T> {
        assert_eq!(
            self.written.into_inner(),
            self.count,
            "every value is written"
        );
        // SAFETY: the capacity is at least `count`. Each part counts what it has written when it is dropped; no two parts have a place in
        // common, and a part writes a place once. So `count` places of the first `count` hold values.
        unsafe { self.list.set_len(self.count) };
        self.list
    }
}

impl<'a, T> Part<'a, T> {
    /// The place in the list of the first value.
    pub(crate) const fn first(&self) -> usize {
        self.first
    }

    /// The place in the list behind the last value that is not yet written.
    pub(crate) const fn end(&self) -> usize {
        self.first + self.free.len()
    }

    /// Writes the last value that is not yet written, and returns it as it stands in the list.
    ///
    /// # Panics
    /// If all are written.
    #[inline]
    pub(crate) fn push_last(&mut self, value: T) -> &mut T {
        let free = std::mem::take(&mut self.free);
        let (last, free) = free.split_last_mut().expect("values were counted");
        self.free = free;
        self.pushed += 1;
        last.write(value)
    }

    /// Writes the last values that are not yet written, in their order.
    ///
    /// # Panics
    /// If there are fewer places than values.
    #[inline]
    pub(crate) fn fill_last(&mut self, values: impl ExactSizeIterator<Item = T>) {
        let free = std::mem::take(&mut self.free);
        let (free, last) = free.split_at_mut(free.len() - values.len());
        self.free = free;
        let mut written = 0;
        for (place, value) in last.iter_mut().zip(values) {
            place.write(value);
            written += 1;
        }
        self.pushed += written;
    }

    /// Cuts off the last values that are not yet written, as a part of their own.
    ///
    /// # Panics
    /// If there are fewer.
    pub(crate) fn split_last(&mut self, count: usize) -> Part<'a, T> {
        let free = std::mem::take(&mut self.free);
        let (front, back) = free.split_at_mut(free.len() - count);
        self.free = front;
        Part {
            first: self.end(),
            free: back,
            pushed: 0,
            written: self.written,
        }
    }
}

impl<T> Drop for Part<'_, T> {
    fn drop(&mut self) {
        self.written.fetch_add(self.pushed, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::for_each;

    #[test]
    fn parts_fill_a_list_from_their_ends_on() {
        let mut filling = Filling::new(100);
        let mut whole = filling.whole();
        whole.push_last(99);
        assert_eq!(whole.end(), 99);
        whole.fill_last(94..99);
        let mut parts = vec![
            whole.split_last(25),
            whole.split_last(0),
            whole.split_last(60),
        ];
        let firsts: Vec<usize> = parts.iter().map(Part::first).collect();
        assert_eq!(firsts, [69, 69, 9]);
        parts.push(whole);
        for_each(parts, |mut part| {
            for place in (part.first()..part.end()).rev() {
                part.push_last(place);
            }
        });
        assert!(filling.finish().into_iter().eq(0..100), "each in its place");
        assert!(
            Filling::<u32>::new(0).finish().is_empty(),
            "nothing to write"
        );
    }

    #[test]
    #[should_panic(expected = "every value is written")]
    fn a_list_with_a_gap_is_not_given_out() {
        let mut filling = Filling::new(4);
        let mut whole = filling.whole();
        drop(whole.split_last(1));
        for _ in 0..3 {
            whole.push_last(0);
        }
        drop(whole);
        filling.finish();
    }

    #[test]
    #[should_panic(expected = "every value is written")]
    fn what_was_written_before_does_not_count() {
        let mut filling = Filling::new(4);
        for _ in 0..2 {
            let mut whole = filling.whole();
            whole.push_last(0);
            whole.push_last(0);
        }
        filling.finish();
    }
}
