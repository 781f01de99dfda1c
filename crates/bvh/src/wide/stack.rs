//! The stack of a traversal.
#![allow(unsafe_code, reason = "most of the stack is never written")]

use std::mem::MaybeUninit;

use tahko_geometry::HitCollector;
use tahko_geometry::simd::{LANES, Simd};

use super::Child;
use crate::build::MAX_DEPTH;

/// Entries of a stack: a power of two, so that keeping an index below it is one instruction.
const CAPACITY: usize = 512;

// A traversal takes one entry and adds at most eight at every node of a way down; some more may be written beyond those that are added.
const _: () = assert!(
    (LANES - 1) * MAX_DEPTH + 2 * LANES <= CAPACITY,
    "no tree needs more"
);

/// Room for the entries of a stack.
pub(super) type Room = [MaybeUninit<u64>; CAPACITY];

/// Children that wait, each with a number that its ray enters not before: the number's bits above those of the child, so that entries
/// with numbers from zero on are in order as integers.
pub(super) struct Stack<'a> {
    room: &'a mut Room,
    /// Invariant: this many entries are written. No tree that is built makes it larger than the room.
    len: usize,
}

/// A child that waits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Entry(u64);

impl Entry {
    #[inline(always)]
    pub(super) fn new(child: Child, start: f32) -> Self {
        Self(u64::from(start.to_bits()) << 32 | u64::from(child.bits()))
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the lower half")]
    pub(super) const fn child(self) -> Child {
        Child::from_bits(self.0 as u32)
    }

    #[inline(always)]
    pub(super) const fn start(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }
}

impl<'a> Stack<'a> {
    /// Room for a stack, not written yet.
    #[inline(always)]
    pub(super) const fn room() -> Room {
        [MaybeUninit::uninit(); CAPACITY]
    }

    #[inline(always)]
    pub(super) fn new(room: &'a mut Room) -> Self {
        Self { room, len: 0 }
    }

    #[inline(always)]
    pub(super) fn push(&mut self, entry: Entry) {
        self.room[self.len % CAPACITY].write(entry.0);
        self.len += 1;
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<Entry> {
        if self.len == 0 {
            return None;
        }
        self.len -= 1;
        // SAFETY: by the invariant, the entries before the length that it had are written.
        Some(Entry(unsafe {
            self.room[self.len % CAPACITY].assume_init()
        }))
    }

    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// The entry that [`pop`](Self::pop) would give.
    #[inline(always)]
    pub(super) fn top(&self) -> Option<Entry> {
        let last = self.len.checked_sub(1)?;
        // SAFETY: by the invariant, the entries before the length are written.
        Some(Entry(unsafe { self.room[last % CAPACITY].assume_init() }))
    }

    /// Pushes the children of a mask, the one with the smallest key last. There is room for eight, however many are pushed.
    #[inline(always)]
    pub(super) fn push_sorted<S: Simd>(
        &mut self,
        simd: S,
        keys: S::F32s,
        mask: S::Mask,
        children: &[u32; LANES],
    ) {
        let free = &mut self.room[self.len..];
        if let Some(target) = free.first_chunk_mut() {
            // All entries up to the new length are written there.
            self.len += simd.write_sorted(keys, mask, children, target);
        }
    }

    /// The next child that may hold something up to `t_max`.
    #[inline(always)]
    pub(super) fn pop_before<H: HitCollector>(&mut self, t_max: f32) -> Option<Child> {
        loop {
            let entry = self.pop()?;
            // Positive comparison: only what certainly begins beyond is skipped.
            if !(H::ORDERED && entry.start() > t_max) {
                return Some(entry.child());
            }
        }
    }

    /// Puts the `count` entries that were pushed last in order, the nearest one on top.
    #[inline(always)]
    pub(super) fn sort_last(&mut self, count: usize) {
        let first = self.len - count;
        for place in first + 1..self.len {
            // SAFETY: by the invariant, all entries before the length are written; so are those moved here.
            unsafe {
                let entry = self.room[place].assume_init();
                let mut hole = place;
                while hole > first && self.room[hole - 1].assume_init() < entry {
                    self.room[hole] = self.room[hole - 1];
                    hole -= 1;
                }
                self.room[hole].write(entry);
            }
        }
    }
}
