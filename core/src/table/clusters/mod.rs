//! Obstacles whose hard cores overlap: the flow has to go round all of them together.
//!
//! Huber, Billard & Slotine (2019) and Huber, Slotine & Billard (2022): obstacles that have a point in common take it
//! as their reference point, and the flow goes round their union. Where there is none the cluster is taken as a tree
//! (each overlaps the next, but not all of them).
//!
//! A polygon is to be seen whole from its reference point; it takes no other, and where that leaves none keeps its
//! own. So does a wall, always: it is seen from inside its free space, where no point of another's core that it
//! overlaps lies.
//!
//! Sets are of places in the table, one a bit. Whatever depends on an order goes by identifiers, for it must not matter who came first.

mod common;
mod neighbours;
mod tree;

use super::Entry;
use crate::{Obstacle, Scalar, Shape, Status, Vector};
use neighbours::Neighbours;

/// Who overlaps whom, and who of them has no reference point in common.
#[derive(Clone, Debug)]
pub(super) struct Clusters<const CAP: usize> {
    neighbours: Neighbours<CAP>,
    /// Members of clusters that are trees.
    unshared: u64,
}

impl<const CAP: usize> Clusters<CAP> {
    pub fn new() -> Self {
        const { assert!(CAP <= 64, "a table has at most 64 obstacles") };
        Self { neighbours: Neighbours::new(), unshared: 0 }
    }

    pub fn status(&self) -> Status {
        if self.unshared == 0 { Status::empty() } else { Status::CLUSTER }
    }

    /// The obstacle at `index` is new or has changed.
    pub fn changed<S: Scalar, const D: usize>(&mut self, index: usize, entries: &mut [Entry<S, D>]) {
        let before = self.neighbours.connected(1 << index);
        self.neighbours.find(index, entries);
        self.refer(before | self.neighbours.connected(1 << index), entries);
    }

    /// The obstacle at `index` was taken out, and the one at `last`, if it was another, put in its place.
    pub fn removed<S: Scalar, const D: usize>(&mut self, index: usize, last: usize, entries: &mut [Entry<S, D>]) {
        let before = self.neighbours.connected(1 << index);
        self.neighbours.remove(index, last);
        self.unshared = moved(self.unshared, index, last);
        self.refer(moved(before, index, last), entries);
    }

    /// Finds the reference points of all clusters that these belong to.
    fn refer<S: Scalar, const D: usize>(&mut self, mut affected: u64, entries: &mut [Entry<S, D>]) {
        while let Some(first) = places(affected).next() {
            let cluster = self.neighbours.connected(1 << first);
            affected &= !cluster;
            self.unshared &= !cluster;
            if cluster.count_ones() == 1 {
                share(entries, first, None);
            } else if let Some(point) = common::point(cluster, &self.neighbours, entries) {
                places(cluster).for_each(|i| share(entries, i, Some(&point)));
            } else {
                self.unshared |= cluster;
                tree::refer(cluster, &self.neighbours, entries);
            }
        }
    }
}

/// The reference point of the obstacle at `index`, or its own again.
fn share<S: Scalar, const D: usize>(entries: &mut [Entry<S, D>], index: usize, point: Option<&Vector<S, D>>) {
    if let Some(entry) = entries.get_mut(index) {
        entry.obstacle.share_reference(point);
    }
}

fn is_polygon<S: Scalar, const D: usize>(o: &Obstacle<S, D>) -> bool {
    matches!(o.spec().shape, Shape::Polygon(_))
}

/// Of these places, the one whose obstacle has the least identifier.
fn least_id<S: Scalar, const D: usize>(set: u64, entries: &[Entry<S, D>]) -> Option<usize> {
    places(set).min_by_key(|i| entries.get(*i).map(|e| e.id))
}

/// The places of a set.
fn places(mut set: u64) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let next = set.trailing_zeros();
        set &= set.wrapping_sub(1);
        (next < 64).then_some(next as usize)
    })
}

/// A set without `index`, which has what was at `last`.
fn moved(set: u64, index: usize, last: usize) -> u64 {
    let rest = set & !(1 << index) & !(1 << last);
    if index == last { rest } else { rest | (set >> last & 1) << index }
}
