//! One view of a scene.

use nalgebra::{Point2, Vector2, Vector3};
use pliant_core::{Controller, Region, RobotState, Vector};

use super::figure::{Anchor, Axes, Extent, Svg, text_width};
use super::outline::Region as Area;
use super::seen::{Seen, track};
use super::style::{
    ATTRACTOR, ATTRACTOR_HEAD, ATTRACTOR_LATER, ATTRACTOR_TRACK, CASING, CORE, CUT_CORE, DOT, FLOW, FLOW_HEAD, GHOST,
    GHOST_INSIDE, LINE, MARGIN, OVERLAP, OVERLAP_LINE, SCAN, SCAN_POINT, SHELL, SMALL, START, TRACK, TRACK_HEAD,
    speed_colour,
};
use super::view::View;
use super::{Options, PlotError, Trajectory, streamlines};
use crate::scene::{ConvertError, MAX_OBSTACLES, Scene, SceneObstacle};

/// Pixels between streamlines, about.
const SPACING: f64 = 17.0;
/// Times at which moving obstacles are drawn again, besides the first.
const MARKS: u32 = 3;
/// How much wider than high a panel may be, and the inverse.
const WIDEST: f64 = 2.4;
const HIGHEST: f64 = 1.15;

/// A velocity, or none where there is nothing to draw.
type Field = Box<dyn Fn(Vector3<f64>) -> Option<Vector3<f64>>>;

/// One view of a scene with everything that is in it.
pub(super) struct Panel<'a> {
    scene: &'a Scene,
    view: View,
    trajectories: &'a [Trajectory],
    speeds: Option<(f64, f64)>,
    seen: Vec<Seen>,
    /// Pairs of obstacles whose soft layers overlap.
    overlaps: Vec<(usize, usize)>,
    /// Where the attractor goes while the robot moves.
    aim: Vec<Point2<f64>>,
    field: Option<Field>,
    /// The time of the figure, s.
    time: f64,
    /// The times at which moving obstacles are drawn again, and robots marked, s.
    marks: Vec<f64>,
}

impl<'a> Panel<'a> {
    pub fn new(
        scene: &'a Scene,
        view: &View,
        trajectories: &'a [Trajectory],
        speeds: Option<(f64, f64)>,
        options: &Options,
    ) -> Result<Self, PlotError> {
        let until = trajectories.iter().map(Trajectory::duration).fold(0.0, f64::max);
        let aims = scene.attractor_moves();
        let moving = aims || scene.obstacles().iter().any(SceneObstacle::is_moving);
        let between = until - options.time;
        // To a tenth of a second, as it is written there.
        let mark = |i| options.time + (between * f64::from(i) / f64::from(MARKS + 1) * 10.0).round() / 10.0;
        let marks: Vec<f64> = if moving && between > 0.5 { (1..=MARKS).map(mark).collect() } else { Vec::new() };
        let seen: Vec<Seen> =
            scene.obstacles_at(options.time).map(|o| Seen::new(&o, view, options.time, until, &marks)).collect();
        let shells: Vec<_> = seen.iter().enumerate().filter_map(|(i, s)| Some((i, s.shell.as_ref()?))).collect();
        let pairs = shells.iter().enumerate().flat_map(|(n, a)| shells[n + 1..].iter().map(move |b| (a, b)));
        let overlaps = pairs.filter(|(a, b)| a.1.meets(b.1)).map(|(a, b)| (a.0, b.0)).collect();
        let attractor = |t| view.project(&scene.attractor_at(t).0);
        let aim = if aims && until > options.time { track(options.time, until, attractor) } else { Vec::new() };
        let field = if !options.streamlines {
            None
        } else if scene.dimension() == 2 {
            Some(field::<2>(scene, options.time)?)
        } else {
            Some(field::<3>(scene, options.time)?)
        };
        Ok(Self { scene, view: *view, trajectories, speeds, seen, overlaps, aim, field, time: options.time, marks })
    }

