//! Charts: lines, points, bands, cells and outlines against two axes, several side by side, with what their colours mean below.

use nalgebra::{Point2, Vector2};

use super::Figure;
use super::figure::{Anchor, Axes, Extent, FONT_SIZE, Pixel, Svg, text_width};
use super::ink::thinned;
use super::style::{ATTRACTOR, CORE, SHELL, START};

/// A colour of a series; they differ in lightness too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colour {
    /// Orange.
    Letter,
    /// Blue.
    Pliant,
    /// Grey.
    Original,
    /// Cyan.
    Reference,
}

impl Colour {
    fn hex(self) -> &'static str {
        match self {
            Self::Letter => "#d9730d",
            Self::Pliant => "#1f5fbf",
            Self::Original => "#6b7480",
            Self::Reference => "#17a2b8",
        }
    }
}

/// How a series is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A line from point to point.
    Line,
    /// The same, dashed.
    Dashed,
    /// A line with a dot at each point.
    Dotted,
    /// A dot at each point.
    Dots,
    /// An area between these values of y and the points'.
    Band(Vec<f64>),
}

/// Points with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Charts of a figure that use a name twice mean the same.
    pub name: String,
    /// Its colour.
    pub colour: Colour,
    /// How it is drawn.
    pub mark: Mark,
    /// x and y, by increasing x.
    pub points: Vec<(f64, f64)>,
}

impl Series {
    /// Points that are joined by a line.
    pub fn line(name: impl Into<String>, colour: Colour, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), colour, mark: Mark::Line, points }
    }

    /// The share of all values that are no larger, in percent, over the value: an empirical distribution. Values are in order.
    pub fn distribution(name: impl Into<String>, colour: Colour, sorted: &[f64]) -> Self {
        let whole = sorted.len().max(1) as f64;
        let rise = |(i, x): (usize, &f64)| [(*x, i as f64 / whole * 100.0), (*x, (i + 1) as f64 / whole * 100.0)];
        Self::line(name, colour, sorted.iter().enumerate().flat_map(rise).collect())
    }
}

/// A shape on a map, m.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// A hard core's outline.
    Core(Vec<(f64, f64)>),
    /// A soft layer's.
    Shell(Vec<(f64, f64)>),
    /// Where a motion starts.
    Start((f64, f64)),
    /// Where it ends.
    Goal((f64, f64)),
}

/// A square of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Its middle.
    pub at: (f64, f64),
    /// Its side.
    pub side: f64,
    /// Its colour, between 0 (white) and 1; below zero reddish.
    pub share: f64,
    /// What is written in it.
    pub label: String,
}

/// One pair of axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// Over it.
    pub title: String,
    /// The name of x and its unit.
    pub x: String,
    /// The name of y and its unit.
    pub y: String,
    /// Under all else.
    pub cells: Vec<Cell>,
    /// Under the series.
    pub places: Vec<Place>,
    /// Lines to compare with, under the series; they alone are nothing to show.
    pub guides: Vec<Series>,
    /// What is drawn, the last on top.
    pub series: Vec<Series>,
    /// The range of x; what the points need if not given.
    pub x_range: Option<(f64, f64)>,
    /// The range of y; likewise.
    pub y_range: Option<(f64, f64)>,
    /// Have both axes the same scale?
    pub map: bool,
}

const EDGE: f64 = 10.0;
const TITLE: f64 = 18.0;
const BELOW: f64 = 44.0;
const BETWEEN: f64 = 16.0;
/// Height over width of a chart that is no map.
const SHAPE: f64 = 0.78;

