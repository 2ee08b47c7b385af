//! The paper's Fig. 4b: how much less time motions take than by the original method, over where they start, at k = e^0.5.

use std::f64::consts::TAU;

use nalgebra::{Rotation2, Vector2};
use serde_json::{Map, json};

use super::column::Column;
use super::drive::{Driving, Robot, drive};
use super::findings::{Findings, Verdict};
use super::measure::{rank_correlation, sorted};
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
    /// How near the original method's path comes to the core: its least Gamma.
    gamma: f64,
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
        let gamma = original.min_gamma();
        let [letter, pliant, original] = [letter, pliant, original].map(|d| d.reached.then(|| d.time()));
        Ok(Start { at: *at, pliant, letter, original, soft, gamma })
    })?;
    let title = "Time to the goal by where it starts; reduction against the original method in percent";
    let header = [
        "x m",
        "y m",
        "original s",
        "original, min Gamma",
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
            number(s.gamma, 3),
            number(s.pliant, 3),
            number(s.letter, 3),
            signed(s.reduction(), 2),
            signed(s.percent(s.letter), 2),
        ]);
    }
    let mut claims = json!(Saved::of(found.iter().filter_map(Start::reduction)));
    claims["through_the_layer"] = json!(Saved::of(found.iter().filter(|s| s.soft).filter_map(Start::reduction)));
    claims["letter"] = json!(Saved::of(found.iter().filter_map(|s| s.percent(s.letter))));
    claims["rank_correlation_with_min_gamma"] = json!(closeness(&found));
    let mut json = Map::new();
    json.insert("claims".into(), json!({ "time_reduction_percent": claims }));
    let findings = Findings { tables: vec![table], verdicts: verdicts(&found), json, ..Findings::default() };
    Ok((findings, map(skill, &found, &body)))
}

/// Time saved against the original method, percent; none where nothing can be compared.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
struct Saved {
    mean: Option<f64>,
    max: Option<f64>,
    min: Option<f64>,
    starts: usize,
}

impl Saved {
    fn of(all: impl Iterator<Item = f64>) -> Self {
        let all = sorted(all);
        let mean = (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64);
        Self { mean, max: all.last().copied(), min: all.first().copied(), starts: all.len() }
    }
}

/// How what is saved goes with the least Gamma of the original method's path, over starts from which a path meets the soft layer: below zero where
/// those that pass closer to the core save more. The others save nothing, and would say no more than that they are far.
fn closeness(found: &[Start]) -> Option<f64> {
    let through = found.iter().filter(|s| s.soft).filter_map(|s| Some((s.gamma, s.reduction()?)));
    rank_correlation(&through.collect::<Vec<_>>())
}

fn verdicts(found: &[Start]) -> Vec<Verdict> {
    let all = Saved::of(found.iter().filter_map(Start::reduction));
    let through = Saved::of(found.iter().filter(|s| s.soft).filter_map(Start::reduction));
    let arrived = found.iter().filter(|s| s.pliant.is_some()).count();
    let closeness = closeness(found);
    vec![
        Verdict {
            claim:
                "no start takes longer than by the original method, and where paths meet the soft layer time is saved"
                    .into(),
            paper: "less".into(),
            measured: format!(
                "{} % in the mean, {} to {} %; {} % in the mean of the {} of {} starts from which a path meets the layer; {arrived} arrive",
                signed(all.mean, 2),
                signed(all.min, 2),
                signed(all.max, 2),
                signed(through.mean, 2),
                through.starts,
                found.len()
            ),
            holds: all
                .min
                .map(|least| arrived == found.len() && least >= 0.0 && through.mean.is_none_or(|mean| mean > 0.0)),
            vital: false,
        },
        Verdict {
            claim: "of paths that meet the soft layer those that pass closer to the core save more".into(),
            paper: "yes".into(),
            measured: format!(
                "rank correlation of the time saved with the least Gamma by the original method {} over {} starts",
                signed(closeness, 2),
                through.starts
            ),
            holds: closeness.map(|r| r < 0.0),
            vital: false,
        },
    ]
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
        places: vec![
            Place::Shell(ring(RATIO)),
            Place::Core(ring(1.0)),
            Place::Start((skill.start.x, skill.start.y)),
            Place::Goal((goal.x, goal.y)),
        ],
        guides: vec![Series::line(
            "path without obstacles",
            Colour::Reference,
            skill.path.iter().map(|p| (p.x, p.y)).collect(),
        )],
        map: true,
        ..Chart::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Starts from which the original takes 1 s, with what is saved (%) and the least Gamma; those from 2 on do not meet the layer.
    fn starts(all: &[(f64, f64)]) -> Vec<Start> {
        let one = |&(saved, gamma): &(f64, f64)| Start {
            at: Vector2::zeros(),
            pliant: Some(1.0 - saved / 100.0),
            letter: None,
            original: Some(1.0),
            soft: gamma < 2.0,
            gamma,
        };
        all.iter().map(one).collect()
    }

    #[test]
    fn that_closer_paths_save_more_can_fail() {
        let holds = |all: &[(f64, f64)]| verdicts(&starts(all)).iter().map(|v| v.holds).collect::<Vec<_>>();
        let far = [(0.0, 3.0), (0.0, 4.0)];
        let with = |near: [(f64, f64); 4]| holds(&[&near[..], &far].concat());
        assert_eq!(with([(9.0, 1.1), (5.0, 1.2), (6.0, 1.4), (1.0, 1.8)]), [Some(true), Some(true)]);
        // As much in all, but it is the far ones of them that save.
        assert_eq!(with([(1.0, 1.1), (6.0, 1.2), (5.0, 1.4), (9.0, 1.8)]), [Some(true), Some(false)]);
        // One is slower; all are.
        assert_eq!(with([(9.0, 1.1), (5.0, 1.2), (6.0, 1.4), (-0.1, 1.8)]), [Some(false), Some(true)]);
        assert_eq!(with([(-1.0, 1.1), (-2.0, 1.2), (-3.0, 1.4), (-9.0, 1.8)]), [Some(false), Some(true)]);
        // Where all save alike, or no path meets the layer, there is no order to find.
        assert_eq!(with([(1.0, 1.1), (1.0, 1.2), (1.0, 1.4), (1.0, 1.8)]), [Some(true), None]);
        assert_eq!(holds(&far), [Some(true), None]);
        assert_eq!(holds(&[]), [None, None]);
        let mut late = starts(&[(9.0, 1.1), (5.0, 1.2), (1.0, 1.4)]);
        late[2].pliant = None;
        assert_eq!(verdicts(&late)[0].holds, Some(false), "one does not arrive");
    }
}
