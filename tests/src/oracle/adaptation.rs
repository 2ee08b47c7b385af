//! The adaptive motion in soft layers, section 5.

use nalgebra::DVector;

use super::geometry::{cross, in_tangent_plane, length, turned_about_z, turned_left};
use super::scene::OracleSteering;

/// Depth of the soft layer, in Gamma_k, over which the push grows.
const FADE: f64 = 0.1;
/// Share of the nominal speed by which the tangential flow leans to the fixed side.
const LEAN: f64 = 0.01;
/// Share of the nominal speed below which the tangential direction is not a full unit.
const FLOOR: f64 = 0.02;
/// An intersection takes at most this share of the speed.
const SLOWEST: f64 = 0.8;

/// A Gamma_k below counts as this.
const DEEPEST: f64 = 1e-9;
/// A push above counts as this, m/s.
const HARDEST: f64 = 1e6;

/// What the adaptive motion has to know about an obstacle.
pub(super) struct Layer {
    pub(super) gamma_soft: f64,
    /// Gamma > 1 and Gamma_k <= 1.
    pub(super) soft_here: bool,
    pub(super) normal: DVector<f64>,
    /// From the reference point, unit length.
    pub(super) radius: DVector<f64>,
    /// theta_1, rad.
    pub(super) heading: f64,
    /// a, in space.
    pub(super) leaning: DVector<f64>,
}

impl Layer {
    /// phi
    pub(super) fn fade(&self) -> f64 {
        if self.soft_here { ((1.0 - self.gamma_soft) / FADE).clamp(0.0, 1.0) } else { 0.0 }
    }
}

/// cos(theta - theta_1), whose sign is S.
pub(super) fn alignment(layer: &Layer, angle: f64) -> f64 {
    (angle - layer.heading).cos()
}

/// The velocity with the pushes of the soft layers.
pub(super) fn adapt(
    u: &DVector<f64>,
    f: &DVector<f64>,
    layers: &[Layer],
    steering: OracleSteering,
    gain: f64,
) -> DVector<f64> {
    match steering {
        OracleSteering::Fixed { angle } => fixed(u, layers, angle, gain),
        OracleSteering::WithFlow { beta } => with_flow(u, f, layers, gain, beta),
    }
}

/// c (2 / (Gamma_k,n + Gamma_k,m))^2
fn shared_gain(a: &Layer, b: &Layer, gain: f64) -> f64 {
    push(gain, 0.5 * (depth(a) + depth(b)))
}

/// Gamma_k as it is counted.
fn depth(layer: &Layer) -> f64 {
    layer.gamma_soft.max(DEEPEST)
}

/// c / Gamma^2 as it is counted.
fn push(gain: f64, gamma: f64) -> f64 {
    (gain / gamma.powi(2)).min(HARDEST)
}

fn fixed(u: &DVector<f64>, layers: &[Layer], angle: f64, gain: f64) -> DVector<f64> {
    let aside = |layer: &Layer| {
        let sign = if alignment(layer, angle) < -1e-6 { -1.0 } else { 1.0 };
        turned_about_z(&layer.radius, angle) * sign
    };
    let soft: Vec<&Layer> = layers.iter().filter(|layer| layer.soft_here).collect();
    match soft.as_slice() {
        [] => u.clone(),
        [only] => u + aside(only) * push(gain, depth(only)),
        several => {
            let mut slowed = u.clone();
            for (n, own) in several.iter().enumerate() {
                // All partners of n share the direction, so their gains add up.
                let partners: f64 =
                    several.iter().enumerate().filter(|(m, _)| *m != n).map(|(_, m)| shared_gain(own, m, gain)).sum();
                slowed -= in_tangent_plane(&aside(own), &own.normal) * partners;
            }
            slowed
        }
    }
}

/// The direction of the flow in the tangent plane, with a lean to a fixed side; below full length where there
/// is hardly any tangential flow.
fn tangential(u: &DVector<f64>, layer: &Layer, nominal_speed: f64) -> DVector<f64> {
    let normal = &layer.normal;
    let side = if normal.len() == 2 { turned_left(normal) } else { cross(&layer.leaning, normal) };
    let t = in_tangent_plane(u, normal) + side * (LEAN * nominal_speed);
    let norm = length(&t).max(FLOOR * nominal_speed);
    t / norm
}

