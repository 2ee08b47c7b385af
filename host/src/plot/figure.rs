//! Axes to draw in: from metres to pixels and back, and the few SVG elements figures are made of.

use std::fmt::Write as _;

use nalgebra::{Point2, Vector2};

use super::ticks::{Tick, scale_ticks};

/// A rectangle in data units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Least x and y.
    pub low: Point2<f64>,
    /// Largest x and y.
    pub high: Point2<f64>,
}

impl Extent {
    /// The smallest that holds all points; none if there is no finite point.
    pub fn around(points: impl IntoIterator<Item = Point2<f64>>) -> Option<Self> {
        points.into_iter().filter(|p| p.x.is_finite() && p.y.is_finite()).fold(None, |extent: Option<Self>, p| {
            let Self { low, high } = extent.unwrap_or(Self { low: p, high: p });
            Some(Self { low: low.inf(&p), high: high.sup(&p) })
        })
    }

    /// Larger by `share` of the longer side all around, and at least `least` wide and high.
    pub fn padded(self, share: f64, least: f64) -> Self {
        let size = self.high - self.low;
        let pad = Vector2::from_element(share * size.max());
        let missing = size.map(|s| (least - s).max(0.0)) / 2.0;
        Self { low: self.low - pad - missing, high: self.high + pad + missing }
    }

    /// Width and height.
    pub fn size(&self) -> Vector2<f64> {
        self.high - self.low
    }

    /// Is a point in it?
    pub fn holds(&self, p: &Point2<f64>) -> bool {
        (self.low.x..=self.high.x).contains(&p.x) && (self.low.y..=self.high.y).contains(&p.y)
    }
}

/// A plot's rectangle on the page and what it shows.
#[derive(Clone, Copy, Debug)]
pub struct Axes {
    /// Left upper corner on the page, px.
    pub corner: Point2<f64>,
    /// px
    pub size: Vector2<f64>,
    /// What is shown.
    pub extent: Extent,
    /// Pixels from one tick to the next, about.
    pub tick_every: f64,
}

/// A position on the page, px.
pub type Pixel = Point2<f64>;

impl Axes {
    /// Axes `width` pixels wide with as much height as makes both directions the same scale.
    pub fn equal(corner: Pixel, width: f64, extent: Extent) -> Self {
        let size = extent.size();
        Self { corner, size: Vector2::new(width, width * size.y / size.x), extent, tick_every: TICK_EVERY }
    }

    /// Axes of a given size, each direction with its own scale.
    pub fn free(corner: Pixel, size: Vector2<f64>, extent: Extent) -> Self {
        Self { corner, size, extent, tick_every: TICK_EVERY }
    }

    /// Pixels a unit of x is long.
    pub fn scale(&self) -> f64 {
        self.size.x / self.extent.size().x
    }

    /// Where a point is on the page.
    pub fn pixel(&self, p: &Point2<f64>) -> Pixel {
        let share = (p - self.extent.low).component_div(&self.extent.size());
        Point2::new(self.corner.x + share.x * self.size.x, self.corner.y + (1.0 - share.y) * self.size.y)
    }

    /// The right lower corner on the page.
    pub fn end(&self) -> Pixel {
        self.corner + self.size
    }

