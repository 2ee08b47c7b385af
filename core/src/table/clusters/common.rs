//! One point for all of a cluster.

use super::neighbours::Neighbours;
use super::{Entry, least_id};
use crate::overlap::{self, MOST};
use crate::{Obstacle, Scalar, Vector};

/// A point inside all hard cores of a cluster, from which each polygon is seen whole, m.
pub(super) fn point<S: Scalar, const D: usize, const CAP: usize>(
    cluster: u64,
    neighbours: &Neighbours<CAP>,
    entries: &[Entry<S, D>],
) -> Option<Vector<S, D>> {
    overlap::common(&members(cluster, neighbours, entries)?)
}

/// The members of a small cluster without a wall in which each overlaps each.
fn members<'a, S: Scalar, const D: usize, const CAP: usize>(
    cluster: u64,
    neighbours: &Neighbours<CAP>,
    entries: &'a [Entry<S, D>],
) -> Option<heapless::Vec<&'a Obstacle<S, D>, MOST>> {
    let (mut members, mut left) = (heapless::Vec::new(), cluster);
    while let Some(i) = least_id(left, entries) {
        left &= !(1 << i);
        let member = &entries.get(i)?.obstacle;
        if member.spec().wall || neighbours.of(i) | 1 << i != cluster {
            return None;
        }
        members.push(member).ok()?;
    }
    Some(members)
}
