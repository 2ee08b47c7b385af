//! A cluster that has no point in common: each one's reference point lies towards its parent's, so that on it the
//! flow leads away from the branch; the root keeps its own, and r of all others leads from as near to that as they
//! can be seen from. Where the tree is not seen from there that promises nothing, and the status says so.
//!
//! Walls are the roots of what sticks out of their free space, all of them, and nobody's children.

use super::neighbours::Neighbours;
use super::{Entry, is_polygon, least_id, places, share};
use crate::overlap::{self, Depth, Inside};
use crate::{Scalar, Vector};

/// Halvings of the way from an overlap to the parent's reference point.
const HALVINGS: u8 = 11;
/// Gamma of the child up to which its reference point goes, and from which on no further is searched.
const DEEPEST: (f64, f64) = (0.8, 0.76);

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
        while reached != cluster
            && let Some(parent) = least_id(front, entries)
        {
            front &= !(1 << parent);
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
    let (parent, child) = (entries.get(parent)?, entries.get(child)?);
    let parent_first = parent.id < child.id;
    let (parent, child) = (&parent.obstacle, &child.obstacle);
    if !overlap::are_near(parent, child) {
        // They have moved apart since they were compared.
        return None;
    }
    let (deepest, enough) = (S::from_f64(DEEPEST.0), S::from_f64(DEEPEST.1));
    let end = parent.reference();
    if !parent.spec().wall && child.sight(&end).0 <= deepest && parent.gamma(&end) < S::one() {
        // As far as it may go: from wherever they overlap, there.
        return Some(end);
    }
    let (of_parent, of_child) = (Inside::Core(parent), Inside::Sight(child));
    let (a, b) = if parent_first { (of_parent, of_child) } else { (of_child, of_parent) };
    let point = overlap::between(a, b, Depth::Ample)?;
    if parent.spec().wall {
        return Some(point);
    }
    let way = end - point;
    let (mut share, mut step) = (S::zero(), S::from_f64(0.5));
    for _ in 0..HALVINGS {
        let further = share + step;
        let level = child.sight(&(point + way * further)).0;
        if level <= deepest {
            share = further;
            if level > enough {
                break;
            }
        }
        step *= S::from_f64(0.5);
    }
    Some(point + way * share)
}
