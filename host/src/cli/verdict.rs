//! What is said of runs that have come to their end: what failed, what would help, and what is worth knowing.

use pliant_core::Status;

use crate::error::counted;
use crate::scene::{Scene, SceneObstacle};
use crate::sim::{Run, Runs};

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
        let late = runs.runs.iter().filter(|r| r.nearest.touched() && !squeezed(r));
        if scene.guard().is_some() && names(late.map(|r| r.nearest.of.as_deref())).iter().any(moving) {
            said.remarks.push(MOVING.into());
        }
        said.remarks.extend(infeasible(scene, runs));
        if runs.runs.iter().any(|r| !r.reached && r.status.contains(Status::CLUSTER)) {
            said.remarks.push(CLUSTER.into());
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

/// What is worth knowing where a run did not arrive among cores that overlap.
const CLUSTER: &str = "hard cores overlap without a point in common from which all of them is seen (`CLUSTER`): the flow may end in the pocket between them";

/// Gamma where a margin of 1.05 begins to be too thin: deeper in a core than this it would not have kept the robot out.
const DEEP: f64 = 1.0 / (1.05 * 1.05);

/// Was there no way out, rather than a robot that was late? Of one that its lag takes into a core `INFEASIBLE` is said as well, but only from
/// then on, and it does not get far.
fn squeezed(run: &Run) -> bool {
    run.before_entry > 0 || (run.infeasible > 0 && run.nearest.gamma < DEEP)
}

/// Why the guard finds no way for a robot whose lag took it in.
const INSIDE: &str = "before, its lag took the robot into a core or its margin";

/// In how many ticks the guard found no way, and why.
fn infeasible(scene: &Scene, runs: &Runs) -> Option<String> {
    let sum = |of: fn(&Run) -> u64| runs.runs.iter().map(of).sum::<u64>();
    let (ticks, found_none) = (sum(|r| r.ticks), sum(|r| r.infeasible));
    let why = if !runs.runs.iter().any(squeezed) {
        INSIDE
    } else if scene.obstacles().iter().any(SceneObstacle::is_moving) {
        "moving obstacles left none, or none that it finds"
    } else {
        "what is around left none, or none that it finds"
    };
    (found_none > 0).then(|| {
        let all = counted(ticks as usize, "tick");
        format!(
            "in {found_none} of {all} the guard found no velocity that keeps out of every core (`INFEASIBLE`): {why}"
        )
    })
}

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
        stepped(&text)
    }

    #[test]
    fn a_core_that_moves_and_was_touched_fails_with_what_would_help() {
        let (scene, runs) = passed(1.0);
        let said = Verdict::of(&scene, &runs);
        assert_eq!(said.failures, ["a hard core was touched (Gamma <= 1): ball"]);
        let (late, ticks) = (runs.runs[0].infeasible, runs.runs[0].ticks);
        let inside = format!(
            "in {late} of {ticks} ticks the guard found no velocity that keeps out of every core (`INFEASIBLE`): {INSIDE}"
        );
        assert!(late > 0 && said.remarks == [MOVING.to_owned(), inside], "{said:?}");
    }

    fn stepped(text: &str) -> (Scene, Runs) {
        let scene = Scene::parse("s.toml", text, "".as_ref()).unwrap();
        let options = RunOptions { stepped: true, ..RunOptions::default() };
        let runs = run_scene(&mut Device::Virtual.open().unwrap(), &scene, &options, &mut |_, _, _| {}).unwrap();
        (scene, runs)
    }

    /// Three boxes that make a C, open to the robot.
    const POCKET: &str = "ds.linear = { attractor = [0.6, 0.0], gain = 1.0 }\ngoal.timeout = 4.0\n[[start]]\nposition = [-0.05, 0.0]\n\
        [[obstacle]]\nname = \"top\"\nshape = { box = [0.15, 0.03] }\ncenter = [0.1, 0.15]\n\
        [[obstacle]]\nname = \"bottom\"\nshape = { box = [0.15, 0.03] }\ncenter = [0.1, -0.15]\n\
        [[obstacle]]\nname = \"back\"\nshape = { box = [0.03, 0.16] }\ncenter = [0.23, 0.0]\n";

    #[test]
    fn a_run_that_ends_in_a_pocket_is_told_of_it() {
        let (scene, runs) = stepped(POCKET);
        let said = Verdict::of(&scene, &runs);
        assert_eq!(said.failures, ["the goal was not reached in time from every start"]);
        assert_eq!(said.remarks, [CLUSTER]);
        // One that arrives is not: here with the same cores behind it.
        let (scene, runs) = stepped(&POCKET.replace("[-0.05, 0.0]", "[0.4, 0.0]"));
        assert!(runs.reached() && runs.runs[0].status.contains(Status::CLUSTER));
        assert!(Verdict::of(&scene, &runs).remarks.is_empty());
    }

    #[test]
    fn a_robot_that_is_squeezed_is_told_so_and_advised_no_margin() {
        let (scene, runs) = stepped(
            "ds.linear = { attractor = [0.5, 0.0], gain = 1.0 }\ngoal.timeout = 4.0\n[[start]]\nposition = [-0.3, 0.01]\n\
             [[obstacle]]\nname = \"piston\"\nshape = { box = [0.05, 0.3] }\ncenter = [0.2, 0.0]\nvelocity = [-0.2, 0.0]\n\
             [[obstacle]]\nname = \"room\"\nwall = true\nshape = { box = [0.6, 0.29] }\ncenter = [0.0, 0.0]\n",
        );
        let run = &runs.runs[0];
        assert!(run.nearest.touched() && run.infeasible > 0 && run.infeasible < run.ticks, "{}", run.infeasible);
        let said = Verdict::of(&scene, &runs);
        assert!(!said.remarks.iter().any(|r| r == MOVING), "{said:?}");
        let expected = format!("in {} of {} ticks the guard found no velocity", run.infeasible, run.ticks);
        let remark = said.remarks.iter().find(|r| r.starts_with(&expected)).unwrap();
        assert!(remark.ends_with("(`INFEASIBLE`): moving obstacles left none, or none that it finds"), "{remark}");
    }

    #[test]
    fn a_margin_that_was_entered_is_a_remark() {
        let (scene, runs) = passed(1.05);
        // The case itself: the lag took it into the margin, not to the core.
        assert!(runs.min_gamma_with_margin() < 1.0 && runs.min_gamma() > 1.0 && runs.untouched());
        let said = Verdict::of(&scene, &runs);
        assert!(said.failures.is_empty(), "{said:?}");
        let entered = "the margin of a core was entered, and the core itself not touched: ball";
        assert!(
            said.remarks.iter().any(|r| r == entered)
                && said.remarks.iter().all(|r| r == entered || r.ends_with(INSIDE)),
            "{said:?}"
        );
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
