//! Where neither what was seen from x nor from where the least violation leads can be fulfilled: one place of the next sample after the other is tried.

use super::{BARE, Guard, HalfSpace, HalfSpaces, Next, View, rounding};
use crate::{Scalar, Vector, norm};

/// From x so many steps are taken, and from every other place.
const LONG: usize = 16;
const SHORT: usize = 4;
/// Room for so many tangents of walls.
const TANGENTS: usize = 48;

impl<S: Scalar> Guard<S> {
    #[cold]
    #[inline(never)]
    pub(super) fn search<const D: usize, const CAP: usize>(
        &self,
        next: &Next<'_, S, D, CAP>,
    ) -> Option<Vector<S, D>> {
        let Next { x, speed, dt, .. } = *next;
        let step = speed * dt;
        if next.near().any(|o| o.is_deeper(o.gamma(x), step)) {
            return None;
        }
        let mut others = next.around.near.clone();
        others.retain(|(index, _)| next.table.at(*index).is_some_and(|o| !o.is_round_wall()));
        let mut search = Search { guard: self, next, others: &others, tangents: heapless::Vec::new() };
        search.beginning(*x, LONG).or_else(|| {
            directions::<S, D>().find_map(|way| search.beginning(x + way * step, SHORT))
        })
    }
}

struct Search<'a, S: Scalar, const D: usize, const CAP: usize> {
    guard: &'a Guard<S>,
    next: &'a Next<'a, S, D, CAP>,
    /// All that may be reached but walls whose free space is convex.
    others: &'a [(usize, S)],
    /// Of those walls, each with all of the free space on one side.
    tangents: heapless::Vec<HalfSpace<S, D>, TANGENTS>,
}

impl<S: Scalar, const D: usize, const CAP: usize> Search<'_, S, D, CAP> {
    /// From one place: what is seen from there leads to the next.
    fn beginning(&mut self, mut at: Vector<S, D>, steps: usize) -> Option<Vector<S, D>> {
        let Next { x, dt, wanted, .. } = *self.next;
        let bare = rounding(x, BARE);
        for _ in 0..steps {
            let mut seen = self.look(&at);
            if self.next.is_clear(&at, bare, true) {
                let near = seen.allowed(wanted).filter(|u| self.next.is_clear(&(x + u * dt), bare, true));
                return Some(near.unwrap_or((at - x) / dt));
            }
            at = x + seen.deepest().velocity * dt;
        }
        self.next.is_clear(&at, bare, true).then(|| (at - x) / dt)
    }

    fn look(&mut self, at: &Vector<S, D>) -> HalfSpaces<S, D> {
        let Next { x, speed, dt, .. } = *self.next;
        let mut seen = HalfSpaces::new(speed);
        let step = speed * dt;
        let skin = rounding(x, BARE + BARE);
        let there = View { at, step: step + step, approach: S::one(), skin, near: self.others };
        self.guard.look(self.next, &there, &mut seen);
        for wall in self.next.near().filter(|o| o.is_round_wall()) {
            wall.tangent(at, |normal, gap| {
                let offset = (normal.dot(&(at - x)) + skin - gap) / dt;
                let _ = self.tangents.push(HalfSpace { normal, offset });
            });
        }
        self.tangents.iter().for_each(|tangent| seen.add(*tangent));
        seen
    }
}

/// Unit vectors evenly about: towards the middles of a cube's faces, edges and corners.
fn directions<S: Scalar, const D: usize>() -> impl Iterator<Item = Vector<S, D>> {
    let ways = (0..D).fold(1, |n, _| n * 3);
    (1..ways).map(|n| {
        let mut n = n;
        let way = Vector::from_fn(|_, _| {
            let digit = n % 3;
            n /= 3;
            [S::zero(), S::one(), -S::one()][digit]
        });
        way / norm(&way)
    })
}
