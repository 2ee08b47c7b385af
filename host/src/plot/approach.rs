//! How near robots come to hard cores, and the moments at which a scene that changes is drawn.

use nalgebra::Vector3;

use super::Trajectory;
use super::outline::nearest;
use super::trajectory::TrajectoryPoint;
use crate::scene::{PosedObstacle, Scene};

/// A robot and the place of a hard core's surface that is nearest to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// s
    pub time: f64,
    /// m
    pub robot: Vector3<f64>,
    /// m
    pub surface: Vector3<f64>,
    /// Is the robot in the core?
    pub inside: bool,
}

impl Clearance {
    /// m; below zero inside.
    pub fn distance(&self) -> f64 {
        let apart = (self.robot - self.surface).norm();
        if self.inside { -apart } else { apart }
    }

    /// As it is written in a figure.
    pub fn label(&self) -> String {
        let apart = match self.distance().abs() {
            d if d < 0.00995 => format!("{:.1} mm", d * 1e3),
            d if d < 0.9995 => format!("{:.0} mm", d * 1e3),
            d => format!("{d:.2} m"),
        };
        if self.inside { format!("{apart} inside") } else { apart }
    }
}

/// A moment that is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// s
    pub time: f64,
    /// What is drawn thick of a path begins this long before, s; none where all of it is, because nothing changes.
    pub tail: Option<f64>,
}

/// Most moments of a scene that changes.
const MOMENTS: usize = 4;
/// Most points of a path that are looked at.
const LOOKED_AT: usize = 400;

/// Where a robot at one place is nearest to the hard cores at a time; none without any.
pub fn clearance(scene: &Scene, p: &TrajectoryPoint) -> Option<Clearance> {
    let found = scene.obstacles_at(p.time).fold(None, |best, o| nearer(best, &o, p));
    let scan = scene.scan().into_iter().flat_map(|scan| {
        scan.points().iter().map(|c| c + (p.position - c).try_normalize(0.0).unwrap_or_default() * scan.radius())
    });
    let inside = scene.scan().is_some_and(|scan| scan.gamma(&p.position) < 1.0);
    let scan = scan.map(|surface| Clearance { time: p.time, robot: p.position, surface, inside });
    found.into_iter().chain(scan).min_by(|a, b| a.distance().total_cmp(&b.distance()))
}

/// The nearest approach of a whole path to any core.
pub fn nearest_approach(scene: &Scene, trajectory: &Trajectory) -> Option<Clearance> {
    looked_at(trajectory).filter_map(|p| clearance(scene, p)).min_by(|a, b| a.distance().total_cmp(&b.distance()))
}

fn looked_at(trajectory: &Trajectory) -> impl Iterator<Item = &TrajectoryPoint> {
    trajectory.points.iter().step_by(trajectory.points.len() / LOOKED_AT + 1)
}

/// The nearer one of what was found and an obstacle.
fn nearer(best: Option<Clearance>, o: &PosedObstacle<'_>, p: &TrajectoryPoint) -> Option<Clearance> {
    // What is around it is not looked at where even that is too far away.
    let at_least = (p.position - o.pose.center).norm() - o.shape.extent().norm();
    if !o.obstacle.is_wall() && best.is_some_and(|b| b.distance() < at_least) {
        return best;
    }
    // A margin is no core.
    let inside = o.gamma(&p.position) < 1.0 && o.without_margin().gamma(&p.position) < 1.0;
    let here = Clearance { time: p.time, robot: p.position, surface: nearest(o, &p.position), inside };
    Some(best.filter(|b| b.distance() <= here.distance()).unwrap_or(here))
}

/// Does anything of it change while robots are under way?
fn changes(scene: &Scene) -> bool {
    scene.attractor_moves() || scene.obstacles().iter().any(crate::scene::SceneObstacle::is_moving)
}

