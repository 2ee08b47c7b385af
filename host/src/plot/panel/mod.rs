//! One view of a scene at one moment.

mod draw;

use nalgebra::{Point2, Vector2, Vector3};
use pliant_core::{Controller, Region, RobotState, Vector};

use super::approach::{Clearance, Moment, clearance, nearest_approach};
use super::figure::Extent;
use super::outline::{Polygon, common};
use super::paths;
use super::seen::{Seen, track};
use super::trajectory::TrajectoryPoint;
use super::view::View;
use super::{Options, PlotError, Trajectory};
use crate::scene::{ConvertError, MAX_OBSTACLES, Scene};

/// How much wider than high a panel may be, and the inverse.
const WIDEST: f64 = 2.4;
const HIGHEST: f64 = 1.15;

/// How near to a core a robot is for its distance to be shown, over the size of what the robots pass through.
const NEAR: f64 = 0.12;

/// A velocity, or none where there is nothing to draw.
type Field = Box<dyn Fn(Vector3<f64>) -> Option<Vector3<f64>>>;

/// One view of a scene with everything that is in it.
pub(in crate::plot) struct Panel<'a> {
    scene: &'a Scene,
    view: View,
    trajectories: &'a [Trajectory],
    speeds: Option<(f64, f64)>,
    moment: Moment,
    seen: Vec<Seen<'a>>,
    /// Pairs of obstacles whose soft layers overlap; in 2-D.
    overlaps: Vec<(usize, usize)>,
    /// What soft layers have in common; in 3-D.
    commons: Vec<Polygon>,
    /// Where the attractor goes while robots move.
    aim: Vec<Point2<f64>>,
    /// How near robots are to cores now; the nearest approach of each if this is no moment of several.
    clearances: Vec<Clearance>,
    options: &'a Options,
    /// Only in 2-D: a flow in space is not to be seen from one side.
    field: Option<Field>,
}

impl<'a> Panel<'a> {
    pub fn new(
        scene: &'a Scene,
        view: &View,
        trajectories: &'a [Trajectory],
        speeds: Option<(f64, f64)>,
        moment: &Moment,
        options: &'a Options,
    ) -> Result<Self, PlotError> {
        let Moment { time, tail } = *moment;
        let until = trajectories.iter().map(Trajectory::duration).fold(options.time, f64::max);
        let before = tail.map(|tail| time - tail).filter(|t| *t >= options.time);
        let posed: Vec<_> = scene.obstacles_at(time).collect();
        let seen: Vec<Seen<'_>> = posed.iter().map(|o| Seen::new(o, view, before, (options.time, until))).collect();
        let shells: Vec<_> = seen.iter().enumerate().filter_map(|(i, s)| Some((i, s.shell.as_ref()?))).collect();
        let pairs = shells.iter().enumerate().flat_map(|(n, a)| shells[n + 1..].iter().map(move |b| (a, b)));
        let overlaps: Vec<_> = pairs.filter(|(a, b)| a.1.meets(b.1)).map(|(a, b)| (a.0, b.0)).collect();
        let flat = !view.is_projection();
        let apart = |(a, b): &&(usize, usize)| !posed[*a].obstacle.is_wall() && !posed[*b].obstacle.is_wall();
        let in_space = overlaps.iter().filter(|_| !flat).filter(apart);
        let commons = in_space.filter_map(|(a, b)| common(&posed[*a], &posed[*b], view)).collect();
        let aim = if scene.attractor_moves() {
            track(options.time, until, |t| view.project(&scene.attractor_at(t).0))
        } else {
            Vec::new()
        };
        let clearances = match tail {
            Some(_) => {
                let here = trajectories.iter().filter_map(|t| clearance(scene, &at(t, time)?));
                here.filter(|c| c.distance() < NEAR * size(scene, trajectories)).collect()
            }
            None if options.clearances => trajectories.iter().filter_map(|t| nearest_approach(scene, t)).collect(),
            None => Vec::new(),
        };
        let field = (options.streamlines && flat).then(|| field::<2>(scene, time)).transpose()?;
        let overlaps = if flat { overlaps } else { Vec::new() };
        let moment = moment.clone();
        Ok(Self {
            scene,
            view: *view,
            trajectories,
            speeds,
            moment,
            seen,
            overlaps,
            commons,
            aim,
            clearances,
            options,
            field,
        })
    }

