//! Boxes, cylinders and capsules: a smaller body with everything within a radius r of it, so that normals turn without a jump.

use super::{Place, Surface, first_axis};
use crate::{Scalar, Vector, is_zero, unit};

/// A box (or, about the third axis, a cylinder) with semi-extents `half`, and everything within `radius` of it.
///
/// Its gauge lambda = |u|/R(u) is where the body, lambda times as large, has u on its surface:
///
/// ```text
/// sum_i max(t_i - lambda h_i, 0)^2 = (lambda r)^2,   t_i = |u_i|, or for a cylinder t = (|(u_1, u_2)|, |u_3|)
/// ```
///
/// a quadratic equation once it is known which terms are positive: i is not where the left side, at lambda = t_i/h_i,
/// is still larger. With t and h cut to the terms that are, and c = t/|t|, its root is
///
/// ```text
/// lambda = |t| / (c.h + sqrt(r^2 - |c x h|^2))
/// ```
///
/// in which nothing is lost where r is small: the usual discriminant is the difference of two far larger numbers there.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rounded<S: Scalar, const D: usize> {
    half: Vector<S, D>,
    radius: S,
    /// Are the first two coordinates one distance from the axis?
    turned: bool,
}

/// The gauge at a point and its gradient, in terms of t and in those of u.
struct Gauge<S: Scalar, const D: usize> {
    lambda: S,
    gradient: Vector<S, D>,
}

impl<S: Scalar, const D: usize> Rounded<S, D> {
    pub fn rounded_box(half: &Vector<S, D>, rounding: S) -> Self {
        Self { half: half.map(|a| a - rounding), radius: rounding, turned: false }
    }

    pub fn cylinder(radius: S, half_length: S, rounding: S) -> Self {
        let half = [radius - rounding, S::zero(), half_length - rounding];
        Self {
            half: Vector::from_fn(|i, _| half.get(i).copied().unwrap_or_else(S::zero)),
            radius: rounding,
            turned: true,
        }
    }

    pub fn capsule(radius: S, half_length: S) -> Self {
        Self { half: Vector::from_fn(|i, _| if i == 2 { half_length } else { S::zero() }), radius, turned: true }
    }

    fn gauge(&self, u: &Vector<S, D>) -> Gauge<S, D> {
        let zero = S::zero();
        let t = self.distances(u);
        let across = t[0];
        let (h, r) = (&self.half, self.radius);
        let counts = Vector::<S, D>::from_fn(|i, _| {
            let beyond: [S; D] = core::array::from_fn(|j| (t[j] * h[i] - t[i] * h[j]).max(zero));
            if S::norm(&beyond) <= t[i] * r { S::one() } else { zero }
        });
        let (length, c) = unit(&t.component_mul(&counts));
        let k = h.component_mul(&counts);
        let aside = aside(&c, &k);
        let reach = S::dot(c.as_slice(), k.as_slice()) + S::other_leg(r, aside.min(r));
        if !(length > zero && reach > zero) {
            return Gauge { lambda: zero, gradient: Vector::zeros() };
        }
        let lambda = length / reach;
        // The smaller body's nearest point sees u along the normal n, and the plane across n that touches the body is h.n + r away.
        let outward = Vector::<S, D>::from_fn(|i, _| (t[i] - lambda * h[i]).max(zero) * counts[i]);
        let (_, normal) = unit(&outward);
        let slope = S::one() / (S::dot(normal.as_slice(), h.as_slice()) + r);
        let gradient = Vector::from_fn(|i, _| {
            let along = if self.turned && i < 2 {
                if across > zero { normal[0] * (u[i] / across) } else { zero }
            } else if u[i] < zero {
                -normal[i]
            } else {
                normal[i]
            };
            along * slope
        });
        Gauge { lambda, gradient }
    }

    /// Of all u inside the one with the largest w.u.
    pub fn farthest(&self, w: &Vector<S, D>) -> Vector<S, D> {
        let (_, n) = unit(w);
        let (across, along) = unit(&Vector::<S, D>::from_fn(|i, _| if i < 2 { n[i] } else { S::zero() }));
        Vector::from_fn(|i, _| {
            let corner = if self.turned && i < 2 {
                if across > S::zero() { along[i] * self.half[0] } else { S::zero() }
            } else if n[i] < S::zero() {
                -self.half[i]
            } else {
                self.half[i]
            };
            corner + n[i] * self.radius
        })
    }

    /// Radius of the largest ball inside.
    pub fn inner(&self) -> S {
        let flat = |i: usize| self.turned && i == 1;
        let least = self.half.iter().enumerate().filter(|(i, _)| !flat(*i)).fold(S::MAX, |m, (_, h)| m.min(*h));
        least + self.radius
    }
}

impl<S: Scalar, const D: usize> Surface<S, D> for Rounded<S, D> {
    fn level(&self, u: &Vector<S, D>) -> (S, Vector<S, D>) {
        let Gauge { lambda, gradient } = self.gauge(u);
        (lambda * lambda, gradient)
    }

