//! An obstacle as the guard sees it: half-spaces that keep out of its hard core, and what its surface cannot be nearer or farther than.

use super::Obstacle;
use crate::shape::{Place, root};
use crate::{Scalar, Vector, norm, times};

/// From where half-spaces are to be found that keep a point out, and where that point may go.
pub(crate) struct Outlook<'a, S: Scalar, const D: usize> {
    /// m
    pub at: &'a Vector<S, D>,
    /// The displacement that is wished for, m: where there is a choice of half-spaces, one that leaves room for it.
    pub wish: &'a Vector<S, D>,
    /// No displacement is longer, m.
    pub step: S,
    /// Surfaces farther away may be left out, m.
    pub reach: S,
    /// The share of the distance that the displacement may use up.
    pub share: S,
}

/// What of the displacements within a step is sure to end in a hard core.
pub(crate) enum Engulfed<S: Scalar, const D: usize> {
    /// All of them.
    Everything,
    /// Those with n.delta <= depth.
    HalfSpace {
        /// n, of unit length, world's frame.
        normal: Vector<S, D>,
        /// m
        depth: S,
    },
    /// None is known to.
    Nothing,
}

impl<S: Scalar, const D: usize> Obstacle<S, D> {
    /// Calls `keep(n, gap)` for half-spaces n.delta >= -gap (n of unit length, world's frame; gap in m) of
    /// displacements from a place that keep out of the hard core (a wall: inside).
    pub(crate) fn keep_out(&self, from: &Outlook<'_, S, D>, mut keep: impl FnMut(Vector<S, D>, S)) {
        if self.plain {
            return self.keep_out_of_ellipsoid(from.at, keep);
        }
        let u = self.scaled(from.at);
        let wish = times(&self.scaling, from.wish);
        let Outlook { step, reach, share, .. } = *from;
        let place = Place { u, wish, inverse: &self.hard, wall: self.spec.wall, step, reach, share };
        self.body.keep_out(&self.spec.shape, &place, |normal, slack| {
            let length = norm(&normal);
            if length > S::zero() {
                let inverse = S::one() / length;
                keep(times(&self.spec.rotation, &(normal * inverse)), slack * inverse - self.blur);
            }
        });
    }

    /// The same for an ellipsoid with p = 1: the half-space where the ray from the centre leaves the surface, as for
    /// other superellipsoids.
    fn keep_out_of_ellipsoid(&self, x: &Vector<S, D>, mut keep: impl FnMut(Vector<S, D>, S)) {
        let one = S::one();
        let u = self.scaled(x);
        let largest = u.iter().fold(S::zero(), |m, u| m.max(u.abs()));
        if !(largest > S::zero()) {
            return keep(self.spec.rotation.column(0).into_owned(), -one / self.hard[0]);
        }
        // Scaled, so that squares stay within range; only the direction counts.
        let t = u / largest;
        let size = norm(&t);
        let (normal, unit) = self.steepened(&t);
        let inverse = one / norm(&normal);
        keep(
            times(&self.spec.rotation, &(normal * inverse)),
            size * (largest * size - one) * (unit * inverse) - self.blur,
        );
    }

    /// None if its surface is farther from x than `step` (m), and a `skin` (m); or else what of the displacements from x that are no longer than the step is sure
    /// to end in the hard core. Of an ellipsoid with p = 1, a half-space:
    ///
    /// ```text
    /// Gamma(x + delta) <= Gamma(x) + grad Gamma(x).delta + (|delta|/shortest semi-axis)^2
    /// ```
    pub(crate) fn engulfs(&self, x: &Vector<S, D>, step: S, skin: S) -> Option<Engulfed<S, D>> {
        let u = self.scaled(x);
        let gamma = self.level(&u).0;
        // Where it is not known how steep the gauge is, the surface is near.
        if self.is_steepness_known() && !self.is_near(gamma, step + skin) {
            return None;
        }
        let bend = step * self.slimmest;
        // Of what a step can lead through to the other side nothing is known.
        if !(self.plain && bend < S::one()) {
            return Some(if self.is_deeper(gamma, step) { Engulfed::Everything } else { Engulfed::Nothing });
        }
        let (normal, unit) = self.steepened(&u);
        // At the centre it has no direction, but all the more depth.
        let inverse = S::one() / norm(&normal);
        let depth = (S::one() - gamma - bend * bend) * (S::from_f64(0.5) * unit * inverse);
        Some(Engulfed::HalfSpace { normal: times(&self.spec.rotation, &(normal * inverse)), depth })
    }

