//! A learnt skill beside what it was learnt from: demonstrations, rollouts from their starts, and in the plane streamlines.

use nalgebra::{Point2, SVector, Vector2};

use super::Figure;
use super::figure::{Anchor, Axes, Extent, FONT_SIZE, Pixel, Svg, text_width};
use super::ink::{SPACING, draw_flow, thinned};
use super::style::{ATTRACTOR, FLOW, FLOW_HEAD, START, demonstration};
use crate::learn::evaluate::Motion;
use crate::learn::{Demonstrations, Unit, motion_of, quality, recordings};
use crate::model::ModelFile;

/// How wide demonstrations are, px: the learnt motion goes over them.
const DEMONSTRATION: f64 = 2.6;
pub(super) const ROLLOUT: &str = r##"fill="none" stroke="#1f5fbf" stroke-width="1.4" stroke-linejoin="round""##;

/// A path as it is seen.
type Line = Vec<Point2<f64>>;

/// A learnt skill, to be drawn.
#[derive(Clone, Debug)]
pub struct Portrait {
    pub(super) title: String,
    pub(super) note: String,
    unit: Unit,
    pub(super) views: Vec<Seen>,
}

/// It, along one of the axes.
#[derive(Clone, Debug)]
pub(super) struct Seen {
    axes: [usize; 2],
    demonstrations: Vec<Line>,
    rollouts: Vec<Line>,
    attractor: Point2<f64>,
    /// Only in the plane: a flow in space is not to be seen from one side.
    field: Option<Motion<2>>,
    /// Of one unit, m.
    metres: f64,
}

impl Portrait {
    /// What a model does from where demonstrations start, with lengths in a unit; none where they differ in dimension. The note is written
    /// beside the title.
    pub fn new(
        title: impl Into<String>,
        note: impl Into<String>,
        model: &ModelFile,
        demonstrations: &Demonstrations,
        unit: Unit,
    ) -> Option<Self> {
        let views = match demonstrations.dimension() {
            2 => seen::<2>(model, demonstrations, unit, &[[0, 1]]),
            _ => seen::<3>(model, demonstrations, unit, &[[0, 1], [0, 2]]),
        }?;
        Some(Self { title: title.into(), note: note.into(), unit, views })
    }

    pub(super) fn unit(&self) -> Unit {
        self.unit
    }
}

fn seen<const D: usize>(
    model: &ModelFile,
    demonstrations: &Demonstrations,
    unit: Unit,
    views: &[[usize; 2]],
) -> Option<Vec<Seen>> {
    let motion = motion_of::<D>(model)?;
    let recordings = recordings::<D>(demonstrations);
    let rollouts: Vec<_> = recordings.iter().map(|r| quality::rollout(&motion, r, demonstrations.extent()).0).collect();
    let metres = unit.metres();
    let view = |&axes: &[usize; 2]| {
        let point = |x: &SVector<f64, D>| Point2::new(x[axes[0]], x[axes[1]]) / metres;
        let line = |x: &Vec<SVector<f64, D>>| x.iter().map(point).collect::<Line>();
        Seen {
            axes,
            demonstrations: recordings.iter().map(|r| line(&r.x)).collect(),
            rollouts: rollouts.iter().map(line).collect(),
            attractor: point(&motion.attractor),
            field: motion_of::<2>(model),
            metres,
        }
    };
    Some(views.iter().map(view).collect())
}

impl Seen {
    /// The part of the world that is shown.
    pub(super) fn extent(&self) -> Extent {
        let points = self.demonstrations.iter().chain(&self.rollouts).flatten().copied().chain([self.attractor]);
        let unit = Extent { low: Point2::origin(), high: Point2::new(1.0, 1.0) };
        let found = Extent::around(points).unwrap_or(unit);
        let longest = found.size().max();
        // A straight line still has a flow around it.
        found.padded(0.08, 0.45 * longest.max(1e-6))
    }

    pub(super) fn draw(&self, svg: &mut Svg, axes: &Axes, id: &str, spacing: f64) {
        let lines = |svg: &mut Svg, all: &[Line], style: &str| {
            for line in all {
                let pixels: Vec<_> = line.iter().map(|p| axes.pixel(p)).collect();
                svg.path(thinned(&pixels, 0.1), false, style);
            }
        };
        svg.clipped(id, axes, |svg| {
            if let Some(motion) = &self.field {
                let velocity = |p: Point2<f64>| {
                    let v: Vector2<f64> = motion.velocity(&(p.coords * self.metres));
                    // Only its direction counts, and a slow one has one too.
                    v.try_normalize(1e-12)
                };
                draw_flow(svg, axes, &velocity, spacing);
            }
            lines(svg, &self.demonstrations, &demonstration(DEMONSTRATION));
            lines(svg, &self.rollouts, ROLLOUT);
            self.rollouts.iter().filter_map(|r| r.first()).for_each(|p| svg.circle(axes.pixel(p), 2.6, START));
            svg.star(axes.pixel(&self.attractor), 7.0, ATTRACTOR);
        });
    }

    fn name(&self, i: usize, unit: Unit) -> String {
        format!("{} ({unit})", ["x", "y", "z"][self.axes[i]])
    }
}

const EDGE: f64 = 12.0;
const TITLE: f64 = 20.0;
const BELOW: f64 = 44.0;
/// Room between the numbers under one view and the next, px.
const BETWEEN: f64 = 10.0;

