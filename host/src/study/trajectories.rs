//! The paper's Fig. 3: its three motions, each past one deformable obstacle and through the overlap of two, from many places.

use nalgebra::Vector2;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Map, Value, json};

use super::column::Column;
use super::drive::{Drive, Driving, Robot, drive};
use super::findings::{Findings, Verdict};
use super::parallel;
use super::skill::{Skill, Skills};
use super::table::{Table, number};
use super::world::{Body, World};
use crate::error::Error;
use crate::plot::{Options, Tile, Trajectory, gallery};
use crate::scene::Scene;

/// Starts of each motion: the one that was shown, and others drawn at random.
pub const STARTS: usize = 25;
/// How wide their paths are drawn, px: there are many.
const LINE: f64 = 1.2;
/// How far beyond the path they are drawn, m.
const AROUND: f64 = 0.05;
/// How far beyond those places paths stretch a figure, over the size of what the motion passes through; beyond it they are cut.
const BEYOND: f64 = 0.25;

/// One motion with its obstacles, computed one way, from every start.
struct Runs {
    skill: &'static str,
    obstacles: usize,
    column: Column,
    scene: Scene,
    drives: Vec<Drive>,
    /// The part of the world that a figure shows.
    limit: [Vector2<f64>; 2],
}

impl Runs {
    fn reached(&self) -> usize {
        self.drives.iter().filter(|d| d.reached).count()
    }
    fn touched(&self) -> usize {
        self.drives.iter().filter(|d| d.touched()).count()
    }
    fn min_gamma(&self) -> f64 {
        self.drives.iter().map(Drive::min_gamma).fold(f64::INFINITY, f64::min)
    }
    /// Of those that arrive; none where none does.
    fn mean_time(&self) -> Option<f64> {
        let times: Vec<f64> = self.drives.iter().filter(|d| d.reached).map(Drive::time).collect();
        (!times.is_empty()).then(|| times.iter().sum::<f64>() / times.len() as f64)
    }
    fn tile<'a>(&'a self, trajectories: &'a [Trajectory]) -> Tile<'a> {
        let ends = |of: &dyn Fn(&Drive) -> bool| {
            let last = self.drives.iter().filter(|d| of(d)).filter_map(|d| d.steps.last());
            last.map(|s| s.position.push(0.0)).collect()
        };
        let (entries, lost) = (ends(&Drive::touched), ends(&|d| !d.reached && !d.touched()));
        Tile {
            title: format!("{}, {}", self.skill, if self.obstacles == 1 { "one" } else { "two" }),
            scene: &self.scene,
            trajectories,
            options: Options {
                speed: false,
                clearances: false,
                entries,
                lost,
                limit: Some(self.limit.map(|corner| corner.push(0.0))),
                line: LINE,
                ..Options::default()
            },
        }
    }
}

/// One ellipse on the path, or two with the path between them.
fn bodies(skill: &Skill, two: bool) -> Vec<Body> {
    const AXES: [f64; 2] = [0.05, 0.03];
    const RATIO: f64 = 1.9;
    let place = skill.place(0.5);
    let angle = place.heading() + 0.4;
    let mut first = Body::new("first", AXES, RATIO, place.at, angle);
    if !two {
        first.center += place.left() * 0.01;
        return vec![first];
    }
    let mut second = Body::new("second", AXES, RATIO, place.at, place.heading() - 0.4);
    first.center += place.left() * (first.reach(&place.left()) + 0.012);
    second.center -= place.left() * (second.reach(&place.left()) + 0.012);
    vec![first, second]
}

/// The box around the motion's path and so much more, m: its corners.
fn around(skill: &Skill, more: f64) -> [Vector2<f64>; 2] {
    let (low, high) = skill.path.iter().fold((skill.start, skill.start), |(l, h), p| (l.inf(p), h.sup(p)));
    [low.add_scalar(-more), high.add_scalar(more)]
}

/// What a figure shows at most.
fn limit(skill: &Skill) -> [Vector2<f64>; 2] {
    let [low, high] = around(skill, AROUND);
    around(skill, AROUND + BEYOND * (high - low).max())
}

/// The start that was shown, and places at random around the path, outside of every core.
fn starts(skill: &Skill, bodies: &[Body], seed: u64) -> Vec<Vector2<f64>> {
    let [low, high] = around(skill, AROUND);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut all = vec![skill.start];
    while all.len() < STARTS {
        let p = Vector2::from_fn(|i, _| random.random_range(low[i]..high[i]));
        if bodies.iter().all(|b| (p - b.center).norm() > 1.05 * b.reach(&(p - b.center).normalize())) {
            all.push(p);
        }
    }
    all
}

