//! Tables and numbers of what was learnt.

use serde_json::{Map, Value, json};

use super::{Failed, HeldOut, Measured, Task, peers};
use crate::learn::Quality;
use crate::study::Findings;
use crate::study::measure::sorted;
use crate::study::table::{Table, number, yes};

/// The middle of all values, or the mean of both middle ones.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let all = sorted(values);
    let last = all.len().checked_sub(1)?;
    Some(f64::midpoint(all[last / 2], all[all.len() / 2]))
}

/// Everything but the figure.
pub fn findings(measured: &[Measured], failed: &[Failed], task: &Task<'_>, lasa: bool) -> Findings {
    let mut tables = vec![motions(measured, task.held_out)];
    if lasa {
        tables.push(beside_peers(measured, failed));
    }
    Findings { tables, json: numbers(measured, failed, task, lasa), ..Findings::default() }
}

/// The columns of a quality: RMSE, e_dot, DTWD.
fn merits(q: Option<&Quality>) -> [String; 3] {
    [number(q.map(|q| q.rmse * 1e3), 2), number(q.map(|q| q.e_dot), 4), number(q.map(|q| q.dtwd * 1e3), 0)]
}

fn arrived(q: &Quality) -> String {
    format!("{} of {}", q.converged, q.rollouts)
}

/// The columns of demonstrations that were held out.
fn unseen(held_out: Option<&HeldOut>) -> Vec<String> {
    let mut columns = merits(held_out.map(|h| &h.mean)).to_vec();
    columns.push(number(held_out.map(|h| h.worst * 1e3), 0));
    columns.push(held_out.map_or("-".into(), |h| arrived(&h.mean)));
    columns
}

fn held_out_medians(measured: &[Measured]) -> Option<HeldOut> {
    let all = || measured.iter().filter_map(|m| m.held_out.as_ref());
    Some(HeldOut { mean: medians(all().map(|h| &h.mean))?, worst: median(all().map(|h| h.worst))? })
}

fn motions(measured: &[Measured], held_out: bool) -> Table {
    let title = "The motions. RMSE: mean over samples of the root of the mean over axes of the squared velocity error; e_dot: mean of 1 - cos; DTWD: \
                 dynamic time warping distance of rollouts, mean over demonstrations; margin: the rate proved in f32, as `pliant check` says it. CPU s: processor time of one core. \
                 Held out: the mean over demonstrations, each measured by what was learnt from the others, and the worst DTWD of one";
    let mut header = vec![
        "motion",
        "demonstrations",
        "K",
        "RMSE mm/s",
        "e_dot",
        "DTWD mm",
        "time over demonstrator's",
        "arrived",
        "certified",
        "margin 1/s",
        "CPU s",
    ];
    if held_out {
        header.extend(["held out: RMSE mm/s", "e_dot", "DTWD mm", "worst", "arrived"]);
    }
    let mut table = Table::new("lasa", title, &header);
    for m in measured {
        let mut row = vec![m.name.clone(), m.quality.rollouts.to_string(), m.k.to_string()];
        row.extend(merits(Some(&m.quality)));
        row.extend([
            number(m.quality.pace, 2),
            arrived(&m.quality),
            yes(m.certified),
            number(m.margin, 3),
            number(m.seconds, 2),
        ]);
        if held_out {
            row.extend(unseen(m.held_out.as_ref()));
        }
        table.push(row);
    }
    let of = |value: fn(&Measured) -> f64| median(measured.iter().map(value));
    let all = |value: fn(&Quality) -> usize| measured.iter().map(|m| value(&m.quality)).sum::<usize>();
    let arrivals = (all(|q| q.converged), all(|q| q.rollouts));
    let mut row = vec![format!("median of {}", measured.len()), arrivals.1.to_string(), number(of(|m| m.k as f64), 0)];
    row.extend(merits(medians(measured.iter().map(|m| &m.quality)).as_ref()));
    row.extend([
        number(of(|m| m.quality.pace), 2),
        format!("{} of {}", arrivals.0, arrivals.1),
        yes(measured.iter().all(|m| m.certified)),
        number(of(|m| m.margin), 3),
        number(of(|m| m.seconds), 2),
    ]);
    if held_out {
        row.extend(unseen(held_out_medians(measured).as_ref()));
    }
    table.push(row);
    table
}

