//! The stack of a traversal.
#![allow(unsafe_code, reason = "most of the stack is never written")]

use std::mem::MaybeUninit;

use tahko_geometry::HitCollector;
use tahko_geometry::simd::LANES;

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

/// Room for several stacks.
pub(super) struct Rooms(Box<[MaybeUninit<u64>]>);

impl Rooms {
    /// A room and some entries, so that not all rooms begin in the same set of a cache.
    const STRIDE: usize = CAPACITY + 40;

    /// Room for `count` stacks, not written yet.
    pub(super) fn new(count: usize) -> Self {
        Self(Box::new_uninit_slice(count * Self::STRIDE))
    }

    /// The rooms.
    #[inline(always)]
    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Room> {
        let rooms = self.0.chunks_exact_mut(Self::STRIDE);
        rooms.filter_map(|room| room.first_chunk_mut())
    }
}

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

    /// Pushes an entry or not, without a branch.
    #[inline(always)]
    pub(super) fn push_if(&mut self, condition: bool, entry: Entry) {
        self.room[self.len % CAPACITY].write(entry.0);
        self.len += usize::from(condition);
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

    /// Pushes the children of a mask in no order.
    #[inline(always)]
    pub(super) fn push_all(&mut self, mut mask: u32, children: &[Child; LANES]) {
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize % LANES;
            self.push(Entry::new(children[lane], 0.0));
            mask &= mask - 1;
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries that begin at some numbers, numbered in turn.
    fn entries(starts: &[f32]) -> Vec<Entry> {
        let children = (1..).map(Child::leaf);
        let entries = starts.iter().zip(children);
        entries
            .map(|(start, child)| Entry::new(child, *start))
            .collect()
    }

    fn popped(stack: &mut Stack<'_>) -> Vec<Entry> {
        std::iter::from_fn(|| stack.pop()).collect()
    }

    #[test]
    fn an_entry_keeps_its_child_and_its_start() {
        for child in [
            Child::NOTHING,
            Child::leaf(7),
            Child::inner(0),
            Child::inner(9),
        ] {
            for start in [0.0, 1.5, f32::MAX, f32::INFINITY, -2.0] {
                let entry = Entry::new(child, start);
                assert_eq!((entry.child(), entry.start()), (child, start));
            }
        }
    }

    #[test]
    fn entries_are_in_the_order_of_their_starts() {
        let starts = [
            0.0,
            1e-45,
            1e-38,
            0.5,
            1.0,
            1.0f32.next_up(),
            3e38,
            f32::INFINITY,
        ];
        let entries = entries(&starts);
        assert!(entries.is_sorted(), "{entries:?}");
        let [late, early] = [Child::leaf(1), Child::inner(2)];
        assert!(
            Entry::new(early, 1.0) < Entry::new(late, 2.0),
            "whatever the child"
        );
    }

    #[test]
    fn what_is_pushed_last_is_popped_first_and_the_room_is_used_again() {
        let mut room = Stack::room();
        let mut stack = Stack::new(&mut room);
        assert!(stack.pop().is_none(), "empty");
        let [a, b, c] = [0.0, 1.0, 2.0].map(|start| Entry::new(Child::inner(4), start));
        stack.push(a);
        stack.push(b);
        assert_eq!(stack.pop(), Some(b));
        stack.push(c);
        stack.push(b);
        assert_eq!(popped(&mut stack), [b, c, a]);
        assert!(stack.pop().is_none(), "empty again");
    }

    #[test]
    fn what_is_pushed_under_a_condition_is_there_if_it_holds() {
        let mut room = Stack::room();
        let mut stack = Stack::new(&mut room);
        let [a, b, c] =
            [0.0, 1.0, f32::NEG_INFINITY].map(|start| Entry::new(Child::leaf(3), start));
        stack.push_if(true, a);
        stack.push_if(false, b);
        stack.push_if(true, c);
        assert_eq!(popped(&mut stack), [c, a]);
    }

    #[test]
    fn stacks_have_rooms_of_their_own() {
        for count in [0, 1, 3] {
            let mut rooms = Rooms::new(count);
            let mut stacks: Vec<Stack<'_>> = rooms.iter_mut().map(Stack::new).collect();
            assert_eq!(stacks.len(), count);
            for (start, stack) in (0u8..).zip(&mut stacks) {
                for index in 0..CAPACITY {
                    stack.push(Entry::new(Child::inner(index), f32::from(start)));
                }
            }
            for (start, stack) in (0u8..).zip(&mut stacks) {
                let starts: Vec<f32> = popped(stack).into_iter().map(Entry::start).collect();
                assert_eq!(starts, [f32::from(start); CAPACITY]);
            }
        }
    }

    #[test]
    fn the_deepest_tree_has_room() {
        let mut room = Stack::room();
        let mut stack = Stack::new(&mut room);
        let all: Vec<Entry> = (0..=(LANES - 1) * MAX_DEPTH + LANES)
            .map(|index| Entry::new(Child::inner(index), 1.0))
            .collect();
        for entry in &all {
            stack.push(*entry);
        }
        let mut popped = popped(&mut stack);
        popped.reverse();
        assert_eq!(popped, all);
    }

    /// All orders of up to five entries, above others that stay where they are.
    #[test]
    fn the_last_entries_are_sorted_and_no_others() {
        let below = entries(&[0.5, 7.0, 0.25]);
        for count in 0..=5u32 {
            for order in 0..5u32.pow(count) {
                let starts: Vec<f32> = (0..count)
                    .map(|place| (order / 5u32.pow(place) % 5) as f32)
                    .collect();
                let last = entries(&starts);
                let mut room = Stack::room();
                let mut stack = Stack::new(&mut room);
                for entry in below.iter().chain(&last) {
                    stack.push(*entry);
                }
                stack.sort_last(last.len());
                let mut expected = last;
                expected.sort_unstable();
                expected.extend(below.iter().rev());
                assert_eq!(popped(&mut stack), expected, "{starts:?}");
            }
        }
    }
}
