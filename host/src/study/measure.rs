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
