//! The figures of the experiments, each with what the paper shows in its own.

use nalgebra::Vector2;

use super::outcome::{Outcome, intersection, soft};
use super::spread::Spread;
use crate::error::Error;
use crate::plot::chart::{Chart, Colour, Series, charts};
use crate::plot::{Figure, Options, Tile, Trajectory, gallery};
use crate::study::column::Column;
use crate::study::drive::Step;
use crate::study::measure::profile;
use crate::study::world::World;

/// Width of a figure for one column of a page, px.
const COLUMN: f64 = 500.0;
/// How wide a path is drawn in a tile, px: in an intersection there is little room beside it.
const LINE: f64 = 2.0;

fn tile<'a>(outcome: &'a Outcome<'_>, trajectory: &'a [Trajectory], title: String) -> Tile<'a> {
    let reference = outcome.case.world.skill.path_in_space();
    let options = Options { reference, clearances: false, line: LINE, ..Options::default() };
    Tile { title, scene: &outcome.scene, trajectories: trajectory, options }
}

/// Some experiments beside each other, by their names; those of the paper's method as Pliant computes it.
///
/// # Errors
/// None.
pub fn side_by_side(all: &[Outcome<'_>], ids: &[&str], columns: usize) -> Result<Figure, Error> {
    let some: Vec<&Outcome<'_>> = ids
        .iter()
        .filter_map(|id| all.iter().find(|o| o.case.id == *id && !matches!(o.column, Column::Letter(_))))
        .collect();
    let paths: Vec<Vec<Trajectory>> = some.iter().map(|o| vec![o.drive.trajectory()]).collect();
    let tiles: Vec<Tile<'_>> = some
        .iter()
        .zip(&paths)
        .map(|(o, path)| tile(o, path, format!("{}: {}", o.case.id, o.column.short_title())))
        .collect();
    Ok(gallery(&tiles, columns, COLUMN)?)
}

/// The recorded motion alone with its demonstrations, and C1.
///
/// # Errors
/// None.
pub fn complex(all: &[Outcome<'_>], recordings: &[Vec<Vector2<f64>>]) -> Result<Figure, Error> {
    let Some(c1) = all.iter().find(|o| o.case.id == "C1" && o.column == Column::Pliant) else {
        return Err(Error::failed("there is no C1"));
    };
    let alone = World::new(c1.case.world.skill, Vec::new()).scene("alone", Column::Pliant)?;
    let path = vec![c1.drive.trajectory()];
    let with = tile(c1, &path, "(b) five obstacles".into());
    let demonstrations = recordings.iter().map(|r| r.iter().map(|x| x.push(0.0)).collect()).collect();
    let options = Options { demonstrations, ..with.options.clone() };
    let without = Tile { title: "(a) demonstrations, motion".into(), scene: &alone, trajectories: &[], options };
    Ok(gallery(&[without, with], 2, 560.0)?)
}

/// The moving obstacle at three moments, each with the path up to then.
///
/// # Errors
/// None.
pub fn moments(outcome: &Outcome<'_>, times: [f64; 3]) -> Result<Figure, Error> {
    let whole = outcome.drive.trajectory();
    let upto = |t: f64| Trajectory { points: whole.points.iter().filter(|p| p.time <= t).copied().collect() };
    let paths = times.map(|t| vec![upto(t)]);
    let tiles: Vec<Tile<'_>> = times
        .iter()
        .zip(&paths)
        .map(|(t, path)| {
            let mut tile = tile(outcome, path, format!("t = {t:.1} s"));
            tile.options.time = *t;
            tile
        })
        .collect();
    Ok(gallery(&tiles, 3, COLUMN)?)
}

/// Speeds in the soft layer (A1 and A3) and where layers overlap (B1 and B3), from when the robot comes there.
pub fn velocities(all: &[Outcome<'_>]) -> Figure {
    let chart = |title: &str, ids: [&str; 2], within: fn(&Step) -> bool| {
        let series = all.iter().filter(|o| ids.contains(&o.case.id)).map(|o| {
            let colour = match o.column {
                Column::Letter(_) => Colour::Letter,
                Column::Pliant => Colour::Pliant,
                Column::Original => Colour::Original,
            };
            Series::line(o.column.title(), colour, profile(&o.drive, within))
        });
        Chart {
            title: title.into(),
            x: "time (s)".into(),
            y: "speed (m/s)".into(),
            series: series.collect(),
            ..Chart::default()
        }
    };
    let all = [
        chart("(a) A1, A3: soft layer", ["A1", "A3"], soft),
        chart("(b) B1, B3: intersection", ["B1", "B3"], intersection),
    ];
    charts(&all, 2, COLUMN)
}

/// The two claims over other places, with the paper's figure for the one it shows.
pub fn spread(spread: &Spread, paper: [f64; 2]) -> Figure {
    let chart = |title: &str, values: &[f64], paper: f64| Chart {
        title: title.into(),
        x: "change of mean speed (%)".into(),
        y: "places (%)".into(),
        series: vec![Series::distribution("places on the path: no more than this", Colour::Pliant, values)],
        guides: vec![Series {
            mark: crate::plot::chart::Mark::Dashed,
            ..Series::line("the paper's figure", Colour::Letter, vec![(paper, 0.0), (paper, 100.0)])
        }],
        y_range: Some((0.0, 100.0)),
        ..Chart::default()
    };
    let all =
        [chart("(a) soft layer", &spread.soft, paper[0]), chart("(b) intersection", &spread.intersection, paper[1])];
    charts(&all, 2, COLUMN)
}
