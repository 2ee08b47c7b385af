//! One view of a scene.

use nalgebra::{Point2, Vector2, Vector3};
use pliant_core::{Controller, Region, RobotState, Vector};

use super::figure::{Anchor, Axes, Extent, Svg};
use super::outline::{Polygon, Surface, overlap, section, shadow};
use super::view::View;
use super::{Options, PlotError, Trajectory, streamlines};
use crate::scene::{ConvertError, MAX_OBSTACLES, PosedObstacle, Scene, SceneObstacle};

pub(super) const CORE: &str = r##"fill="#343a43" stroke="#15181c" stroke-width="1""##;
/// In a section paths pass before and behind what is cut: it does not hide them.
pub(super) const CUT_CORE: &str = r##"fill="#343a43" fill-opacity="0.5" stroke="#15181c" stroke-width="1""##;
const SMALL: &str =
    r##"font-size="10" stroke="#ffffff" stroke-width="3" stroke-linejoin="round" paint-order="stroke""##;
pub(super) const DOT: &str = r##"fill="#ffffff" stroke="#15181c" stroke-width="1.2""##;
pub(super) const MARGIN: &str = r##"fill="none" stroke="#15181c" stroke-width="1" stroke-dasharray="2 2.5""##;
pub(super) const SHELL: &str = r##"fill="#f0a54a" fill-opacity="0.30" stroke="#c97a1c" stroke-width="1""##;
pub(super) const OVERLAP: &str = r##"fill="#d03b5f" fill-opacity="0.42" stroke="#a81f45" stroke-width="0.8""##;
pub(super) const GHOST: &str = r##"fill="none" stroke="#6b7480" stroke-width="0.9" stroke-dasharray="4 3""##;
pub(super) const TRACK: &str =
    r##"fill="none" stroke="#343a43" stroke-width="1.3" stroke-dasharray="1.5 3" stroke-linecap="round""##;
pub(super) const LINE: &str = r##"fill="none" stroke="#1f5fbf" stroke-width="3" stroke-linecap="round""##;
pub(super) const START: &str = r##"fill="#ffffff" stroke="#15181c" stroke-width="1.8""##;
pub(super) const ATTRACTOR: &str = r##"fill="#ffd43b" stroke="#15181c" stroke-width="1.1" stroke-linejoin="round""##;
const CASING: &str =
    r##"fill="none" stroke="#ffffff" stroke-width="5.4" stroke-linecap="round" stroke-linejoin="round""##;
const FLOW: &str = r##"fill="none" stroke="#9db0c4" stroke-width="1""##;
const FLOW_HEAD: &str = r##"fill="#8298af""##;

/// Pixels between streamlines, about.
const SPACING: f64 = 17.0;
/// Times at which moving obstacles are drawn again, besides the first.
const MARKS: u32 = 3;
/// How much wider than high a panel may be, and the inverse.
const WIDEST: f64 = 2.4;
const HIGHEST: f64 = 1.15;

