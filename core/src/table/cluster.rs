//! Obstacles whose hard cores overlap: the flow has to go round all of them together.
//!
//! Huber, Billard & Slotine (2019) and Huber, Slotine & Billard (2022): obstacles that have a point in common take it as their reference
//! point, and the flow goes round their union. Where there is none the cluster is taken as a tree (each overlaps the next, but not all of them):
//! each one's reference point lies towards its parent's, so that on it the flow leads away from the branch; the root keeps its own, and r of all others leads
//! from as near to that as they can be seen from. Where the tree is not seen from there that promises nothing, and the status says so.
//!
//! A polygon is to be seen whole from its reference point; it takes no other, and where that leaves none keeps its own.

use super::Entry;
use crate::overlap::{self, Depth, Inside, Search};
use crate::{Obstacle, Scalar, Shape, Status, Vector};

/// Largest cluster that is searched for one common point; larger ones are taken as trees.
const COMMON: usize = 8;
/// Gammas that a piece of such a search takes, at most one a member more.
const GAMMAS: usize = 32;

/// Who overlaps whom, by places in the table, and what is still to be found out.
///
/// A change only notes what is to be done. That is done piece by piece, in rounds: first who overlaps those that have changed, then the reference points
/// of all clusters that they were in or are in.
#[derive(Clone, Debug)]
pub(super) struct Clusters<S: Scalar, const D: usize, const CAP: usize> {
    /// Bit j of the i-th: do i and j overlap?
    neighbours: [u64; CAP],
    /// Members of clusters without a common reference point.
    unshared: u64,
    /// For the next round: who has changed, and whose reference points may be others.
    changed: u64,
    affected: u64,
    /// The same in this round.
    searched: u64,
    referred: u64,
    /// Whom the first of the searched has not been compared with yet, where that has begun.
    others: Option<u64>,
    task: Task<S, D>,
}

/// Reference points that are being found.
#[derive(Clone, Debug)]
enum Task<S: Scalar, const D: usize> {
    None,
    /// One for all of this cluster.
    Common {
        cluster: u64,
        search: Search<S, D>,
    },
    /// One for each below a root.
    Tree(Tree<S, D>),
}

/// What is to be done about a cluster.
enum Next<S: Scalar, const D: usize> {
    Search(Search<S, D>),
    Shared(Vector<S, D>),
    Tree,
}

/// A cluster that is gone through as a tree.
#[derive(Clone, Debug)]
struct Tree<S: Scalar, const D: usize> {
    cluster: u64,
    /// The root's reference point, unless it is a wall.
    hub: Option<Vector<S, D>>,
    reached: u64,
    /// Whose children come next, and those children: of this parent the ones that are left.
    front: u64,
    next: u64,
    parent: usize,
    children: u64,
}

impl<S: Scalar, const D: usize, const CAP: usize> Clusters<S, D, CAP> {
    pub fn new() -> Self {
        const { assert!(CAP <= 64, "a table has at most 64 obstacles") };
        let (neighbours, others, task) = ([0; CAP], None, Task::None);
        Self { neighbours, unshared: 0, changed: 0, affected: 0, searched: 0, referred: 0, others, task }
    }

    pub fn status(&self) -> Status {
        if self.unshared == 0 { Status::empty() } else { Status::CLUSTER }
    }

    /// The obstacle at `index` is new or has changed.
    pub fn changed(&mut self, index: usize) {
        let bit = 1 << index;
        self.affected |= self.connected(bit);
        for row in &mut self.neighbours {
            *row &= !bit;
        }
        if let Some(row) = self.neighbours.get_mut(index) {
            *row = 0;
        }
        if self.searched & bit == 0 {
            self.changed |= bit;
        } else if bits(self.searched).next() == Some(index) {
            self.others = None;
        }
    }

    /// The obstacle at `index` was taken out, and the one at `last`, if it was another, put in its place.
    pub fn removed(&mut self, index: usize, last: usize) {
        self.affected |= self.connected(1 << index);
        // What had begun begins again.
        self.others = None;
        self.referred |= match core::mem::replace(&mut self.task, Task::None) {
            Task::None => 0,
            Task::Common { cluster, .. } | Task::Tree(Tree { cluster, .. }) => cluster,
        };
        let moved = self.neighbours.get_mut(last).map(core::mem::take).unwrap_or_default();
        if let Some(row) = self.neighbours.get_mut(index) {
            *row = if index == last { 0 } else { moved };
        }
        let renamed = |bits: &mut u64| {
            let rest = *bits & !(1 << index) & !(1 << last);
            *bits = if index == last { rest } else { rest | (*bits >> last & 1) << index };
        };
        self.neighbours.iter_mut().for_each(renamed);
        [&mut self.unshared, &mut self.changed, &mut self.affected, &mut self.searched, &mut self.referred]
            .into_iter()
            .for_each(renamed);
    }

