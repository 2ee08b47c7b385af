//! Shapes on the page.

use nalgebra::{Point2, Vector2};

use super::figure::{Axes, Svg};
use super::outline::Region;
use super::streamlines;
use super::style::{FLOW, FLOW_HEAD};

/// Pixels between streamlines, about.
pub(super) const SPACING: f64 = 17.0;

/// Streamlines with arrowheads, so many pixels apart.
pub(super) fn draw_flow(svg: &mut Svg, axes: &Axes, field: &dyn Fn(Point2<f64>) -> Option<Vector2<f64>>, spacing: f64) {
    for line in streamlines(field, &axes.extent, spacing / axes.scale()) {
        let pixels: Vec<_> = line.iter().map(|p| axes.pixel(p)).collect();
        svg.path(thinned(&pixels, 0.04), false, FLOW);
        let length = pixels.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>();
        let heads = (length / 150.0).round().max(1.0);
        for i in 0..heads as usize {
            let at = ((i as f64 + 0.5) / heads * (pixels.len() - 1) as f64) as usize;
            if let Some([from, tip]) = pixels.get(at.saturating_sub(1)..=at).and_then(|w| <[_; 2]>::try_from(w).ok()) {
                svg.arrowhead(tip, &(tip - from), 7.5, FLOW_HEAD);
            }
        }
    }
}

/// A dashed line with an arrowhead.
pub(super) fn draw_track(svg: &mut Svg, axes: &Axes, track: &[Point2<f64>], style: &str, head: &str) {
    let track: Vec<_> = track.iter().map(|p| axes.pixel(p)).collect();
    if let [.., from, tip] = track[..] {
        svg.path(track.iter().copied(), false, style);
        svg.arrowhead(tip, &(tip - from), 8.0, head);
    }
}

/// A closed line on the page.
pub(super) fn ring(polygon: &[Point2<f64>], axes: &Axes) -> Vec<Point2<f64>> {
    let closed: Vec<_> = polygon.iter().chain(polygon.first()).map(|p| axes.pixel(p)).collect();
    let mut ring = thinned(&closed, 0.03);
    ring.pop();
    ring
}

/// A region on the page: what is outside of a line ends beyond the axes, where nothing is seen.
pub(super) fn rings(area: &Region, axes: &Axes) -> Vec<Vec<Point2<f64>>> {
    let mut rings = vec![ring(&area.ring, axes)];
    if area.outside {
        let room = Vector2::new(10.0, 10.0);
        let (low, high) = (axes.corner - room, axes.end() + room);
        rings.push(vec![low, Point2::new(high.x, low.y), high, Point2::new(low.x, high.y)]);
    }
    rings
}

/// Draws with all regions cut out. `name` is unique in the figure.
pub(super) fn beside(svg: &mut Svg, axes: &Axes, name: &str, regions: &[&Region], draw: &dyn Fn(&mut Svg)) {
    let Some((first, others)) = regions.split_first() else {
        return draw(svg);
    };
    let outside = Region { ring: first.ring.clone(), outside: !first.outside };
    let id = format!("beside{name}-{}", others.len());
    svg.within(&id, &rings(&outside, axes), |svg| beside(svg, axes, name, others, draw));
}

/// Without points that are within `tolerance` pixels of the line through their neighbours.
pub(super) fn thinned(points: &[Point2<f64>], tolerance: f64) -> Vec<Point2<f64>> {
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