/// The moments that show how robots pass what moves: their nearest approaches, the begin, the end, and what is between. One without a tail
/// if nothing changes.
pub fn moments(scene: &Scene, trajectories: &[Trajectory], from: f64) -> Vec<Moment> {
    let until = trajectories.iter().map(Trajectory::duration).fold(from, f64::max);
    if !changes(scene) || until - from < 0.5 {
        return vec![Moment { time: from, tail: None }];
    }
    let progress = Progress::new(trajectories, from, until);
    let apart = 1.0 / (2.0 * MOMENTS as f64);
    // Each with how much of their ways robots then have behind them.
    let mut chosen = if scene.attractor_moves() { vec![(1.0, until)] } else { Vec::new() };
    for approach in passes(scene, trajectories).iter().filter(|approach| approach.time >= from) {
        let share = progress.share(approach.time);
        if chosen.len() < MOMENTS && chosen.iter().all(|(s, _)| (s - share).abs() >= apart) {
            chosen.push((share, approach.time));
        }
    }
    while chosen.len() < MOMENTS {
        // The begin, or else the middle of the longest way of which nothing is shown.
        chosen.sort_by(|a, b| a.0.total_cmp(&b.0));
        let ends: Vec<f64> = chosen.iter().map(|c| c.0).chain([1.0]).collect();
        let gap = ends.windows(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
        let share = match gap {
            Some(gap) if chosen.first().is_some_and(|(s, _)| *s < apart) => f64::midpoint(gap[0], gap[1]),
            _ => 0.0,
        };
        chosen.push((share, progress.time(share)));
    }
    chosen.sort_by(|a, b| a.1.total_cmp(&b.1));
    let tail = ((until - from) / 2.0).ceil() / 10.0;
    chosen.into_iter().map(|(_, time)| Moment { time, tail: Some(tail) }).collect()
}

/// How much of their ways robots have behind them over time: little happens while they creep to the attractor.
struct Progress(Vec<(f64, f64)>);

impl Progress {
    fn new(trajectories: &[Trajectory], from: f64, until: f64) -> Self {
        const STEPS: u32 = 400;
        let steps = (0..=STEPS).map(|i| f64::from(i) / f64::from(STEPS));
        let lengths: Vec<Vec<(f64, f64)>> = trajectories.iter().map(lengths).collect();
        let way = |time: f64| {
            let each = |l: &Vec<(f64, f64)>| {
                let whole = l.last().map_or(0.0, |last| last.1);
                let here =
                    l.partition_point(|(t, _)| *t <= time).checked_sub(1).and_then(|i| l.get(i)).map_or(0.0, |p| p.1);
                if whole > 0.0 { here / whole } else { 1.0 }
            };
            lengths.iter().map(each).sum::<f64>() / lengths.len().max(1) as f64
        };
        let begun = way(from);
        // Time counts for a little too, so that no two moments are the same.
        let share = |s: f64, time: f64| 0.1 * s + 0.9 * (way(time) - begun) / (1.0 - begun).max(1e-9);
        Self(steps.map(|s| (from + (until - from) * s, s)).map(|(t, s)| (t, share(s, t))).collect())
    }

    fn share(&self, time: f64) -> f64 {
        self.0.iter().find(|(t, _)| *t >= time).map_or(1.0, |p| p.1)
    }

    fn time(&self, share: f64) -> f64 {
        self.0.iter().find(|(_, s)| *s >= share - 1e-9).or(self.0.last()).map_or(0.0, |p| p.0)
    }
}

/// The length of a path up to each of its points: s, m.
fn lengths(trajectory: &Trajectory) -> Vec<(f64, f64)> {
    let mut length = 0.0;
    let mut before: Option<Vector3<f64>> = None;
    let point = |p: &TrajectoryPoint| {
        length += before.map_or(0.0, |b| (p.position - b).norm());
        before = Some(p.position);
        (p.time, length)
    };
    trajectory.points.iter().map(point).collect()
}

/// Where each robot is nearest to each obstacle that moves, or to each if none does, the nearest first.
fn passes(scene: &Scene, trajectories: &[Trajectory]) -> Vec<Clearance> {
    let none = !scene.obstacles().iter().any(crate::scene::SceneObstacle::is_moving);
    let moving: Vec<_> = scene.obstacles().iter().filter(|o| none || o.is_moving()).collect();
    let pass = |t: &Trajectory, o: &crate::scene::SceneObstacle| {
        looked_at(t).fold(None, |best, p| nearer(best, &o.at(p.time), p))
    };
    let mut passes: Vec<Clearance> =
        trajectories.iter().flat_map(|t| moving.iter().filter_map(|o| pass(t, o))).collect();
    passes.sort_by(|a, b| a.distance().total_cmp(&b.distance()));
    passes
}