/// Runs all.
///
/// # Errors
/// None for the skills there are.
pub fn study(skills: &Skills, seed: u64, done: &(dyn Fn(usize) + Sync)) -> Result<Findings, Error> {
    let worlds = skills.three().into_iter().flat_map(|skill| {
        [false, true].map(|two| {
            let bodies = bodies(skill, two);
            World { starts: starts(skill, &bodies, seed), ..World::new(skill, bodies) }
        })
    });
    let worlds: Vec<World<'_>> = worlds.collect();
    let all: Vec<(&World<'_>, Column)> = worlds.iter().flat_map(|w| Column::ALL.map(|c| (w, c))).collect();
    let runs = parallel::map(&all, done, |(world, column)| {
        let scene = world.scene("trajectories", *column)?;
        let driving = Driving { ends_at_contact: true, ..Driving::of(Robot::Exact) };
        let drives = world.starts.iter().map(|start| drive(&scene, start, &driving, None)).collect::<Result<_, _>>()?;
        let (skill, obstacles) = (world.skill.name, world.bodies.len());
        Ok(Runs { skill, obstacles, column: *column, scene, drives, limit: limit(world.skill) })
    })?;
    let title = format!("Motions from {STARTS} places each, with a robot that follows exactly");
    let header =
        ["motion", "obstacles", "computed by", "starts", "reached", "touched a core", "min Gamma", "mean time s"];
    let mut table = Table::new("trajectories", title, &header);
    let mut json = Vec::new();
    for r in &runs {
        let starts = r.drives.len();
        table.push([
            r.skill.into(),
            r.obstacles.to_string(),
            r.column.title().into(),
            starts.to_string(),
            r.reached().to_string(),
            r.touched().to_string(),
            number(r.min_gamma(), 3),
            number(r.mean_time(), 2),
        ]);
        json.push(json!({
            "skill": r.skill, "obstacles": r.obstacles, "column": r.column.key(), "starts": starts, "reached": r.reached(),
            "touched": r.touched(), "min_gamma": r.min_gamma(), "mean_time_s": r.mean_time(),
        }));
    }
    let ours: Vec<&Runs> = runs.iter().filter(|r| r.column == Column::Pliant).collect();
    let (reached, count) = ours.iter().fold((0, 0), |(n, all), r| (n + r.reached(), all + r.drives.len()));
    let least = ours.iter().map(|r| r.min_gamma()).fold(f64::INFINITY, f64::min);
    let verdict = Verdict {
        claim: "every motion, from wherever it starts, goes round the hard regions and arrives".into(),
        paper: "all".into(),
        measured: format!("{reached} of {count}, min Gamma {least:.3}"),
        holds: (count > 0).then_some(reached == count && least > 1.0),
        vital: true,
    };
    let mut figures = Vec::new();
    for (name, column) in [("trajectories", Column::Pliant), ("trajectories-letter", Column::ALL[0])] {
        let figure = figure(&runs, column)?;
        let cut = match figure.cut() {
            0 => String::new(),
            cut => format!(
                "; {} farther than is shown",
                if cut == 1 { "1 path goes".into() } else { format!("{cut} paths go") }
            ),
        };
        let caption = format!(
            "Motions past one deformable obstacle and through the overlap of two from {STARTS} places each: {} (with streamlines of its flow, before any guard){cut}",
            column.title()
        );
        figures.push((name, caption, figure));
    }
    let mut numbers = Map::new();
    numbers.insert("trajectories".into(), Value::Array(json));
    Ok(Findings { tables: vec![table], figures, verdicts: vec![verdict], json: numbers, ..Findings::default() })
}

/// One obstacle above, two below, as in the paper.
fn figure(runs: &[Runs], column: Column) -> Result<crate::plot::Figure, Error> {
    let mut some: Vec<&Runs> = runs.iter().filter(|r| r.column == column).collect();
    some.sort_by_key(|r| r.obstacles);
    let paths: Vec<Vec<Trajectory>> = some.iter().map(|r| r.drives.iter().map(Drive::trajectory).collect()).collect();
    let tiles: Vec<Tile<'_>> = some.iter().zip(&paths).map(|(r, paths)| r.tile(paths)).collect();
    Ok(gallery(&tiles, 3, 560.0)?)
}
