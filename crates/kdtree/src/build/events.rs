//! Events: where the boxes of references begin and end along an axis, sorted once and kept sorted.
//!
//! Source: Wald and Havran, "On building fast kd-trees for ray tracing, and on doing that in O(N log N)", 2006, section
//! 4.3. Differs in one list per axis, and in an event being a number whose order is the order of the list.

use super::cell::Reference;
use super::join;

/// An event: the position in the upper 32 bits, mapped to an integer of the same order, then two bits for the
/// kind, then the number of the reference in its cell. The natural order is by position, then kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Event(u64);

/// What happens at an event, in the order in which a sweep meets the kinds at one position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EventKind {
    End = 0,
    /// The box is flat and begins and ends here.
    Planar = 1,
    Start = 2,
}

const NUMBER_BITS: u32 = 30;
const NUMBER_MASK: u32 = (1 << NUMBER_BITS) - 1;

impl Event {
    /// Behind all other events.
    const LAST: Self = Self(u64::MAX);

    fn new(position: f32, kind: EventKind, number: u32) -> Self {
        // -0.0 and 0.0 are one position.
        let bits = (position + 0.0).to_bits();
        let ordered = if bits >> 31 == 0 {
            bits | 1 << 31
        } else {
            !bits
        };
        Self(u64::from(ordered) << 32 | (kind as u64) << NUMBER_BITS | u64::from(number))
    }

    /// The upper half, which events at the same position share.
    #[inline]
    pub(super) const fn position_key(self) -> u32 {
        (self.0 >> 32) as u32
    }

    pub(super) const fn position(self) -> f32 {
        let ordered = self.position_key();
        f32::from_bits(if ordered >> 31 == 1 {
            ordered ^ 1 << 31
        } else {
            !ordered
        })
    }

    #[inline]
    pub(super) const fn kind(self) -> EventKind {
        match self.0 >> NUMBER_BITS & 3 {
            0 => EventKind::End,
            1 => EventKind::Planar,
            _ => EventKind::Start,
        }
    }

    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "masked to the lower bits")]
    const fn number(self) -> u32 {
        self.0 as u32 & NUMBER_MASK
    }

    #[inline]
    const fn renumbered(self, number: u32) -> Self {
        Self(self.0 & !(NUMBER_MASK as u64) | number as u64)
    }
}

/// Where the events of a reference go when its cell is divided: to one half, under a new number; or nowhere,
/// because the reference is cut in two parts with events of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Target(u32);

impl Target {
    pub(super) const CUT: Self = Self(2 << NUMBER_BITS);

    pub(super) fn left(number: usize) -> Self {
        Self(to_number(number))
    }

    pub(super) fn right(number: usize) -> Self {
        Self(1 << NUMBER_BITS | to_number(number))
    }
}

fn to_number(index: usize) -> u32 {
    debug_assert!(
        index <= NUMBER_MASK as usize,
        "budgets keep lists below 2^30"
    );
    #[expect(clippy::cast_possible_truncation, reason = "below 2^30")]
    let number = index as u32;
    number
}

/// The events of a cell's references along x, y and z, each list sorted.
#[derive(Clone, Debug, Default)]
pub(super) struct EventLists([Vec<Event>; 3]);

impl EventLists {
    /// Makes and sorts the events of all references, in `O(n log n)`.
    pub(super) fn new(references: &[Reference]) -> Self {
        let list = |axis: usize| {
            let mut events = Vec::with_capacity(2 * references.len());
            for (number, reference) in references.iter().enumerate() {
                push_events(&mut events, axis, number, reference);
            }
            events.sort_unstable();
            events
        };
        let (x, (y, z)) = join(|| list(0), || join(|| list(1), || list(2)));
        Self([x, y, z])
    }

    pub(super) const fn axis(&self, axis: tahko_geometry::Axis) -> &[Event] {
        self.0[axis as usize].as_slice()
    }

    /// Hands the events to the halves of a cell, keeping the order: `O(n + k log k)` for `k` cut references.
    ///
    /// Numbers grow in the halves as they did in the cell, so renumbered events are still sorted; the events of
    /// the parts of cut references are made, sorted and merged with them.
    pub(super) fn distribute(&self, division: &Division, halves: &mut [Self; 2]) {
        let [left, right] = halves;
        let [left_x, left_y, left_z] = &mut left.0;
        let [right_x, right_y, right_z] = &mut right.0;
        let mut x = || division.merge(&self.0[0], 0, [left_x, right_x]);
        let mut y = || division.merge(&self.0[1], 1, [left_y, right_y]);
        let mut z = || division.merge(&self.0[2], 2, [left_z, right_z]);
        if self.0[0].len() < PARALLEL_EVENTS {
            x();
            y();
            z();
        } else {
            join(x, || join(y, z));
        }
    }
}