    pub fn has_trajectories(&self) -> bool {
        !self.trajectories.is_empty() && self.speeds.is_none()
    }
    pub fn has_cores(&self) -> bool {
        !self.is_cut() && !self.seen.is_empty()
    }
    pub fn has_cut_cores(&self) -> bool {
        self.is_cut() && !self.seen.is_empty()
    }
    fn is_cut(&self) -> bool {
        self.view.plane.is_some()
    }
    pub fn has_margins(&self) -> bool {
        self.seen.iter().any(|s| s.margin.is_some())
    }
    pub fn has_shells(&self) -> bool {
        self.seen.iter().any(|s| s.shell.is_some())
    }
    pub fn has_overlaps(&self) -> bool {
        !self.overlaps.is_empty()
    }
    pub fn has_shadows(&self) -> bool {
        self.seen.iter().any(|s| !s.shadows.is_empty())
    }
    pub fn has_aim(&self) -> bool {
        !self.aim.is_empty()
    }
    pub fn has_scan(&self) -> bool {
        self.scene.scan().is_some()
    }
    pub fn has_marks(&self) -> bool {
        !self.marks.is_empty()
    }
    pub fn has_tracks(&self) -> bool {
        self.seen.iter().any(|s| s.track.len() > 1)
    }

    /// What has to be in the picture.
    fn extent(&self) -> Option<Extent> {
        let places = self.scene.starts().iter().map(|p| self.view.project(p)).chain([self.attractor(self.time)]);
        let paths = self.trajectories.iter().flat_map(|t| &t.points).map(|p| self.view.project(&p.position));
        let shapes = self
            .seen
            .iter()
            .flat_map(|s| {
                let regions = s.core.iter().chain(&s.shell).map(|area| &area.ring);
                regions.chain(&s.shadows).chain(&s.ghosts)
            })
            .flatten()
            .copied();
        let scan = self.scene.scan().into_iter().flat_map(|scan| {
            let corner = Vector2::from_element(scan.radius());
            scan.points().iter().map(|p| self.view.project(p)).flat_map(move |p| [p - corner, p + corner])
        });
        Extent::around(places.chain(paths).chain(shapes).chain(scan).chain(self.aim.iter().copied()))
    }

    fn attractor(&self, t: f64) -> Point2<f64> {
        self.view.project(&self.scene.attractor_at(t).0)
    }

    /// Draws the panel; `named` if the horizontal axis has its numbers and its name here.
    pub fn draw(&self, svg: &mut Svg, axes: &Axes, named: bool, index: usize) -> Result<(), PlotError> {
        axes.grid(svg);
        svg.clipped(&format!("panel{index}"), axes, |svg| {
            self.draw_flow(svg, axes);
            self.draw_obstacles(svg, axes, index);
            self.draw_aim(svg, axes);
            for t in self.trajectories {
                self.draw_trajectory(svg, axes, t);
            }
            for start in self.scene.starts() {
                svg.circle(axes.pixel(&self.view.project(start)), 4.6, START);
            }
            self.draw_marks(svg, axes);
            svg.star(axes.pixel(&self.attractor(self.time)), 8.5, ATTRACTOR);
        });
        let [x, y] = self.view.names();
        axes.frame(svg, named.then_some(&x), &y);
        Ok(())
    }

    fn draw_flow(&self, svg: &mut Svg, axes: &Axes) {
        let Some(field) = &self.field else {
            return;
        };
        let seen = |p: Point2<f64>| Some(self.view.project_direction(&field(self.view.lift(&p))?));
        for line in streamlines(&seen, &axes.extent, SPACING / axes.scale()) {
            let pixels: Vec<_> = line.iter().map(|p| axes.pixel(p)).collect();
            svg.path(thinned(&pixels, 0.04), false, FLOW);
            let length = pixels.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>();
            let heads = (length / 150.0).round().max(1.0);
            for i in 0..heads as usize {
                let at = ((i as f64 + 0.5) / heads * (pixels.len() - 1) as f64) as usize;
                if let Some([from, tip]) =
                    pixels.get(at.saturating_sub(1)..=at).and_then(|w| <[_; 2]>::try_from(w).ok())
                {
                    svg.arrowhead(tip, &(tip - from), 7.5, FLOW_HEAD);
                }
            }
        }
    }