/// The colour of a speed between 0 (the least) and 1 (the largest): viridis without its lightest end, which white paper swallows.
pub(super) fn speed_colour(share: f64) -> String {
    const COLOURS: [[f64; 3]; 8] = [
        [68.0, 1.0, 84.0],
        [70.0, 50.0, 126.0],
        [54.0, 92.0, 141.0],
        [39.0, 127.0, 142.0],
        [31.0, 161.0, 135.0],
        [74.0, 193.0, 109.0],
        [130.0, 211.0, 77.0],
        [178.0, 221.0, 45.0],
    ];
    let at = share.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let low = (at.floor() as usize).min(COLOURS.len() - 2);
    let mix = |i: usize| (COLOURS[low][i] + (COLOURS[low + 1][i] - COLOURS[low][i]) * (at - low as f64)).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

/// An obstacle as it is seen.
struct Seen {
    core: Option<Polygon>,
    margin: Option<Polygon>,
    shell: Option<Polygon>,
    /// Of core and shell, in 3-D.
    shadows: Vec<Polygon>,
    /// Where its centre goes while the robot moves, and its core at some times on the way.
    track: Vec<Point2<f64>>,
    ghosts: Vec<Polygon>,
}

/// A velocity, or none where there is nothing to draw.
type Field = Box<dyn Fn(Vector3<f64>) -> Option<Vector3<f64>>>;

/// One view of a scene with everything that is in it.
pub(super) struct Panel<'a> {
    scene: &'a Scene,
    view: View,
    trajectories: &'a [Trajectory],
    speeds: Option<(f64, f64)>,
    seen: Vec<Seen>,
    overlaps: Vec<Polygon>,
    field: Option<Field>,
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
        let moving = scene.obstacles().iter().any(SceneObstacle::is_moving);
        let between = until - options.time;
        // To a tenth of a second, as it is written there.
        let mark = |i| options.time + (between * f64::from(i) / f64::from(MARKS + 1) * 10.0).round() / 10.0;
        let marks: Vec<f64> = if moving && between > 0.5 { (1..=MARKS).map(mark).collect() } else { Vec::new() };
        let seen: Vec<Seen> =
            scene.obstacles_at(options.time).map(|o| see(&o, view, options.time, until, &marks)).collect();
        let shells: Vec<&Polygon> = seen.iter().filter_map(|s| s.shell.as_ref()).collect();
        let pairs = shells.iter().enumerate().flat_map(|(i, a)| shells[i + 1..].iter().map(move |b| (a, b)));
        let overlaps = pairs.filter_map(|(a, b)| overlap(a, b)).collect();
        let field = if !options.streamlines {
            None
        } else if scene.dimension() == 2 {
            Some(field::<2>(scene, options.time)?)
        } else {
            Some(field::<3>(scene, options.time)?)
        };
        Ok(Self { scene, view: *view, trajectories, speeds, seen, overlaps, field, marks })
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
    pub fn has_marks(&self) -> bool {
        !self.marks.is_empty()
    }
    pub fn has_tracks(&self) -> bool {
        self.seen.iter().any(|s| s.track.len() > 1)
    }

    /// What has to be in the picture.
    fn extent(&self) -> Option<Extent> {
        let points = self
            .scene
            .starts()
            .iter()
            .chain(std::iter::once(&self.attractor()))
            .map(|p| self.view.project(p))
            .collect::<Vec<_>>();
        let paths = self.trajectories.iter().flat_map(|t| &t.points).map(|p| self.view.project(&p.position));
        let shapes = self
            .seen
            .iter()
            .flat_map(|s| s.core.iter().chain(&s.shell).chain(&s.shadows).chain(&s.ghosts).flatten().copied());
        Extent::around(points.into_iter().chain(paths).chain(shapes))
    }

    fn attractor(&self) -> Vector3<f64> {
        self.scene.attractor()
    }

    /// Draws the panel; `named` if the horizontal axis has its numbers and its name here.
    pub fn draw(&self, svg: &mut Svg, axes: &Axes, named: bool, index: usize) -> Result<(), PlotError> {
        axes.grid(svg);
        svg.clipped(&format!("panel{index}"), axes, |svg| {
            self.draw_flow(svg, axes);
            self.draw_obstacles(svg, axes);
            for t in self.trajectories {
                self.draw_trajectory(svg, axes, t);
            }
            for start in self.scene.starts() {
                svg.circle(axes.pixel(&self.view.project(start)), 4.6, START);
            }
            self.draw_marks(svg, axes);
            svg.star(axes.pixel(&self.view.project(&self.attractor())), 8.5, ATTRACTOR);
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

    fn draw_obstacles(&self, svg: &mut Svg, axes: &Axes) {
        let draw =
            |svg: &mut Svg, polygon: &Polygon, style| svg.path(polygon.iter().map(|p| axes.pixel(p)), true, style);
        for s in &self.seen {
            for ghost in s.ghosts.iter().chain(&s.shadows) {
                draw(svg, ghost, GHOST);
            }
        }
        for shell in self.seen.iter().filter_map(|s| s.shell.as_ref()) {
            draw(svg, shell, SHELL);
        }
        for overlap in &self.overlaps {
            draw(svg, overlap, OVERLAP);
        }
        for s in &self.seen {
            if let Some(core) = &s.core {
                draw(svg, core, if self.is_cut() { CUT_CORE } else { CORE });
            }
            if let Some(margin) = &s.margin {
                draw(svg, margin, MARGIN);
            }
            let track: Vec<_> = s.track.iter().map(|p| axes.pixel(p)).collect();
            if let [.., from, tip] = track[..] {
                svg.path(track.iter().copied(), false, TRACK);
                svg.arrowhead(tip, &(tip - from), 8.0, r##"fill="#343a43""##);
            }
        }
    }

    /// Moving obstacles and robots at the same times.
    fn draw_marks(&self, svg: &mut Svg, axes: &Axes) {
        for (i, t) in self.marks.iter().enumerate() {
            let label = format!("{t:.1} s");
            for (seen, ghost) in self.seen.iter().filter_map(|s| Some((s, s.ghosts.get(i)?))) {
                // Beside the way it goes, where its next outline is not.
                let upright = seen
                    .track
                    .first()
                    .zip(seen.track.last())
                    .is_some_and(|(a, b)| (b.y - a.y).abs() > (b.x - a.x).abs());
                let pixels = ghost.iter().map(|p| axes.pixel(p));
                if upright {
                    if let Some(p) = pixels.max_by(|a, b| a.x.total_cmp(&b.x)) {
                        svg.text(p + Vector2::new(4.0, 3.5), Anchor::Start, SMALL, &label);
                    }
                } else if let Some(p) = pixels.max_by(|a, b| a.y.total_cmp(&b.y)) {
                    svg.text(p + Vector2::new(0.0, 11.0), Anchor::Middle, SMALL, &label);
                }
            }
            for at in self.trajectories.iter().filter_map(|trajectory| trajectory.points.iter().find(|p| p.time >= *t))
            {
                let p = axes.pixel(&self.view.project(&at.position));
                svg.circle(p, 3.2, DOT);
                svg.text(p + Vector2::new(7.0, 3.5), Anchor::Start, SMALL, &label);
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

fn see(o: &PosedObstacle<'_>, view: &View, time: f64, until: f64, marks: &[f64]) -> Seen {
    let soft = o.obstacle.is_soft();
    let inflated = o.obstacle.margin().max() > 1.0;
    let mut seen = Seen {
        core: section(o, Surface::Core, view),
        margin: inflated.then(|| section(o, Surface::Margin, view)).flatten(),
        shell: soft.then(|| section(o, Surface::Shell, view)).flatten(),
        shadows: Vec::new(),
        track: Vec::new(),
        ghosts: Vec::new(),
    };
    if view.plane.is_some() {
        seen.shadows = std::iter::once(Surface::Core)
            .chain(soft.then_some(Surface::Shell))
            .map(|surface| shadow(o, surface, view))
            .collect();
    }
    if o.obstacle.is_moving() && until > time {
        let at = |share: f64| o.obstacle.at(time + (until - time) * share);
        let track: Vec<_> = (0..=120).map(|i| view.project(&at(f64::from(i) / 120.0).pose.center)).collect();
        if track.windows(2).any(|w| w[0] != w[1]) {
            seen.track = track;
            seen.track.dedup();
        }
        seen.ghosts = marks.iter().filter_map(|t| outline_at(o, *t, view)).collect();
    }
    seen
}

/// The core's outline at another time: in 3-D its shadow, for the plane of the section may miss it.
fn outline_at(o: &PosedObstacle<'_>, time: f64, view: &View) -> Option<Polygon> {
    let then = o.obstacle.at(time);
    if view.plane.is_some() { Some(shadow(&then, Surface::Core, view)) } else { section(&then, Surface::Core, view) }
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
