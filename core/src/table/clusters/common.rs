//! One point for all of a cluster.

use super::neighbours::Neighbours;
use super::{Entry, is_polygon, least_id};
use crate::overlap::{self, Depth, Inside};
use crate::{Scalar, Vector};

/// Largest cluster that is searched for one; larger ones are taken as trees.
const MOST: usize = 8;

/// A point inside all hard cores of a cluster, from which each polygon is seen whole, m.
pub(super) fn point<S: Scalar, const D: usize, const CAP: usize>(
    cluster: u64,
    neighbours: &Neighbours<CAP>,
    entries: &[Entry<S, D>],
) -> Option<Vector<S, D>> {
    let members = members(cluster, neighbours, entries)?;
    match members.as_slice() {
        [a, b] if !is_polygon(a.obstacle()) && !is_polygon(b.obstacle()) => {
            overlap::between(Inside::Core(a.obstacle()), Inside::Core(b.obstacle()), Depth::Deepest)
        }
        members => overlap::search(members, &amidst(members), Depth::Deepest),
    }
}

/// The members of a small cluster without a wall in which each overlaps each, where they may have their reference points.
fn members<'a, S: Scalar, const D: usize, const CAP: usize>(
    cluster: u64,
    neighbours: &Neighbours<CAP>,
    entries: &'a [Entry<S, D>],
) -> Option<heapless::Vec<Inside<'a, S, D>, MOST>> {
    let (mut members, mut left) = (heapless::Vec::new(), cluster);
    while let Some(i) = least_id(left, entries) {
        left &= !(1 << i);
        let member = &entries.get(i)?.obstacle;
        if member.spec().wall || neighbours.of(i) | 1 << i != cluster {
            return None;
        }
        members.push(Inside::Sight(member)).ok()?;
    }
    Some(members)
}

/// Where the search starts: amidst the centres, with the weights 1/outer^2, for a point of all lies in the smallest.
fn amidst<S: Scalar, const D: usize>(members: &[Inside<'_, S, D>]) -> Vector<S, D> {
    let smallest = members.iter().fold(S::MAX, |m, o| m.min(o.obstacle().outer()));
    let (mut weights, mut mean) = (S::zero(), Vector::zeros());
    for member in members {
        let ratio = smallest / member.obstacle().outer();
        let weight = ratio * ratio;
        weights += weight;
        // A running mean, so that no sum leaves the range.
        mean += (member.obstacle().spec().center - mean) * (weight / weights);
    }
    mean
}