    fn draw_obstacles(&self, svg: &mut Svg, axes: &Axes, index: usize) {
        for s in &self.seen {
            let ghosts = s.ghosts.iter().filter(|_| !s.shrinks);
            ghosts.chain(&s.shadows).for_each(|ghost| svg.area(&[ring(ghost, axes)], GHOST));
        }
        for shell in self.seen.iter().filter_map(|s| s.shell.as_ref()) {
            svg.area(&rings(shell, axes), SHELL);
        }
        for (n, (a, b)) in self.overlaps.iter().enumerate() {
            let shell = |i: usize| self.seen.get(i).and_then(|s| s.shell.as_ref()).map(|area| rings(area, axes));
            if let (Some(a), Some(b)) = (shell(*a), shell(*b)) {
                svg.within(&format!("overlap{index}-{n}a"), &a, |svg| svg.area(&b, OVERLAP));
                svg.within(&format!("overlap{index}-{n}b"), &b, |svg| svg.area(&a, OVERLAP_LINE));
            }
        }
        if let Some(scan) = self.scene.scan() {
            let points = || scan.points().iter().map(|p| axes.pixel(&self.view.project(p)));
            points().for_each(|p| svg.circle(p, scan.radius() * axes.scale(), SCAN));
            points().for_each(|p| svg.circle(p, 1.2, SCAN_POINT));
        }
        for s in &self.seen {
            if let Some(core) = &s.core {
                svg.area(&rings(core, axes), if self.is_cut() { CUT_CORE } else { CORE });
            }
            if let Some(margin) = &s.margin {
                svg.area(&[ring(&margin.ring, axes)], MARGIN);
            }
            for ghost in s.ghosts.iter().filter(|_| s.shrinks) {
                svg.area(&[ring(ghost, axes)], GHOST_INSIDE);
            }
            draw_track(svg, axes, &s.track, TRACK, TRACK_HEAD);
        }
    }

    /// The way of the attractor, and where on it it is at the marks.
    fn draw_aim(&self, svg: &mut Svg, axes: &Axes) {
        draw_track(svg, axes, &self.aim, ATTRACTOR_TRACK, ATTRACTOR_HEAD);
        if self.has_aim() {
            for t in &self.marks {
                let p = axes.pixel(&self.attractor(*t));
                svg.star(p, 6.0, ATTRACTOR_LATER);
                svg.text(p + Vector2::new(0.0, 17.0), Anchor::Middle, SMALL, &format!("{t:.1} s"));
            }
        }
    }

    /// Moving obstacles and robots at the same times.
    fn draw_marks(&self, svg: &mut Svg, axes: &Axes) {
        let star = axes.pixel(&self.attractor(self.time)) - Vector2::new(15.0, -3.5);
        let mut labels = Labels(vec![star]);
        for (i, t) in self.marks.iter().enumerate() {
            let label = format!("{t:.1} s");
            for (seen, ghost) in self.seen.iter().filter_map(|s| Some((s, s.ghosts.get(i)?))) {
                // Beside the way it goes, where its next outline is not.
                let upright = seen
                    .track
                    .first()
                    .zip(seen.track.last())
                    .is_some_and(|(a, b)| (b.y - a.y).abs() > (b.x - a.x).abs());
                let pixels: Vec<_> = ghost.iter().map(|p| axes.pixel(p)).collect();
                if upright {
                    let p = farthest(&pixels, &Vector2::x());
                    labels.text(svg, p + Vector2::new(4.0, 3.5), Anchor::Start, &label);
                } else {
                    let p = farthest(&pixels, &Vector2::y());
                    labels.text(svg, p + Vector2::new(0.0, 11.0), Anchor::Middle, &label);
                }
            }
            for at in self.trajectories.iter().filter_map(|trajectory| trajectory.points.iter().find(|p| p.time >= *t))
            {
                let p = axes.pixel(&self.view.project(&at.position));
                svg.circle(p, 3.2, DOT);
                labels.text(svg, p + Vector2::new(7.0, 3.5), Anchor::Start, &label);
            }
        }
    }