/// Charts in rows of so many, all as wide as each other. `width` in px: text has a fixed size, see [`super::Options::width`].
pub fn charts(charts: &[Chart], columns: usize, width: f64) -> Figure {
    let mut svg = Svg::default();
    let columns = columns.max(1);
    let extents: Vec<Extent> = charts.iter().map(Chart::extent).collect();
    let left =
        extents.iter().map(|e| Axes::left_room_of_close_ticks(e, width / columns as f64 * SHAPE)).fold(0.0, f64::max);
    let each = (width - 2.0 * EDGE - BETWEEN * (columns - 1) as f64) / columns as f64 - left;
    let mut top = EDGE;
    for (row, (some, ranges)) in charts.chunks(columns).zip(extents.chunks(columns)).enumerate() {
        top += TITLE;
        let mut bottom = top;
        // Beside a map the others are as high as it is.
        let maps = some.iter().zip(ranges).filter(|(c, _)| c.map);
        let height = maps.map(|(_, e)| each * e.size().y / e.size().x).fold(0.0, f64::max);
        let height = if height > 0.0 { height } else { each * SHAPE };
        for (i, (chart, extent)) in some.iter().zip(ranges).enumerate() {
            let corner = Point2::new(EDGE + left + (each + left + BETWEEN) * i as f64, top);
            let axes = if chart.map {
                Axes::equal(corner, each, *extent)
            } else {
                Axes::free(corner, Vector2::new(each, height), *extent)
            };
            let axes = axes.with_close_ticks();
            chart.draw(&mut svg, &axes, &format!("chart{row}-{i}"));
            bottom = bottom.max(axes.end().y);
        }
        top = bottom + BELOW;
    }
    let bottom = legend(&mut svg, charts, Point2::new(EDGE + left, top), width - EDGE);
    Figure::from_svg(svg.finish(Vector2::new(width, bottom + EDGE)))
}

/// What is written where no series has a point and there is no cell.
const NOTHING: &str = "nothing to show";

impl Chart {
    /// Guides and series, the last on top.
    fn lines(&self) -> impl Iterator<Item = &Series> {
        self.guides.iter().chain(&self.series)
    }

    /// Is there nothing in it but what it would have been compared with?
    fn is_empty(&self) -> bool {
        self.cells.is_empty() && self.series.iter().all(|s| s.points.is_empty())
    }

    fn extent(&self) -> Extent {
        let bands = self.series.iter().flat_map(|s| match &s.mark {
            Mark::Band(low) => s.points.iter().zip(low).map(|((x, _), y)| (*x, *y)).collect(),
            _ => Vec::new(),
        });
        let outlines = self.places.iter().flat_map(|p| match p {
            Place::Core(ring) | Place::Shell(ring) => ring.clone(),
            Place::Start(at) | Place::Goal(at) => vec![*at],
        });
        let corners = self.cells.iter().flat_map(|c| {
            let half = c.side / 2.0;
            [(c.at.0 - half, c.at.1 - half), (c.at.0 + half, c.at.1 + half)]
        });
        let points = self.lines().flat_map(|s| s.points.iter().copied());
        let all = points.chain(bands).chain(outlines).chain(corners).map(|(x, y)| Point2::new(x, y));
        let unit = Extent { low: Point2::origin(), high: Point2::new(1.0, 1.0) };
        let found = Extent::around(all).unwrap_or(unit);
        let range = |given: Option<(f64, f64)>, low: f64, high: f64| {
            given.unwrap_or_else(|| {
                let room = ((high - low) * 0.06).max(1e-3 * high.abs().max(1e-6));
                (low - room, high + room)
            })
        };
        let (x, y) = (range(self.x_range, found.low.x, found.high.x), range(self.y_range, found.low.y, found.high.y));
        Extent { low: Point2::new(x.0, y.0), high: Point2::new(x.1, y.1) }
    }

