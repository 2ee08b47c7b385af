//! What is measured of a run.

use pliant_core::Status;

#[cfg(doc)]
use super::drive::Robot;
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

/// The largest change of velocity from one millisecond to the next, after so many ([`Robot::ramp`]), m/s.
pub fn largest_jump(drive: &Drive, ramp: usize) -> f64 {
    drive.steps.windows(2).skip(ramp).map(|w| (w[1].velocity - w[0].velocity).norm()).fold(0.0, f64::max)
}

/// Root of the mean squared jerk after so many milliseconds ([`Robot::ramp`]), from velocities 10 ms apart, m/s^3.
pub fn jerk(drive: &Drive, ramp: usize) -> f64 {
    const EVERY: usize = 10;
    let dt = EVERY as f64 * TICK;
    let kept: Vec<_> = drive.steps.iter().skip(ramp).step_by(EVERY).map(|s| s.velocity).collect();
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

/// Spearman's rank correlation: 1 where the second of each pair rises with the first, -1 where it falls, near 0 where neither; equal values share their
/// mean rank. None of fewer than three pairs, or where all values of a side are equal.
pub fn rank_correlation(pairs: &[(f64, f64)]) -> Option<f64> {
    let ranks = |of: &dyn Fn(&(f64, f64)) -> f64| -> Vec<f64> {
        let rank = |x: f64| {
            let below = pairs.iter().filter(|p| of(p) < x).count();
            let equal = pairs.iter().filter(|p| of(p) == x).count();
            // Less the mean of all.
            below as f64 + (equal as f64 - pairs.len() as f64) / 2.0
        };
        pairs.iter().map(|p| rank(of(p))).collect()
    };
    let (a, b) = (ranks(&|p| p.0), ranks(&|p| p.1));
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let size = (dot(&a, &a) * dot(&b, &b)).sqrt();
    (pairs.len() > 2 && size > 0.0).then(|| dot(&a, &b) / size)
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
        assert_eq!((largest_jump(&d, 1), guarded(&d), d.min_gamma()), (3.0, 0.25, 2.0));
        assert!((change_percent(1.25, 1.0) - 25.0).abs() < 1e-12);
    }

    #[test]
    fn a_start_from_rest_is_no_jump() {
        use crate::sim::PointRobot;
        use crate::study::drive::Robot;
        // Told to go at 1 m/s all the time; in between a jump of 2 mm/s.
        let lag = |i: u32| 1.0 - (-f64::from(i) * TICK / PointRobot::LAG).exp();
        let d = drive((0..500).map(|i| lag(i) + if i < 300 { 0.0 } else { 0.002 }));
        assert!(largest_jump(&d, 1) > 0.05 && (largest_jump(&d, Robot::Lagging.ramp()) - 0.002).abs() < 1e-5);
        assert!(jerk(&d, 1) > 50.0 * jerk(&d, Robot::Lagging.ramp()));
        // One that follows exactly is up to speed at once.
        let d = drive((0..500).map(|i| if i == 0 { 0.0 } else { 1.0 }));
        assert_eq!((largest_jump(&d, 0), largest_jump(&d, Robot::Exact.ramp())), (1.0, 0.0));
    }

    #[test]
    fn jerk_is_the_second_derivative_of_velocity() {
        // v = t^2/2: jerk 1. Steady acceleration: none.
        let t = |i: u32| f64::from(i) * TICK;
        assert!((jerk(&drive((0..500).map(|i| t(i) * t(i) / 2.0)), 1) - 1.0).abs() < 1e-6);
        assert!(jerk(&drive((0..500).map(t)), 1) < 1e-6);
    }

    #[test]
    fn ranks_correlate_by_order_alone() {
        let pairs = |y: [f64; 5]| [1.0, 2.0, 4.0, 8.0, 9.0].into_iter().zip(y).collect::<Vec<_>>();
        let near = |y, r: f64| (rank_correlation(&pairs(y)).unwrap() - r).abs() < 1e-12;
        assert!(near([0.0, 1.0, 1e3, 1e4, 1e9], 1.0) && near([5.0, 4.0, 3.0, 2.0, 1.0], -1.0));
        // 1 - 6 * (1 + 1 + 0 + 1 + 1) / (5 * 24) without ties; with two equal ones by Pearson's formula on ranks 1, 2.5, 2.5, 4, 5.
        assert!(near([2.0, 1.0, 3.0, 5.0, 4.0], 0.8) && near([1.0, 2.0, 2.0, 3.0, 4.0], 9.5 / (10.0 * 9.5_f64).sqrt()));
        assert_eq!((rank_correlation(&pairs([1.0; 5])), rank_correlation(&pairs([0.0; 5])[..2])), (None, None));
    }

    #[test]
    fn quantiles_of_what_is_a_number() {
        let all = sorted([3.0, f64::NAN, 1.0, 2.0]);
        assert_eq!(all, [1.0, 2.0, 3.0]);
        assert_eq!((quantile(&all, 0.0), quantile(&all, 0.5), quantile(&all, 1.0)), (Some(1.0), Some(2.0), Some(3.0)));
        assert_eq!(quantile(&[], 0.5), None);
    }
}