    /// How long before now what is drawn thick of a path begins, s; none if all of it is.
    pub fn tail(&self) -> Option<f64> {
        self.moment.tail.filter(|_| self.has_paths())
    }
    pub fn has_paths(&self) -> bool {
        !self.trajectories.is_empty()
    }
    pub fn has_speeds(&self) -> bool {
        self.speeds.is_some()
    }
    pub fn has_cores(&self) -> bool {
        !self.seen.is_empty()
    }
    pub fn is_projection(&self) -> bool {
        self.view.is_projection()
    }
    pub fn has_margins(&self) -> bool {
        self.seen.iter().any(|s| s.margin.is_some())
    }
    pub fn has_shells(&self) -> bool {
        self.seen.iter().any(|s| s.shell.is_some())
    }
    pub fn has_overlaps(&self) -> bool {
        !self.overlaps.is_empty() || !self.commons.is_empty()
    }
    pub fn has_aim(&self) -> bool {
        !self.aim.is_empty()
    }
    pub fn has_scan(&self) -> bool {
        self.scene.scan().is_some()
    }
    pub fn has_reference(&self) -> bool {
        !self.options.reference.is_empty()
    }
    pub fn has_demonstrations(&self) -> bool {
        !self.options.demonstrations.is_empty()
    }
    pub fn has_entries(&self) -> bool {
        self.has_ends() || self.clearances.iter().any(|c| c.inside)
    }
    pub fn has_ends(&self) -> bool {
        !self.options.entries.is_empty()
    }
    pub fn has_lost(&self) -> bool {
        !self.options.lost.is_empty()
    }
    /// How wide paths are, px.
    pub fn line(&self) -> f64 {
        self.options.line
    }
    pub fn has_flow(&self) -> bool {
        self.field.is_some()
    }
    pub fn has_before(&self) -> bool {
        self.seen.iter().any(|s| s.before.is_some())
    }
    pub fn has_tracks(&self) -> bool {
        self.seen.iter().any(|s| s.track.len() > 1)
    }
    pub fn has_clearances(&self) -> bool {
        !self.clearances.is_empty()
    }
    pub fn has_hidden(&self) -> bool {
        let drawn = self.trajectories.iter().map(|t| paths::parts(&t.points, &self.seen, &self.view));
        drawn.flatten().any(|(behind, _)| behind)
    }

    /// The names of both axes.
    pub fn names(&self) -> [String; 2] {
        self.view.names()
    }

    /// What is written over it; nothing over a flat scene that does not change.
    pub fn title(&self) -> Option<String> {
        let time = self.moment.tail.map(|_| format!("t = {:.2} s", self.moment.time));
        let parts: Vec<String> = time.into_iter().chain(self.view.title().map(String::from)).collect();
        (!parts.is_empty()).then(|| parts.join(", "))
    }

    /// What has to be in the picture.
    pub fn extent(&self) -> Option<Extent> {
        let places = self.scene.starts().iter().map(|p| self.view.project(p)).chain([self.attractor()]);
        let inside = |p: &Vector3<f64>| self.options.limit.is_none_or(|[a, b]| a.inf(&b) <= *p && *p <= a.sup(&b));
        let paths = self.trajectories.iter().flat_map(|t| &t.points).map(|p| p.position).filter(inside);
        let paths = paths.map(|p| self.view.project(&p));
        let regions = self.seen.iter().flat_map(|s| std::iter::once(&s.core).chain(&s.shell));
        let others = self.options.reference.iter().chain(self.options.demonstrations.iter().flatten());
        let others = others.map(|p| self.view.project(p));
        let shapes = regions.flat_map(|region| &region.ring).copied();
        let scan = self.scene.scan().into_iter().flat_map(|scan| {
            let corner = Vector2::from_element(scan.radius());
            scan.points().iter().map(|p| self.view.project(p)).flat_map(move |p| [p - corner, p + corner])
        });
        Extent::around(places.chain(paths).chain(others).chain(shapes).chain(scan).chain(self.aim.iter().copied()))
    }

