//! An obstacle as it is seen.

use nalgebra::Point2;

use super::outline::{Polygon, Region, Surface, outline};
use super::view::View;
use crate::scene::PosedObstacle;

/// What is drawn of an obstacle.
pub(super) struct Seen<'a> {
    /// The obstacle itself, without its safety factors.
    pub posed: PosedObstacle<'a>,
    pub core: Region,
    pub margin: Option<Region>,
    pub shell: Option<Region>,
    /// Its core a little earlier, if it moves.
    pub before: Option<Polygon>,
    /// Where its centre goes while the robot moves.
    pub track: Vec<Point2<f64>>,
}

impl<'a> Seen<'a> {
    /// An obstacle as it is, was at `before`, and on its way during `span`, s.
    pub fn new(o: &PosedObstacle<'a>, view: &View, before: Option<f64>, (from, until): (f64, f64)) -> Self {
        let region = |surface| Region { ring: outline(o, surface, view), outside: o.obstacle.is_wall() };
        let moves = o.obstacle.is_moving();
        let earlier = |t: f64| outline(&o.obstacle.at(t), Surface::Core, view);
        let track =
            if moves { track(from, until, |t| view.project(&o.obstacle.at(t).pose.center)) } else { Vec::new() };
        Self {
            posed: o.without_margin(),
            core: region(Surface::Core),
            margin: o.obstacle.has_margin().then(|| region(Surface::Margin)),
            shell: o.obstacle.is_soft().then(|| region(Surface::Shell)),
            before: before.filter(|_| moves).map(earlier),
            track,
        }
    }
}

/// Where something goes from `from` to `until`, s; nothing if it stays.
pub(super) fn track(from: f64, until: f64, at: impl Fn(f64) -> Point2<f64>) -> Vec<Point2<f64>> {
    if until <= from {
        return Vec::new();
    }
    let mut track: Vec<_> = (0..=120).map(|i| at(from + (until - from) * f64::from(i) / 120.0)).collect();
    track.dedup();
    if track.len() > 1 { track } else { Vec::new() }
}