    fn keep_out(&self, at: &Place<'_, S, D>, mut keep: impl FnMut(Vector<S, D>, S)) {
        if at.wall {
            return self.keep_in(at).into_iter().for_each(|(normal, gap)| keep(normal, gap));
        }
        let Gauge { lambda, gradient } = self.gauge(&at.u);
        // Near the centre the edges' radius may have no digits, and the normal none.
        if lambda > S::zero() && !is_zero(&gradient) {
            keep(gradient.component_mul(at.inverse), lambda - S::one());
        } else {
            keep(first_axis(at.inverse[0]), -(self.half[0] + self.radius));
        }
    }
}

impl<S: Scalar, const D: usize> Rounded<S, D> {
    /// With k the point of the smaller body nearest to u, |u + delta - k| <= r is enough to stay inside; with |delta| <= L that is
    /// n.delta <= sqrt(r^2 - L^2) - |u - k|. Within the smaller body a step shorter than r ends inside anyway.
    fn keep_in(&self, at: &Place<'_, S, D>) -> heapless::Vec<(Vector<S, D>, S), 6> {
        let mut kept = heapless::Vec::new();
        // Cannot be full: two for each extent.
        let mut keep = |normal: Vector<S, D>, gap: S| {
            let _ = kept.push((normal.component_mul(at.inverse), gap));
        };
        let zero = S::zero();
        let fastest = at.inverse.iter().fold(zero, |m, i| m.max(*i));
        let stride = at.step * fastest;
        // sqrt(r^2 - L^2), whose squares would leave fixed point few digits.
        let rest = |r: S| {
            let share = stride / r;
            r * (S::one() - share * share).sqrt()
        };
        if stride < self.radius {
            let (away, _) = self.beyond(&at.u);
            let distance = S::norm(away.as_slice());
            if distance > zero {
                keep(-(away / distance), rest(self.radius) - distance);
            }
            return kept;
        }
        // Edges sharper than a step is long: stay within a box (a cylinder) that has u inside and is inside the body, between its faces.
        let (away, t) = self.beyond(&at.u);
        let (away, distance) = (self.distances(&away), S::norm(away.as_slice()));
        let (scale, more) = if distance > self.radius {
            (self.radius / distance, zero)
        } else {
            let terms = S::from_f64(if D == 2 || self.turned { 2.0 } else { 3.0 });
            (S::one(), (self.radius - distance) / terms.sqrt())
        };
        // |a + (r - |a|)(1, 1, ..)/sqrt(n)| <= r
        let face = Vector::<S, D>::from_fn(|i, _| self.half[i] + away[i] * scale + more);
        let mut between = |normal: Vector<S, D>, face: S, along: S| {
            keep(-normal, face - along);
            keep(normal, face + along);
        };
        for i in 0..D {
            if !(self.turned && i < 2) {
                between(Vector::from_fn(|j, _| if i == j { S::one() } else { zero }), face[i], at.u[i]);
            }
        }
        if !self.turned {
            return kept;
        }
        let out = if t[0] > zero { [at.u[0] / t[0], at.u[1] / t[0]] } else { [S::one(), zero] };
        if stride < face[0] && t[0] <= rest(face[0]) {
            let normal = Vector::<S, D>::from_fn(|i, _| out.get(i).map_or(zero, |x| -*x));
            keep(normal, rest(face[0]) - t[0]);
            return kept;
        }
        // A step reaches over the disc: stay within the square that has a corner where u is.
        let half = S::from_f64(core::f64::consts::FRAC_1_SQRT_2);
        for turn in [half, -half] {
            let normal = [out[0] * half - out[1] * turn, out[1] * half + out[0] * turn];
            let normal = Vector::<S, D>::from_fn(|i, _| normal.get(i).copied().unwrap_or(zero));
            between(normal, face[0] * half, t[0] * half);
        }
        kept
    }

    /// From the nearest point of the smaller body to u; and t, the distances from the axes that its extents are measured along.
    fn beyond(&self, u: &Vector<S, D>) -> (Vector<S, D>, Vector<S, D>) {
        let zero = S::zero();
        let t = self.distances(u);
        let outward = Vector::from_fn(|i, _| {
            if self.turned && i < 2 {
                if t[0] > zero { u[i] * ((t[0] - self.half[0]).max(zero) / t[0]) } else { zero }
            } else {
                let beyond = (t[i] - self.half[i]).max(zero);
                if u[i] < zero { -beyond } else { beyond }
            }
        });
        (outward, t)
    }

    /// |u_i|; for a cylinder the distance from its axis, nothing, and |u_3|.
    fn distances(&self, u: &Vector<S, D>) -> Vector<S, D> {
        let across = if self.turned { S::norm(&u.as_slice()[..2.min(D)]) } else { S::zero() };
        Vector::from_fn(|i, _| match (self.turned, i) {
            (true, 0) => across,
            (true, 1) => S::zero(),
            _ => u[i].abs(),
        })
    }
}

/// |c x h|: how far the ray along c passes the point h.
fn aside<S: Scalar, const D: usize>(c: &Vector<S, D>, h: &Vector<S, D>) -> S {
    let between = |i: usize, j: usize| S::dot(&[c[i], -c[j]], &[h[j], h[i]]);
    if D == 2 { between(0, 1).abs() } else { S::norm(&[between(0, 1), between(1, 2), between(2, 0)]) }
}
