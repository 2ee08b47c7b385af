//! Obstacles whose hard cores overlap: the flow has to go round all of them together.
//!
//! Huber, Billard & Slotine (2019) and Huber, Slotine & Billard (2022): obstacles that have a point in common take it as their reference
//! point, and the flow goes round their union. Where there is none the cluster is taken as a tree (each overlaps the next, but not all of them):
//! each one's reference point lies towards its parent's, so that on it the flow leads away from the branch; the root keeps its own, and r of all others leads
//! from as near to that as they can be seen from. Where the tree is not seen from there that promises nothing, and the status says so.
//!
//! A polygon is to be seen whole from its reference point; it takes no other, and where that leaves none keeps its own.

use super::Entry;
use crate::overlap::{self, Inside};
use crate::{Obstacle, Scalar, Shape, Status, Vector};

/// Largest cluster that is searched for one common point; larger ones are taken as trees.
const COMMON: usize = 8;

/// Who overlaps whom, by places in the table.
#[derive(Clone, Debug)]
pub(super) struct Clusters<const CAP: usize> {
    /// Bit j of the i-th: do i and j overlap?
    neighbours: [u64; CAP],
    /// Members of clusters without a common reference point.
    unshared: u64,
}

impl<const CAP: usize> Clusters<CAP> {
    pub fn new() -> Self {
        const { assert!(CAP <= 64, "a table has at most 64 obstacles") };
        Self { neighbours: [0; CAP], unshared: 0 }
    }

    pub fn status(&self) -> Status {
        if self.unshared == 0 { Status::empty() } else { Status::CLUSTER }
    }

    /// The obstacle at `index` is new or has changed.
    pub fn changed<S: Scalar, const D: usize>(&mut self, index: usize, entries: &mut [Entry<S, D>]) {
        let before = self.connected(1 << index);
        let mut own = 0;
        if let Some(changed) = entries.get(index) {
            for (j, other) in entries.iter().enumerate() {
                if j != index && ordered(changed, other).is_some() {
                    own |= 1 << j;
                }
            }
        }
        for (j, row) in self.neighbours.iter_mut().enumerate() {
            *row = (*row & !(1 << index)) | (own >> j & 1) << index;
        }
        if let Some(row) = self.neighbours.get_mut(index) {
            *row = own;
        }
        let after = self.connected(1 << index);
        self.share(before | after, entries);
    }

    /// The obstacle at `index` was taken out, and the last one, if it was another, put in its place.
    pub fn removed<S: Scalar, const D: usize>(&mut self, index: usize, entries: &mut [Entry<S, D>]) {
        let last = entries.len();
        let before = self.connected(1 << index);
        let moved = self.neighbours.get_mut(last).map(core::mem::take).unwrap_or_default();
        if let Some(row) = self.neighbours.get_mut(index) {
            *row = moved;
        }
        let renamed = |bits: u64| {
            let rest = bits & !(1 << index) & !(1 << last);
            if index == last { rest } else { rest | (bits >> last & 1) << index }
        };
        for row in &mut self.neighbours {
            *row = renamed(*row);
        }
        self.unshared = renamed(self.unshared);
        self.share(renamed(before), entries);
    }

    /// Everything connected with any of these.
    fn connected(&self, seed: u64) -> u64 {
        let mut all = seed;
        loop {
            let next = bits(all).filter_map(|i| self.neighbours.get(i)).fold(all, |all, row| all | row);
            if next == all {
                return all;
            }
            all = next;
        }
    }

    /// Finds reference points for these, cluster by cluster.
    fn share<S: Scalar, const D: usize>(&mut self, mut affected: u64, entries: &mut [Entry<S, D>]) {
        while let Some(first) = bits(affected).next() {
            let cluster = self.connected(1 << first);
            affected &= !cluster;
            self.unshared &= !cluster;
            match cluster.count_ones() {
                1 => refer(entries, first, None),
                _ => self.share_one(cluster, entries),
            }
        }
    }

    fn share_one<S: Scalar, const D: usize>(&mut self, cluster: u64, entries: &mut [Entry<S, D>]) {
        if let Some(point) = self.common_point(cluster, entries) {
            bits(cluster).for_each(|i| refer(entries, i, Some(&point)));
            return;
        }
        self.unshared |= cluster;
        let Some(root) = self.root(cluster, entries) else { return };
        refer(entries, root, None);
        let hub = entries.get(root).filter(|e| !e.obstacle.spec().wall).map(|e| e.obstacle.reference());
        let (mut reached, mut front) = (1u64 << root, 1u64 << root);
        while front != 0 {
            let mut next = 0;
            loop {
                let next_parent = by_id(front, entries).next();
                let Some(parent) = next_parent else { break };
                front &= !(1 << parent);
                for child in bits(self.neighbours.get(parent).copied().unwrap_or_default() & !reached) {
                    let point = towards_parent(entries, parent, child);
                    refer(entries, child, point.as_ref());
                    if let Some(entry) = entries.get_mut(child) {
                        entry.obstacle.lean_towards(hub.as_ref());
                    }
                    (reached, next) = (reached | 1 << child, next | 1 << child);
                }
            }
            front = next;
        }
    }