/// One skill with its axes; in space from above and, under that, from the side. `width` in px.
pub fn portrait(skill: &Portrait, width: f64) -> Figure {
    let extents: Vec<Extent> = skill.views.iter().map(Seen::extent).collect();
    let left = extents.iter().map(|e| Axes::left_room(e, width * e.size().y / e.size().x)).fold(0.0, f64::max);
    let mut svg = Svg::default();
    let mut top = EDGE + TITLE;
    let heading = if skill.note.is_empty() { skill.title.clone() } else { format!("{}: {}", skill.title, skill.note) };
    svg.text(Point2::new(left, top - 8.0), Anchor::Start, "", &heading);
    for (i, (view, extent)) in skill.views.iter().zip(&extents).enumerate() {
        let axes = Axes::equal(Point2::new(left, top), width - left - EDGE, *extent);
        axes.grid(&mut svg);
        view.draw(&mut svg, &axes, &format!("view{i}"), SPACING);
        axes.frame(&mut svg, Some(&view.name(0, skill.unit)), Some(&view.name(1, skill.unit)));
        top = axes.end().y + BELOW + BETWEEN;
    }
    let flow = skill.views.iter().any(|v| v.field.is_some());
    let bottom = legend(&mut svg, Point2::new(left, top - BETWEEN), width - EDGE, flow);
    Figure::from_svg(svg.finish(Vector2::new(width, bottom + EDGE)))
}

/// What is what; the lower end of its last line.
pub(super) fn legend(svg: &mut Svg, corner: Pixel, right: f64, flow: bool) -> f64 {
    type Sign = fn(&mut Svg, Pixel);
    let entries: [(bool, &str, Sign); 5] = [
        (true, "demonstration", |svg, p| dash(svg, p, &demonstration(DEMONSTRATION))),
        (true, "learnt motion", |svg, p| dash(svg, p, ROLLOUT)),
        (true, "start", |svg, p| svg.circle(p, 2.6, START)),
        (true, "goal", |svg, p| svg.star(p, 7.0, ATTRACTOR)),
        (flow, "learnt flow", |svg, p| {
            dash(svg, p, FLOW);
            svg.arrowhead(p + Vector2::new(4.0, 0.0), &Vector2::x(), 7.5, FLOW_HEAD);
        }),
    ];
    let mut at = corner + Vector2::new(0.0, FONT_SIZE);
    for (_, name, sign) in entries.into_iter().filter(|e| e.0) {
        let width = 26.0 + text_width(name);
        if at.x + width > right && at.x > corner.x {
            at = Point2::new(corner.x, at.y + FONT_SIZE + 8.0);
        }
        sign(svg, at + Vector2::new(10.0, -4.0));
        svg.text(at + Vector2::new(26.0, 0.0), Anchor::Start, "", name);
        at.x += width + 14.0;
    }
    at.y
}

fn dash(svg: &mut Svg, at: Pixel, style: &str) {
    svg.path([-10.0, 10.0].map(|x| at + Vector2::new(x, 0.0)), false, style);
}

#[cfg(test)]
mod tests {
    use super::super::contact_sheet;
    use super::*;
    use crate::learn::{Demonstration, Options, learn_from};
    use nalgebra::DVector;

    fn skill(dimension: usize) -> Portrait {
        let t: Vec<f64> = (0..100).map(|i| f64::from(i) / 50.0).collect();
        let line = |y: f64| {
            let x = t.iter().map(|t| DVector::from_fn(dimension, |i, _| [0.2, y, 0.1][i] * (2.0 - t))).collect();
            Demonstration::new("line", t.clone(), x, None).unwrap()
        };
        let demonstrations = Demonstrations::new(vec![line(0.0), line(0.01)]).unwrap();
        let learnt = learn_from(demonstrations, &Options::default(), &|_| {}).unwrap();
        Portrait::new("a <line>", "K 1", &learnt.model, &learnt.demonstrations, Unit::Mm).unwrap()
    }

    #[test]
    fn a_planar_skill_has_its_paths_and_its_flow_in_one_view() {
        let figure = portrait(&skill(2), 400.0);
        let text = figure.svg();
        assert_eq!(text.matches("#e8862a").count(), 2 + 1, "two demonstrations and the legend's");
        assert_eq!(text.matches("#1f5fbf").count(), 2 + 1);
        assert!(text.contains("a &lt;line>: K 1") && text.contains("x (mm)") && text.contains("learnt flow"));
        assert!(!text.contains("NaN") && figure.png().unwrap().len() > 1000);
    }

    #[test]
    fn a_spatial_skill_is_seen_from_two_sides_without_a_flow() {
        let text = portrait(&skill(3), 400.0).svg().to_owned();
        assert_eq!(text.matches("#e8862a").count(), 2 * 2 + 1);
        assert!(text.contains("y (mm)") && text.contains("z (mm)") && !text.contains("learnt flow"));
    }

    #[test]
    fn a_sheet_has_a_tile_for_each_with_its_scale() {
        let sheet = contact_sheet(&[skill(2), skill(3), skill(2)], 2, 500.0);
        let text = sheet.svg();
        assert_eq!(text.matches("a &lt;line></text>").count(), 3);
        assert_eq!(text.matches(" mm</text>").count(), 3, "a scale each");
        assert!(!text.contains("NaN"));
        assert!(contact_sheet(&[], 4, 500.0).svg().starts_with("<svg"));
    }
}