    /// Does one piece of what is to be done: one pair of cores, a part of a search for a point in common, or the reference point of one obstacle. False when
    /// nothing is left.
    pub fn settle(&mut self, entries: &mut [Entry<S, D>]) -> bool {
        match core::mem::replace(&mut self.task, Task::None) {
            Task::Common { cluster, search } => self.search(cluster, search, entries),
            Task::Tree(tree) => self.grow(tree, entries),
            Task::None => {
                if let Some(index) = bits(self.searched).next() {
                    self.compare(index, entries);
                } else if let Some(first) = bits(self.referred).next() {
                    self.begin(first, entries);
                } else {
                    self.searched = core::mem::take(&mut self.changed);
                    self.referred = core::mem::take(&mut self.affected);
                    return self.searched | self.referred != 0;
                }
            }
        }
        true
    }

    /// Everything connected with any of these.
    fn connected(&self, seed: u64) -> u64 {
        let (mut all, mut front) = (seed, seed);
        while front != 0 {
            let next = bits(front).filter_map(|i| self.neighbours.get(i)).fold(0, |all, row| all | row);
            front = next & !all;
            all |= next;
        }
        all
    }

    /// Compares the obstacle at `index` with others, up to the first that is near.
    fn compare(&mut self, index: usize, entries: &[Entry<S, D>]) {
        // Those that come after it are compared with it then.
        let later = self.searched | self.changed;
        let mut others = self.others.unwrap_or(u64::MAX) & !later;
        if let Some(one) = entries.get(index) {
            for (j, other) in entries.iter().enumerate() {
                if others >> j & 1 == 0 {
                    continue;
                }
                others &= !(1 << j);
                if overlap::are_near(&one.obstacle, &other.obstacle) {
                    if ordered(core(one), core(other), Depth::Any).is_some() {
                        self.link(index, j);
                        self.link(j, index);
                    }
                    self.others = Some(others);
                    return;
                }
            }
        }
        self.others = None;
        self.searched &= !(1 << index);
        self.referred |= self.connected(1 << index);
    }

    fn link(&mut self, from: usize, to: usize) {
        if let Some(row) = self.neighbours.get_mut(from) {
            *row |= 1 << to;
        }
    }

    /// Begins to find reference points for the cluster of the obstacle at `first`.
    fn begin(&mut self, first: usize, entries: &mut [Entry<S, D>]) {
        let cluster = self.connected(1 << first);
        self.referred &= !cluster;
        if cluster.count_ones() == 1 {
            self.unshared &= !cluster;
            return refer(entries, first, None);
        }
        let next = match self.together(cluster, entries).as_deref() {
            None => Next::Tree,
            Some([Inside::Sight(a), Inside::Sight(b)]) if !is_polygon(a) && !is_polygon(b) => {
                overlap::between(Inside::Core(a), Inside::Core(b), Depth::Most).map_or(Next::Tree, Next::Shared)
            }
            Some(members) => Next::Search(Search::new(members, &amidst(members), Depth::Most)),
        };
        self.go_on(cluster, next, entries);
    }

    fn go_on(&mut self, cluster: u64, next: Next<S, D>, entries: &mut [Entry<S, D>]) {
        match next {
            Next::Search(search) => self.task = Task::Common { cluster, search },
            Next::Shared(point) => self.share(cluster, &point, entries),
            Next::Tree => self.plant(cluster, entries),
        }
    }

