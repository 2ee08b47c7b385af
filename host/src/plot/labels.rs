//! Small texts beside what they are about, none over another.

use nalgebra::Vector2;

use super::figure::{Anchor, Axes, Extent, FONT_SIZE, Pixel, Svg, text_width};
use super::style::{SMALL, SMALL_SIZE};

/// Between two texts, px: nearer to one another they are read as one.
const APART: f64 = 4.0;
/// Around a text nothing is to be seen either, px: its white edge and a little.
const EDGE: f64 = 2.5;
/// From what a text is about to the text, px: the farther, the less is hidden.
const AWAY: [f64; 5] = [7.0, 13.0, 21.0, 29.0, 37.0];
/// Two places nearer to one another are seen as one, px.
const SAME: f64 = 4.0;
/// To be a px farther away is as bad as to hide so many px of a line.
const FARTHER: f64 = 0.7;
/// To be nearer to what another text is about is as bad as to hide so many px of a line.
const ASTRAY: f64 = 25.0;

/// What is taken, and what had better not be hidden.
pub(super) struct Labels {
    taken: Vec<Extent>,
    /// What texts are about.
    marks: Vec<Pixel>,
    /// What was written, and about where.
    written: Vec<(Pixel, String)>,
    /// Lines, a point a px.
    ink: Vec<Pixel>,
    within: Extent,
}

impl Labels {
    pub fn new(axes: &Axes) -> Self {
        let (taken, marks, written, ink) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { taken, marks, written, ink, within: Extent { low: axes.corner, high: axes.end() } }
    }

    /// No text is to be here.
    pub fn keep_free(&mut self, at: Pixel, radius: f64) {
        self.taken.push(grown(&Extent { low: at, high: at }, radius));
    }

    /// There will be a text about this.
    pub fn mark(&mut self, at: Pixel) {
        self.marks.push(at);
    }

    /// Better no text over this line.
    pub fn avoid(&mut self, line: impl IntoIterator<Item = Pixel>) {
        let mut before: Option<Pixel> = None;
        for p in line {
            let from = before.unwrap_or(p);
            let length = (p - from).norm();
            // Points nearer than a px to the last one that counts are left out, so that a slow robot's path is no better than a fast one's.
            if before.is_none() || length >= 1.0 {
                let steps = length.floor().clamp(1.0, 1e4);
                self.ink.extend((1..=steps as u32).map(|i| from + (p - from) * (f64::from(i) / steps)));
                before = Some(p);
            }
        }
    }

    /// Writes a text near a place where it hides least and is not taken for another's; not at all where there is no room, or where it is said
    /// already.
    pub fn text(&mut self, svg: &mut Svg, at: Pixel, text: &str) {
        if self.written.iter().any(|(place, said)| said == text && (at - place).norm() < SAME) {
            return;
        }
        let size = Vector2::new(text_width(text) * SMALL_SIZE / FONT_SIZE, SMALL_SIZE);
        let around = (0..16).map(|i| f64::from(i) * std::f64::consts::TAU / 16.0);
        let places = around.flat_map(|a| AWAY.map(|r| (r, Vector2::new(a.cos(), a.sin()))));
        let boxes = places.map(|(r, d)| {
            let center = at + d * r + Vector2::new(d.x * size.x / 2.0, d.y * size.y / 2.0);
            (r, Extent { low: center - size / 2.0, high: center + size / 2.0 })
        });
        let free = boxes.filter(|(_, b)| {
            self.within.holds(&b.low) && self.within.holds(&b.high) && !self.taken.iter().any(|t| overlap(t, b))
        });
        let cost = |(r, b): &(f64, Extent)| {
            let covered = grown(b, EDGE);
            let hidden = self.ink.iter().filter(|p| covered.holds(p)).count() as f64;
            let own = distance(b, &at);
            let astray = self.marks.iter().any(|m| distance(b, m) < own - 0.5);
            hidden + r * FARTHER + if astray { ASTRAY } else { 0.0 }
        };
        if let Some((_, place)) = free.min_by(|a, b| cost(a).total_cmp(&cost(b))) {
            svg.text(Pixel::new(place.low.x, place.high.y - 1.5), Anchor::Start, SMALL, text);
            self.taken.push(grown(&place, APART));
            self.written.push((at, text.into()));
        }
    }
}

fn grown(b: &Extent, by: f64) -> Extent {
    let by = Vector2::from_element(by);
    Extent { low: b.low - by, high: b.high + by }
}

/// From a rectangle to a point, 0 inside.
fn distance(b: &Extent, p: &Pixel) -> f64 {
    (b.low - p).sup(&(p - b.high)).sup(&Vector2::zeros()).norm()
}

fn overlap(a: &Extent, b: &Extent) -> bool {
    a.low.x < b.high.x && b.low.x < a.high.x && a.low.y < b.high.y && b.low.y < a.high.y
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;

    fn labels() -> Labels {
        let extent = Extent { low: Point2::origin(), high: Point2::new(1.0, 1.0) };
        Labels::new(&Axes::free(Pixel::origin(), Vector2::new(400.0, 300.0), extent))
    }

    #[test]
    fn a_line_between_two_far_points_is_not_hidden() {
        let at = Pixel::new(200.0, 150.0);
        // Across, down, and both ways aslant.
        for way in [Vector2::x(), Vector2::y(), Vector2::new(1.0, 1.0), Vector2::new(1.0, -1.0)] {
            let mut labels = labels();
            labels.avoid([at - way * 100.0, at + way * 100.0]);
            labels.text(&mut Svg::default(), at, "12 mm");
            let on_it = |i: i32| at + way * (f64::from(i) * 0.5);
            assert_eq!(labels.taken.len(), 1);
            let text = grown(&labels.taken[0], -APART);
            assert!((-200..=200).map(on_it).all(|p| distance(&text, &p) > 1.0), "{way:?}");
        }
    }

    #[test]
    fn of_places_side_by_side_each_has_its_own_text_nearest() {
        let places = [(0.0, 0.0), (9.0, 7.0), (4.0, 14.0)].map(|(x, y)| Pixel::new(200.0 + x, 150.0 + y));
        let mut labels = labels();
        places.iter().for_each(|p| labels.mark(*p));
        for (p, text) in places.iter().zip(["0.1 mm", "15 mm", "0.3 mm"]) {
            labels.text(&mut Svg::default(), *p, text);
        }
        assert_eq!(labels.taken.len(), 3);
        for (i, own) in places.iter().enumerate() {
            let text = grown(&labels.taken[i], -APART);
            assert!(places.iter().all(|p| distance(&text, p) >= distance(&text, own) - 0.5), "{i}");
            // Each with the room around it.
            assert!(
                labels.taken.iter().skip(i + 1).all(|other| !overlap(&labels.taken[i], &grown(other, -APART))),
                "{i}"
            );
        }
    }

    #[test]
    fn what_is_said_of_a_place_is_said_once() {
        let mut labels = labels();
        for (x, text) in [(200.0, "4.0 mm"), (201.0, "4.0 mm"), (201.0, "5.0 mm"), (240.0, "4.0 mm")] {
            labels.text(&mut Svg::default(), Pixel::new(x, 150.0), text);
        }
        assert_eq!(labels.written.len(), 3);
    }
}
