//! Who overlaps whom.

use super::{Entry, moved, places};
use crate::Scalar;
use crate::overlap;

/// Bit j of the i-th: did i and j overlap when one of them last changed?
#[derive(Clone, Debug)]
pub(super) struct Neighbours<const CAP: usize>([u64; CAP]);

impl<const CAP: usize> Neighbours<CAP> {
    pub fn new() -> Self {
        Self([0; CAP])
    }

    /// Whom the obstacle at `index` overlaps.
    pub fn of(&self, index: usize) -> u64 {
        self.0.get(index).copied().unwrap_or_default()
    }

    /// Everything connected with any of these, and these.
    pub fn connected(&self, seed: u64) -> u64 {
        let (mut all, mut front) = (seed, seed);
        while front != 0 {
            let next = places(front).fold(0, |next, i| next | self.of(i));
            front = next & !all;
            all |= next;
        }
        all
    }

    /// Compares the obstacle at `index` with all others.
    pub fn find<S: Scalar, const D: usize>(&mut self, index: usize, entries: &[Entry<S, D>]) {
        let Some(one) = entries.get(index) else { return };
        let overlapped = |(j, other): (usize, &Entry<S, D>)| if j != index && overlap(one, other) { 1 << j } else { 0 };
        let own = entries.iter().enumerate().map(overlapped).fold(0, |all, bit: u64| all | bit);
        for (j, row) in self.0.iter_mut().enumerate() {
            *row = if j == index { own } else { *row & !(1 << index) | (own >> j & 1) << index };
        }
    }

    /// The obstacle at `index` is gone, and the one at `last` in its place.
    pub fn remove(&mut self, index: usize, last: usize) {
        let row = self.0.get_mut(last).map(core::mem::take).unwrap_or_default();
        if index != last
            && let Some(to) = self.0.get_mut(index)
        {
            *to = row;
        }
        self.0.iter_mut().for_each(|row| *row = moved(*row, index, last));
    }
}

fn overlap<S: Scalar, const D: usize>(one: &Entry<S, D>, other: &Entry<S, D>) -> bool {
    // Rounding may tell which is the first.
    let (a, b) = if one.id < other.id { (one, other) } else { (other, one) };
    overlap::overlap(&a.obstacle, &b.obstacle)
}