/// The median of each figure; of numbers of rollouts the sum.
fn medians<'a>(all: impl Iterator<Item = &'a Quality> + Clone) -> Option<Quality> {
    let of = |value: fn(&Quality) -> f64| median(all.clone().map(value));
    Some(Quality {
        rmse: of(|q| q.rmse)?,
        e_dot: of(|q| q.e_dot)?,
        dtwd: of(|q| q.dtwd)?,
        path_error: of(|q| q.path_error)?,
        pace: of(|q| q.pace)?,
        converged: all.clone().map(|q| q.converged).sum(),
        rollouts: all.clone().map(|q| q.rollouts).sum(),
        robust: all.clone().map(|q| q.robust).sum(),
        beside: all.clone().map(|q| q.beside).sum(),
        excursion: of(|q| q.excursion)?,
        excursion_from: None,
    })
}

fn beside_peers(measured: &[Measured], failed: &[Failed]) -> Table {
    let mut table = peers::table();
    for p in &peers::PEERS {
        let merit = |i: usize, decimals| p.medians.map_or("by its seed".into(), |m| number(m[i], decimals));
        table.push([
            p.name.into(),
            p.learnt.map_or(format!("{} tried", p.tried), |n| format!("{n} of {}", p.tried)),
            format!("{} of {}", p.broken, p.tried),
            p.seconds.to_string(),
            merit(0, 2),
            merit(1, 3),
            merit(2, 0),
        ]);
    }
    let q = medians(measured.iter().map(|m| &m.quality));
    table.push([
        "Pliant, here and now".into(),
        format!(
            "{} of {}",
            measured.len(),
            measured.len() + failed.iter().filter(|f| is_unlearnt(f, measured)).count()
        ),
        format!("{} of {}", measured.iter().filter(|m| !m.certified).count(), measured.len()),
        number(median(measured.iter().map(|m| m.seconds)), 2),
        number(q.map(|q| q.rmse * 1e3), 2),
        number(q.map(|q| q.e_dot), 3),
        number(q.map(|q| q.dtwd * 1e3), 0),
    ]);
    table
}

fn is_unlearnt(failed: &Failed, measured: &[Measured]) -> bool {
    measured.iter().all(|m| m.name != failed.name)
}

fn quality_json(q: &Quality) -> Value {
    json!({"rmse_mm_s": q.rmse * 1e3, "e_dot": q.e_dot, "dtwd_mm": q.dtwd * 1e3, "path_error_mm": q.path_error * 1e3, "pace": q.pace, "converged": q.converged, "rollouts": q.rollouts})
}

fn held_out_json(h: &HeldOut) -> Value {
    let mut all = quality_json(&h.mean);
    all["worst_dtwd_mm"] = (h.worst * 1e3).into();
    all
}

fn numbers(measured: &[Measured], failed: &[Failed], task: &Task<'_>, lasa: bool) -> Map<String, Value> {
    let motion = |m: &Measured| {
        let mut one = quality_json(&m.quality);
        one["name"] = m.name.clone().into();
        one["k"] = m.k.into();
        one["seconds"] = m.seconds.into();
        one["certified"] = m.certified.into();
        one["margin"] = m.margin.into();
        one["demonstrations"] = m.shown.items().len().into();
        one["warnings"] = m.shown.warnings().iter().map(ToString::to_string).collect();
        if task.held_out {
            one["held_out"] = m.held_out.as_ref().map(held_out_json).into();
        }
        one
    };
    let middle = |value: fn(&Measured) -> f64| Value::from(median(measured.iter().map(value)));
    let mut medians_json = medians(measured.iter().map(|m| &m.quality)).as_ref().map_or(Value::Null, quality_json);
    medians_json["k"] = middle(|m| m.k as f64);
    medians_json["seconds"] = middle(|m| m.seconds);
    medians_json["margin"] = middle(|m| m.margin);
    if task.held_out {
        medians_json["held_out"] = held_out_medians(measured).as_ref().map(held_out_json).into();
    }
    let fault = |f: &Failed| json!({"name": f.name, "error": f.reason});
    let peer = |p: &peers::Peer| {
        json!({"name": p.name, "learnt": p.learnt, "tried": p.tried, "certificate_broken": p.broken, "seconds": p.seconds,
               "rmse_mm_s": p.medians.map(|m| m[0]), "e_dot": p.medians.map(|m| m[1]), "dtwd_mm": p.medians.map(|m| m[2])})
    };
    let mut all = Map::new();
    all.insert("motions".into(), measured.iter().map(motion).collect());
    all.insert("medians".into(), medians_json);
    all.insert("failed".into(), failed.iter().map(fault).collect());
    if lasa {
        all.insert("peers".into(), peers::PEERS.iter().map(peer).collect());
    }
    all
}
