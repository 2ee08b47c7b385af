//! Ellipsoids and superellipsoids: gamma(u) = sum_i |u_i|^2p, after Khansari-Zadeh & Billard (2012).

use super::{Place, Surface, first_axis};
use crate::{Scalar, Vector};

/// The unit superellipsoid: the semi-axes are in the scale.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Superellipsoid {
    pub p: u8,
}

impl Superellipsoid {
    /// p, as a number.
    fn powers<S: Scalar>(&self) -> S {
        (0..self.p).fold(S::zero(), |sum, _| sum + S::one())
    }

    /// gamma^(1/2p). Of u over its largest entry, for in fixed point the high powers of a third are nothing.
    fn gauge<S: Scalar, const D: usize>(&self, u: &Vector<S, D>) -> S {
        let largest = u.iter().fold(S::zero(), |m, u| m.max(u.abs()));
        if !(largest > S::zero()) {
            return largest;
        }
        let level = u.iter().fold(S::zero(), |sum, u| sum + ((*u / largest) * (*u / largest)).powi(self.p));
        largest * root(level, self.p)
    }

    /// What a displacement of this length may add to the tangent of gamma, which is convex with second derivatives up
    /// to 2p(2p - 1) within the surface; and a fifth of that more.
    fn bend<S: Scalar>(&self, stride: S) -> S {
        let p = self.powers::<S>();
        S::from_f64(1.2) * p * (p + p - S::one()) * stride * stride
    }

    /// Whatever the step's length: |delta_i| <= s, with s times the gauge of (1, 1, ...) what the gauge of u `lacks` to one, for no gauge of a
    /// sum is more than the sum of the gauges. From outside that is none.
    fn keep_within<S: Scalar, const D: usize>(&self, lacks: S, mut keep: impl FnMut(Vector<S, D>, S)) {
        let one = S::one();
        let room = lacks / root((0..D).fold(S::zero(), |sum, _| sum + one), self.p);
        for i in 0..D {
            let side = |sign: S| Vector::from_fn(|j, _| if i == j { sign } else { S::zero() });
            keep(side(-one), room);
            keep(side(one), room);
        }
    }
}

impl Superellipsoid {
    /// Of all u inside the one with the largest w.u: u_i is as |w_i|^(1/(2p - 1)).
    pub fn farthest<S: Scalar, const D: usize>(&self, w: &Vector<S, D>) -> Vector<S, D> {
        let largest = w.iter().fold(S::zero(), |m, w| m.max(w.abs()));
        if !(largest > S::zero()) {
            return Vector::zeros();
        }
        let power = self.p + self.p - 1;
        let u = w.map(|w| {
            let share = w / largest;
            let u = root(share * share, power);
            if w < S::zero() { -u } else { u }
        });
        let gamma = u.iter().fold(S::zero(), |sum, u| sum + (*u * *u).powi(self.p));
        u / root(gamma, self.p)
    }
}

impl<S: Scalar, const D: usize> Surface<S, D> for Superellipsoid {
    fn level(&self, u: &Vector<S, D>) -> (S, Vector<S, D>) {
        if self.p == 1 {
            return (S::dot(u.as_slice(), u.as_slice()), *u);
        }
        let gamma = u.iter().fold(S::zero(), |sum, u| sum + (*u * *u).powi(self.p));
        // |u|^(2p - 1) overflows far away and underflows near the centre; its direction is that of u / max|u|.
        let largest = u.iter().fold(S::zero(), |m, u| m.max(u.abs()));
        if !(largest > S::EPSILON * S::EPSILON) {
            return (gamma, *u);
        }
        let scale = S::one() / largest;
        (gamma, u.map(|u| slope(u * scale, self.p)))
    }

    fn keep_out(&self, at: &Place<'_, S, D>, mut keep: impl FnMut(Vector<S, D>, S)) {
        let one = S::one();
        let steepest = at.inverse.iter().fold(S::zero(), |m, i| m.max(*i));
        let shortest = one / steepest;
        // A normal that is scaled by the shortest axis, so that high powers of thin ones stay within range, and a slack in units of that axis: brought to
        // length one before they meet, for in fixed point a small slack times a short axis has no digits left.
        let mut keep = |slopes: Vector<S, D>, slack: S| {
            let normal = slopes.zip_map(at.inverse, |slope, inverse| slope * (inverse * shortest));
            let length = S::norm(normal.as_slice());
            if length > S::zero() {
                keep(normal / length, slack * (shortest / length));
            }
        };
        let within = |gamma: &S| *gamma < one;
        let gamma = || at.u.iter().fold(S::zero(), |sum, u| sum + (*u * *u).powi(self.p));
        if let Some(gamma) = at.wall.then(gamma).filter(within) {
            let stride = at.step * steepest;
            let gap = one - gamma - self.bend(stride);
            if gap >= S::zero() {
                keep(at.u.map(|u| -slope(u, self.p)), gap * S::from_f64(0.5) / self.powers());
                return;
            }
            // A step is longer than the bend allows.
            return self.keep_within(one - self.gauge(&at.u), keep);
        }
        // The supporting half-space where the ray from the centre leaves the surface: the normal there is that at u.
        let largest = at.u.iter().fold(S::zero(), |m, u| m.max(u.abs()));
        if !(largest > S::zero()) {
            keep(first_axis(one), -one);
            return;
        }
        let t = at.u / largest;
        let level = t.iter().fold(S::zero(), |sum, t| sum + (*t * *t).powi(self.p));
        let gauge = largest * root(level, self.p);
        if at.wall {
            // Where the ray leaves it the tangent is off by what bends on the way back to there and within the step.
            let y = at.u / gauge;
            let bend = self.bend(at.step * steepest + S::norm((at.u - y).as_slice()));
            // In fixed point what bends more may be more than a number can say.
            if bend > S::MAX * S::from_f64(0.5) {
                return self.keep_within(one - gauge, keep);
            }
            keep(y.map(|u| -slope(u, self.p)), one - gauge - bend * S::from_f64(0.5) / self.powers());
            return;
        }
        let slopes = t.map(|t| slope(t, self.p));
        keep(slopes, slopes.dot(&t) * (gauge - one) * (largest / gauge));
    }
}

/// |u|^(2p - 1) sgn u
fn slope<S: Scalar>(u: S, p: u8) -> S {
    (u * u).powi(p.saturating_sub(1)) * u
}

/// gamma^(1/2p), by Newton's method on y^p = sqrt(gamma) from above.
pub(crate) fn root<S: Scalar>(gamma: S, p: u8) -> S {
    let target = gamma.sqrt();
    if p <= 1 {
        return target;
    }
    let powers = (0..p).fold(S::zero(), |sum, _| sum + S::one());
    // From sqrt(gamma) itself a large one would take hundreds of steps, each a share of 1/p: so from its root of the
    // power of two next below p.
    let mut y = target.max(S::one());
    let mut power = p;
    while power > 1 {
        y = y.sqrt();
        power /= 2;
    }
    for _ in 0..60 {
        let next = y - (y - target / y.powi(p - 1)) / powers;
        if !(next < y) {
            break;
        }
        y = next;
    }
    y
}
