//! The paper to the letter by its angle theta_2: what it does is up to the angle, and to the side on which the obstacle is passed.

use crate::error::Error;
use crate::plot::Figure;
use crate::plot::chart::{Chart, Colour, Mark, Series, charts};
use crate::study::column::{Column, THETA};
use crate::study::drive::{Driving, Robot, drive};
use crate::study::experiments::cases::one;
use crate::study::measure::{change_percent, mean_speed, quantile, sorted};
use crate::study::parallel;
use crate::study::skill::Skill;
use crate::study::table::{Table, signed, yes};
use crate::study::world::World;

/// Degrees between two angles.
const STEP: i32 = 10;
/// Where the cylinder is: at this share of the path, this far to its left or its right, m.
const PLACE: (f64, f64) = (0.53, 0.025);

/// What came of an angle on a side.
#[derive(Clone, Copy, Debug)]
pub struct Angle {
    /// Degrees; none is the default, which takes the flow's.
    degrees: Option<i32>,
    /// Is the obstacle to the left?
    left: bool,
    /// Percent.
    change: Option<f64>,
    reached: bool,
    touched: bool,
}

/// Every angle, on both sides.
pub fn study(skill: &Skill, done: &(dyn Fn(usize) + Sync)) -> Result<Vec<Angle>, Error> {
    let angles = (-180 / STEP..=180 / STEP).map(|i| Some(i * STEP)).chain([None]);
    let all: Vec<(Option<i32>, bool)> = angles.flat_map(|a| [(a, true), (a, false)]).collect();
    parallel::map(&all, done, |(degrees, left)| {
        let world =
            World { timeout: 15.0, ..World::new(skill, one(skill, PLACE.0, if *left { PLACE.1 } else { -PLACE.1 })) };
        let driving = Driving { ends_at_contact: true, ..Driving::of(Robot::Exact) };
        let run = |column| {
            let scene = world.scene("angle", column)?;
            drive(&scene, &skill.start, &driving, None)
        };
        let column = degrees.map_or(Column::Pliant, |d| Column::Letter(f64::from(d).to_radians()));
        let (ours, original) = (run(column)?, run(Column::Original)?);
        let speed = |d| mean_speed(d, |s| s.layers > 0 && s.gamma > 1.0);
        let change = speed(&ours).zip(speed(&original)).map(|(a, b)| change_percent(a, b));
        Ok(Angle { degrees: *degrees, left: *left, change, reached: ours.reached, touched: ours.touched() })
    })
}

/// One row an angle.
pub fn table(all: &[Angle]) -> Table {
    let title = "Speed in the soft layer of one cylinder against the original method by theta_2, percent, and how the run ended";
    let mut table =
        Table::new("angles", title, &["theta_2, degrees", "obstacle", "change %", "reached", "entered the core"]);
    for a in all {
        let angle = a.degrees.map_or("with the flow".into(), |d| d.to_string());
        let side = if a.left { "left" } else { "right" };
        table.push([
            angle,
            side.into(),
            signed(a.change, 1),
            yes(a.reached),
            if a.touched { "YES" } else { "no" }.into(),
        ]);
    }
    table
}

/// Both sides beside each other; a dot where a run entered the core or never arrived.
pub fn figure(all: &[Angle]) -> Figure {
    let chart = |title: &str, left: bool| {
        let of: Vec<&Angle> = all.iter().filter(|a| a.left == left).collect();
        let points = |failed: bool| {
            of.iter()
                .filter(|a| !failed || !a.reached)
                .filter_map(|a| Some((f64::from(a.degrees?), a.change?)))
                .collect::<Vec<_>>()
        };
        let level = of.iter().find(|a| a.degrees.is_none()).and_then(|a| a.change);
        let level = level.map_or_else(Vec::new, |level| vec![(-180.0, level), (180.0, level)]);
        let changes = || all.iter().filter_map(|a| a.change).chain([0.0]);
        let (lowest, highest) = (changes().fold(0.0, f64::min) - 5.0, changes().fold(0.0, f64::max) + 5.0);
        let chosen = f64::from(THETA.to_degrees().round() as i32);
        let dashed = |name: &str, colour, points| Series { mark: Mark::Dashed, ..Series::line(name, colour, points) };
        let letter = pieces(&points(false)).into_iter().map(|p| Series::line("paper to the letter", Colour::Letter, p));
        let failed = Series {
            mark: Mark::Dots,
            ..Series::line("never arrived, or entered the core", Colour::Letter, points(true))
        };
        let mut series = vec![Series::line("Pliant's default: with the flow", Colour::Pliant, level)];
        series.extend(letter);
        series.push(failed);
        Chart {
            title: title.into(),
            x: "theta_2 (degrees)".into(),
            y: "change of speed (%)".into(),
            guides: vec![
                dashed(Column::Original.title(), Colour::Original, vec![(-180.0, 0.0), (180.0, 0.0)]),
                dashed("theta_2 of the other studies", Colour::Reference, vec![(chosen, lowest), (chosen, highest)]),
            ],
            series,
            x_range: Some((-180.0, 180.0)),
            y_range: Some((lowest, highest)),
            ..Chart::default()
        }
    };
    charts(&[chart("obstacle to the left", true), chart("obstacle to the right", false)], 2, 500.0)
}

/// A curve in pieces, broken where it jumps: where the step from one point to the next is many times the median of all.
fn pieces(points: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
    const MANY: f64 = 5.0;
    let step = |a: &(f64, f64), b: &(f64, f64)| (b.1 - a.1).abs();
    let steps = sorted(points.windows(2).map(|w| step(&w[0], &w[1])));
    let most = MANY * quantile(&steps, 0.5).unwrap_or_default();
    points.chunk_by(|a, b| step(a, b) <= most).map(<[_]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_broken_where_it_jumps_alone() {
        let saw: Vec<(f64, f64)> = (0..30).map(|i| (f64::from(i), f64::from(i % 10) * 2.0)).collect();
        let lengths = |points: &[(f64, f64)]| pieces(points).iter().map(Vec::len).collect::<Vec<_>>();
        assert_eq!(lengths(&saw), [10, 10, 10]);
        assert_eq!(pieces(&saw).concat(), saw);
        assert_eq!((lengths(&saw[..10]), lengths(&saw[..1]), lengths(&[])), (vec![10], vec![1], vec![]));
    }
}
