//! The paths of robots: all of them or a part, and what is before a core and what behind it.

use nalgebra::{Point2, Vector3};

use super::figure::{Pixel, Svg};
use super::ink::thinned;
use super::seen::Seen;
use super::style::{BEHIND_CASING, LINE_COLOUR, THIN_CASING, casing, speed_colour};
use super::trajectory::TrajectoryPoint;
use super::view::View;

/// How a path is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stroke {
    Thick,
    /// The same where its [`edge`] is there already.
    Bare,
    Thin,
    /// Behind a core.
    Dashed,
    /// The same of what is thin.
    ThinDashed,
}

impl Stroke {
    fn is_dashed(self) -> bool {
        matches!(self, Self::Dashed | Self::ThinDashed)
    }
}

/// The white edge of a path so many px wide.
pub(super) fn edge(svg: &mut Svg, points: &[TrajectoryPoint], pixel: impl Fn(&Vector3<f64>) -> Pixel, line: f64) {
    let pixels: Vec<Pixel> = points.iter().map(|p| pixel(&p.position)).collect();
    svg.path(thinned(&pixels, 0.1), false, &casing(line));
}

/// A path through points on the page, `line` px wide where it is thick, coloured by speed if there is a range of speeds.
pub(super) fn draw(
    svg: &mut Svg,
    points: &[TrajectoryPoint],
    pixel: impl Fn(&Vector3<f64>) -> Pixel,
    speeds: Option<(f64, f64)>,
    stroke: Stroke,
    line: f64,
) {
    if stroke == Stroke::Thick {
        edge(svg, points, &pixel, line);
    }
    let pixels: Vec<Pixel> = points.iter().map(|p| pixel(&p.position)).collect();
    let width = match stroke {
        Stroke::Thick | Stroke::Bare => line,
        Stroke::Thin | Stroke::ThinDashed => 1.3,
        Stroke::Dashed => 2.4,
    };
    if speeds.is_none() && !stroke.is_dashed() {
        let style = format!(
            r#"fill="none" stroke="{LINE_COLOUR}" stroke-width="{width}" stroke-linecap="round" stroke-linejoin="round""#
        );
        return svg.path(thinned(&pixels, 0.1), false, &style);
    }
    let cap = if stroke.is_dashed() { "butt" } else { "round" };
    let common = format!(r#"fill="none" stroke-width="{width}" stroke-linecap="{cap}""#);
    svg.group(&common, |svg| pieces(svg, points, &pixels, speeds, stroke));
}

/// A path in pieces of one colour each.
fn pieces(svg: &mut Svg, points: &[TrajectoryPoint], pixels: &[Pixel], speeds: Option<(f64, f64)>, stroke: Stroke) {
    let (mut from, mut pieces) = (0, 0);
    for i in 1..pixels.len() {
        // A few pixels long at least, so that the file stays small.
        let least = if stroke.is_dashed() { 4.5 } else { 2.0 };
        if (pixels[i] - pixels[from]).norm() < least && i + 1 < pixels.len() {
            continue;
        }
        let colour = speeds.map_or(LINE_COLOUR.into(), |(low, high)| {
            speed_colour((points[(from + i) / 2].speed - low) / (high - low))
        });
        let piece = &pixels[from..=i];
        if !stroke.is_dashed() || pieces % 2 == 0 {
            match stroke {
                Stroke::Dashed => svg.path(piece.iter().copied(), false, BEHIND_CASING),
                Stroke::ThinDashed => svg.path(piece.iter().copied(), false, THIN_CASING),
                _ => {}
            }
            svg.path(thinned(piece, 0.04), false, &format!(r#"stroke="{colour}""#));
        }
        (from, pieces) = (i, pieces + 1);
    }
}

/// The parts of a path in order, each with whether it is behind a core.
pub(super) fn parts<'p>(
    points: &'p [TrajectoryPoint],
    cores: &[Seen<'_>],
    view: &View,
) -> Vec<(bool, &'p [TrajectoryPoint])> {
    let hidden: Vec<bool> = points.iter().map(|p| is_behind(&p.position, cores, view)).collect();
    let mut parts = Vec::new();
    let mut from = 0;
    for i in 1..=points.len() {
        if i == points.len() || hidden[i] != hidden[from] {
            // Each part goes on to the begin of the next: there is no gap.
            parts.push((hidden[from], &points[from..points.len().min(i + 1)]));
            from = i;
        }
    }
    parts
}

/// Is a core between a point and the viewer?
fn is_behind(p: &Vector3<f64>, cores: &[Seen<'_>], view: &View) -> bool {
    /// Places on the way to the viewer that are looked at.
    const LOOKS: u32 = 80;
    let (toward, seen): (_, Point2<f64>) = (view.toward(), view.project(p));
    let convex = cores.iter().filter(|c| view.is_projection() && !c.core.outside && c.core.holds(&seen));
    convex.map(|c| &c.posed).any(|o| {
        let (middle, reach) = ((o.pose.center - p).dot(&toward), o.shape.extent().norm());
        let (from, until) = ((middle - reach).max(0.0), middle + reach);
        let at = |i: u32| p + toward * (from + (until - from) * f64::from(i) / f64::from(LOOKS));
        until > 0.0 && (0..=LOOKS).any(|i| o.gamma(&at(i)) <= 1.0)
    })
}