    /// How many trajectories leave what is shown.
    pub fn cut(&self, shown: &Extent) -> usize {
        let leaves = |t: &&Trajectory| t.points.iter().any(|p| !shown.holds(&self.view.project(&p.position)));
        self.trajectories.iter().filter(leaves).count()
    }

    fn attractor(&self) -> Point2<f64> {
        self.view.project(&self.scene.attractor_at(self.moment.time).0)
    }

    /// The part of a path that is drawn thick.
    fn thick<'t>(&self, trajectory: &'t Trajectory) -> &'t [TrajectoryPoint] {
        let points = &trajectory.points[..];
        let Some(tail) = self.moment.tail else {
            return points;
        };
        let upto = |t: f64| points.partition_point(|p| p.time < t);
        // A robot that has arrived has no tail.
        if self.moment.time > trajectory.duration() + 1e-9 {
            return &[];
        }
        points.get(upto(self.moment.time - tail)..(upto(self.moment.time) + 1).min(points.len())).unwrap_or(&[])
    }
}

/// The longest way there is between two robots or from one to the attractor, about, m.
fn size(scene: &Scene, trajectories: &[Trajectory]) -> f64 {
    let places = trajectories.iter().flat_map(|t| &t.points).map(|p| p.position).chain([scene.attractor()]);
    let (low, high) = places.fold((scene.attractor(), scene.attractor()), |(l, h), p| (l.inf(&p), h.sup(&p)));
    (high - low).norm()
}

/// Where a robot is at a time; none before its begin and after its end.
fn at(trajectory: &Trajectory, time: f64) -> Option<TrajectoryPoint> {
    trajectory.points.iter().find(|p| p.time >= time - 1e-9).copied()
}

fn field<const D: usize>(scene: &Scene, time: f64) -> Result<Field, ConvertError> {
    let controller: Controller<f64, D, MAX_OBSTACLES> = scene.controller(time)?;
    Ok(Box::new(move |x| {
        let state = RobotState::new(Vector::<f64, D>::from_fn(|i, _| x[i]))?;
        let stages = controller.evaluate(&state);
        let v = stages.adapted;
        (stages.region != Region::Hard).then(|| Vector3::from_fn(|i, _| v.get(i).copied().unwrap_or_default()))
    }))
}

/// What each view shows: all of it, with the same horizontal range for all and no odd proportions.
pub(in crate::plot) fn shared(views: &[Vec<Panel<'_>>]) -> Vec<Extent> {
    let unit = Extent { low: Point2::origin(), high: Point2::new(1.0, 1.0) };
    let whole = |panels: &Vec<Panel<'_>>| {
        let corners = panels.iter().filter_map(Panel::extent).flat_map(|e| [e.low, e.high]);
        Extent::around(corners).unwrap_or(unit).padded(0.08, 0.02)
    };
    let mut extents: Vec<Extent> = views.iter().map(whole).collect();
    let low = extents.iter().map(|e| e.low.x).fold(f64::INFINITY, f64::min);
    let high = extents.iter().map(|e| e.high.x).fold(f64::NEG_INFINITY, f64::max);
    let highest = extents.iter().map(|e| e.size().y).fold(0.0, f64::max);
    let widen = ((highest / HIGHEST - (high - low)) / 2.0).max(0.0);
    for e in &mut extents {
        (e.low.x, e.high.x) = (low - widen, high + widen);
        let raise = ((e.size().x / WIDEST - e.size().y) / 2.0).max(0.0);
        (e.low.y, e.high.y) = (e.low.y - raise, e.high.y + raise);
    }
    extents
}