    /// Grid lines, to go under what is drawn.
    pub fn grid(&self, svg: &mut Svg) {
        let (x, y) = self.ticks();
        let end = self.end();
        for t in &x {
            let p = self.pixel(&Point2::new(t.value, self.extent.low.y));
            svg.line([Point2::new(p.x, self.corner.y), Point2::new(p.x, end.y)], r##"stroke="#eef0f3""##);
        }
        for t in &y {
            let p = self.pixel(&Point2::new(self.extent.low.x, t.value));
            svg.line([Point2::new(self.corner.x, p.y), Point2::new(end.x, p.y)], r##"stroke="#eef0f3""##);
        }
    }

    /// The frame, ticks, and for each direction with a name that and the numbers; to go over what is drawn.
    pub fn frame(&self, svg: &mut Svg, x_name: Option<&str>, y_name: Option<&str>) {
        let (x, y) = self.ticks();
        let end = self.end();
        svg.rect(self.corner, self.size, r##"fill="none" stroke="#3a3f47""##);
        for t in &x {
            let p = self.pixel(&Point2::new(t.value, self.extent.low.y));
            svg.line([p, p + Vector2::new(0.0, 4.0)], r##"stroke="#3a3f47""##);
            if x_name.is_some() {
                svg.text(p + Vector2::new(0.0, 17.0), Anchor::Middle, "", &t.label);
            }
        }
        let mut widest = 0.0f64;
        for t in &y {
            let p = self.pixel(&Point2::new(self.extent.low.x, t.value));
            svg.line([p, p - Vector2::new(4.0, 0.0)], r##"stroke="#3a3f47""##);
            if y_name.is_some() {
                svg.text(p + Vector2::new(-7.0, 4.2), Anchor::End, "", &t.label);
            }
            widest = widest.max(text_width(&t.label));
        }
        if let Some(name) = x_name {
            svg.text(Point2::new((self.corner.x + end.x) / 2.0, end.y + 35.0), Anchor::Middle, "", name);
        }
        if let Some(name) = y_name {
            let at = Point2::new(self.corner.x - widest - 14.0, (self.corner.y + end.y) / 2.0);
            let turn = format!(r#"transform="rotate(-90 {:.2} {:.2})""#, at.x, at.y);
            svg.text(at, Anchor::Middle, &turn, name);
        }
    }

    /// The same with ticks closer to each other, for a small plot.
    pub fn with_close_ticks(self) -> Self {
        Self { tick_every: CLOSE_TICKS, ..self }
    }

    /// Room that the numbers and the name of y need on the left, px.
    pub fn left_room(extent: &Extent, height: f64) -> f64 {
        Self::room(extent, height, TICK_EVERY)
    }

    /// The same for [close ticks](Self::with_close_ticks).
    pub fn left_room_of_close_ticks(extent: &Extent, height: f64) -> f64 {
        Self::room(extent, height, CLOSE_TICKS)
    }

    fn room(extent: &Extent, height: f64, every: f64) -> f64 {
        let labels = scale_ticks(extent.low.y, extent.high.y, height, every, |_| FONT_SIZE);
        labels.iter().map(|t| text_width(&t.label)).fold(0.0, f64::max) + 28.0
    }

    fn ticks(&self) -> (Vec<Tick>, Vec<Tick>) {
        let Extent { low, high } = self.extent;
        let x = scale_ticks(low.x, high.x, self.size.x, self.tick_every, text_width);
        (x, scale_ticks(low.y, high.y, self.size.y, self.tick_every, |_| FONT_SIZE))
    }
}

/// Pixels from one tick to the next, about.
const TICK_EVERY: f64 = 62.0;
/// The same in a small plot.
const CLOSE_TICKS: f64 = 40.0;

/// Which part of a text is where it is put.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its begin.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// Size of all text, px.
pub const FONT_SIZE: f64 = 12.0;

/// About how wide a text is in DejaVu Sans, px.
pub fn text_width(text: &str) -> f64 {
    let em = |c: char| match c {
        'i' | 'j' | 'l' | '.' | ',' | ' ' | '\'' | 'I' | ':' => 0.31,
        'f' | 't' | 'r' | '(' | ')' | '/' => 0.39,
        'm' | 'w' | 'M' | 'W' | '\u{2212}' => 0.9,
        _ => 0.62,
    };
    text.chars().map(em).sum::<f64>() * FONT_SIZE
}

/// SVG as it is written, element by element.
#[derive(Clone, Debug, Default)]
pub struct Svg {
    body: String,
}

impl Svg {
    /// A line from one place to another.
    pub fn line(&mut self, [a, b]: [Pixel; 2], style: &str) {
        let _ =
            writeln!(self.body, r#"<line x1="{:.2}" y1="{:.2}" x2="{:.2}" y2="{:.2}" {style}/>"#, a.x, a.y, b.x, b.y);
    }

    /// A line through many places, closed or not.
    pub fn path(&mut self, points: impl IntoIterator<Item = Pixel>, closed: bool, style: &str) {
        let d = outline(points);
        let end = if closed { "Z" } else { "" };
        if !d.is_empty() {
            let _ = writeln!(self.body, r#"<path d="{d}{end}" {style}/>"#);
        }
    }

    /// What is inside closed lines, or between them: where an odd number of them is around.
    pub fn area(&mut self, rings: &[Vec<Pixel>], style: &str) {
        let d = outlines(rings);
        let _ = writeln!(self.body, r#"<path d="{d}" fill-rule="evenodd" {style}/>"#);
    }

    /// Draws with everything outside an [`area`](Self::area) cut off. `id` is unique in the figure.
    pub fn within(&mut self, id: &str, rings: &[Vec<Pixel>], draw: impl FnOnce(&mut Self)) {
        let d = outlines(rings);
        let _ = writeln!(self.body, r#"<clipPath id="{id}"><path d="{d}" clip-rule="evenodd"/></clipPath>"#);
        let _ = writeln!(self.body, r#"<g clip-path="url(#{id})">"#);
        draw(self);
        self.body += "</g>\n";
    }

    /// Draws with a style that all of it has in common.
    pub fn group(&mut self, style: &str, draw: impl FnOnce(&mut Self)) {
        let _ = writeln!(self.body, "<g {style}>");
        draw(self);
        self.body += "</g>\n";
    }

    /// A rectangle by its left upper corner.
    pub fn rect(&mut self, at: Pixel, size: Vector2<f64>, style: &str) {
        let _ = writeln!(
            self.body,
            r#"<rect x="{:.2}" y="{:.2}" width="{:.2}" height="{:.2}" {style}/>"#,
            at.x, at.y, size.x, size.y
        );
    }

    /// A circle.
    pub fn circle(&mut self, at: Pixel, radius: f64, style: &str) {
        let _ = writeln!(self.body, r#"<circle cx="{:.2}" cy="{:.2}" r="{radius:.2}" {style}/>"#, at.x, at.y);
    }

    /// A filled arrowhead with its point at `tip`.
    pub fn arrowhead(&mut self, tip: Pixel, direction: &Vector2<f64>, length: f64, style: &str) {
        let Some(d) = direction.try_normalize(1e-12) else {
            return;
        };
        let side = Vector2::new(-d.y, d.x) * (length * 0.42);
        let back = tip - d * length;
        self.path([tip, back + side, back + d * (length * 0.22), back - side], true, style);
    }

    /// A square from its middle.
    pub fn square(&mut self, at: Pixel, half: f64, style: &str) {
        self.rect(at - Vector2::repeat(half), Vector2::repeat(2.0 * half), style);
    }

    /// A diagonal cross with a white edge; `colour` is of its lines.
    pub fn cross(&mut self, at: Pixel, radius: f64, colour: &str) {
        for (edge, width) in [("#ffffff", 4.6), (colour, 2.2)] {
            let style = format!(r#"stroke="{edge}" stroke-width="{width}" stroke-linecap="round""#);
            for side in [-1.0, 1.0] {
                let arm = Vector2::new(radius, radius * side) * std::f64::consts::FRAC_1_SQRT_2;
                self.line([at - arm, at + arm], &style);
            }
        }
    }

    /// A five-pointed star.
    pub fn star(&mut self, at: Pixel, radius: f64, style: &str) {
        let points = (0..10).map(|i| {
            let angle = std::f64::consts::PI * (f64::from(i) / 5.0 - 0.5);
            let r = if i % 2 == 0 { radius } else { radius * 0.42 };
            at + Vector2::new(angle.cos(), angle.sin()) * r
        });
        self.path(points, true, style);
    }

    /// A text.
    pub fn text(&mut self, at: Pixel, anchor: Anchor, style: &str, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let text = text.replace('&', "&amp;").replace('<', "&lt;");
        let _ = writeln!(
            self.body,
            r#"<text x="{:.2}" y="{:.2}" text-anchor="{anchor}" {style}>{text}</text>"#,
            at.x, at.y
        );
    }

    /// A colour scale that runs upwards; used as `fill="url(#id)"`.
    pub fn gradient(&mut self, id: &str, colours: &[String]) {
        let _ = write!(self.body, r#"<linearGradient id="{id}" x1="0" y1="1" x2="0" y2="0">"#);
        let last = colours.len().saturating_sub(1).max(1) as f64;
        for (i, colour) in colours.iter().enumerate() {
            let _ = write!(self.body, r#"<stop offset="{:.4}" stop-color="{colour}"/>"#, i as f64 / last);
        }
        self.body += "</linearGradient>\n";
    }

    /// Draws with everything outside the axes cut off. `id` is unique in the figure.
    pub fn clipped(&mut self, id: &str, axes: &Axes, draw: impl FnOnce(&mut Self)) {
        let _ = write!(self.body, r#"<clipPath id="{id}">"#);
        self.rect(axes.corner, axes.size, "");
        let _ = writeln!(self.body, r#"</clipPath><g clip-path="url(#{id})">"#);
        draw(self);
        self.body += "</g>\n";
    }

    /// The whole document.
    pub fn finish(self, size: Vector2<f64>) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w:.0}\" height=\"{h:.0}\" viewBox=\"0 0 {w:.0} {h:.0}\" \
             font-family=\"DejaVu Sans, Verdana, sans-serif\" font-size=\"{FONT_SIZE}\" fill=\"#22262c\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{}</svg>\n",
            self.body,
            w = size.x,
            h = size.y
        )
    }
}

fn outlines(rings: &[Vec<Pixel>]) -> String {
    rings.iter().map(|ring| outline(ring.iter().copied()) + "Z").collect()
}

/// A line as path data: the first place, then steps from one to the next, which take half the room. Steps are between rounded places, so that
/// rounding does not add up.
fn outline(points: impl IntoIterator<Item = Pixel>) -> String {
    let mut d = String::new();
    let mut before: Option<[i64; 2]> = None;
    for p in points {
        let place = [p.x, p.y].map(|c| (c * 100.0).round() as i64);
        let step = before.map_or(place, |b| [place[0] - b[0], place[1] - b[1]]);
        // One of them with its letter serves for all that follow.
        match d.len() {
            0 => d.push('M'),
            _ if !d.contains('l') => d.push('l'),
            _ if step[0] >= 0 => d.push(' '),
            _ => {}
        }
        push_hundredths(&mut d, step[0]);
        if step[1] >= 0 {
            d.push(' ');
        }
        push_hundredths(&mut d, step[1]);
        before = Some(place);
    }
    d
}

/// A number of hundredths, as short as it gets: `-.5` for -50.
fn push_hundredths(text: &mut String, hundredths: i64) {
    let (whole, part) = (hundredths.unsigned_abs() / 100, hundredths.unsigned_abs() % 100);
    if hundredths < 0 {
        text.push('-');
    }
    if whole > 0 || part == 0 {
        let _ = write!(text, "{whole}");
    }
    match (part, part % 10) {
        (0, _) => {}
        (_, 0) => _ = write!(text, ".{}", part / 10),
        _ => _ = write!(text, ".{part:02}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_axes_have_one_scale_and_y_upwards() {
        let extent = Extent { low: Point2::new(-1.0, 0.0), high: Point2::new(3.0, 2.0) };
        let axes = Axes::equal(Point2::new(10.0, 20.0), 200.0, extent);
        assert_eq!(axes.size, Vector2::new(200.0, 100.0));
        assert_eq!(axes.pixel(&extent.low), Point2::new(10.0, 120.0));
        assert_eq!(axes.pixel(&extent.high), Point2::new(210.0, 20.0));
        assert_eq!(axes.scale(), 50.0);
    }

    /// What a renderer makes of path data with one `M` and one `l`.
    fn places(data: &str) -> Vec<Pixel> {
        let mut numbers = Vec::new();
        let mut one = String::new();
        for c in data.chars().chain([' ']) {
            let goes_on = c.is_ascii_digit() || c == '.' || one.is_empty();
            if !goes_on {
                numbers.push(std::mem::take(&mut one).parse::<f64>().unwrap());
            }
            if c.is_ascii_digit() || c == '.' || c == '-' {
                one.push(c);
            }
        }
        let mut at = Point2::origin();
        let steps = numbers.chunks(2).map(|p| Vector2::new(p[0], p[1]));
        let walk = steps.map(|step| {
            at += step;
            at
        });
        walk.collect()
    }

    #[test]
    fn path_data_leads_to_its_places_however_long_it_is() {
        let spiral = |i: i32| Point2::new(300.0 + 0.013 * f64::from(i) * f64::from(i).sin(), 0.7 * f64::from(i % 37));
        let line: Vec<Pixel> = (0..5000).map(spiral).collect();
        let data = outline(line.iter().copied());
        let drawn = places(&data);
        assert_eq!((drawn.len(), data.matches(['M', 'l']).count()), (line.len(), 2));
        assert!(line.iter().zip(&drawn).all(|(a, b)| (a - b).amax() < 0.005 + 1e-9));
        let corners = [(1.0, -0.5), (1.0, 0.0), (-0.05, 12.3)].map(|(x, y)| Point2::new(x, y));
        assert_eq!(outline(corners), "M1-.5l0 .5-1.05 12.3");
        assert_eq!(outline([]), "");
    }

    #[test]
    fn text_is_escaped() {
        let mut svg = Svg::default();
        svg.text(Point2::origin(), Anchor::Start, "", "a < b & c");
        assert!(svg.finish(Vector2::new(1.0, 1.0)).contains("a &lt; b &amp; c"));
    }
}