    fn draw(&self, svg: &mut Svg, axes: &Axes, id: &str) {
        axes.grid(svg);
        let pixel = |(x, y): &(f64, f64)| axes.pixel(&Point2::new(*x, *y));
        svg.clipped(id, axes, |svg| {
            for cell in &self.cells {
                let side = cell.side * axes.scale();
                let at = pixel(&cell.at);
                let style = format!(r##"fill="{}" stroke="#ffffff" stroke-width="1""##, shade(cell.share));
                svg.rect(at - Vector2::repeat(side / 2.0), Vector2::repeat(side), &style);
            }
            for place in &self.places {
                match place {
                    Place::Core(ring) => svg.area(&[ring.iter().map(pixel).collect()], CORE),
                    Place::Shell(ring) => svg.area(&[ring.iter().map(pixel).collect()], SHELL),
                    Place::Start(_) | Place::Goal(_) => {}
                }
            }
            self.lines().for_each(|s| s.draw(svg, &pixel));
            for place in &self.places {
                match place {
                    Place::Core(_) | Place::Shell(_) => {}
                    Place::Start(at) => svg.circle(pixel(at), 4.0, START),
                    Place::Goal(at) => svg.star(pixel(at), 8.0, ATTRACTOR),
                }
            }
            for cell in &self.cells {
                let size = (cell.side * axes.scale() * 0.36).min(FONT_SIZE);
                let style = format!(
                    r##"font-size="{size:.1}" stroke="#ffffff" stroke-width="2.2" stroke-linejoin="round" paint-order="stroke""##
                );
                svg.text(pixel(&cell.at) + Vector2::new(0.0, size * 0.36), Anchor::Middle, &style, &cell.label);
            }
        });
        if self.is_empty() {
            let middle = nalgebra::center(&axes.corner, &axes.end());
            svg.text(middle, Anchor::Middle, "", NOTHING);
        }
        axes.frame(svg, Some(&self.x), Some(&self.y));
        let middle = Point2::new((axes.corner.x + axes.end().x) / 2.0, axes.corner.y - 6.0);
        svg.text(middle, Anchor::Middle, "", &self.title);
    }
}

impl Series {
    fn draw(&self, svg: &mut Svg, pixel: &impl Fn(&(f64, f64)) -> Pixel) {
        let points: Vec<Pixel> = self.points.iter().map(pixel).collect();
        let stroke = |more: &str| {
            format!(r#"fill="none" stroke="{}" stroke-width="1.8" stroke-linejoin="round" {more}"#, self.colour.hex())
        };
        let dots = |svg: &mut Svg, radius: f64| {
            let style = format!(r#"fill="{}""#, self.colour.hex());
            points.iter().for_each(|p| svg.circle(*p, radius, &style));
        };
        match &self.mark {
            Mark::Line => svg.path(thinned(&points, 0.05), false, &stroke("")),
            Mark::Dashed => svg.path(thinned(&points, 0.05), false, &stroke(r#"stroke-dasharray="5 3""#)),
            Mark::Dotted => {
                svg.path(points.iter().copied(), false, &stroke(""));
                dots(svg, 3.0);
            }
            Mark::Dots => dots(svg, 1.9),
            Mark::Band(low) => {
                let back = self.points.iter().zip(low).rev().map(|((x, _), y)| pixel(&(*x, *y)));
                let ring = points.iter().copied().chain(back).collect();
                svg.area(&[ring], &format!(r#"fill="{}" fill-opacity="0.18" stroke="none""#, self.colour.hex()));
            }
        }
    }

    fn sign(&self, svg: &mut Svg, at: Pixel) {
        let ends: Vec<Pixel> = [-10.0, 10.0].iter().map(|x| at + Vector2::new(*x, 0.0)).collect();
        let hex = self.colour.hex();
        let line = |svg: &mut Svg, dash: &str| {
            svg.path(ends.iter().copied(), false, &format!(r#"fill="none" stroke="{hex}" stroke-width="1.8" {dash}"#));
        };
        match self.mark {
            Mark::Line => line(svg, ""),
            Mark::Dashed => line(svg, r#"stroke-dasharray="5 3""#),
            Mark::Dotted => {
                line(svg, "");
                svg.circle(at, 3.0, &format!(r#"fill="{hex}""#));
            }
            Mark::Dots => svg.circle(at, 2.4, &format!(r#"fill="{hex}""#)),
            Mark::Band(_) => {
                let style = format!(r#"fill="{hex}" fill-opacity="0.18""#);
                svg.rect(at - Vector2::new(10.0, 5.0), Vector2::new(20.0, 10.0), &style);
            }
        }
    }
}

/// White to green, or to red below zero.
fn shade(share: f64) -> String {
    let full = if share < 0.0 { [214.0, 96.0, 77.0] } else { [26.0, 140.0, 105.0] };
    let by = share.abs().min(1.0);
    let [r, g, b] = full.map(|c: f64| (247.0 + (c - 247.0) * by).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Each name once, with a word where it has no point in any chart; the lower end of the last line.
fn legend(svg: &mut Svg, charts: &[Chart], corner: Pixel, right: f64) -> f64 {
    let mut known: Vec<(&Series, String)> = Vec::new();
    let all = || charts.iter().flat_map(Chart::lines).filter(|s| !s.name.is_empty());
    for s in all() {
        if known.iter().all(|(k, _)| k.name != s.name) {
            let none = all().filter(|other| other.name == s.name).all(|other| other.points.is_empty());
            known.push((s, if none { format!("{}: none", s.name) } else { s.name.clone() }));
        }
    }
    let mut at = corner + Vector2::new(0.0, FONT_SIZE);
    for (s, name) in &known {
        let width = 26.0 + text_width(name) + 14.0;
        if at.x + width - 14.0 > right && at.x > corner.x {
            at = Point2::new(corner.x, at.y + FONT_SIZE + 8.0);
        }
        s.sign(svg, at + Vector2::new(10.0, -4.0));
        svg.text(at + Vector2::new(26.0, 0.0), Anchor::Start, "", name);
        at.x += width;
    }
    if known.is_empty() { corner.y - EDGE } else { at.y }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_distribution_rises_from_nothing_to_all() {
        let s = Series::distribution("d", Colour::Pliant, &[1.0, 2.0, 2.0, 4.0]);
        assert_eq!((s.points[0], s.points[7]), ((1.0, 0.0), (4.0, 100.0)));
        assert!(s.points.windows(2).all(|w| w[0].0 <= w[1].0 && w[0].1 <= w[1].1));
    }

    #[test]
    fn where_nothing_was_measured_the_chart_says_so() {
        let guide = Series::line("the paper's", Colour::Letter, vec![(1.0, 0.0), (1.0, 9.0)]);
        let empty = Chart {
            series: vec![Series::distribution("places", Colour::Pliant, &[])],
            guides: vec![guide],
            ..Chart::default()
        };
        let text = charts(std::slice::from_ref(&empty), 1, 300.0).svg().to_owned();
        assert!(text.contains(">nothing to show</text>") && text.contains(">places: none</text>"), "{text}");
        assert!(!text.contains("NaN") && !text.contains("inf"));
        let full = Chart { series: vec![Series::distribution("places", Colour::Pliant, &[1.0])], ..empty.clone() };
        let both = charts(&[empty, full], 2, 600.0).svg().to_owned();
        assert_eq!(both.matches(NOTHING).count(), 1);
        assert!(both.contains(">places</text>") && !both.contains("places: none"));
    }

    #[test]
    fn charts_have_titles_axes_and_one_entry_for_a_name() {
        let line = || Series::line("speed & time", Colour::Letter, vec![(0.0, 1.0), (1.0, 3.0)]);
        let band = Series { mark: Mark::Band(vec![-5.0, 0.0]), name: "spread".into(), ..line() };
        let cell = Cell { at: (0.5, 2.0), side: 0.2, share: -0.3, label: "-3".into() };
        let chart = Chart {
            title: "one".into(),
            x: "x (m)".into(),
            series: vec![line(), band],
            cells: vec![cell],
            ..Chart::default()
        };
        let svg = charts(&[chart.clone(), Chart { title: "two".into(), ..chart }], 2, 400.0);
        let text = svg.svg();
        assert_eq!(text.matches("speed &amp; time</text>").count(), 1);
        assert!(text.contains(">one</text>") && text.contains(">two</text>") && text.matches("x (m)").count() == 2);
        assert!(svg.png().unwrap().len() > 1000);
        assert!(!text.contains("NaN"));
    }
}
