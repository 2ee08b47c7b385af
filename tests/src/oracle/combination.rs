//! Several obstacles, section 4: weights, and a mean of rotations away from the nominal direction.

use std::f64::consts::PI;

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

/// One velocity from several, each with its weight.
pub(super) struct Combined {
    pub(super) velocity: DVector<f64>,
    /// How far the velocity that turns most is from the exact opposite of f, rad.
    pub(super) to_opposite: f64,
}

/// The weighted mean of the speeds, along f turned by the weighted mean of the rotations.
pub(super) fn combine(f: &DVector<f64>, velocities: &[DVector<f64>], weights: &[f64]) -> Combined {
    let d = f.len();
    let weighted = || velocities.iter().zip(weights);
    let Some(forward) = unit(f) else {
        let velocity = weighted().fold(DVector::zeros(d), |sum, (v, w)| sum + v * *w);
        return Combined { velocity, to_opposite: PI };
    };
    let speed: f64 = weighted().map(|(v, w)| w * length(v)).sum();
    let to_opposite = weighted().filter(|(_, w)| **w > 0.0).map(|(v, _)| PI - angle_between(f, v)).fold(PI, f64::min);
    let direction = if d == 2 {
        let turn: f64 = weighted().map(|(v, w)| w * plane_turn(&forward, v)).sum();
        turned_about_z(&forward, turn)
    } else {
        let turn = weighted().fold(DVector::zeros(d), |sum, (v, w)| sum + space_turn(&forward, v) * *w);
        turned_about(&forward, &turn)
    };
    Combined { velocity: direction * speed, to_opposite }
}

/// The signed angle that turns `forward` to v; +pi for the exact opposite.
fn plane_turn(forward: &DVector<f64>, v: &DVector<f64>) -> f64 {
    let across = plane_cross(forward, v);
    let along = forward.dot(v);
    if across == 0.0 {
        return if along < 0.0 { PI } else { 0.0 };
    }
    across.atan2(along)
}

/// The rotation (axis times angle) that turns `forward` to v.
fn space_turn(forward: &DVector<f64>, v: &DVector<f64>) -> DVector<f64> {
    if let Some(axis) = unit(&cross(forward, v)) {
        // Near the opposite the product is small, and its rounding need not be across `forward`.
        let across = &axis - forward * forward.dot(&axis);
        return across * angle_between(forward, v);
    }
    if forward.dot(v) >= 0.0 {
        return DVector::zeros(3);
    }
    // Half a turn through the fixed side, z x forward, or y x forward where forward is along z.
    let side = |axis: [f64; 3]| unit(&cross(&DVector::from_column_slice(&axis), forward));
    let side = side([0.0, 0.0, 1.0]).or_else(|| side([0.0, 1.0, 0.0]));
    side.map_or_else(|| DVector::zeros(3), |side| cross(forward, &side) * PI)
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
        assert!((mean.velocity - v(&[1.0, 0.0])).amax() < 1e-15);
        let mean = combine(&v(&[0.0, 0.0, 1.0]), &[v(&[0.0, 2.0, 0.0]), v(&[0.0, 0.0, 3.0])], &[0.5, 0.5]);
        // Speed 2.5, half of a right angle.
        let part = 2.5 * std::f64::consts::FRAC_1_SQRT_2;
        assert!((mean.velocity - v(&[0.0, part, part])).amax() < 1e-14);
    }

    #[test]
    fn the_mean_of_one_velocity_is_that_velocity() {
        let f = v(&[0.3, -0.8, 0.4]);
        for own in [v(&[0.1, 0.9, -0.3]), v(&[0.3, -0.8, 0.4 + 1e-9]), v(&[-0.3, 0.8, -0.4 + 1e-7])] {
            assert!((combine(&f, std::slice::from_ref(&own), &[1.0]).velocity - own).amax() < 1e-13);
        }
    }

    #[test]
    fn the_exact_opposite_turns_over_the_fixed_side() {
        let f = v(&[1.0, 0.0]);
        let both = [v(&[-1.0, 0.0]), v(&[1.0, 0.0])];
        let half = combine(&f, &both, &[0.5, 0.5]);
        assert!((half.velocity - v(&[0.0, 1.0])).amax() < 1e-15);
        assert_eq!(half.to_opposite, 0.0);
        // z x (1, 0, 0) = (0, 1, 0), and y x (0, 0, 1) = (1, 0, 0).
        let x = v(&[1.0, 0.0, 0.0]);
        assert!((combine(&x, &[-&x, x.clone()], &[0.5, 0.5]).velocity - v(&[0.0, 1.0, 0.0])).amax() < 1e-15);
        let z = v(&[0.0, 0.0, 1.0]);
        assert!((combine(&z, &[-&z, z.clone()], &[0.5, 0.5]).velocity - v(&[1.0, 0.0, 0.0])).amax() < 1e-15);
        let all = combine(&f, &[both[0].clone()], &[1.0]);
        assert!((all.velocity - &both[0]).amax() < 1e-15);
    }

    #[test]
    fn a_standing_velocity_only_lowers_the_speed() {
        let f = v(&[1.0, 0.0]);
        let mean = combine(&f, &[v(&[0.0, 0.0]), v(&[0.0, 2.0])], &[0.5, 0.5]);
        // Speed 1, a quarter of a right angle counts half: 45 degrees.
        assert!((mean.velocity - v(&[1.0, 1.0]) * std::f64::consts::FRAC_1_SQRT_2).amax() < 1e-15);
    }

    #[test]
    fn without_a_nominal_direction_the_velocities_are_averaged() {
        let mean = combine(&v(&[0.0, 0.0]), &[v(&[1.0, 0.0]), v(&[0.0, 2.0])], &[0.25, 0.75]);
        assert_eq!(mean.velocity.as_slice(), &[0.25, 1.5]);
    }
}
