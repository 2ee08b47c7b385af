//! What is said of runs that have come to their end: what failed, what would help, and what is worth knowing.

use crate::error::counted;
use crate::scene::Scene;
use crate::sim::Runs;

/// More missed ticks than this, of those that were due, are worth a word.
const MISSED: f64 = 0.05;

/// What is said of all runs together.
#[derive(Debug, Default)]
pub(super) struct Verdict {
    /// What went wrong; nothing if the runs did what they were to do.
    pub failures: Vec<String>,
    /// What would help, and what is worth knowing.
    pub remarks: Vec<String>,
}

impl Verdict {
    pub fn of(scene: &Scene, runs: &Runs) -> Self {
        let mut said = Self::default();
        if !runs.reached() {
            said.failures.push("the goal was not reached in time from every start".into());
        }
        let touched = names(runs.runs.iter().map(|r| &r.nearest).filter(|n| n.touched()).map(|n| n.of.as_deref()));
        if !touched.is_empty() {
            said.failures.push(format!("a hard core was touched (Gamma <= 1): {}", touched.join(", ")));
        }
        let moving = |name: &&str| scene.obstacles().iter().any(|o| o.name() == *name && o.is_moving());
        if scene.guard().is_some() && touched.iter().any(moving) {
            said.remarks.push(MOVING.into());
        }
        let near = runs.runs.iter().filter(|r| !r.nearest.touched()).map(|r| &r.nearest_margin);
        let entered = names(near.filter(|n| n.touched()).map(|n| n.of.as_deref()));
        if !entered.is_empty() {
            let whose = entered.join(", ");
            said.remarks.push(format!("the margin of a core was entered, and the core itself not touched: {whose}"));
        }
        let (ticks, missed) = runs.runs.iter().fold((0, 0), |(t, m), r| (t + r.ticks, m + r.missed));
        if missed as f64 > MISSED * (ticks + missed) as f64 {
            let share = 100.0 * missed as f64 / (ticks + missed) as f64;
            said.remarks.push(format!(
                "{} of {} missed ({share:.0} %): this machine or the device was too busy for real time; with `--stepped` none is",
                missed,
                counted((ticks + missed) as usize, "tick")
            ));
        }
        said
    }
}

/// What helps a robot that follows with a lag past what moves.
const MOVING: &str = "it moves, and the robot follows with a lag: a `margin` of 1.05 or more keeps such a robot off, a smaller `approach` of the guard, such as \
                      0.005, helps less (figures in docs/scenes.md)";

/// Each name once, in quotes.
fn names<'a>(all: impl Iterator<Item = Option<&'a str>>) -> Vec<&'a str> {
    let mut names: Vec<&str> = all.flatten().collect();
    names.sort_unstable();
    names.dedup();
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bridge::Device;
    use crate::sim::{RunOptions, run_scene};

    /// A ball that overtakes the robot on one side, nearer than its lag allows.
    fn passed(margin: f64) -> (Scene, Runs) {
        let text = format!(
            "ds.linear = {{ attractor = [0.45, 0.0], gain = 1.0 }}\n[[start]]\nposition = [-0.45, 0.074]\n[[obstacle]]\nname = \"ball\"\n\
             shape = {{ ellipsoid = [0.0326, 0.0326] }}\ncenter = [-0.4329, 0.1558]\nvelocity = [0.3218, -0.2376]\n\
             margin = [{margin}, {margin}]\n"
        );
        let scene = Scene::parse("s.toml", &text, "".as_ref()).unwrap();
        let options = RunOptions { stepped: true, ..RunOptions::default() };
        let runs = run_scene(&mut Device::Virtual.open().unwrap(), &scene, &options, &mut |_, _, _| {}).unwrap();
        (scene, runs)
    }

    #[test]
    fn a_core_that_moves_and_was_touched_fails_with_what_would_help() {
        let (scene, runs) = passed(1.0);
        let said = Verdict::of(&scene, &runs);
        assert_eq!(said.failures, ["a hard core was touched (Gamma <= 1): ball"]);
        assert_eq!(said.remarks, [MOVING]);
    }

    #[test]
    fn a_margin_that_was_entered_is_a_remark() {
        let (scene, runs) = passed(1.05);
        // The case itself: the lag took it into the margin, not to the core.
        assert!(runs.min_gamma_with_margin() < 1.0 && runs.min_gamma() > 1.0 && runs.untouched());
        let said = Verdict::of(&scene, &runs);
        assert!(said.failures.is_empty(), "{said:?}");
        assert_eq!(said.remarks, ["the margin of a core was entered, and the core itself not touched: ball"]);
    }

    #[test]
    fn many_missed_ticks_are_worth_a_word() {
        let (scene, mut runs) = passed(1.0);
        runs.runs[0].ticks = 4000;
        let mut said = |missed| {
            runs.runs[0].missed = missed;
            Verdict::of(&scene, &runs).remarks.into_iter().filter(|r| r.contains("`--stepped`")).collect::<Vec<_>>()
        };
        assert!(said(0).is_empty() && said(200).is_empty());
        let remarks = said(1000);
        assert!(remarks.len() == 1 && remarks[0].starts_with("1000 of 5000 ticks missed (20 %)"), "{remarks:?}");
    }
}
