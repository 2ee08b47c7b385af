//! Where neither what is seen from x nor what is seen from where the least violation leads can be fulfilled: other places of the next sample.
//!
//! What is seen from a place y leads on to the next, and that is the one with most room: with s the half-spaces' offsets as seen from y,
//! of all |u| <= speed first that nearest to zero with n_i.u >= s_i + speed/8, or else that with the largest least n_i.u - s_i. Round walls, whose
//! free space is convex, ask for tangents here,
//!
//! ```text
//! n.delta >= -gap,   n inwards along the gradient of the gauge lambda at y,   gap = (1 - lambda(y))/|grad lambda(y)| - n.(y - x)
//! ```
//!
//! which leave out none of it, wherever y is, so those of all places are kept. A place is taken if it is outside of every core, whatever half-spaces
//! say; once it is, the velocity nearest to the wanted one among what is seen from there, if that leads outside too.
//!
//! From x it goes two places on (five among ellipsoids alone; eight where round walls are near, in space twelve: one after the other comes nearer to their
//! curve), and then one (among ellipsoids alone four) from each end of the step along each axis of the nearest obstacle, four or six in all. So it is bounded,
//! and what is narrow can be missed.

use super::{BARE, Guard, HalfSpace, HalfSpaces, Next, Stride, View};
use crate::{Matrix, Obstacle, Scalar, Vector, times, unit};

/// Places one after the other, from x and from each end of the step; a look at ellipsoids costs little.
const PLACES: (usize, usize) = (2, 1);
const PLACES_AMONG_ELLIPSOIDS: (usize, usize) = (5, 4);
/// From x where round walls are near, for each dimension.
const PLACES_IN_WALLS: usize = 4;
/// Room for so many tangents of walls.
const TANGENTS: usize = 48;

impl<S: Scalar> Guard<S> {
    /// A velocity whose next sample is outside of every core.
    #[cold]
    #[inline(never)]
    pub(super) fn search<const D: usize, const CAP: usize>(&self, next: &Next<'_, S, D, CAP>) -> Option<Vector<S, D>> {
        let Next { x, table, stride: &Stride { speed, .. }, .. } = *next;
        let mut search = Search {
            guard: self,
            next,
            others: heapless::Vec::new(),
            walls: heapless::Vec::new(),
            tangents: heapless::Vec::new(),
        };
        let (mut nearest, mut frame) = (S::MAX, Matrix::identity());
        for (index, reach) in next.near {
            let Some(obstacle) = table.at(*index) else { continue };
            let gamma = obstacle.gamma(x);
            if gamma < nearest {
                (nearest, frame) = (gamma, obstacle.spec().rotation);
            }
            // Neither can be full: they have the table's own capacity.
            if obstacle.is_round_wall() {
                let _ = search.walls.push(obstacle);
            } else {
                let _ = search.others.push((*index, *reach));
            }
        }
        let (places, from_ends) = if !search.walls.is_empty() {
            (PLACES_IN_WALLS * D, PLACES.1)
        } else if table.scan().points().is_empty() && next.near().all(Obstacle::is_plain) {
            PLACES_AMONG_ELLIPSOIDS
        } else {
            PLACES
        };
        search.from(Vector::zeros(), places).or_else(|| {
            (0..D).flat_map(|axis| [(axis, speed), (axis, -speed)]).find_map(|(axis, speed)| {
                let along = Vector::from_fn(|i, _| if i == axis { S::one() } else { S::zero() });
                // Of unit length whatever was given for a rotation.
                search.from(unit(&times(&frame, &along)).1 * speed, from_ends)
            })
        })
    }
}

struct Search<'a, S: Scalar, const D: usize, const CAP: usize> {
    guard: &'a Guard<S>,
    next: &'a Next<'a, S, D, CAP>,
    /// Of what a step may reach, walls whose free space is convex.
    walls: heapless::Vec<&'a Obstacle<S, D>, CAP>,
    /// And all else: places in the table, with how far to look.
    others: heapless::Vec<(usize, S), CAP>,
    /// Of those walls from all places so far; each has all of the free space on one side.
    tangents: heapless::Vec<HalfSpace<S, D>, TANGENTS>,
}

impl<S: Scalar, const D: usize, const CAP: usize> Search<'_, S, D, CAP> {
    /// From where this velocity leads so many places on.
    fn from(&mut self, mut velocity: Vector<S, D>, places: usize) -> Option<Vector<S, D>> {
        for _ in 0..places {
            let mut seen = self.look(&velocity);
            if self.leads_outside(&velocity) {
                let nearest = seen.allowed(self.next.wanted).filter(|u| self.leads_outside(u));
                return Some(nearest.unwrap_or(velocity));
            }
            let last = velocity;
            velocity = seen.roomiest();
            if velocity == last {
                return None;
            }
        }
        self.leads_outside(&velocity).then_some(velocity)
    }

    fn leads_outside(&self, velocity: &Vector<S, D>) -> bool {
        let Next { x, stride, .. } = *self.next;
        self.next.is_clear(&(x + velocity * stride.dt), stride.unit * S::from_f64(BARE))
    }

    /// The half-spaces seen from where a velocity leads, and tangents of walls from there and before.
    fn look(&mut self, velocity: &Vector<S, D>) -> HalfSpaces<S, D> {
        let Next { x, stride: &Stride { speed, dt, length: step, unit, .. }, .. } = *self.next;
        let at = x + velocity * dt;
        let skin = unit * S::from_f64(BARE + BARE);
        let mut seen = HalfSpaces::new(speed);
        let there = View { at: &at, step: step + step, approach: S::one(), skin, near: &self.others };
        self.guard.look(self.next, &there, &mut seen);
        for wall in &self.walls {
            if let Some((normal, gap)) = wall.tangent(&at) {
                // Where there is no more room, those before have to do.
                let _ = self.tangents.push(HalfSpace { normal, offset: normal.dot(velocity) + (skin - gap) / dt });
            }
        }
        self.tangents.iter().for_each(|tangent| seen.add(*tangent));
        seen
    }
}

impl<S: Scalar, const D: usize> HalfSpaces<S, D> {
    /// A velocity that keeps off all half-spaces by an eighth of the speed, or else by as much as can be had.
    fn roomiest(&mut self) -> Vector<S, D> {
        let room = self.speed * S::from_f64(0.125);
        self.all.iter_mut().for_each(|h| h.offset += room);
        self.least(&Vector::zeros()).velocity
    }
}