fn with_flow(u: &DVector<f64>, f: &DVector<f64>, layers: &[Layer], gain: f64, beta: f64) -> DVector<f64> {
    let nominal_speed = length(f);
    if nominal_speed == 0.0 {
        return u.clone();
    }
    let most = beta * nominal_speed;
    let active: Vec<(&Layer, f64)> =
        layers.iter().map(|layer| (layer, layer.fade())).filter(|(_, phi)| *phi > 0.0).collect();
    let directions: Vec<DVector<f64>> = active.iter().map(|(layer, _)| tangential(u, layer, nominal_speed)).collect();
    let mut speed_up = DVector::zeros(u.len());
    let mut slow_down = DVector::zeros(u.len());
    for (n, (own, phi)) in active.iter().enumerate() {
        let alone: f64 =
            active.iter().enumerate().filter(|(m, _)| *m != n).map(|(_, (_, other))| 1.0 - other).product();
        speed_up += &directions[n] * (most.min(push(gain, depth(own))) * phi * alone);
        for (m, (other, other_phi)) in active.iter().enumerate().skip(n + 1) {
            // The two orders of a pair differ in the direction only.
            let size = most.min(shared_gain(own, other, gain)) * phi * other_phi;
            slow_down += (&directions[n] + &directions[m]) * size;
        }
    }
    // A share of the whole flow is taken, at most SLOWEST of it.
    let share = if slow_down.amax() > 0.0 { (length(&slow_down) / length(u)).min(SLOWEST) } else { 0.0 };
    u * (1.0 - share) + speed_up
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn v(values: &[f64]) -> DVector<f64> {
        DVector::from_column_slice(values)
    }

    fn layer(gamma_soft: f64, normal: &[f64]) -> Layer {
        let leaning = v(&[1.0, 2.0, 2.0]) / 3.0;
        Layer { gamma_soft, soft_here: gamma_soft <= 1.0, normal: v(normal), radius: v(normal), heading: 0.0, leaning }
    }

    const WITH_FLOW: OracleSteering = OracleSteering::WithFlow { beta: 1.0 };

    #[test]
    fn alone_the_push_speeds_up_along_the_flow() {
        // Full depth, Gamma_k = 1/2: c * 4 = 0.4, below |f| = 1, along the flow past the obstacle.
        let f = v(&[1.0, 0.0]);
        let pushed = adapt(&f, &f, &[layer(0.5, &[0.0, 1.0])], WITH_FLOW, 0.1);
        assert!((pushed - v(&[1.4, 0.0])).amax() < 1e-15);
        // The cap: beta |f|.
        let capped = adapt(&f, &f, &[layer(0.5, &[0.0, 1.0])], OracleSteering::WithFlow { beta: 0.25 }, 0.1);
        assert!((capped - v(&[1.25, 0.0])).amax() < 1e-15);
        // Half way into the fading band.
        let faded = adapt(&f, &f, &[layer(0.95, &[0.0, 1.0])], WITH_FLOW, 0.1);
        assert!((faded - v(&[1.0 + 0.05 / 0.9025, 0.0])).amax() < 1e-14);
    }

    #[test]
    fn head_on_the_push_is_half_and_to_the_left_of_the_normal() {
        // No tangential flow: t = 0.01 |f| e against a floor of 0.02 |f|.
        let f = v(&[1.0, 0.0]);
        let pushed = adapt(&f, &f, &[layer(0.5, &[-1.0, 0.0])], WITH_FLOW, 0.1);
        assert!((pushed - v(&[1.0, -0.2])).amax() < 1e-15);
        // In space (1, 2, 2)/3 x (-1, 0, 0) = (0, -2, 2)/3.
        let f = v(&[1.0, 0.0, 0.0]);
        let pushed = adapt(&f, &f, &[layer(0.5, &[-1.0, 0.0, 0.0])], WITH_FLOW, 0.1);
        assert!((pushed - v(&[1.0, -0.4 / 3.0, 0.4 / 3.0])).amax() < 1e-15);
    }

    #[test]
    fn an_intersection_slows_down() {
        // Between two obstacles: the same tangential flow of both, each c (2 / (1/2 + 1/2))^2 = 0.2, twice.
        let f = v(&[1.0, 0.0]);
        let pair = [layer(0.5, &[0.0, 1.0]), layer(0.5, &[0.0, -1.0])];
        let slowed = adapt(&f, &f, &pair, WITH_FLOW, 0.05);
        assert!((slowed - v(&[0.6, 0.0])).amax() < 1e-15);
        // A large gain leaves a fifth.
        let slowest = adapt(&f, &f, &pair, WITH_FLOW, 5.0);
        assert!((slowest - v(&[0.2, 0.0])).amax() < 1e-15);
        // One of them half faded: half of its own speed-up is gone, half of the slow-down is there.
        let half = [layer(0.5, &[0.0, 1.0]), layer(0.95, &[0.0, -1.0])];
        let mixed = adapt(&f, &f, &half, WITH_FLOW, 0.05);
        let expected = 1.0 + 0.05 * 4.0 * 0.5 - 2.0 * 0.05 * (2.0_f64 / 1.45).powi(2) * 0.5;
        assert!((mixed - v(&[expected, 0.0])).amax() < 1e-14);
    }

    #[test]
    fn pushes_of_an_intersection_add_as_vectors_and_slow_the_flow_as_it_is() {
        // Normals (0, 1) and (1, 0), u = (3, 4): tangential parts (3, 0) and (0, 4), leaning by 0.01 |f| = 0.05
        // to (-1, 0) and (0, 1), which does not turn them. c (2 / 1.25)^2 = 0.256 along each.
        let f = v(&[3.0, 4.0]);
        let pair = [layer(0.5, &[0.0, 1.0]), layer(0.75, &[1.0, 0.0])];
        let slowed = adapt(&f, &f, &pair, WITH_FLOW, 0.1);
        let share = 0.256 * 2.0_f64.sqrt() / 5.0;
        assert!((slowed - v(&[3.0, 4.0]) * (1.0 - share)).amax() < 1e-15);
    }

    #[test]
    fn a_slow_flow_is_pushed_in_proportion() {
        let f = v(&[1.0, 0.0]);
        for normal in [[0.0, 1.0], [-0.6, 0.8], [-1.0, 0.0]] {
            let full = adapt(&f, &f, &[layer(0.5, &normal)], WITH_FLOW, 0.1);
            let slow = adapt(&(&f * 1e-6), &(&f * 1e-6), &[layer(0.5, &normal)], WITH_FLOW, 1e-7);
            assert!((full - slow * 1e6).amax() < 1e-14);
        }
    }

    #[test]
    fn no_push_without_a_nominal_motion() {
        let u = v(&[0.3, 0.1]);
        assert_eq!(adapt(&u, &v(&[0.0, 0.0]), &[layer(0.5, &[0.0, 1.0])], WITH_FLOW, 0.1), u);
    }

    #[test]
    fn the_fixed_push_by_hand() {
        let u = v(&[1.0, 0.0]);
        // theta = 60 degrees, S = +1, the radius turned from +y to (-sin 60, cos 60); c / Gamma_k^2 = 0.4.
        let angle = 60.0_f64.to_radians();
        let above = layer(0.5, &[0.0, 1.0]);
        let pushed = adapt(&u, &u, &[above], OracleSteering::Fixed { angle }, 0.1);
        assert!((pushed - v(&[1.0 - 0.4 * angle.sin(), 0.4 * angle.cos()])).amax() < 1e-15);
        // An axis at 180 degrees turns the sign.
        let turned = Layer { heading: std::f64::consts::PI, ..layer(0.5, &[0.0, 1.0]) };
        let pushed = adapt(&u, &u, &[turned], OracleSteering::Fixed { angle }, 0.1);
        assert!((pushed - v(&[1.0 + 0.4 * angle.sin(), -0.4 * angle.cos()])).amax() < 1e-15);
    }

    #[test]
    fn the_fixed_slow_down_keeps_to_the_tangents() {
        let u = v(&[1.0, 0.0]);
        let angle = 60.0_f64.to_radians();
        // Normals (0, 1) and (1, 0): pushes turned by 60 degrees are (-sin, cos) and (cos, sin) of it; their
        // tangential parts (-sin, 0) and (0, sin), each times c (2 / 1.25)^2.
        let pair = [layer(0.5, &[0.0, 1.0]), layer(0.75, &[1.0, 0.0])];
        let slowed = adapt(&u, &u, &pair, OracleSteering::Fixed { angle }, 0.1);
        let part = 0.1 * 1.6 * 1.6 * angle.sin();
        assert!((slowed - v(&[1.0 + part, -part])).amax() < 1e-15);
        // A third obstacle that is not soft here changes nothing.
        let three = [layer(0.5, &[0.0, 1.0]), layer(1.5, &[0.6, 0.8]), layer(0.75, &[1.0, 0.0])];
        let slowed = adapt(&u, &u, &three, OracleSteering::Fixed { angle }, 0.1);
        assert!((slowed - v(&[1.0 + part, -part])).amax() < 1e-15);
    }

    #[test]
    fn the_fixed_angle_turns_about_z_in_space() {
        let u = v(&[0.0, 0.0, 0.0]);
        let pushed = adapt(&u, &u, &[layer(0.5, &[0.6, 0.0, 0.8])], OracleSteering::Fixed { angle: 1.0 }, 0.25);
        assert!((pushed - v(&[0.6 * 1.0_f64.cos(), 0.6 * 1.0_f64.sin(), 0.8])).amax() < 1e-15);
        // A right angle to the first axis counts as +1.
        let aligned = Layer { heading: FRAC_PI_2, ..layer(0.5, &[1.0, 0.0, 0.0]) };
        assert!(alignment(&aligned, 0.0).abs() < 1e-15);
    }
}
