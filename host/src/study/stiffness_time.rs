//! The paper's Fig. 4a: how long it takes past an obstacle as its soft layer becomes thicker.
//!
//! The paper gives its lengths without a unit. Its S-shape fills an area of 4 x 4, and ours of 0.4 m x 0.4 m: one of its units is 0.1 m here.

use nalgebra::Vector2;
use serde_json::{Map, json};

use super::column::Column;
use super::drive::{Driving, Robot, drive};
use super::findings::{Findings, Verdict};
use super::parallel;
use super::skill::{Skill, Skills};
use super::table::{Table, number};
use super::world::{Body, World};
use crate::error::Error;
use crate::plot::chart::{Chart, Colour, Mark, Series};

/// One of the paper's lengths, m.
pub const UNIT: f64 = 0.1;
/// ln k
pub const EXPONENTS: [f64; 7] = [0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5];
/// Starts along each side of the box.
const SIDE: usize = 5;
/// The box's side, m.
const BOX: f64 = 0.5 * UNIT;
/// Hard semi-axes of the obstacle, m.
pub const AXES: [f64; 2] = [0.06, 0.04];
/// Where it is: at this share of the path, this far to its left, m.
pub const PLACE: (f64, f64) = (0.54, 0.015);
/// The radius of the target area, m, and how far from the core's end its middle is.
const TARGET: f64 = 0.06;

/// The obstacle of both studies of time.
pub fn obstacle(skill: &Skill, ratio: f64) -> Body {
    let place = skill.place(PLACE.0);
    Body::new("ellipse", AXES, ratio, place.at + place.left() * PLACE.1, place.heading())
}

/// 25 places in a box that begins where the layer of k = e^0.5 does, before the obstacle; and the middle of the target area, right behind it.
fn places(skill: &Skill) -> (Vec<Vector2<f64>>, Vector2<f64>) {
    let place = skill.place(PLACE.0);
    let center = obstacle(skill, 1.0).center;
    let middle = center - place.along * (AXES[0] * 1.5 + BOX / 2.0);
    let step = BOX / (SIDE - 1) as f64;
    let at = |i: usize, j: usize| {
        let (a, b) = (i as f64 * step - BOX / 2.0, j as f64 * step - BOX / 2.0);
        middle + place.along * a + place.left() * b
    };
    let starts = (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| at(i, j))).collect();
    (starts, center + place.along * (AXES[0] + TARGET))
}

/// Times to the target area for one k, s; none for a start that never came there.
#[derive(Clone, Debug)]
struct Times {
    exponent: f64,
    column: Column,
    times: Vec<Option<f64>>,
}

impl Times {
    fn arrived(&self) -> usize {
        self.times.iter().flatten().count()
    }
    /// Of those that arrived; no number where none did.
    fn mean(&self) -> f64 {
        self.times.iter().flatten().sum::<f64>() / self.arrived() as f64
    }
    fn deviation(&self) -> f64 {
        let mean = self.mean();
        let squares = self.times.iter().flatten().map(|t| (t - mean).powi(2)).sum::<f64>();
        (squares / self.arrived() as f64).sqrt()
    }
}

/// Runs all; the chart is for a figure beside that of [`super::reduction`].
///
/// # Errors
/// None for the skills there are.
pub fn study(skills: &Skills, done: &(dyn Fn(usize) + Sync)) -> Result<(Findings, Chart), Error> {
    let skill = &skills.s;
    let (starts, target) = places(skill);
    let all: Vec<(f64, Column)> = EXPONENTS.iter().flat_map(|e| Column::ALL.map(|c| (*e, c))).collect();
    let found = parallel::map(&all, done, |(exponent, column)| {
        let world = World { timeout: 10.0, ..World::new(skill, vec![obstacle(skill, exponent + 1.0)]) };
        let scene = world.scene("time", *column)?;
        let driving = Driving { ends_at_contact: true, ..Driving::of(Robot::Exact) };
        let time = |start| {
            let run = drive(&scene, start, &driving, Some((target, TARGET)))?;
            Ok::<_, Error>(run.reached.then(|| run.time()))
        };
        let times = starts.iter().map(time).collect::<Result<_, _>>()?;
        Ok(Times { exponent: *exponent, column: *column, times })
    })?;
    let title = format!(
        "Time from {} places in a box of {BOX} m beside the obstacle to an area behind it, mean (standard deviation), s",
        starts.len()
    );
    let mut table =
        Table::new("time-vs-k", title, &["ln k", "k", "computed by", "arrived", "mean s", "standard deviation s"]);
    for t in &found {
        table.push([
            number(t.exponent, 2),
            number(t.exponent.exp(), 3),
            t.column.title().into(),
            t.arrived().to_string(),
            number(t.mean(), 3),
            number(t.deviation(), 3),
        ]);
    }
    let ours: Vec<&Times> = found.iter().filter(|t| t.column == Column::Pliant).collect();
    let falls = ours.windows(2).all(|w| w[1].mean() < w[0].mean()) && ours.iter().all(|t| t.arrived() == starts.len());
    let ends = |all: &[&Times]| all.first().zip(all.last()).map_or((f64::NAN, f64::NAN), |(a, b)| (a.mean(), b.mean()));
    let (first, last) = ends(&ours);
    let verdict = Verdict {
        claim: "the time past the obstacle falls with every step of k from 1 to e^1.5".into(),
        paper: "falls".into(),
        measured: format!("{first:.2} s to {last:.2} s, {}", if falls { "at every step" } else { "not at every step" }),
        holds: falls,
        vital: false,
    };
    let rows = |column: &'static str| {
        let of = found.iter().filter(move |t| t.column.key() == column);
        of.map(|t| json!({ "k": t.exponent.exp(), "mean_s": t.mean(), "deviation_s": t.deviation(), "arrived": t.arrived(), "starts": t.times.len() }))
    };
    let mut json = Map::new();
    let all_ways =
        json!({ "letter": rows("letter").collect::<Vec<_>>(), "original": rows("original").collect::<Vec<_>>() });
    json.insert(
        "claims".into(),
        json!({ "time_vs_k": rows("pliant").collect::<Vec<_>>(), "time_vs_k_others": all_ways }),
    );
    let findings = Findings { tables: vec![table], verdicts: vec![verdict], json, ..Findings::default() };
    Ok((findings, chart(&found)))
}

fn chart(found: &[Times]) -> Chart {
    let mut series = Vec::new();
    let colours = [("original", Colour::Original), ("letter", Colour::Letter), ("pliant", Colour::Pliant)];
    for (key, colour) in colours {
        let of: Vec<&Times> = found.iter().filter(|t| t.column.key() == key && t.arrived() > 0).collect();
        let Some(first) = of.first() else { continue };
        let at = |f: &dyn Fn(&Times) -> f64| of.iter().map(|t| (t.exponent.exp(), f(t))).collect::<Vec<_>>();
        if key == "pliant" {
            let low = of.iter().map(|t| t.mean() - t.deviation()).collect();
            let points = at(&|t| t.mean() + t.deviation());
            series.push(Series { name: "one standard deviation".into(), colour, mark: Mark::Band(low), points });
        }
        let mark = if key == "original" { Mark::Dashed } else { Mark::Dotted };
        series.push(Series { name: first.column.title().into(), colour, mark, points: at(&|t| t.mean()) });
    }
    Chart {
        title: "(a) time past the obstacle".into(),
        x: "k".into(),
        y: "time (s)".into(),
        series,
        ..Chart::default()
    }
}
