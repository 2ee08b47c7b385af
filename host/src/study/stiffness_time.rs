//! The paper's Fig. 4a: how long it takes past an obstacle as its soft layer becomes thicker.
//!
//! The paper gives its lengths without a unit. Its S-shape fills an area of 4 x 4, and ours one of about 0.4 m x 0.4 m: one of its units is 0.1 m
//! here. (The path of our own is 0.38 m wide and 0.43 m high, that of LASA handwriting, a unit as a centimetre, 0.45 m and 0.45 m.)

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
    /// Of those that arrived; none where none did.
    fn mean(&self) -> Option<f64> {
        let arrived = self.arrived();
        (arrived > 0).then(|| self.times.iter().flatten().sum::<f64>() / arrived as f64)
    }
    fn deviation(&self) -> Option<f64> {
        let mean = self.mean()?;
        let squares = self.times.iter().flatten().map(|t| (t - mean).powi(2)).sum::<f64>();
        Some((squares / self.arrived() as f64).sqrt())
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
    let falls = falls(&ours, starts.len());
    let ends = |t: Option<&&Times>| number(t.and_then(|t| t.mean()), 2);
    let (first, last) = (ends(ours.first()), ends(ours.last()));
    let step = match falls {
        Some(true) => "at every step",
        Some(false) => "not at every step, or not from every start",
        None => "none arrive",
    };
    let verdict = Verdict {
        claim: "the time past the obstacle falls with every step of k from 1 to e^1.5".into(),
        paper: "falls".into(),
        measured: format!("{first} s to {last} s, {step}"),
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

/// Does the time fall with every step, and do all arrive? None where none does.
fn falls(ours: &[&Times], starts: usize) -> Option<bool> {
    ours.iter().any(|t| t.arrived() > 0).then(|| {
        let falls = |w: &[&Times]| w[0].mean().zip(w[1].mean()).is_some_and(|(before, after)| after < before);
        ours.windows(2).all(falls) && ours.iter().all(|t| t.arrived() == starts)
    })
}

/// Over how many the means are, by increasing k, where that is not all.
fn survivors(of: &[&Times]) -> String {
    if of.iter().all(|t| t.arrived() == t.times.len()) {
        return String::new();
    }
    let starts = of.iter().map(|t| t.times.len()).max().unwrap_or(0);
    let arrived: Vec<String> = of.iter().map(|t| t.arrived().to_string()).collect();
    format!(", mean of those that arrive: {} of {starts}", arrived.join(", "))
}

fn chart(found: &[Times]) -> Chart {
    let mut series = Vec::new();
    let colours = [("original", Colour::Original), ("letter", Colour::Letter), ("pliant", Colour::Pliant)];
    for (key, colour) in colours {
        let of: Vec<&Times> = found.iter().filter(|t| t.column.key() == key).collect();
        let Some(first) = of.first() else { continue };
        let at = |by: f64| {
            let one = |t: &&Times| Some((t.exponent.exp(), t.mean()? + by * t.deviation()?));
            of.iter().filter_map(one).collect::<Vec<_>>()
        };
        if key == "pliant" {
            let (low, points) = (at(-1.0).into_iter().map(|(_, y)| y).collect(), at(1.0));
            series.push(Series { name: "one standard deviation".into(), colour, mark: Mark::Band(low), points });
        }
        let mark = if key == "original" { Mark::Dashed } else { Mark::Dotted };
        series.push(Series {
            name: format!("{}{}", first.column.title(), survivors(&of)),
            colour,
            mark,
            points: at(0.0),
        });
    }
    Chart {
        title: "(a) time past the obstacle".into(),
        x: "k".into(),
        y: "time (s)".into(),
        series,
        ..Chart::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(exponent: f64, times: &[Option<f64>]) -> Times {
        Times { exponent, column: Column::Pliant, times: times.to_vec() }
    }

    #[test]
    fn means_are_over_those_that_arrive_and_the_chart_says_how_many() {
        let all = [times(0.0, &[Some(2.0), Some(4.0)]), times(0.5, &[Some(1.0), None])];
        assert_eq!((all[0].mean(), all[0].deviation(), all[1].mean()), (Some(3.0), Some(1.0), Some(1.0)));
        let found: Vec<&Times> = all.iter().collect();
        assert_eq!((falls(&found, 2), falls(&found[..1], 2)), (Some(false), Some(true)));
        assert_eq!(survivors(&found), ", mean of those that arrive: 2, 1 of 2");
        assert_eq!(survivors(&found[..1]), "");
        let chart = chart(&all);
        assert!(chart.series.iter().any(|s| s.name == "Pliant's default, mean of those that arrive: 2, 1 of 2"));
        let none = times(0.0, &[None, None]);
        assert_eq!((none.mean(), falls(&[&none], 2)), (None, None));
    }
}
