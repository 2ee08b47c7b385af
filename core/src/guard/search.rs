//! Where neither what was seen from x nor from where the least violation leads can be fulfilled: one place of the next sample after the other is tried.

use super::{BARE, Guard, HalfSpace, HalfSpaces, Next, View, rounding};
use crate::{Scalar, Vector};

/// From x so many steps are taken, and from every other place.
const LONG: usize = 8;
const SHORT: usize = 3;
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
        if next.table.has_only_ellipsoids() {
            return None;
        }
        let mut near = heapless::Vec::<_, CAP>::new();
        let mut walls = false;
        for (index, reach) in &next.around.near {
            let Some(o) = next.table.at(*index) else { continue };
            let gamma = o.gamma(x);
            if o.is_deeper(gamma, step) {
                return None;
            }
            if o.is_near(gamma, step + next.skin) {
                walls |= o.is_round_wall();
                let _ = near.push((*index, *reach));
            }
        }
        let mut search = Search { guard: self, next, near: &near, tangents: heapless::Vec::new() };
        search.beginning(*x, if walls { LONG } else { SHORT }).or_else(|| {
            directions::<S, D>().find_map(|way| search.beginning(x + way * step, 1))
        })
    }
}

struct Search<'a, S: Scalar, const D: usize, const CAP: usize> {
    guard: &'a Guard<S>,
    next: &'a Next<'a, S, D, CAP>,
    /// What a step may reach.
    near: &'a [(usize, S)],
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
            if self.next.is_clear(&at, bare) {
                let near = seen.allowed(wanted).filter(|u| self.next.is_clear(&(x + u * dt), bare));
                return Some(near.unwrap_or((at - x) / dt));
            }
            let from = at;
            at = x + seen.deepest().velocity * dt;
            if at == from {
                return None;
            }
        }
        self.next.is_clear(&at, bare).then(|| (at - x) / dt)
    }

    fn look(&mut self, at: &Vector<S, D>) -> HalfSpaces<S, D> {
        let Next { x, speed, dt, table, .. } = *self.next;
        let mut others = heapless::Vec::<_, CAP>::new();
        others.extend(self.near.iter().filter(|(index, _)| table.at(*index).is_some_and(|o| !o.is_round_wall())).copied());
        let mut seen = HalfSpaces::new(speed);
        let step = speed * dt;
        let skin = rounding(x, BARE + BARE);
        let there = View { at, step: step + step, approach: S::one(), skin, near: &others };
        self.guard.look(self.next, &there, &mut seen);
        for wall in self.near.iter().filter_map(|(index, _)| table.at(*index)).filter(|o| o.is_round_wall()) {
            wall.tangent(at, |normal, gap| {
                let offset = (normal.dot(&(at - x)) + skin - gap) / dt;
                let _ = self.tangents.push(HalfSpace { normal, offset });
            });
        }
        self.tangents.iter().for_each(|tangent| seen.add(*tangent));
        seen
    }
}

/// Unit vectors both ways along each axis.
fn directions<S: Scalar, const D: usize>() -> impl Iterator<Item = Vector<S, D>> {
    (0..2 * D).map(|n| {
        let along = if n % 2 == 0 { S::one() } else { -S::one() };
        Vector::from_fn(|i, _| if i == n / 2 { along } else { S::zero() })
    })
}
