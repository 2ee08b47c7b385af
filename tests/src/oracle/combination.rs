//! Several obstacles, section 4: weights, and a mean of rotations away from the nominal direction.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::DVector;

use super::geometry::{angle_between, cross, length, plane_cross, turned_about, turned_about_z, unit};

/// w_n = 1 / sum_m (Gamma_n - 1)/(Gamma_m - 1); inside a core, equal shares of the cores that hold x.
pub(super) fn weights(gammas: &[f64]) -> Vec<f64> {
    let inside = gammas.iter().filter(|gamma| **gamma <= 1.0).count();
    gammas
        .iter()
        .map(|own| {
            if inside == 0 {
                1.0 / gammas.iter().map(|other| (own - 1.0) / (other - 1.0)).sum::<f64>()
            } else if *own <= 1.0 {
                1.0 / inside as f64
            } else {
                0.0
            }
        })
        .collect()
}

/// Tangent of the angle to the exact opposite of f below which the mean of angles fades.
const TURNING: f64 = 0.3;
/// Share of the mean speed below which f is too slow to turn from.
const SLOW: f64 = 0.05;

/// The weighted mean of the speeds, along f turned by the weighted mean of the rotations; where there is hardly a rotation
/// to speak of, the weighted mean of the velocities.
pub(super) fn combine(f: &DVector<f64>, velocities: &[DVector<f64>], weights: &[f64]) -> DVector<f64> {
    let d = f.len();
    let weighted = || velocities.iter().zip(weights);
    let plain = weighted().fold(DVector::zeros(d), |sum, (v, w)| sum + v * *w);
    let Some(forward) = unit(f) else {
        return plain;
    };
    let speed: f64 = weighted().map(|(v, w)| w * length(v)).sum();
    if speed == 0.0 {
        return plain;
    }
    let direction = if d == 2 {
        let turn: f64 = weighted().map(|(v, w)| w * plane_turn(&forward, v)).sum();
        turned_about_z(&forward, turn)
    } else {
        let turn = weighted().fold(DVector::zeros(d), |sum, (v, w)| sum + space_turn(&forward, v) * *w);
        turned_about(&forward, &turn)
    };
    let back = velocities.iter().map(|v| backwards(f, v)).fold(0.0, f64::max);
    let still = 1.0 - length(f) / (SLOW * speed);
    let share = back.max(still);
    direction * (speed * (1.0 - share)) + plain * share
}

/// How near a velocity is to the exact opposite of f: 1 there, 0 from an angle whose tangent is [`TURNING`].
fn backwards(f: &DVector<f64>, v: &DVector<f64>) -> f64 {
    let short = PI - angle_between(f, v);
    if short < FRAC_PI_2 { (1.0 - short.tan() / TURNING).max(0.0) } else { 0.0 }
}

/// The signed angle that turns `forward` to v.
fn plane_turn(forward: &DVector<f64>, v: &DVector<f64>) -> f64 {
    let across = plane_cross(forward, v);
    if across == 0.0 { 0.0 } else { across.atan2(forward.dot(v)) }
}

