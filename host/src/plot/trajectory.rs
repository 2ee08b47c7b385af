//! Where a robot went, and how fast.

use nalgebra::Vector3;

use crate::sim::Runs;

/// A point of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectoryPoint {
    /// s
    pub time: f64,
    /// m
    pub position: Vector3<f64>,
    /// m/s
    pub speed: f64,
}

/// A trajectory, by increasing time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trajectory {
    /// Its points.
    pub points: Vec<TrajectoryPoint>,
}

impl Trajectory {
    /// From positions (m) at equal intervals (s), with the speeds between them.
    pub fn from_positions(positions: &[Vector3<f64>], interval: f64) -> Self {
        let last = positions.len().saturating_sub(2);
        let point = |(i, position): (usize, &Vector3<f64>)| {
            let speed = positions.windows(2).nth(i.min(last)).map_or(0.0, |w| (w[1] - w[0]).norm() / interval);
            TrajectoryPoint { time: i as f64 * interval, position: *position, speed }
        };
        Self { points: positions.iter().enumerate().map(point).collect() }
    }

    /// The time of its last point, s.
    pub fn duration(&self) -> f64 {
        self.points.last().map_or(0.0, |p| p.time)
    }
}

/// The trajectories of simulated runs.
pub fn trajectories(runs: &Runs) -> Vec<Trajectory> {
    let point =
        |p: &crate::sim::PathPoint| TrajectoryPoint { time: p.time, position: p.position, speed: p.velocity.norm() };
    runs.runs.iter().map(|run| Trajectory { points: run.path.iter().map(point).collect() }).collect()
}

/// The range of speeds of a colour scale, up to a number of two digits; none without motion.
pub(super) fn speeds(trajectories: &[Trajectory]) -> Option<(f64, f64)> {
    let highest = trajectories.iter().flat_map(|t| &t.points).map(|p| p.speed).fold(0.0, f64::max);
    if !(highest > 0.0 && highest.is_finite()) {
        return None;
    }
    let digit = 10f64.powf(highest.log10().floor() - 1.0);
    // What rounding has put a hair above a limit is not to add a tick.
    Some((0.0, (highest / digit - 1e-6).ceil() * digit))
}
