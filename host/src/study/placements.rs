//! What the paper does not show: its method at places it did not choose, on both sides of passing, as distributions.

mod ablation;
mod angles;
mod draw;
mod figure;
mod run;

use serde_json::{Map, Value, json};

use super::column::Column;
use super::findings::{Findings, Verdict};
use super::measure::{quantile, sorted};
use super::parallel;
use super::skill::Skills;
use super::table::{Table, number};
use crate::error::Error;
use run::{After, Measured, Passed};

/// Places where the user does not say.
pub const COUNT: usize = 1000;

/// Runs all.
///
/// # Errors
/// None for the skills there are.
pub fn study(skills: &Skills, count: usize, seed: u64, done: &(dyn Fn(usize) + Sync)) -> Result<Findings, Error> {
    let skill = &skills.s;
    let bodies: Vec<_> =
        draw::pairs(skill, count, seed).into_iter().flat_map(|[l, r]| [(true, l), (false, r)]).collect();
    let all = parallel::map(&bodies, done, |(left, body)| Passed::of(skill, *left, body))?;
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
    let tables = vec![counts(&all, count), ablation::table(&all), quantiles(&all), angles::table(&angles)];
    Ok(Findings { tables, figures, verdicts, json, ..Findings::default() })
}

/// How often something is so, and of how many, of those that passed on a side (both if none is given).
fn share(all: &[Passed], side: Option<bool>, is: impl Fn(&Passed) -> Option<bool>) -> (usize, usize) {
    let of = all.iter().filter(|p| side.is_none_or(|left| p.left == left)).filter_map(is);
    of.fold((0, 0), |(n, of), is| (n + usize::from(is), of + 1))
}

/// What is counted; none where it cannot be said.
type Count = (&'static str, &'static str, fn(&Passed, &Measured) -> Option<bool>);

const COUNTS: [Count; 7] = [
    ("reached the goal", "reached", |_, m| Some(m.reached)),
    ("slower than the original in the layer, of those that were there", "slower", |p, m| {
        Some(p.speed_change(m)? < 0.0)
    }),
    ("stalled on the way", "stalled", |_, m| Some(m.stalled)),
    ("entered a hard core", "penetrated", |_, m| Some(m.entered)),
    ("ended at a core; had it gone on through it, it would have stalled", "would_stall", |_, m| Some(m.would_stall())),
    ("ended at a core; had it gone on through it, it would have arrived", "would_arrive", |_, m| {
        Some(m.after == Some(After::Arrives))
    }),
    ("guard acted", "guarded", |_, m| Some(m.guarded > 0.0)),
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
                let (n, of) = share(all, Some(left), |p| is(p, &p.runs[c]));
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
    /// What of it is shown, and its unit.
    unit: &'static str,
    /// What JSON calls it.
    key: &'static str,
    /// As many are written.
    decimals: usize,
    /// Its value for a run.
    of: fn(&Passed, &Measured) -> Option<f64>,
}

const QUANTITIES: [Quantity; 6] = [
    Quantity {
        name: "speed in the soft layer",
        unit: "change against the original (%)",
        key: "speed_change_percent",
        decimals: 1,
        of: Passed::speed_change,
    },
    Quantity {
        name: "time to the goal",
        unit: "change against the original (%)",
        key: "time_change_percent",
        decimals: 2,
        of: Passed::time_change,
    },
    Quantity {
        name: "time to the goal",
        unit: "seconds",
        key: "time_s",
        decimals: 2,
        of: |_, m| m.reached.then_some(m.time),
    },
    Quantity {
        name: "nearest to a core",
        unit: "min Gamma (1: its surface)",
        key: "min_gamma",
        decimals: 3,
        of: |_, m| Some(m.min_gamma),
    },
    Quantity {
        name: "jerk",
        unit: "root mean square (m/s\u{b3})",
        key: "rms_jerk",
        decimals: 1,
        of: |_, m| Some(m.jerk),
    },
    Quantity {
        name: "jump of velocity",
        unit: "largest in 1 ms (m/s)",
        key: "velocity_jump",
        decimals: 4,
        of: |_, m| Some(m.jump),
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
            let all = values(all, |p| (q.of)(p, &p.runs[c]));
            [0.05, 0.5, 0.95].map(|share| number(quantile(&all, share), q.decimals)).join(", ")
        };
        table.push([format!("{}, {}", q.name, q.unit), cell(0), cell(1), cell(2)]);
    }
    table
}

fn summary(all: &[Passed], count: usize) -> Value {
    let mut out = Map::new();
    out.insert("count".into(), count.into());
    out.insert("ablation".into(), ablation::json(all));
    for (c, column) in Column::ALL.into_iter().enumerate() {
        let mut of = Map::new();
        for (_, key, is) in COUNTS {
            let side = |left| share(all, left, |p| is(p, &p.runs[c]));
            let ((left, left_of), (right, right_of)) = (side(Some(true)), side(Some(false)));
            of.insert(key.into(), json!({ "left": left, "right": right, "left_of": left_of, "right_of": right_of }));
        }
        for q in QUANTITIES {
            let all = values(all, |p| (q.of)(p, &p.runs[c]));
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
    let count = |what: usize, c: usize| share(all, None, |p| COUNTS[what].2(p, &p.runs[c])).0;
    let [late, slower, stalled, entered, would_stall] = [0, 1, 2, 3, 4].map(|what| {
        let of = |c| if what == 0 { all.len() - count(0, c) } else { count(what, c) };
        [of(0), of(1), of(2)]
    });
    let met = |c: usize| share(all, None, |p| COUNTS[1].2(p, &p.runs[c])).1;
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
                .map(|(who, c)| {
                    let more = match would_stall[c] {
                        0 => String::new(),
                        n => format!(" and {n} would, had they not ended at a core"),
                    };
                    format!("{who}{} do not arrive, {} stall{more}", late[c], stalled[c])
                })
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
