//! An obstacle as it is seen.

use nalgebra::Point2;

use super::outline::{Polygon, Region, Surface, section, shadow};
use super::view::View;
use crate::scene::PosedObstacle;

/// What is drawn of an obstacle.
pub(super) struct Seen {
    pub core: Option<Region>,
    pub margin: Option<Region>,
    pub shell: Option<Region>,
    /// Of core and shell, in 3-D.
    pub shadows: Vec<Polygon>,
    /// Where its centre goes while the robot moves, and its core at some times on the way.
    pub track: Vec<Point2<f64>>,
    pub ghosts: Vec<Polygon>,
    /// Do they lie within it?
    pub shrinks: bool,
}

impl Seen {
    /// An obstacle at `time`, and on its way until `until`, s; drawn again at each of `marks`.
    pub fn new(o: &PosedObstacle<'_>, view: &View, time: f64, until: f64, marks: &[f64]) -> Self {
        let soft = o.obstacle.is_soft();
        let inflated = o.obstacle.margin().max() > 1.0;
        let outside = o.obstacle.is_wall();
        let region = |surface| section(o, surface, view).map(|ring| Region { ring, outside });
        let mut seen = Self {
            core: region(Surface::Core),
            margin: inflated.then(|| region(Surface::Margin)).flatten(),
            shell: soft.then(|| region(Surface::Shell)).flatten(),
            shadows: Vec::new(),
            track: Vec::new(),
            ghosts: Vec::new(),
            shrinks: o.growth < 0.0,
        };
        if view.plane.is_some() {
            seen.shadows = std::iter::once(Surface::Core)
                .chain(soft.then_some(Surface::Shell))
                .map(|surface| shadow(o, surface, view))
                .collect();
        }
        if o.obstacle.is_moving() && until > time {
            seen.track = track(time, until, |t| view.project(&o.obstacle.at(t).pose.center));
            seen.ghosts = marks.iter().filter_map(|t| outline_at(o, *t, view)).collect();
        }
        seen
    }
}

/// Where something goes from `time` to `until`, s; nothing if it stays.
pub(super) fn track(time: f64, until: f64, at: impl Fn(f64) -> Point2<f64>) -> Vec<Point2<f64>> {
    let mut track: Vec<_> = (0..=120).map(|i| at(time + (until - time) * f64::from(i) / 120.0)).collect();
    track.dedup();
    if track.len() > 1 { track } else { Vec::new() }
}

/// The core's outline at another time: in 3-D its shadow, for the plane of the section may miss it.
fn outline_at(o: &PosedObstacle<'_>, time: f64, view: &View) -> Option<Polygon> {
    let then = o.obstacle.at(time);
    if view.plane.is_some() { Some(shadow(&then, Surface::Core, view)) } else { section(&then, Surface::Core, view) }
}
