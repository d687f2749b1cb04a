//! Slots of the neighbors in lists, register by register.
//!
//! A register of neighbors is its slots, two bytes each, or a short one of eight: the lowest of them in two bytes, and how far the
//! others are from it in one byte each. One whose neighbors are farther apart becomes two or more, each with some of them
//! in their lanes and a slot that adds nothing in the others: sums are the same bits.

use std::ops::Range;
use std::slice::ChunksExact;

use super::window::{Runs, WITHIN};
use crate::simd::lanes::{Index, Lanes, MOST_LANES};

/// Bytes of a slot.
const SLOT: usize = size_of::<u16>();
/// Longest run of which every slot is this near to one that adds nothing, before or after it.
pub(super) const LONGEST_RUN: usize = 2 * (WITHIN - 1);

/// Registers of slots, one after the other.
#[derive(Clone, Debug, Default)]
pub(super) struct Slots {
    bytes: Vec<u8>,
}

impl Slots {
    pub(super) fn clear(&mut self) {
        self.bytes.clear();
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    pub(super) fn bytes_mut(&mut self) -> &mut Vec<u8> {
        &mut self.bytes
    }

    /// One past the last register, as spans store it.
    pub(super) fn end(&self) -> u32 {
        self.bytes.len() as u32
    }

    /// Removes what comes after an end.
    pub(super) fn truncate(&mut self, end: u32) {
        self.bytes.truncate(end as usize);
    }

    /// Memory held; bytes.
    pub(super) fn memory(&self) -> usize {
        self.bytes.capacity()
    }

    /// Adds registers, the last one filled up with a slot that adds nothing.
    #[inline(always)]
    pub(super) fn add<L: Lanes>(&mut self, slots: &[u32], padding: u32) {
        let before = self.bytes.len();
        let padded = slots.len().next_multiple_of(L::WIDTH);
        self.bytes.resize(before + SLOT * padded, 0);
        let (places, _) = self.bytes[before..].as_chunks_mut();
        let (of_slots, of_padding) = places.split_at_mut(slots.len());
        for (place, &slot) in of_slots.iter_mut().zip(slots) {
            *place = (slot as u16).to_le_bytes();
        }
        of_padding.fill((padding as u16).to_le_bytes());
    }

    /// Adds short registers of slots in a window of runs. Slots that are in order save a look for the ends of each register.
    #[inline(always)]
    pub(super) fn add_short(&mut self, slots: &[u32], window: &Runs, in_order: bool) {
        // arrays, for which the machine has registers, too
        let (registers, rest) = slots.as_chunks::<MOST_LANES>();
        for register in registers {
            let (lowest, highest) = match in_order {
                true => (register[0], register[MOST_LANES - 1]),
                false => ends(register),
            };
            if ((highest - lowest) as usize) < WITHIN {
                self.add_register(lowest, register);
            } else {
                self.add_parts(register, window);
            }
        }
        if !rest.is_empty() {
            self.add_parts(rest, window);
        }
    }

    /// Adds the slots of a register in as many as they need.
    #[inline(never)]
    fn add_parts(&mut self, slots: &[u32], window: &Runs) {
        let mut first = 0;
        while first < slots.len() {
            let mut end = slots.len();
            let (lowest, nothing) = loop {
                let (lowest, highest) = ends(&slots[first..end]);
                let near = [slots[first], slots[end - 1]].map(|slot| window.nothing_beside(slot));
                let nothing = near.into_iter().flatten().find(|&nothing| {
                    ((highest.max(nothing) - lowest.min(nothing)) as usize) < WITHIN
                });
                match nothing {
                    Some(nothing) => break (lowest.min(nothing), nothing),
                    // one alone is near enough to what is beside its run
                    None => end -= 1,
                }
            };
            let mut register = [nothing; MOST_LANES];
            register[first..end].copy_from_slice(&slots[first..end]);
            self.add_register(lowest, &register);
            first = end;
        }
    }

    #[inline(always)]
    fn add_register(&mut self, lowest: u32, slots: &[u32; MOST_LANES]) {
        let mut bytes = [0; SLOT + MOST_LANES];
        bytes[..SLOT].copy_from_slice(&(lowest as u16).to_le_bytes());
        for (way, slot) in bytes[SLOT..].iter_mut().zip(slots) {
            *way = (slot - lowest) as u8;
        }
        self.bytes.extend_from_slice(&bytes);
    }

    /// Those of a span, which begin where the one before ends.
    #[inline(always)]
    pub(super) fn of_span<const SHORT: bool>(&self, range: Range<usize>) -> Registers<'_, SHORT> {
        Registers(&self.bytes[range])
    }
}

/// Lowest and highest of some slots.
#[inline(always)]
fn ends(slots: &[u32]) -> (u32, u32) {
    let (mut lowest, mut highest) = (slots[0], slots[0]);
    for &slot in slots {
        lowest = lowest.min(slot);
        highest = highest.max(slot);
    }
    (lowest, highest)
}

/// Registers of a span.
#[derive(Clone, Copy)]
pub(super) struct Registers<'a, const SHORT: bool>(&'a [u8]);

impl<'a, const SHORT: bool> Registers<'a, SHORT> {
    /// Bytes of one.
    #[inline(always)]
    const fn size<L: Lanes>() -> usize {
        if SHORT {
            SLOT + MOST_LANES
        } else {
            SLOT * L::WIDTH
        }
    }

    /// Bytes of one after the other.
    #[inline(always)]
    pub(super) fn iter<L: Lanes>(self) -> ChunksExact<'a, u8> {
        self.0.chunks_exact(Self::size::<L>())
    }

    /// Slots of all lanes.
    pub(super) fn slots<L: Lanes>(self) -> impl Iterator<Item = usize> {
        self.iter::<L>().flat_map(|bytes| {
            let register = Register::<SHORT>(bytes);
            (0..L::WIDTH).map(move |lane| register.at(lane))
        })
    }
}

/// A register.
#[derive(Clone, Copy)]
pub(super) struct Register<'a, const SHORT: bool>(pub &'a [u8]);

impl<'a, const SHORT: bool> Register<'a, SHORT> {
    /// Its lowest slot, and how far its slots are from it; of a short one.
    #[inline(always)]
    pub(super) fn ways(self) -> (usize, &'a [u8]) {
        let (lowest, ways) = self.0.split_at(SLOT);
        ([lowest[0], lowest[1]].index(), ways)
    }

    /// Its slots; of one that is not short.
    #[inline(always)]
    pub(super) fn slots(self) -> &'a [[u8; SLOT]] {
        self.0.as_chunks().0
    }

    /// Slot of a lane.
    #[inline(always)]
    pub(super) fn at(self, lane: usize) -> usize {
        if SHORT {
            let (lowest, ways) = self.ways();
            lowest + ways[lane].index()
        } else {
            self.slots()[lane].index()
        }
    }
}
