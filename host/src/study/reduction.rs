//! The paper's Fig. 4b: how much less time motions take than by the original method, over where they start, at k = e^0.5.

use std::f64::consts::TAU;

use nalgebra::{Rotation2, Vector2};
use serde_json::{Map, json};

use super::column::Column;
use super::drive::{Driving, Robot, drive};
use super::findings::{Findings, Verdict};
use super::measure::sorted;
use super::parallel;
use super::skill::{Skill, Skills};
use super::stiffness_time::{UNIT, obstacle};
use super::table::{Table, number, signed};
use super::world::World;
use crate::error::Error;
use crate::plot::chart::{Cell, Chart, Colour, Place, Series};

/// Starts along each side of the area.
const SIDE: usize = 8;
/// The area's side, m.
const AREA: f64 = 4.0 * UNIT;
/// ln k + 1 for k = e^0.5.
const RATIO: f64 = 1.5;

/// A start, and how long it takes from there, s; none if it never arrives.
#[derive(Clone, Debug)]
struct Start {
    at: Vector2<f64>,
    pliant: Option<f64>,
    letter: Option<f64>,
    original: Option<f64>,
    /// Does either pass through the soft layer?
    soft: bool,
}

impl Start {
    fn percent(&self, ours: Option<f64>) -> Option<f64> {
        ours.zip(self.original).map(|(ours, original)| (1.0 - ours / original) * 100.0)
    }
    fn reduction(&self) -> Option<f64> {
        self.percent(self.pliant)
    }
}

/// The middles of a grid of cells over the area that holds the path.
fn starts(skill: &Skill) -> Vec<Vector2<f64>> {
    let (low, high) = skill.path.iter().fold((skill.start, skill.start), |(l, h), p| (l.inf(p), h.sup(p)));
    let corner = (low + high) / 2.0 - Vector2::repeat(AREA / 2.0);
    let step = AREA / SIDE as f64;
    let at = |i: usize, j: usize| corner + Vector2::new((i as f64 + 0.5) * step, (j as f64 + 0.5) * step);
    (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| at(i, j))).collect()
}

/// Runs all; the chart is for a figure beside that of [`super::stiffness_time`].
///
/// # Errors
/// None for the skills there are.
pub fn study(skills: &Skills, done: &(dyn Fn(usize) + Sync)) -> Result<(Findings, Chart), Error> {
    let skill = &skills.s;
    let body = obstacle(skill, RATIO);
    let world = World::new(skill, vec![body.clone()]);
    let [letter, pliant, original] = Column::ALL.map(|column| world.scene("reduction", column));
    let (letter, pliant, original) = (letter?, pliant?, original?);
    let outside = |p: &Vector2<f64>| pliant.obstacles_at(0.0).all(|o| o.gamma(&p.push(0.0)) > 1.0);
    let all: Vec<Vector2<f64>> = starts(skill).into_iter().filter(outside).collect();
    let found = parallel::map(&all, done, |at| {
        let driving = Driving { ends_at_contact: true, ..Driving::of(Robot::Exact) };
        let run = |scene| drive(scene, at, &driving, None);
        let (letter, pliant, original) = (run(&letter)?, run(&pliant)?, run(&original)?);
        let soft = [&pliant, &original].iter().any(|d| d.steps.iter().any(|s| s.layers > 0));
        let [letter, pliant, original] = [letter, pliant, original].map(|d| d.reached.then(|| d.time()));
        Ok(Start { at: *at, pliant, letter, original, soft })
    })?;
    let title = "Time to the goal by where it starts; reduction against the original method in percent";
    let header = [
        "x m",
        "y m",
        "original s",
        "Pliant's default s",
        "paper to the letter s",
        "reduction, default",
        "reduction, letter",
    ];
    let mut table = Table::new("time-reduction", title, &header);
    for s in &found {
        table.push([
            number(s.at.x, 3),
            number(s.at.y, 3),
            number(s.original, 3),
            number(s.pliant, 3),
            number(s.letter, 3),
            signed(s.reduction(), 2),
            signed(s.percent(s.letter), 2),
        ]);
    }
    let summary = |of: &dyn Fn(&Start) -> Option<f64>, through: bool| {
        let all = sorted(found.iter().filter(|s| !through || s.soft).filter_map(of));
        let mean = (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64);
        json!({ "mean": mean, "max": all.last(), "min": all.first(), "starts": all.len() })
    };
    let mine = summary(&Start::reduction, false);
    let near = summary(&Start::reduction, true);
    let mut claims = mine.clone();
    if let Some(claims) = claims.as_object_mut() {
        claims.insert("through_the_layer".into(), near.clone());
        claims.insert("letter".into(), summary(&|s| s.percent(s.letter), false));
    }
    let mut json = Map::new();
    json.insert("claims".into(), json!({ "time_reduction_percent": claims }));
    let value = |v: &serde_json::Value, key: &str| v.get(key).and_then(serde_json::Value::as_f64);
    let arrived = found.iter().filter(|s| s.pliant.is_some()).count();
    let verdict = Verdict {
        claim: "less time than by the original method, most where paths pass close to the core".into(),
        paper: "less".into(),
        measured: format!(
            "{} % in the mean, {} % at most; {} % where paths meet the soft layer ({} of {} starts); {arrived} arrive",
            signed(value(&mine, "mean"), 2),
            signed(value(&mine, "max"), 2),
            signed(value(&near, "mean"), 2),
            near.get("starts").cloned().unwrap_or_default(),
            found.len()
        ),
        holds: value(&mine, "min")
            .map(|least| arrived == found.len() && least > -0.5 && value(&near, "mean") > value(&mine, "mean")),
        vital: false,
    };
    let findings = Findings { tables: vec![table], verdicts: vec![verdict], json, ..Findings::default() };
    Ok((findings, map(skill, &found, &body)))
}

fn map(skill: &Skill, found: &[Start], body: &super::world::Body) -> Chart {
    let most = found.iter().filter_map(Start::reduction).fold(1.0, f64::max);
    let cells = found.iter().map(|s| Cell {
        at: (s.at.x, s.at.y),
        side: AREA / SIDE as f64,
        share: s.reduction().unwrap_or(-most) / most,
        label: s
            .reduction()
            .map_or("-".into(), |r| format!("{r:.0}").replace('-', "\u{2212}").replace("\u{2212}0", "0")),
    });
    let ring = |ratio: f64| {
        let turn = Rotation2::new(body.angle);
        let at = |i: u32| {
            let a = TAU * f64::from(i) / 90.0;
            let p = body.center + turn * Vector2::new(body.axes[0] * a.cos(), body.axes[1] * a.sin()) * ratio;
            (p.x, p.y)
        };
        (0..90).map(at).collect::<Vec<_>>()
    };
    let goal = skill.goal();
    Chart {
        title: "(b) time saved (%)".into(),
        x: "x of the start (m)".into(),
        y: "y of the start (m)".into(),
        cells: cells.collect(),
        places: vec![Place::Shell(ring(RATIO)), Place::Core(ring(1.0)), Place::Goal((goal.x, goal.y))],
        guides: vec![Series::line(
            "path without obstacles",
            Colour::Reference,
            skill.path.iter().map(|p| (p.x, p.y)).collect(),
        )],
        map: true,
        ..Chart::default()
    }
}
