//! What is measured of a run.

use pliant_core::Status;

use super::drive::{Drive, Step};
use super::skill::Skill;
use crate::sim::TICK;

/// Mean speed over the time in which `within` holds, m/s; none if it never does.
pub fn mean_speed(drive: &Drive, within: impl Fn(&Step) -> bool) -> Option<f64> {
    // The first step stands: the robot has not been told anything yet.
    let (sum, count) = drive
        .steps
        .iter()
        .skip(1)
        .filter(|s| within(s))
        .fold((0.0, 0_u32), |(sum, count), s| (sum + s.velocity.norm(), count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

/// The speeds, m/s, by time, s, from when `within` first holds to when it last does.
pub fn profile(drive: &Drive, within: impl Fn(&Step) -> bool) -> Vec<(f64, f64)> {
    let first = drive.steps.iter().position(&within);
    let last = drive.steps.iter().rposition(&within);
    let (Some(first), Some(last)) = (first, last) else { return Vec::new() };
    drive.steps[first..=last].iter().enumerate().map(|(i, s)| (i as f64 * TICK, s.velocity.norm())).collect()
}

/// Mean and largest distance from the path without obstacles, m.
pub fn deviation(drive: &Drive, skill: &Skill) -> (f64, f64) {
    let all = drive.steps.iter().step_by(10).map(|s| skill.distance(&s.position));
    let (sum, most, count) = all.fold((0.0, 0.0_f64, 0_u32), |(sum, most, n), d| (sum + d, most.max(d), n + 1));
    (sum / f64::from(count.max(1)), most)
}

/// The largest change of velocity from one millisecond to the next, after the first, m/s.
pub fn largest_jump(drive: &Drive) -> f64 {
    drive.steps.windows(2).skip(1).map(|w| (w[1].velocity - w[0].velocity).norm()).fold(0.0, f64::max)
}

/// Root of the mean squared jerk, from velocities 10 ms apart, m/s^3.
pub fn jerk(drive: &Drive) -> f64 {
    const EVERY: usize = 10;
    let dt = EVERY as f64 * TICK;
    let kept: Vec<_> = drive.steps.iter().skip(1).step_by(EVERY).map(|s| s.velocity).collect();
    let squares: Vec<f64> = kept.windows(3).map(|w| ((w[2] - w[1] * 2.0 + w[0]) / (dt * dt)).norm_squared()).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

/// The share of ticks in which the guard changed the command.
pub fn guarded(drive: &Drive) -> f64 {
    let guarded = drive.steps.iter().filter(|s| s.status.contains(Status::GUARDED)).count();
    guarded as f64 / drive.steps.len().max(1) as f64
}

/// a over b, less one, in percent.
pub fn change_percent(a: f64, b: f64) -> f64 {
    (a / b - 1.0) * 100.0
}

/// The value below which a share of all lie; none of none.
pub fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    sorted.get((share * last as f64).round() as usize).copied()
}

/// In order, without what is no number.
pub fn sorted(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = values.into_iter().filter(|x| !x.is_nan()).collect();
    all.sort_by(f64::total_cmp);
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    /// Along x, with these speeds, one a millisecond; every other one in a layer.
    fn drive(speeds: impl IntoIterator<Item = f64>) -> Drive {
        let step = |(i, v): (usize, f64)| Step {
            position: Vector2::zeros(),
            velocity: Vector2::new(v, 0.0),
            gamma: 2.0 + i as f64,
            layers: u8::from(i % 2 == 1),
            status: if i == 3 { Status::GUARDED } else { Status::empty() },
        };
        Drive { steps: speeds.into_iter().enumerate().map(step).collect(), reached: true }
    }

    #[test]
    fn means_jumps_and_shares() {
        let d = drive([0.0, 1.0, 2.0, 5.0]);
        assert_eq!(mean_speed(&d, |_| true), Some(8.0 / 3.0));
        assert_eq!(mean_speed(&d, |s| s.layers > 0), Some(3.0));
        assert_eq!(mean_speed(&d, |s| s.layers > 1), None);
        assert_eq!(profile(&d, |s| s.layers > 0), [(0.0, 1.0), (0.001, 2.0), (0.002, 5.0)]);
        assert_eq!((largest_jump(&d), guarded(&d), d.min_gamma()), (3.0, 0.25, 2.0));
        assert!((change_percent(1.25, 1.0) - 25.0).abs() < 1e-12);
    }

    #[test]
    fn jerk_is_the_second_derivative_of_velocity() {
        // v = t^2/2: jerk 1. Steady acceleration: none.
        let t = |i: u32| f64::from(i) * TICK;
        assert!((jerk(&drive((0..500).map(|i| t(i) * t(i) / 2.0))) - 1.0).abs() < 1e-6);
        assert!(jerk(&drive((0..500).map(t))) < 1e-6);
    }

    #[test]
    fn quantiles_of_what_is_a_number() {
        let all = sorted([3.0, f64::NAN, 1.0, 2.0]);
        assert_eq!(all, [1.0, 2.0, 3.0]);
        assert_eq!((quantile(&all, 0.0), quantile(&all, 0.5), quantile(&all, 1.0)), (Some(1.0), Some(2.0), Some(3.0)));
        assert_eq!(quantile(&[], 0.5), None);
    }
}