    fn draw_trajectory(&self, svg: &mut Svg, axes: &Axes, trajectory: &Trajectory) {
        let pixels: Vec<_> = trajectory.points.iter().map(|p| axes.pixel(&self.view.project(&p.position))).collect();
        svg.path(thinned(&pixels, 0.1), false, CASING);
        let Some((low, high)) = self.speeds else {
            svg.path(thinned(&pixels, 0.1), false, LINE);
            return;
        };
        // Pieces of one colour each, a few pixels long at least, so that the file stays small.
        let mut from = 0;
        for i in 1..pixels.len() {
            if (pixels[i] - pixels[from]).norm() < 2.0 && i + 1 < pixels.len() {
                continue;
            }
            let middle = trajectory.points[(from + i) / 2].speed;
            let colour = speed_colour((middle - low) / (high - low));
            let style = format!(r#"fill="none" stroke="{colour}" stroke-width="3.2" stroke-linecap="round""#);
            svg.path(pixels[from..=i].iter().copied(), false, &style);
            from = i;
        }
    }
}

/// Where a closed line goes farthest in a direction; the middle of it where that is a side.
fn farthest(ring: &[Point2<f64>], direction: &Vector2<f64>) -> Point2<f64> {
    let along = |p: &Point2<f64>| p.coords.dot(direction);
    let most = ring.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
    let there: Vec<Point2<f64>> = ring.iter().filter(|p| along(p) > most - 0.5).copied().collect();
    Extent::around(there).map_or(Point2::origin(), |e| nalgebra::center(&e.low, &e.high))
}

/// Small texts by their left ends, left out where something is already.
struct Labels(Vec<Point2<f64>>);

impl Labels {
    fn text(&mut self, svg: &mut Svg, at: Point2<f64>, anchor: Anchor, text: &str) {
        let width = text_width(text) * 0.85;
        let left = match anchor {
            Anchor::Start => at.x,
            Anchor::Middle => at.x - width / 2.0,
            Anchor::End => at.x - width,
        };
        let free = self.0.iter().all(|p| (p.x - left).abs() > width || (p.y - at.y).abs() > 9.0);
        if free {
            self.0.push(Point2::new(left, at.y));
            svg.text(at, anchor, SMALL, text);
        }
    }
}

/// A dashed line with an arrowhead.
fn draw_track(svg: &mut Svg, axes: &Axes, track: &[Point2<f64>], style: &str, head: &str) {
    let track: Vec<_> = track.iter().map(|p| axes.pixel(p)).collect();
    if let [.., from, tip] = track[..] {
        svg.path(track.iter().copied(), false, style);
        svg.arrowhead(tip, &(tip - from), 8.0, head);
    }
}

/// A closed line on the page.
fn ring(polygon: &[Point2<f64>], axes: &Axes) -> Vec<Point2<f64>> {
    let closed: Vec<_> = polygon.iter().chain(polygon.first()).map(|p| axes.pixel(p)).collect();
    let mut ring = thinned(&closed, 0.03);
    ring.pop();
    ring
}

/// A region on the page: what is outside of a line ends beyond the axes, where nothing is seen.
fn rings(area: &Area, axes: &Axes) -> Vec<Vec<Point2<f64>>> {
    let mut rings = vec![ring(&area.ring, axes)];
    if area.outside {
        let room = Vector2::new(10.0, 10.0);
        let (low, high) = (axes.corner - room, axes.end() + room);
        rings.push(vec![low, Point2::new(high.x, low.y), high, Point2::new(low.x, high.y)]);
    }
    rings
}

/// Without points that are within `tolerance` pixels of the line through their neighbours.
fn thinned(points: &[Point2<f64>], tolerance: f64) -> Vec<Point2<f64>> {
    let Some((&first, &last)) = points.first().zip(points.last()) else {
        return Vec::new();
    };
    let mut kept = vec![first];
    let mut anchor = 0;
    for i in 2..points.len() {
        let chord: Vector2<f64> = points[i] - points[anchor];
        let off = |p: &Point2<f64>| chord.perp(&(p - points[anchor])).abs();
        let length = chord.norm();
        if i - anchor > 60 || points[anchor + 1..i].iter().any(|p| off(p) > tolerance * length) {
            anchor = i - 1;
            kept.push(points[anchor]);
        }
    }
    kept.push(last);
    kept
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

/// What each panel shows: all of it, with the same horizontal range for all and no odd proportions.
pub(super) fn shared(panels: &[Panel<'_>]) -> Vec<Extent> {
    let unit = Extent { low: Point2::origin(), high: Point2::new(1.0, 1.0) };
    let mut extents: Vec<Extent> = panels.iter().map(|p| p.extent().unwrap_or(unit).padded(0.08, 0.02)).collect();
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
