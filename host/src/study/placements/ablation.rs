//! What the velocity and what the guard contribute: every column with the guard and without.

use serde_json::{Map, Value, json};

use super::run::{Measured, Passed};
use crate::study::column::{Column, Way};
use crate::study::table::Table;

/// Of how many it is so, and how many it could be.
type Share = (usize, usize);

/// One of the columns, guarded or not.
struct Row {
    way: Way,
    entered: usize,
    missed: usize,
    stalled: usize,
    would_stall: usize,
    slower: Share,
    guarded: usize,
}

fn rows(all: &[Passed]) -> Vec<Row> {
    let columns = Column::ALL.into_iter().enumerate();
    let ways = columns.flat_map(|(c, column)| {
        let (own, other) = (Way::from(column), Way::other(column));
        // Without the guard first.
        let (first, second) = if own.guard { (other, own) } else { (own, other) };
        [(c, first), (c, second)]
    });
    let row = |(c, way): (usize, Way)| {
        let own = way == Way::from(way.column);
        let of = |p: &Passed| if own { p.runs[c] } else { p.others[c] };
        let count = |is: fn(&Measured) -> bool| all.iter().filter(|p| is(&of(p))).count();
        let changes: Vec<f64> = all.iter().filter_map(|p| p.speed_change(&of(p))).collect();
        Row {
            way,
            entered: count(|m| m.entered),
            missed: count(|m| !m.reached),
            stalled: count(|m| m.stalled),
            would_stall: count(Measured::would_stall),
            slower: (changes.iter().filter(|x| **x < 0.0).count(), changes.len()),
            guarded: count(|m| m.guarded > 0.0),
        }
    };
    ways.map(row).collect()
}

/// One row a way.
pub fn table(all: &[Passed]) -> Table {
    let title = format!(
        "The same {} runs with the guard and without: how many of them (a run ends where it touches a core)",
        all.len()
    );
    let header = [
        "computed by",
        "guard",
        "entered a hard core",
        "did not reach the goal",
        "stalled on the way",
        "ended at a core and would have stalled",
        "slower than the original in the layer",
        "guard acted",
    ];
    let mut table = Table::new("placements-ablation", title, &header);
    for r in rows(all) {
        table.push([
            r.way.column.title().into(),
            if r.way.guard { "with" } else { "without" }.into(),
            r.entered.to_string(),
            r.missed.to_string(),
            r.stalled.to_string(),
            r.would_stall.to_string(),
            format!("{} of {}", r.slower.0, r.slower.1),
            r.guarded.to_string(),
        ]);
    }
    table
}

/// By column, with the guard and without.
pub fn json(all: &[Passed]) -> Value {
    let mut out = Map::new();
    for r in rows(all) {
        let of = out.entry(r.way.column.key()).or_insert_with(|| json!({}));
        of[if r.way.guard { "with_guard" } else { "without_guard" }] = json!({
            "runs": all.len(), "penetrated": r.entered, "not_reached": r.missed, "stalled": r.stalled, "would_stall": r.would_stall,
            "slower": r.slower.0, "slower_of": r.slower.1, "guarded": r.guarded,
        });
    }
    out.into()
}
