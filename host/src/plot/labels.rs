//! Small texts beside what they are about, none over another.

use nalgebra::Vector2;

use super::figure::{Anchor, Axes, Extent, FONT_SIZE, Pixel, Svg, text_width};
use super::style::{SMALL, SMALL_SIZE};

/// What is taken, and what had better not be hidden.
pub(super) struct Labels {
    taken: Vec<Extent>,
    ink: Vec<Pixel>,
    within: Extent,
}

impl Labels {
    pub fn new(axes: &Axes) -> Self {
        Self { taken: Vec::new(), ink: Vec::new(), within: Extent { low: axes.corner, high: axes.end() } }
    }

    /// No text is to be here.
    pub fn keep_free(&mut self, at: Pixel, radius: f64) {
        let r = Vector2::from_element(radius);
        self.taken.push(Extent { low: at - r, high: at + r });
    }

    /// Better no text here.
    pub fn avoid(&mut self, ink: impl IntoIterator<Item = Pixel>) {
        self.ink.extend(ink);
    }

    /// Writes a text near a place where it hides least; not at all where there is no room.
    pub fn text(&mut self, svg: &mut Svg, at: Pixel, text: &str) {
        let size = Vector2::new(text_width(text) * SMALL_SIZE / FONT_SIZE, SMALL_SIZE);
        let around = (0..16).map(|i| f64::from(i) * std::f64::consts::TAU / 16.0);
        let places = around.flat_map(|a| [7.0, 13.0, 21.0].map(|r| (r, Vector2::new(a.cos(), a.sin()))));
        let boxes = places.map(|(r, d)| {
            let center = at + d * r + Vector2::new(d.x * size.x / 2.0, d.y * size.y / 2.0);
            (r, Extent { low: center - size / 2.0, high: center + size / 2.0 })
        });
        let free = boxes.filter(|(_, b)| {
            self.within.holds(&b.low) && self.within.holds(&b.high) && !self.taken.iter().any(|t| overlap(t, b))
        });
        let cost = |(r, b): &(f64, Extent)| {
            let hidden = self.ink.iter().filter(|p| b.holds(p)).count();
            hidden as f64 + r * 0.3
        };
        if let Some((_, place)) = free.min_by(|a, b| cost(a).total_cmp(&cost(b))) {
            svg.text(Pixel::new(place.low.x, place.high.y - 1.5), Anchor::Start, SMALL, text);
            self.taken.push(place);
        }
    }
}

fn overlap(a: &Extent, b: &Extent) -> bool {
    a.low.x < b.high.x && b.low.x < a.high.x && a.low.y < b.high.y && b.low.y < a.high.y
}
