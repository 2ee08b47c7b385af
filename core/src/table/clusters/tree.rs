//! A cluster that has no point in common: each one's reference point lies towards its parent's, so that on it the
//! flow leads away from the branch; the root keeps its own, and r of all others leads from as near to that as they
//! can be seen from. Where the tree is not seen from there that promises nothing, and the status says so.
//!
//! Walls are the roots of what sticks out of their free space, all of them, and nobody's children.

use super::neighbours::Neighbours;
use super::{Entry, is_polygon, least_id, places, share};
use crate::overlap::Sight;
use crate::{Scalar, Vector};

/// Finds the reference points of a cluster, from its roots outwards.
pub(super) fn refer<S: Scalar, const D: usize, const CAP: usize>(
    cluster: u64,
    neighbours: &Neighbours<CAP>,
    entries: &mut [Entry<S, D>],
) {
    let is_wall = |i: &usize| entries.get(*i).is_some_and(|e| e.obstacle.spec().wall);
    let walls = places(cluster).filter(is_wall).fold(0, |walls, i| walls | 1 << i);
    let hub = if walls == 0 { hub(cluster, neighbours, entries) } else { None };
    let roots = hub.map_or(walls, |root| 1 << root);
    places(roots).for_each(|root| share(entries, root, None));
    let hub = hub.and_then(|root| entries.get(root)).map(|e| e.obstacle.reference());

    let (mut reached, mut front) = (roots, roots);
    while front != 0 {
        let mut next = 0;
        // Only those that have children are put in order.
        let has_children = |i: &usize, reached: u64| neighbours.of(*i) & !reached != 0;
        let parents = |reached: u64| places(front).filter(|i| has_children(i, reached)).fold(0, |all, i| all | 1 << i);
        while let Some(parent) = least_id(parents(reached), entries) {
            let children = neighbours.of(parent) & !reached;
            (reached, next) = (reached | children, next | children);
            for child in places(children) {
                let point = towards_parent(entries, parent, child);
                share(entries, child, point.as_ref());
                if let Some(entry) = entries.get_mut(child) {
                    entry.obstacle.lean_towards(hub.as_ref());
                }
            }
        }
        front = next;
    }
}

/// The root of a tree without walls: who overlaps most others, of equals a polygon, for it may not be seen from elsewhere.
fn hub<S: Scalar, const D: usize, const CAP: usize>(
    cluster: u64,
    neighbours: &Neighbours<CAP>,
    entries: &[Entry<S, D>],
) -> Option<usize> {
    places(cluster)
        .filter_map(|i| entries.get(i).map(|e| (i, e)))
        .map(|(i, e)| ((neighbours.of(i).count_ones(), is_polygon(&e.obstacle), core::cmp::Reverse(e.id)), i))
        .max()
        .map(|(_, i)| i)
}

/// Where a child refers to: from the overlap with its parent on towards the parent's reference point, as far as the
/// child's own core goes. Then in the notch between the two the child leads the flow away from the branch, as its
/// parent does. Nowhere if a polygon is not seen whole from there.
fn towards_parent<S: Scalar, const D: usize>(
    entries: &[Entry<S, D>],
    parent: usize,
    child: usize,
) -> Option<Vector<S, D>> {
    let (parent, child) = (&entries.get(parent)?.obstacle, &entries.get(child)?.obstacle);
    let (sight, end) = (Sight::of(child), parent.reference());
    if parent.spec().wall {
        return sight.meets(parent);
    }
    if sight.reaches(&end) && parent.gamma(&end) < S::one() {
        // As far as it may go: from wherever they overlap, there.
        return Some(end);
    }
    sight.meets(parent).map(|point| sight.drawn(&point, &end))
}
