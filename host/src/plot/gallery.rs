//! Several scenes beside each other, each as it is at its begin.

use nalgebra::{Point2, Vector2};

use super::approach::Moment;
use super::figure::{Anchor, Axes, Extent, Svg};
use super::panel::{self, Panel};
use super::view::View;
use super::{Figure, Options, PlotError, SCALE_ROOM, Trajectory, legend, trajectory};
use crate::scene::Scene;

/// One of them.
#[derive(Clone, Debug)]
pub struct Tile<'a> {
    /// What is written over it.
    pub title: String,
    /// The scene; one of two dimensions.
    pub scene: &'a Scene,
    /// Where robots went in it.
    pub trajectories: &'a [Trajectory],
    /// What is drawn of it; its width counts for nothing here.
    pub options: Options,
}

const EDGE: f64 = 10.0;
const TITLE: f64 = 18.0;
const BELOW: f64 = 24.0;
const BETWEEN: f64 = 10.0;

/// Scenes in rows of so many, all tiles of a row of one size, with one legend and one scale of speeds. `width` in px, as in [`Options`].
///
/// # Errors
/// As [`super::scene_figure`].
pub fn gallery(tiles: &[Tile<'_>], columns: usize, width: f64) -> Result<Figure, PlotError> {
    let columns = columns.max(1);
    let all: Vec<Trajectory> =
        tiles.iter().filter(|t| t.options.speed).flat_map(|t| t.trajectories.iter().cloned()).collect();
    let speeds = trajectory::speeds(&all);
    let mut panels: Vec<Vec<Panel<'_>>> = Vec::new();
    for tile in tiles {
        let moment = Moment { time: tile.options.time, tail: None };
        let speeds = speeds.filter(|_| tile.options.speed);
        let views = View::of(tile.scene);
        let of_view = |view: &View| Panel::new(tile.scene, view, tile.trajectories, speeds, &moment, &tile.options);
        panels.push(views.iter().take(1).map(of_view).collect::<Result<_, _>>()?);
    }
    // Each tile shows its own part of the world.
    let mut extents: Vec<Extent> = panels.iter().flat_map(|one| panel::shared(std::slice::from_ref(one))).collect();
    let each = |left: f64| {
        let right = EDGE + if speeds.is_some() { SCALE_ROOM } else { 0.0 };
        (width - EDGE - right - BETWEEN * (columns - 1) as f64) / columns as f64 - left
    };
    extents.chunks_mut(columns).for_each(same_shape);
    let high = |e: &Extent| each(40.0) * e.size().y / e.size().x;
    let left = extents.iter().map(|e| Axes::left_room_of_close_ticks(e, high(e)) - 14.0).fold(0.0, f64::max);
    let each = each(left);
    let mut svg = Svg::default();
    let mut top = EDGE;
    let mut first = None;
    let rows = panels.chunks(columns).zip(extents.chunks(columns)).zip(tiles.chunks(columns));
    for (row, ((panels, extents), tiles)) in rows.enumerate() {
        top += TITLE;
        let mut bottom = top;
        for (i, ((panels, extent), tile)) in panels.iter().zip(extents).zip(tiles).enumerate() {
            let corner = Point2::new(EDGE + left + (each + left + BETWEEN) * i as f64, top);
            let axes = Axes::equal(corner, each, *extent).with_close_ticks();
            for panel in panels {
                panel.draw(&mut svg, &axes, &format!("tile{row}-{i}"));
            }
            axes.frame(&mut svg, Some(""), Some(""));
            let middle = Point2::new((axes.corner.x + axes.end().x) / 2.0, axes.corner.y - 6.0);
            svg.text(middle, Anchor::Middle, "", &tile.title);
            bottom = bottom.max(axes.end().y);
            if row == 0 {
                first = Some(axes);
            }
        }
        top = bottom + BELOW;
    }
    if let (Some(speeds), Some(first)) = (speeds, first) {
        legend::speed_scale(&mut svg, &first, top - BELOW, speeds);
    }
    let all: Vec<&Panel<'_>> = panels.iter().flatten().collect();
    svg.text(Point2::new(EDGE + left, top + 14.0), Anchor::Start, "", "axes: x, y (m)");
    let bottom = legend::draw(&mut svg, &all, Point2::new(EDGE + left, top + 20.0), width - EDGE);
    let cut = panels.iter().zip(&extents).flat_map(|(panels, e)| panels.iter().map(|p| p.cut(e))).sum();
    Ok(Figure { svg: svg.finish(Vector2::new(width, bottom + EDGE)), cut })
}

/// Makes all as high over their width as the highest.
fn same_shape(extents: &mut [Extent]) {
    let shape = extents.iter().map(|e| e.size().y / e.size().x).fold(0.0, f64::max);
    for e in extents {
        let raise = (e.size().x * shape - e.size().y) / 2.0;
        (e.low.y, e.high.y) = (e.low.y - raise, e.high.y + raise);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_of_a_row_get_one_shape_around_their_middles() {
        let e = |w: f64, h: f64| Extent { low: Point2::new(1.0, 2.0), high: Point2::new(1.0 + w, 2.0 + h) };
        let mut row = [e(2.0, 1.0), e(1.0, 1.0)];
        same_shape(&mut row);
        assert!((row[0].size() - Vector2::new(2.0, 2.0)).norm() < 1e-12 && row[1] == e(1.0, 1.0));
        assert!((row[0].low.y - 1.5).abs() < 1e-12);
    }
}
