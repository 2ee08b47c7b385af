//! A contact sheet: many learnt skills in small, each at its own scale, with a bar that says which.

use nalgebra::{Point2, Vector2};

use super::Figure;
use super::figure::{Anchor, Axes, Extent, Svg};
use super::portrait::{Portrait, legend};
use super::style::{SMALL, SMALL_SIZE};

const EDGE: f64 = 12.0;
/// Room over a tile for its title and its note, px.
const TITLE: f64 = 17.0;
/// Room under it for its scale.
const SCALE: f64 = 16.0;
const BETWEEN: f64 = 12.0;
/// Between streamlines, px: few enough that a small tile is no carpet.
const SPACING: f64 = 13.0;
/// The longest bar over the width of its tile.
const BAR: f64 = 0.3;
const INK: &str = r##"stroke="#15181c" stroke-width="2""##;
const FRAME: &str = r##"fill="none" stroke="#3a3f47""##;

/// Skills in rows of so many, each in a square of its own scale with its title and its note over it; those in space from above. `width`
/// in px.
pub fn contact_sheet(skills: &[Portrait], columns: usize, width: f64) -> Figure {
    let columns = columns.max(1);
    let side = (width - 2.0 * EDGE - BETWEEN * (columns - 1) as f64) / columns as f64;
    let mut svg = Svg::default();
    let step = Vector2::new(side + BETWEEN, side + TITLE + SCALE + BETWEEN);
    for (i, skill) in skills.iter().enumerate() {
        let Some(view) = skill.views.first() else { continue };
        let (row, column) = (i / columns, i % columns);
        let corner = Point2::new(EDGE + step.x * column as f64, EDGE + TITLE + step.y * row as f64);
        let axes = Axes::equal(corner, side, square(view.extent()));
        view.draw(&mut svg, &axes, &format!("tile{i}"), SPACING);
        svg.rect(axes.corner, axes.size, FRAME);
        svg.text(corner - Vector2::new(0.0, 5.0), Anchor::Start, "", &skill.title);
        svg.text(corner + Vector2::new(side, -5.0), Anchor::End, SMALL, &skill.note);
        bar(&mut svg, &axes, &skill.unit().to_string());
    }
    let top = EDGE + step.y * skills.len().div_ceil(columns) as f64;
    let bottom = legend(&mut svg, Point2::new(EDGE, top), width - EDGE, true);
    Figure::from_svg(svg.finish(Vector2::new(width, bottom + EDGE)))
}

/// The smallest square around an extent's middle that holds it.
fn square(extent: Extent) -> Extent {
    let side = extent.size().max();
    let missing = extent.size().map(|s| side - s) / 2.0;
    Extent { low: extent.low - missing, high: extent.high + missing }
}

/// The largest of 1, 2, 5, 10, 20 and so on up to `most`.
fn round_length(most: f64) -> f64 {
    let power = 10f64.powf(most.log10().floor());
    [5.0, 2.0].into_iter().map(|m| m * power).find(|l| *l <= most * (1.0 + 1e-9)).unwrap_or(power)
}

/// Under the left of a tile.
fn bar(svg: &mut Svg, axes: &Axes, unit: &str) {
    let length = round_length(BAR * axes.extent.size().x);
    let from = Point2::new(axes.corner.x, axes.end().y + 9.0);
    let to = from + Vector2::new(length * axes.scale(), 0.0);
    svg.line([from, to], INK);
    svg.text(to + Vector2::new(5.0, 0.35 * SMALL_SIZE), Anchor::Start, SMALL, &format!("{length} {unit}"));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_are_round_and_not_too_long() {
        for i in 0..600 {
            let most = 1.037f64.powi(i - 300);
            let length = round_length(most);
            assert!(length <= most * (1.0 + 1e-9) && length > most / 2.6, "{length} of {most}");
        }
        assert_eq!((round_length(20.0), round_length(4.9), round_length(0.1)), (20.0, 2.0, 0.1));
    }

    #[test]
    fn a_square_keeps_the_middle() {
        let e = square(Extent { low: Point2::new(1.0, 2.0), high: Point2::new(5.0, 4.0) });
        assert_eq!((e.low, e.high), (Point2::new(1.0, 1.0), Point2::new(5.0, 5.0)));
    }
}
