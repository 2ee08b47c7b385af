//! What the paper does not show: its method at places it did not choose, on both sides of passing, as distributions.

mod angles;
mod draw;
mod figure;

use serde_json::{Map, Value, json};

use super::column::Column;
use super::drive::{Drive, Driving, Robot, drive};
use super::findings::{Findings, Verdict};
use super::measure::{self, change_percent, quantile, sorted};
use super::parallel;
use super::skill::{Skill, Skills};
use super::table::{Table, number};
use super::world::World;
use crate::error::Error;

/// Places where the user does not say.
pub const COUNT: usize = 1000;

/// Below this speed, m/s, farther than [`FAR`] from the goal a robot counts as stalled.
const STALLED: f64 = 0.005;
/// m
const FAR: f64 = 0.03;

/// What is measured of a run.
#[derive(Clone, Copy, Debug)]
struct Measured {
    reached: bool,
    /// Was Gamma below 1? A robot that rests on a surface, at 1, stalls.
    entered: bool,
    stalled: bool,
    time: f64,
    min_gamma: f64,
    soft_speed: Option<f64>,
    jerk: f64,
    jump: f64,
    guarded: f64,
}

impl Measured {
    fn of(drive: &Drive, skill: &Skill) -> Self {
        let goal = skill.goal();
        let still = |s: &super::drive::Step| s.velocity.norm() < STALLED && (s.position - goal).norm() > FAR;
        Self {
            reached: drive.reached,
            entered: drive.min_gamma() < 1.0,
            // The first step stands: the robot has not been told anything yet.
            stalled: drive.steps.iter().skip(1).any(still),
            time: drive.time(),
            min_gamma: drive.min_gamma(),
            soft_speed: measure::mean_speed(drive, |s| s.layers > 0 && s.gamma > 1.0),
            jerk: measure::jerk(drive),
            jump: measure::largest_jump(drive),
            guarded: measure::guarded(drive),
        }
    }
}

/// One obstacle on one side of the path, each way; the order is that of [`Column::ALL`].
#[derive(Clone, Copy, Debug)]
struct Passed {
    left: bool,
    runs: [Measured; 3],
}

impl Passed {
    /// Change of mean speed in the soft layer against the original method, percent.
    fn speed_change(&self, column: usize) -> Option<f64> {
        Some(change_percent(self.runs[column].soft_speed?, self.runs[2].soft_speed?))
    }

    /// Change of the time to the goal, likewise.
    fn time_change(&self, column: usize) -> Option<f64> {
        let (ours, original) = (&self.runs[column], &self.runs[2]);
        (ours.reached && original.reached).then(|| change_percent(ours.time, original.time))
    }
}

/// Runs all.
///
/// # Errors
/// None for the skills there are.
pub fn study(skills: &Skills, count: usize, seed: u64, done: &(dyn Fn(usize) + Sync)) -> Result<Findings, Error> {
    let skill = &skills.s;
    let bodies: Vec<_> =
        draw::pairs(skill, count, seed).into_iter().flat_map(|[l, r]| [(true, l), (false, r)]).collect();
    let all = parallel::map(&bodies, done, |(left, body)| {
        let world = World { timeout: 15.0, ..World::new(skill, vec![body.clone()]) };
        let driving = Driving { ends_at_contact: true, ..Driving::of(Robot::Exact) };
        let run = |column| {
            let scene = world.scene("placement", column)?;
            Ok::<_, Error>(Measured::of(&drive(&scene, &skill.start, &driving, None)?, skill))
        };
        let [letter, pliant, original] = Column::ALL.map(run);
        Ok(Passed { left: *left, runs: [letter?, pliant?, original?] })
    })?;
    let angles = angles::study(skill, done)?;
    let mut json = Map::new();
    json.insert("placements".into(), summary(&all, count));
    let verdicts = verdicts(&all);
    let figures = vec![
        (
            "placements",
            format!("{count} random obstacles, each to the left and to the right of the path: distributions over runs"),
            figure::distributions(&all),
        ),
        (
            "angles",
            "The paper to the letter by its angle theta_2, which it does not give: speed in a soft layer against the original method".into(),
            angles::figure(&angles),
        ),
    ];
    let tables = vec![counts(&all, count), quantiles(&all), angles::table(&angles)];
    Ok(Findings { tables, figures, verdicts, json, ..Findings::default() })
}

/// How often something is so, and of how many, of those that passed on a side (both if none is given).
fn share(all: &[Passed], side: Option<bool>, is: impl Fn(&Passed) -> Option<bool>) -> (usize, usize) {
    let of = all.iter().filter(|p| side.is_none_or(|left| p.left == left)).filter_map(is);
    of.fold((0, 0), |(n, of), is| (n + usize::from(is), of + 1))
}

/// What is counted; none where it cannot be said.
type Count = (&'static str, &'static str, fn(&Passed, usize) -> Option<bool>);

const COUNTS: [Count; 5] = [
    ("reached the goal", "reached", |p, c| Some(p.runs[c].reached)),
    ("slower than the original in the layer, of those that were there", "slower", |p, c| {
        Some(p.speed_change(c)? < 0.0)
    }),
    ("stalled on the way", "stalled", |p, c| Some(p.runs[c].stalled)),
    ("entered a hard core", "penetrated", |p, c| Some(p.runs[c].entered)),
    ("guard acted", "guarded", |p, c| Some(p.runs[c].guarded > 0.0)),
];