/// The rotation (axis times angle) that turns `forward` to v.
fn space_turn(forward: &DVector<f64>, v: &DVector<f64>) -> DVector<f64> {
    let Some(axis) = unit(&cross(forward, v)) else {
        return DVector::zeros(3);
    };
    // Near the opposite the product is small, and its rounding need not be across `forward`.
    let across = &axis - forward * forward.dot(&axis);
    across * angle_between(forward, v)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn v(values: &[f64]) -> DVector<f64> {
        DVector::from_column_slice(values)
    }

    #[test]
    fn weights_by_hand() {
        assert_eq!(weights(&[3.0, 3.0]), vec![0.5, 0.5]);
        // 1/3, 1/1.25, 1/1 are as 20, 48, 60.
        let three = weights(&[4.0, 2.25, 2.0]);
        for (weight, expected) in three.iter().zip([20.0 / 128.0, 48.0 / 128.0, 60.0 / 128.0]) {
            assert!((weight - expected).abs() < 1e-15);
        }
        // On the boundary an obstacle has all the weight; inside, it is shared.
        assert_eq!(weights(&[1.0, 5.0]), vec![1.0, 0.0]);
        assert_eq!(weights(&[0.2, 5.0, 1.0, 1.5]), vec![0.5, 0.0, 0.5, 0.0]);
        let close = weights(&[1.0 + 1e-9, 3.0]);
        assert!((close[0] - 1.0).abs() < 1e-9 && close[1] < 1e-9);
        // No product is formed that could overflow.
        let far = weights(&[9e14; 40]);
        assert!((far.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn opposite_turns_cancel() {
        let f = v(&[2.0, 0.0]);
        let mean = combine(&f, &[v(&[0.6, 0.8]), v(&[0.6, -0.8])], &[0.5, 0.5]);
        assert!((mean - v(&[1.0, 0.0])).amax() < 1e-15);
        let mean = combine(&v(&[0.0, 0.0, 1.0]), &[v(&[0.0, 2.0, 0.0]), v(&[0.0, 0.0, 3.0])], &[0.5, 0.5]);
        // Speed 2.5, half of a right angle.
        let part = 2.5 * std::f64::consts::FRAC_1_SQRT_2;
        assert!((mean - v(&[0.0, part, part])).amax() < 1e-14);
    }

    #[test]
    fn the_mean_of_one_velocity_is_that_velocity() {
        let f = v(&[0.3, -0.8, 0.4]);
        let back = -&f;
        for own in [v(&[0.1, 0.9, -0.3]), v(&[0.3, -0.8, 0.4 + 1e-9]), v(&[-0.3, 0.8, -0.4 + 1e-7]), back] {
            assert!((combine(&f, std::slice::from_ref(&own), &[1.0]) - own).amax() < 1e-13);
        }
    }

    #[test]
    fn the_exact_opposite_is_a_plain_mean() {
        for f in [v(&[1.0, 0.0]), v(&[0.0, 0.6, 0.8])] {
            let half = combine(&f, &[-&f, &f * 3.0], &[0.25, 0.75]);
            assert!((half - &f * 2.0).amax() < 1e-15);
        }
    }

    #[test]
    fn half_way_to_the_opposite_both_means_count_alike() {
        // |t|/|cos| = 0.15: z = 1/2. The speeds are 1, the turns pi - atan(0.15) and 0.
        let f = v(&[1.0, 0.0]);
        let short = 0.15_f64.atan();
        let other = v(&[-short.cos(), short.sin()]);
        let turn = (PI - short) / 2.0;
        let expected = (v(&[turn.cos(), turn.sin()]) + (&f + &other) / 2.0) / 2.0;
        assert!((combine(&f, &[other.clone(), f.clone()], &[0.5, 0.5]) - expected).amax() < 1e-15);
        // No longer than 0.3: nothing fades.
        assert_eq!(backwards(&f, &v(&[-1.0, 0.31])), 0.0);
        assert!((backwards(&f, &v(&[-1.0, 0.1])) - 2.0 / 3.0).abs() < 1e-14);
        assert_eq!(backwards(&f, &v(&[0.0, 1.0])), 0.0);
    }

    #[test]
    fn from_either_side_of_the_opposite_comes_the_same() {
        let f = v(&[1.0, 0.0]);
        let near = |t: f64| combine(&f, &[v(&[-1.0, t]), v(&[0.5, 0.5])], &[0.5, 0.5]);
        assert!((near(1e-9) - near(-1e-9)).amax() < 1e-7);
        assert!((near(1e-9) - near(0.0)).amax() < 1e-7);
    }

    #[test]
    fn a_slow_nominal_motion_fades_too() {
        // Speed 2, |f| = 0.05: half of 0.05 times the speed.
        let f = v(&[0.05, 0.0]);
        let expected = v(&[1.0, 1.0]) * (2.0 * std::f64::consts::FRAC_1_SQRT_2) / 2.0 + v(&[1.0, 1.0]) / 2.0;
        assert!((combine(&f, &[v(&[2.0, 0.0]), v(&[0.0, 2.0])], &[0.5, 0.5]) - expected).amax() < 1e-14);
    }

    #[test]
    fn a_standing_velocity_only_lowers_the_speed() {
        let f = v(&[1.0, 0.0]);
        let mean = combine(&f, &[v(&[0.0, 0.0]), v(&[0.0, 2.0])], &[0.5, 0.5]);
        // Speed 1, a quarter of a right angle counts half: 45 degrees.
        assert!((mean - v(&[1.0, 1.0]) * std::f64::consts::FRAC_1_SQRT_2).amax() < 1e-15);
        assert_eq!(combine(&f, &[v(&[0.0, 0.0]), v(&[0.0, 0.0])], &[0.5, 0.5]).as_slice(), &[0.0, 0.0]);
    }

    #[test]
    fn without_a_nominal_direction_the_velocities_are_averaged() {
        let mean = combine(&v(&[0.0, 0.0]), &[v(&[1.0, 0.0]), v(&[0.0, 2.0])], &[0.25, 0.75]);
        assert_eq!(mean.as_slice(), &[0.25, 1.5]);
    }
}
