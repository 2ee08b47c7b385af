//! One view of a scene at one moment.

use nalgebra::{Point2, Vector2, Vector3};
use pliant_core::{Controller, Region, RobotState, Vector};

use super::approach::{Clearance, Moment, clearance, nearest_approach};
use super::figure::{Axes, Extent, Svg};
use super::ink::{SPACING, beside, draw_flow, draw_track, ring, rings, thinned};
use super::labels::Labels;
use super::outline::{self, Polygon, common};
use super::paths::{self, Stroke};
use super::seen::{Seen, track};
use super::style::{
    ARRIVED, ATTRACTOR, ATTRACTOR_HEAD, ATTRACTOR_TRACK, BEFORE, BEFORE_INSIDE, CLEARANCE, CLEARANCE_CASING,
    CLEARANCE_END, CORE, DOT, ENTRY, LOST, MARGIN, OVERLAP, OVERLAP_LINE, REFERENCE, SCAN, SCAN_POINT, SHELL, START,
    TRACK, TRACK_HEAD, demonstration,
};
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
pub(super) struct Panel<'a> {
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

    /// Draws all but frame and title. `name` is unique in the figure.
    pub fn draw(&self, svg: &mut Svg, axes: &Axes, name: &str) {
        axes.grid(svg);
        svg.clipped(&format!("panel{name}"), axes, |svg| {
            let pixel = |p: &Vector3<f64>| axes.pixel(&self.view.project(p));
            self.draw_flow(svg, axes);
            self.draw_soft(svg, axes);
            let still = self.moment.tail.is_none();
            // An overlap may be hardly wider than a path: that has its white edge under it then.
            let edged = still && !self.overlaps.is_empty();
            if !edged {
                self.draw_overlaps(svg, axes, name);
            }
            for shown in &self.options.demonstrations {
                let pixels: Vec<_> = shown.iter().map(pixel).collect();
                svg.path(thinned(&pixels, 0.1), false, &demonstration(0.6 * self.line()));
            }
            let draw = |svg: &mut Svg, part: &[TrajectoryPoint], stroke| {
                paths::draw(svg, part, pixel, self.speeds, stroke, self.line());
            };
            let size = 1.0 + 1.125 * self.line();
            let starts = |svg: &mut Svg| self.scene.starts().iter().for_each(|p| svg.circle(pixel(p), size, START));
            // Where robots were before, a core may have come since: it hides that. In space it hides what is behind it.
            let (mut under, mut over) = (Vec::new(), Vec::new());
            for t in self.trajectories {
                let parts = paths::parts(self.thick(t), &self.seen, &self.view);
                if self.is_projection() || still {
                    over.extend(parts);
                } else {
                    under.extend(parts);
                }
            }
            if !still && !self.is_projection() {
                self.trajectories.iter().for_each(|t| draw(svg, &t.points, Stroke::Thin));
            }
            let reference: Vec<_> = self.options.reference.iter().map(pixel).collect();
            svg.path(thinned(&reference, 0.1), false, REFERENCE);
            under.iter().for_each(|(_, part)| draw(svg, part, Stroke::Thick));
            if !still && !self.is_projection() {
                starts(svg);
            }
            self.draw_hard(svg, axes, name);
            if !still && self.is_projection() {
                for (behind, part) in
                    self.trajectories.iter().flat_map(|t| paths::parts(&t.points, &self.seen, &self.view))
                {
                    draw(svg, part, if behind { Stroke::ThinDashed } else { Stroke::Thin });
                }
                starts(svg);
            }
            draw_track(svg, axes, &self.aim, ATTRACTOR_TRACK, ATTRACTOR_HEAD);
            if edged {
                over.iter().for_each(|(_, part)| paths::edge(svg, part, pixel, self.line()));
                let cores: Vec<&outline::Region> = self.seen.iter().map(|s| &s.core).collect();
                beside(svg, axes, name, &cores, &|svg| self.draw_overlaps(svg, axes, name));
            }
            for (behind, part) in over {
                let thick = if edged { Stroke::Bare } else { Stroke::Thick };
                draw(svg, part, if behind { Stroke::Dashed } else { thick });
            }
            if still {
                starts(svg);
            }
            let mut labels = Labels::new(axes);
            self.trajectories.iter().for_each(|t| labels.avoid(self.thick(t).iter().map(|p| pixel(&p.position))));
            self.draw_places(svg, axes, &mut labels);
        });
    }

    fn draw_flow(&self, svg: &mut Svg, axes: &Axes) {
        let Some(field) = &self.field else {
            return;
        };
        let seen = |p: Point2<f64>| Some(self.view.project_direction(&field(self.view.lift(&p))?));
        draw_flow(svg, axes, &seen, SPACING);
    }

    fn draw_soft(&self, svg: &mut Svg, axes: &Axes) {
        for s in &self.seen {
            s.before.iter().for_each(|before| svg.area(&[ring(before, axes)], BEFORE));
        }
        for shell in self.seen.iter().filter_map(|s| s.shell.as_ref()) {
            svg.area(&rings(shell, axes), SHELL);
        }
        self.commons.iter().for_each(|area| svg.area(&[ring(area, axes)], OVERLAP));
        if let Some(scan) = self.scene.scan() {
            let points = || scan.points().iter().map(|p| axes.pixel(&self.view.project(p)));
            points().for_each(|p| svg.circle(p, scan.radius() * axes.scale(), SCAN));
            points().for_each(|p| svg.circle(p, 1.2, SCAN_POINT));
        }
    }

    /// What soft layers have in common, in 2-D.
    fn draw_overlaps(&self, svg: &mut Svg, axes: &Axes, name: &str) {
        for (n, (a, b)) in self.overlaps.iter().enumerate() {
            let shell = |i: usize| self.seen.get(i).and_then(|s| s.shell.as_ref()).map(|area| rings(area, axes));
            if let (Some(a), Some(b)) = (shell(*a), shell(*b)) {
                svg.within(&format!("overlap{name}-{n}a"), &a, |svg| svg.area(&b, OVERLAP));
                svg.within(&format!("overlap{name}-{n}b"), &b, |svg| svg.area(&a, OVERLAP_LINE));
            }
        }
    }

    fn draw_hard(&self, svg: &mut Svg, axes: &Axes, name: &str) {
        // The farthest from the viewer first.
        let mut seen: Vec<_> = self.seen.iter().enumerate().collect();
        let height = |s: &Seen<'_>| s.posed.pose.center.dot(&self.view.toward());
        seen.sort_by(|a, b| height(a.1).total_cmp(&height(b.1)));
        for (i, s) in seen {
            let core = rings(&s.core, axes);
            svg.area(&core, CORE);
            if let Some(before) = &s.before {
                svg.within(&format!("core{name}-{i}"), &core, |svg| svg.area(&[ring(before, axes)], BEFORE_INSIDE));
            }
            if let Some(margin) = &s.margin {
                svg.area(&[ring(&margin.ring, axes)], MARGIN);
            }
            draw_track(svg, axes, &s.track, TRACK, TRACK_HEAD);
        }
    }

    /// Where robots and attractor are, and how near robots are to cores.
    fn draw_places(&self, svg: &mut Svg, axes: &Axes, labels: &mut Labels) {
        let pixel = |p: &Vector3<f64>| axes.pixel(&self.view.project(p));
        let star = axes.pixel(&self.attractor());
        labels.keep_free(star, 8.5);
        self.scene.starts().iter().for_each(|p| labels.keep_free(pixel(p), 5.0));
        for s in &self.seen {
            let ring = || ring(&s.core.ring, axes).into_iter();
            labels.avoid(ring().chain(ring().next()));
        }
        for p in self.scene.scan().iter().flat_map(|scan| scan.points()) {
            let (at, half) = (pixel(p), Vector2::new(2.0, 0.0));
            labels.avoid([at - half, at + half]);
        }
        for c in &self.clearances {
            let (from, to) = (pixel(&c.robot), pixel(&c.surface));
            svg.line([from, to], CLEARANCE_CASING);
            svg.line([from, to], CLEARANCE);
            svg.circle(to, 2.2, CLEARANCE_END);
            labels.avoid([from, to]);
            labels.keep_free(nalgebra::center(&from, &to), 1.0);
            labels.mark(nalgebra::center(&from, &to));
        }
        svg.star(star, 8.5, ATTRACTOR);
        for t in self.trajectories {
            let here = self.moment.tail.and_then(|_| at(t, self.moment.time));
            match (here, t.points.last()) {
                (Some(here), _) => {
                    svg.circle(pixel(&here.position), 3.6, DOT);
                    labels.keep_free(pixel(&here.position), 6.0);
                }
                (None, Some(end)) if self.has_aim() => svg.circle(pixel(&end.position), 3.0, ARRIVED),
                _ => {}
            }
        }
        if self.moment.tail.is_none() {
            self.clearances.iter().for_each(|c| svg.circle(pixel(&c.robot), 2.2, CLEARANCE_END));
        }
        self.options.lost.iter().for_each(|p| svg.square(pixel(p), 1.8 + self.line(), LOST));
        self.options.entries.iter().for_each(|p| svg.cross(pixel(p), 1.8 + self.line(), ENTRY));
        for c in &self.clearances {
            labels.text(svg, nalgebra::center(&pixel(&c.robot), &pixel(&c.surface)), &c.label());
        }
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
pub(super) fn shared(views: &[Vec<Panel<'_>>]) -> Vec<Extent> {
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