    /// The members of a small cluster without a wall in which each overlaps each, where they may have their reference points.
    fn together<'a>(
        &self,
        cluster: u64,
        entries: &'a [Entry<S, D>],
    ) -> Option<heapless::Vec<Inside<'a, S, D>, COMMON>> {
        let mut members = heapless::Vec::new();
        for i in by_id(cluster, entries) {
            let member = &entries.get(i)?.obstacle;
            if member.spec().wall || *self.neighbours.get(i)? | 1 << i != cluster {
                return None;
            }
            members.push(Inside::Sight(member)).ok()?;
        }
        Some(members)
    }

    /// Goes on with the search for a point inside all hard cores of a cluster, from which each polygon is seen whole.
    fn search(&mut self, cluster: u64, mut search: Search<S, D>, entries: &mut [Entry<S, D>]) {
        let next = match self.together(cluster, entries).as_deref() {
            // Something has changed in between, and all of this is done again in the next round.
            None => Next::Tree,
            Some(members) => {
                let (mut gammas, mut more) = (0, true);
                while more && gammas < GAMMAS {
                    gammas += members.len();
                    more = search.step(members);
                }
                if more { Next::Search(search) } else { search.found().map_or(Next::Tree, Next::Shared) }
            }
        };
        self.go_on(cluster, next, entries);
    }

    /// This is where all of a cluster have their reference points.
    fn share(&mut self, cluster: u64, point: &Vector<S, D>, entries: &mut [Entry<S, D>]) {
        self.unshared &= !cluster;
        bits(cluster).for_each(|i| refer(entries, i, Some(point)));
    }

    /// Begins to go through a cluster as a tree.
    fn plant(&mut self, cluster: u64, entries: &mut [Entry<S, D>]) {
        self.unshared |= cluster;
        let Some(root) = self.root(cluster, entries) else { return };
        refer(entries, root, None);
        let hub = entries.get(root).filter(|e| !e.obstacle.spec().wall).map(|e| e.obstacle.reference());
        let bit = 1 << root;
        self.task = Task::Tree(Tree { cluster, hub, reached: bit, front: bit, next: 0, parent: root, children: 0 });
    }

    /// Goes on through a tree, up to the next child.
    fn grow(&mut self, mut tree: Tree<S, D>, entries: &mut [Entry<S, D>]) {
        if tree.reached == tree.cluster {
            return;
        }
        while tree.children == 0 {
            if tree.front == 0 {
                (tree.front, tree.next) = (tree.next, 0);
            }
            let parent = by_id(tree.front, entries).next();
            let Some(parent) = parent else { return };
            tree.front &= !(1 << parent);
            tree.children = self.neighbours.get(parent).copied().unwrap_or_default() & !tree.reached;
            tree.parent = parent;
        }
        let Some(child) = bits(tree.children).next() else { return };
        let bit = 1 << child;
        tree.children &= !bit;
        (tree.reached, tree.next) = (tree.reached | bit, tree.next | bit);
        let point = towards_parent(entries, tree.parent, child);
        refer(entries, child, point.as_ref());
        if let Some(entry) = entries.get_mut(child) {
            entry.obstacle.lean_towards(tree.hub.as_ref());
        }
        self.task = Task::Tree(tree);
    }

    /// Where the tree begins: the wall, or else who overlaps most others, of equals a polygon, for it may not be seen from elsewhere.
    fn root(&self, cluster: u64, entries: &[Entry<S, D>]) -> Option<usize> {
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

/// Where the search for a point in common starts: amidst the centres, with the weights 1/outer^2, for a point of all lies in the smallest.
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

/// A point that two have in common; whatever their places, for which obstacle is where must not matter.
fn ordered<'a, S: Scalar, const D: usize>(
    (a, of_a): (&'a Entry<S, D>, Inside<'a, S, D>),
    (b, of_b): (&'a Entry<S, D>, Inside<'a, S, D>),
    depth: Depth,
) -> Option<Vector<S, D>> {
    if a.id < b.id { overlap::between(of_a, of_b, depth) } else { overlap::between(of_b, of_a, depth) }
}

fn core<S: Scalar, const D: usize>(entry: &Entry<S, D>) -> (&Entry<S, D>, Inside<'_, S, D>) {
    (entry, Inside::Core(&entry.obstacle))
}

/// Where a child refers to: from the overlap with its parent on towards the parent's reference point, as far as the child's own core goes. Then in the
/// notch between the two the child leads the flow away from the branch, as its parent does. Nowhere if a polygon is not seen whole from there.
fn towards_parent<S: Scalar, const D: usize>(
    entries: &[Entry<S, D>],
    parent: usize,
    child: usize,
) -> Option<Vector<S, D>> {
    let (parent, child) = (entries.get(parent)?, entries.get(child)?);
    if !overlap::are_near(&parent.obstacle, &child.obstacle) {
        // They have moved apart since they were compared.
        return None;
    }
    let inside = if child.obstacle.spec().wall { core(child) } else { (child, Inside::Sight(&child.obstacle)) };
    let point = ordered(core(parent), inside, Depth::Well)?;
    let (parent, child) = (&parent.obstacle, &child.obstacle);
    if parent.spec().wall {
        return Some(point);
    }
    let way = parent.reference() - point;
    let (inside, nearly) = (S::from_f64(0.8), S::from_f64(0.76));
    let (mut reached, mut step) = (S::zero(), S::one());
    for _ in 0..12 {
        let further = reached + step;
        step *= S::from_f64(0.5);
        if further > S::one() {
            break;
        }
        let level = child.sight(&(point + way * further)).0;
        if level <= inside {
            reached = further;
            if level > nearly {
                break;
            }
        }
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