fn counts(all: &[Passed], count: usize) -> Table {
    let title = format!(
        "{count} random obstacles on each side of the path: share of runs, percent (left of the path / right of it)"
    );
    let mut table =
        Table::new("placements", title, &["what", "paper to the letter", "Pliant's default", "original (Huber 2019)"]);
    for (name, _, is) in COUNTS {
        let cell = |c: usize| {
            let percent = |left| {
                let (n, of) = share(all, Some(left), |p| is(p, c));
                number((of > 0).then(|| n as f64 / of as f64 * 100.0), 1)
            };
            format!("{} / {}", percent(true), percent(false))
        };
        table.push([name.into(), cell(0), cell(1), cell(2)]);
    }
    table
}

/// A quantity.
struct Quantity {
    /// What it is.
    name: &'static str,
    /// Its unit, or what it is measured by.
    unit: &'static str,
    /// What JSON calls it.
    key: &'static str,
    /// As many are written.
    decimals: usize,
    /// Its value for a column.
    of: fn(&Passed, usize) -> Option<f64>,
}

const QUANTITIES: [Quantity; 6] = [
    Quantity {
        name: "speed in the layer",
        unit: "against the original (%)",
        key: "speed_change_percent",
        decimals: 1,
        of: Passed::speed_change,
    },
    Quantity {
        name: "time to the goal",
        unit: "against the original (%)",
        key: "time_change_percent",
        decimals: 2,
        of: Passed::time_change,
    },
    Quantity {
        name: "time",
        unit: "to the goal (s)",
        key: "time_s",
        decimals: 2,
        of: |p, c| p.runs[c].reached.then_some(p.runs[c].time),
    },
    Quantity {
        name: "nearest to a core",
        unit: "min Gamma",
        key: "min_gamma",
        decimals: 3,
        of: |p, c| Some(p.runs[c].min_gamma),
    },
    Quantity {
        name: "jerk",
        unit: "root mean square (m/s\u{b3})",
        key: "rms_jerk",
        decimals: 1,
        of: |p, c| Some(p.runs[c].jerk),
    },
    Quantity {
        name: "largest jump in 1 ms",
        unit: "of velocity (m/s)",
        key: "velocity_jump",
        decimals: 4,
        of: |p, c| Some(p.runs[c].jump),
    },
];

fn values(all: &[Passed], of: impl Fn(&Passed) -> Option<f64>) -> Vec<f64> {
    sorted(all.iter().filter_map(of))
}

fn quantiles(all: &[Passed]) -> Table {
    let title = "The same runs: 5 %, 50 % and 95 % of all are no larger";
    let mut table = Table::new(
        "placements-quantiles",
        title,
        &["what", "paper to the letter", "Pliant's default", "original (Huber 2019)"],
    );
    for q in QUANTITIES {
        let cell = |c: usize| {
            let all = values(all, |p| (q.of)(p, c));
            [0.05, 0.5, 0.95].map(|share| number(quantile(&all, share), q.decimals)).join(", ")
        };
        table.push([format!("{}, {}", q.name, q.unit), cell(0), cell(1), cell(2)]);
    }
    table
}

fn summary(all: &[Passed], count: usize) -> Value {
    let mut out = Map::new();
    out.insert("count".into(), count.into());
    for (c, column) in Column::ALL.into_iter().enumerate() {
        let mut of = Map::new();
        for (_, key, is) in COUNTS {
            let side = |left| share(all, left, |p| is(p, c));
            let ((left, left_of), (right, right_of)) = (side(Some(true)), side(Some(false)));
            of.insert(key.into(), json!({ "left": left, "right": right, "left_of": left_of, "right_of": right_of }));
        }
        for q in QUANTITIES {
            let all = values(all, |p| (q.of)(p, c));
            let at = |share| quantile(&all, share);
            of.insert(
                q.key.into(),
                json!({ "p05": at(0.05), "p50": at(0.5), "p95": at(0.95), "least": all.first(), "most": all.last() }),
            );
        }
        out.insert(column.key().into(), of.into());
    }
    Value::Object(out)
}

fn verdicts(all: &[Passed]) -> Vec<Verdict> {
    let count = |what: usize, c: usize| share(all, None, |p| COUNTS[what].2(p, c)).0;
    let [late, slower, stalled, entered] = [0, 1, 2, 3].map(|what| {
        let of = |c| if what == 0 { all.len() - count(0, c) } else { count(what, c) };
        [of(0), of(1), of(2)]
    });
    let met = |c: usize| share(all, None, |p| COUNTS[1].2(p, c)).1;
    let measured = !all.is_empty();
    vec![
        Verdict {
            claim: "no core is entered, wherever the obstacle is and on whichever side it is passed".into(),
            paper: "-".into(),
            measured: format!("{} of {} enter one; to the letter {}", entered[1], all.len(), entered[0]),
            holds: measured.then_some(entered[1] == 0),
            vital: true,
        },
        Verdict {
            claim: "all arrive, and none stalls".into(),
            paper: "-".into(),
            measured: [("", 1), ("; to the letter ", 0), ("; original: ", 2)]
                .map(|(who, c)| format!("{who}{} do not arrive, {} stall", late[c], stalled[c]))
                .concat(),
            holds: measured.then_some(late[1] + stalled[1] == 0),
            vital: false,
        },
        Verdict {
            claim: "none is slower in a soft layer than by the original method".into(),
            paper: "-".into(),
            measured: format!("{} of {} that meet it; to the letter {} of {}", slower[1], met(1), slower[0], met(0)),
            holds: (met(1) > 0).then_some(slower[1] == 0),
            vital: false,
        },
    ]
}