    /// t diag(hard), along the gradient of Gamma where t is along u, in units of which as many are a metre as `unit` says.
    #[inline(always)]
    fn steepened(&self, t: &Vector<S, D>) -> (Vector<S, D>, S) {
        let one = S::one();
        if S::FLOATS {
            return (t.component_mul(&self.hard), one);
        }
        // In fixed point a short axis' reciprocal has no square.
        let shortest = one / self.slimmest;
        (t.zip_map(&self.hard, |t, inverse| t * (inverse * shortest)), shortest)
    }

    /// Is it an ellipsoid with p = 1, and no wall?
    pub(crate) fn is_plain(&self) -> bool {
        self.plain
    }

    /// Is it a wall whose free space is convex?
    pub(crate) fn is_round_wall(&self) -> bool {
        self.spec.wall && self.body.pieces().is_none()
    }

    /// The tangent to the gauge at x, as a half-space n.delta >= -gap of displacements from x (n of unit length, world's frame, to where the robot may
    /// be; gap in m): that in which lambda(x) + grad lambda(x).delta is at least 1, or at most 1 in a wall. That of a wall whose free space is convex
    /// has all of it inside. None at the centre.
    pub(crate) fn tangent(&self, x: &Vector<S, D>) -> Option<(Vector<S, D>, S)> {
        let u = self.scaled(x);
        let (gamma, direction) = self.body.level(&self.spec.shape, &u);
        let gauge = root(gamma, self.body.power());
        let length = norm(&direction);
        // The steepest scale, for in fixed point the reciprocals of short lengths have few digits.
        let steepest = self.steepest();
        let outward = (direction / length).zip_map(&self.hard, |n, hard| n * (hard / steepest));
        let slope = norm(&outward);
        (gauge > S::zero() && length > S::zero() && slope > S::zero()).then(|| {
            let way = if self.spec.wall { -S::one() } else { S::one() };
            // grad lambda . u = lambda
            let gap = (direction / length).dot(&u) * (S::one() - S::one() / gauge) / (steepest * slope);
            (times(&self.spec.rotation, &(outward * (way / slope))), gap * way)
        })
    }

    /// In fixed point the reciprocal of what is very thin is out of range.
    fn is_steepness_known(&self) -> bool {
        self.slimmest <= S::MAX * S::from_f64(0.5)
    }

    /// May the hard surface be within `reach` (m) of a point with this Gamma?
    #[inline(always)]
    pub(crate) fn is_near(&self, gamma: S, reach: S) -> bool {
        // The gauge is gamma^(1/2p) and changes by no more than `slimmest` a metre.
        let gauge = self.rim + reach * self.slimmest;
        if self.quadratic {
            return gamma <= gauge * gauge;
        }
        self.is_within(gamma, gauge - S::one())
    }

    /// Is the surface farther than `distance` (m) from x, which is outside? A convex core is no nearer than the tangent says; a round wall may
    /// come nearer twice as fast as at x.
    #[cold]
    #[inline(never)]
    pub(crate) fn is_farther(&self, x: &Vector<S, D>, distance: S) -> bool {
        let u = self.scaled(x);
        let longest = S::one() / self.hard.iter().fold(S::MAX, |m, hard| m.min(*hard));
        // What rounding does to scaled coordinates of a large body: all are equally coarse in fixed point.
        let size = if S::FLOATS { u.iter().fold(S::zero(), |m, u| m.max(u.abs())) } else { S::one() };
        let curve = if self.is_round_wall() { distance } else { S::zero() };
        let least = distance + curve + S::EPSILON * S::from_f64(8.0) * size * longest;
        // Beside a corner the nearest edge's tangent says less than there is.
        let gap = match self.body.distance(&self.spec.shape, &u) {
            Some(gap) => Some(gap * longest),
            None => self.tangent(x).map(|(_, gap)| gap),
        };
        gap.is_some_and(|gap| gap >= least)
    }

    /// Is all of the surface farther than `reach` (m) from a point inside with this Gamma?
    pub(crate) fn is_deeper(&self, gamma: S, reach: S) -> bool {
        let one = S::one();
        let change = reach * self.slimmest;
        if !self.is_steepness_known() {
            false
        } else if self.spec.wall {
            let gauge = one + change;
            gamma * (gauge * gauge).powi(self.body.power()) < one
        } else {
            let gauge = (one - change).max(S::zero());
            gamma < (gauge * gauge).powi(self.body.power())
        }
    }

    /// May the gauge be 1 where it differs by `change`, at most, from that of a point with this Gamma?
    #[inline(never)]
    fn is_within(&self, gamma: S, change: S) -> bool {
        let one = S::one();
        if self.spec.wall {
            let gauge = (one - change).max(S::zero());
            // Beyond FAR it is not told how far.
            gamma.min(S::FAR) * (gauge * gauge).powi(self.body.power()) <= one
        } else {
            gamma <= ((one + change) * (one + change)).powi(self.body.power())
        }
    }
}