    /// A point inside all hard cores of a small cluster without a wall, from which each polygon is seen whole.
    fn common_point<S: Scalar, const D: usize>(&self, cluster: u64, entries: &[Entry<S, D>]) -> Option<Vector<S, D>> {
        let mut members: heapless::Vec<Inside<'_, S, D>, COMMON> = heapless::Vec::new();
        if cluster.count_ones() as usize > COMMON {
            return None;
        }
        let mut polygons = false;
        for i in by_id(cluster, entries) {
            let member = &entries.get(i)?.obstacle;
            if member.spec().wall {
                return None;
            }
            polygons |= is_polygon(member);
            members.push(Inside::Sight(member)).ok()?;
        }
        if let [Inside::Sight(a), Inside::Sight(b)] = members.as_slice()
            && !polygons
        {
            return overlap::between(a, b);
        }
        let mut start = Vector::zeros();
        let mut share = S::zero();
        for i in by_id(cluster, entries) {
            for j in by_id(self.neighbours.get(i).copied()?, entries) {
                let point = overlap(entries, i, j)?;
                // A running mean, so that no sum leaves the range.
                share += S::one();
                start += (point - start) / share;
            }
        }
        overlap::common(&members, &start)
    }

    /// Where the tree begins: the wall, or else who overlaps most others, of equals a polygon, for it may not be seen from elsewhere.
    fn root<S: Scalar, const D: usize>(&self, cluster: u64, entries: &[Entry<S, D>]) -> Option<usize> {
        bits(cluster)
            .filter_map(|i| entries.get(i).map(|e| (i, e)))
            .max_by_key(|(i, e)| {
                (e.obstacle.spec().wall, self.degree(*i), is_polygon(&e.obstacle), core::cmp::Reverse(e.id))
            })
            .map(|(i, _)| i)
    }

    fn degree(&self, index: usize) -> u32 {
        self.neighbours.get(index).map_or(0, |row| row.count_ones())
    }
}

/// A point that two of the table's obstacles have in common; whatever their places, for which obstacle is where must not matter.
fn overlap<S: Scalar, const D: usize>(entries: &[Entry<S, D>], i: usize, j: usize) -> Option<Vector<S, D>> {
    ordered(entries.get(i)?, entries.get(j)?)
}

fn ordered<S: Scalar, const D: usize>(a: &Entry<S, D>, b: &Entry<S, D>) -> Option<Vector<S, D>> {
    let (a, b) = if a.id < b.id { (a, b) } else { (b, a) };
    overlap::between(&a.obstacle, &b.obstacle)
}

/// Where a child refers to: from the overlap with its parent on towards the parent's reference point, as far as the child's own core goes. Then in the
/// notch between the two the child leads the flow away from the branch, as its parent does. Nowhere if a polygon is not seen whole from there.
fn towards_parent<S: Scalar, const D: usize>(
    entries: &[Entry<S, D>],
    parent: usize,
    child: usize,
) -> Option<Vector<S, D>> {
    let mut point = overlap(entries, parent, child)?;
    let (parent, child) = (&entries.get(parent)?.obstacle, &entries.get(child)?.obstacle);
    if is_polygon(child) {
        point = overlap::common(&[Inside::Sight(child), Inside::Core(parent)], &point)?;
    }
    if parent.spec().wall {
        return Some(point);
    }
    let way = parent.reference() - point;
    let inside = S::from_f64(0.8);
    let (mut reached, mut step) = (S::zero(), S::one());
    for _ in 0..12 {
        let further = reached + step;
        if further <= S::one() && child.sight(&(point + way * further)) <= inside {
            reached = further;
        }
        step *= S::from_f64(0.5);
    }
    Some(point + way * reached)
}

fn is_polygon<S: Scalar, const D: usize>(o: &Obstacle<S, D>) -> bool {
    matches!(o.spec().shape, Shape::Polygon(_))
}

/// These places, by the identifiers of what is there.
fn by_id<S: Scalar, const D: usize>(mut set: u64, entries: &[Entry<S, D>]) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let next = bits(set).min_by_key(|i| entries.get(*i).map(|e| e.id))?;
        set &= !(1 << next);
        Some(next)
    })
}

fn refer<S: Scalar, const D: usize>(entries: &mut [Entry<S, D>], index: usize, point: Option<&Vector<S, D>>) {
    if let Some(entry) = entries.get_mut(index) {
        entry.obstacle.share_reference(point);
    }
}

/// The places of the bits that are set.
fn bits(mut set: u64) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let next = set.trailing_zeros();
        set &= set.wrapping_sub(1);
        (next < 64).then_some(next as usize)
    })
}
