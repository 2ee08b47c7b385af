//! How steep the velocity may be, from what its obstacles look like and not from how it is computed.

use crate::world::numbers;
use crate::{GAIN, Line, turning};
use pliant_core::{Obstacle, RobotState, Scalar, Scan, Shape, Vector};
use std::f64::consts::PI;

/// A bound on the slope, 1/s, where no gauge is steeper than [`STEEP`] and no normal turns faster than a smooth body's. Across a shell the push rises from 0
/// to 1 m/s while Gamma_k falls by 0.1, and the slope of Gamma_k is 2p/a <= 6/0.045 on a body of 45 mm: 1330. Between two cores the weights turn from one to
/// the other while Gamma - 1 doubles, by at most 6/0.045/(4 * 0.05) = 670 a metre, of velocities that differ by |f| or so; with several at a time, and f
/// of up to 5 m/s, no more than:
pub const SLOPE: f64 = 4000.0;
/// |grad lambda| of a body of 45 mm, 1/m. The slope of Gamma is in proportion to it.
const STEEP: f64 = 1.0 / 0.045;

/// How fast a surface moves by growing, at most, m/s.
const SWELLING: f64 = 0.1;

impl<S: Scalar, const D: usize> Line<'_, S, D> {
    /// Bounds on the slopes of both between two places, from how it looks at these, 1/s. That of the modulated velocity, which is bounded by itself, there is
    /// so steep.
    pub fn slope(&self, ends: [f64; 2], modulated: f64) -> [f64; 2] {
        let at = ends.map(|along| (self.from + self.way * along).map(S::from_f64));
        let apart = ends[1] - ends[0];
        let both = at.iter().map(|x| self.slope_at(x, [&at[0], &at[1]], apart, modulated));
        both.fold([0.0; 2], |most, here| [0, 1].map(|i| f64::max(most[i], here[i])))
    }

    /// Where a reference point is seen slantingly (a shared one, a tree's, or a polygon's) the flow past its obstacle goes with |g| |r| / (g.r), and the
    /// slope with its square. Near the corners of a polygon its normal turns within a share of an edge, which may be as short as one likes: (2/G) u (m.u)/(m.r) r
    /// changes by |u| |r|/(m.r) (1 + |m| |r|/(m.r)) |dm| 2/G.
    ///
    /// A push has that = t/max(|t|, 0.02 |f|), and t changes with u and by |u| |dn|; it is as long as P, of which the slope is in [`SLOPE`]. Where several
    /// layers overlap, u is made shorter by pushes, of two layers each.
    fn slope_at(&self, x: &Vector<S, D>, ends: [&Vector<S, D>; 2], apart: f64, modulated: f64) -> [f64; 2] {
        // In fixed point the gradient itself does not fit far from a superellipsoid, of which nothing is seen slantingly.
        let fits = |o: &&Obstacle<S, D>| o.gradient(x).iter().all(|g| g.abs() < S::MAX);
        let present =
            || self.controller.table().iter().map(|e| e.obstacle()).filter(|o| o.gamma(x) < S::FAR).filter(fits);
        let most = |of: &dyn Fn(&Obstacle<S, D>) -> f64| present().map(of).fold(1.0, f64::max);
        let (slant_most, steep) = (most(&|o| slant(o, x)), most(&|o| steepness(o, x) / STEEP));
        let Some(state) = RobotState::new(*x) else { return [0.0; 2] };
        let stages = self.controller.evaluate(&state);
        let (f, u) = (numbers(&stages.nominal).norm(), numbers(&stages.modulated));
        // No more than all the way round.
        let rate = |o: &Obstacle<S, D>| turning::rate(o, ends).min(2.0 * PI / apart);
        let past = |o: &Obstacle<S, D>| {
            let relative = f + numbers(&o.surface_velocity(x)).norm() + SWELLING;
            let slant = slant(o, x);
            2.0 / o.gamma(x).to_f64().max(1.0) * relative * slant * (1.0 + slant) * rate(o)
        };
        let polygons = present().filter(|o| matches!(o.spec().shape, Shape::Polygon(_)));
        let smooth = slant_most * slant_most * SLOPE * steep;
        let soft: Vec<_> = present().filter(|o| o.gamma_soft(x) <= S::one()).collect();
        let push = |o: &&Obstacle<S, D>| {
            let n = numbers(&o.gradient(x)).normalize();
            let gamma = o.gamma_soft(x).to_f64();
            let longest = (GAIN / (gamma * gamma)).min(f) + (soft.len() - 1) as f64 * f;
            let t = (u - n * n.dot(&u)).norm() - 0.01 * f;
            longest * (modulated + (u.norm() + 0.01 * f) * rate(o)) / t.max(0.02 * f).max(1e-9)
        };
        let bend = smooth + polygons.map(past).sum::<f64>() + f * points_rate(self.controller.table().scan(), x);
        [bend, smooth + 2.6 * modulated + soft.iter().map(push).sum::<f64>()]
    }
}

/// How much of f the points of a scan bend off a metre, 1/m. With weights w_i, sum_i w_i = 1, of which each changes by w_i (a_i - sum_j w_j a_j), a_i =
/// |grad Gamma_i|/(Gamma_i - 1), nbar changes by no more than K = sum_i w_i (1/|x - p_i| + 2 a_i). Of u + (|nbar|/Gamma) (u - 2 (n.u) n), where n turns by K/|nbar|,
/// the rest changes by 3 (K/Gamma + |grad Gamma|/Gamma^2) + 4 K/Gamma times |u|: nowhere steeper where nbar vanishes.
fn points_rate<S: Scalar, const D: usize>(scan: &Scan<S, D>, x: &Vector<S, D>) -> f64 {
    let radius = scan.radius().to_f64();
    let away: Vec<f64> = scan.points().iter().map(|p| (numbers(x) - numbers(p)).norm()).collect();
    let least = away.iter().fold(f64::MAX, |m, a| m.min(*a)) / radius;
    if !(least > 1.0) || away.is_empty() {
        return 0.0;
    }
    let (mut sum, mut turns) = (0.0, 0.0);
    for away in away {
        let distance = (away / radius).powi(2) - 1.0;
        sum += 1.0 / distance;
        turns += (1.0 / away + 2.0 * (2.0 * away / (radius * radius)) / distance) / distance;
    }
    7.0 * turns / sum / (least * least) + 3.0 * 2.0 / (radius * least.powi(3))
}

/// |g| |r| / (g.r), with g.r as little as there may be left of it.
fn slant<S: Scalar, const D: usize>(o: &Obstacle<S, D>, x: &Vector<S, D>) -> f64 {
    let (g, r) = (numbers(&o.gradient(x)), numbers(&(x - o.reference())));
    // In a tree r leans towards the root's reference point by a share of h, which depends on where x is, down to a tenth of g.r.
    let h = o.hub().map_or_else(Vector::zeros, |hub| numbers(&(hub - o.reference())));
    let left = (g.dot(&r) - g.dot(&h)).max(0.1 * g.dot(&r)).min(g.dot(&r));
    g.norm() * (r.norm() + h.norm()) / left.max(1e-9)
}

/// |grad lambda|, 1/m, of the gauge lambda = Gamma^(1/2p).
fn steepness<S: Scalar, const D: usize>(o: &Obstacle<S, D>, x: &Vector<S, D>) -> f64 {
    let p = if let Shape::Ellipsoid { curvature, .. } = o.spec().shape { f64::from(curvature) } else { 1.0 };
    let gamma = o.gamma(x).to_f64();
    numbers(&o.gradient(x)).norm() * gamma.powf(0.5 / p - 1.0) / (2.0 * p)
}