/// Lists with fewer events are not worth a task for each axis.
pub(super) const PARALLEL_EVENTS: usize = 1 << 14;

/// Where the references of a cell went when it was divided.
#[derive(Debug, Default)]
pub(super) struct Division {
    /// For each reference of the cell.
    pub targets: Vec<Target>,
    /// The new lists.
    pub references: [Vec<Reference>; 2],
    /// The numbers of the parts of cut references in them.
    pub cut_parts: [Vec<usize>; 2],
}

impl Division {
    /// The events of the two halves along one axis, from those of the cell.
    fn merge(&self, events: &[Event], axis: usize, halves: [&mut Vec<Event>; 2]) {
        let [left, right] = halves;
        let fresh = [0, 1].map(|side| self.events_of_cut_parts(side, axis));
        let [mut fresh_left, mut fresh_right] = fresh.each_ref().map(|list| Merger::new(list));
        left.clear();
        right.clear();
        for event in events {
            let target = self.targets[event.number() as usize].0;
            let moved = event.renumbered(target & NUMBER_MASK);
            match target >> NUMBER_BITS {
                0 => {
                    fresh_left.emit_before(moved, left);
                    left.push(moved);
                }
                1 => {
                    fresh_right.emit_before(moved, right);
                    right.push(moved);
                }
                _ => {}
            }
        }
        fresh_left.emit_before(Event::LAST, left);
        fresh_right.emit_before(Event::LAST, right);
    }

    fn events_of_cut_parts(&self, side: usize, axis: usize) -> Vec<Event> {
        let mut events = Vec::with_capacity(2 * self.cut_parts[side].len());
        for number in &self.cut_parts[side] {
            push_events(&mut events, axis, *number, &self.references[side][*number]);
        }
        events.sort_unstable();
        events
    }
}

/// A sorted list on its way into another one.
struct Merger<'a> {
    rest: std::slice::Iter<'a, Event>,
    next: Event,
}

impl<'a> Merger<'a> {
    fn new(events: &'a [Event]) -> Self {
        let mut rest = events.iter();
        let next = rest.next().copied().unwrap_or(Event::LAST);
        Self { rest, next }
    }

    /// Moves the events that come before `limit`.
    #[inline]
    fn emit_before(&mut self, limit: Event, into: &mut Vec<Event>) {
        while self.next < limit {
            into.push(self.next);
            self.next = self.rest.next().copied().unwrap_or(Event::LAST);
        }
    }
}

fn push_events(events: &mut Vec<Event>, axis: usize, number: usize, reference: &Reference) {
    let number = to_number(number);
    let (min, max) = (reference.bounds.min[axis], reference.bounds.max[axis]);
    if min == max {
        events.push(Event::new(min, EventKind::Planar, number));
    } else {
        events.push(Event::new(min, EventKind::Start, number));
        events.push(Event::new(max, EventKind::End, number));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_are_ordered_by_position_then_kind() {
        let ordered = [
            Event::new(f32::MIN, EventKind::Start, 9),
            Event::new(-1e-45, EventKind::Start, 8),
            Event::new(-0.0, EventKind::End, 7),
            Event::new(0.0, EventKind::Planar, 6),
            Event::new(-0.0, EventKind::Start, 5),
            Event::new(1e-45, EventKind::End, 4),
            Event::new(f32::MAX, EventKind::End, 3),
            Event::LAST,
        ];
        assert!(ordered.is_sorted(), "{ordered:?}");
    }

    #[test]
    fn events_unpack_to_what_was_packed() {
        for position in [f32::MIN, -1.5, 0.0, 1e-45, 2.0, f32::MAX] {
            for kind in [EventKind::End, EventKind::Planar, EventKind::Start] {
                let event = Event::new(position, kind, NUMBER_MASK).renumbered(12345);
                assert_eq!(
                    (event.position(), event.kind(), event.number()),
                    (position, kind, 12345)
                );
            }
        }
    }
}
