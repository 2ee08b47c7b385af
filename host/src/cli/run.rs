//! `pliant run`

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use pliant_protocol::message::{Mode, StopReason};
use serde_json::json;

use super::verdict::Verdict;
use super::{Finished, finite, print_json, progress};
use crate::bridge::{BridgeError, Device};
use crate::error::{Error, Outcome, counted};
use crate::eval::flag_names;
use crate::plot;
use crate::scene::Scene;
use crate::sim::{RunOptions, Runs, run_scene};

/// Options of `pliant run`.
#[derive(Clone, Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct Args {
    /// Scene file; the built-in scene if not given.
    scene: Option<PathBuf>,
    /// virtual, qemu, qemu-serial, serial:PATH[@BAUD] or udp:HOST:PORT
    #[arg(long, default_value = "virtual")]
    device: Device,
    /// One tick a robot state, as fast as it goes and the same every time, instead of 1 kHz real time.
    #[arg(long)]
    stepped: bool,
    /// The robot that is driven.
    #[arg(long, value_enum, default_value = "point")]
    robot: Robot,
    /// Give up after this many seconds from a start (the scene's timeout if not given).
    #[arg(long, value_name = "S", value_parser = seconds)]
    duration: Option<f64>,
    /// Draw no figure.
    #[arg(long)]
    headless: bool,
}

impl Default for Args {
    fn default() -> Self {
        let (device, robot) = (Device::Virtual, Robot::Point);
        Self { scene: None, device, stepped: false, robot, duration: None, headless: false }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Robot {
    /// A point with a first-order lag of 10 ms.
    Point,
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(s) if s > 0.0 && s <= 86_400.0 => Ok(s),
        _ => Err("allowed is a number of seconds above 0, at most 86400".into()),
    }
}

/// Where figures go, below the working folder.
const FIGURES: &str = "out";

pub(super) fn main(args: &Args, json: bool) -> Finished {
    let Robot::Point = args.robot;
    let scene = super::scene(args.scene.as_deref())?;
    let mut session = args.device.open()?;
    let slow_link = args.device.is_slow();
    let options = RunOptions { stepped: args.stepped, duration: args.duration, slow_link, ..RunOptions::default() };
    let bar = progress::bar(json);
    let starts = scene.starts().len();
    let runs = run_scene(&mut session, &scene, &options, &mut |i, time, distance| {
        let whole = (scene.starts()[i] - scene.attractor()).norm();
        let done = (i as f64 + 1.0 - (distance / whole).clamp(0.0, 1.0)) / starts as f64;
        bar.set_position((done * 1000.0) as u64);
        bar.set_message(format!("start {} of {starts}: {time:.1} s, {distance:.3} m to go", i + 1));
    });
    let runs = runs.map_err(|error| broken_off(error, args.stepped))?;
    bar.finish_and_clear();
    let board = session.info().board.clone();
    drop(session);
    // What was run is told also where it cannot be drawn.
    let (figure, drawn) = match (!args.headless).then(|| draw(&scene, &runs)) {
        None => (None, true),
        Some(Ok(figure)) => (Some(figure), true),
        Some(Err(error)) => {
            super::warn(&[format!("no figure: {error}")]);
            (None, false)
        }
    };
    let verdict = Verdict::of(&scene, &runs);
    if json {
        print_json(&as_json(&scene, args, &board, &runs, &verdict, figure.as_deref()));
    } else {
        print_table(&scene, args, &board, &runs, &verdict, figure.as_deref());
    }
    Ok(if verdict.failures.is_empty() && drawn { Outcome::Success } else { Outcome::Failed })
}

/// What is said of a run that did not come to its end.
fn broken_off(error: BridgeError, stepped: bool) -> Error {
    let held_up = matches!(
        error,
        BridgeError::Silent { .. } | BridgeError::Stopped { mode: Mode::Stopped(StopReason::LinkLost), .. }
    );
    match error {
        BridgeError::Capacity { .. } | BridgeError::Refused { .. } => error.into(),
        // The device was there and failed at what it was asked to run.
        _ if held_up && !stepped => Error::failed(error.to_string()).with_help(IN_TIME),
        _ => Error::failed(error.to_string()),
    }
}

/// What can be done where real time was too fast for this machine.
const IN_TIME: &str = "in real time host and device have a millisecond for a tick, and a busy machine keeps both from it, an emulated device most of all: \
                       run it with less beside it, or with `--stepped`, where the device waits for the robot's state before each tick";

/// The figure of a run, as SVG and PNG; the path of the PNG.
fn draw(scene: &Scene, runs: &Runs) -> Result<PathBuf, Error> {
    let figure = plot::scene_figure(scene, &plot::trajectories(runs), &plot::Options::default())?;
    let base = Path::new(FIGURES).join(scene.name());
    figure.save(&base.with_extension("svg"))?;
    let png = base.with_extension("png");
    figure.save(&png)?;
    Ok(png)
}

fn as_json(
    scene: &Scene,
    args: &Args,
    board: &str,
    runs: &Runs,
    verdict: &Verdict,
    figure: Option<&Path>,
) -> serde_json::Value {
    let each: Vec<_> = runs
        .runs
        .iter()
        .map(|r| {
            json!({
                "start": r.start.as_slice()[..scene.dimension()],
                "reached": r.reached,
                "ticks": r.ticks,
                "missed": r.missed,
                "host_late": r.host_late,
                "min_gamma": finite(r.nearest.gamma),
                "min_gamma_with_margin": finite(r.nearest_margin.gamma),
                "nearest": r.nearest.of,
                "status": flag_names(r.status),
                "infeasible": r.infeasible,
                "time_to_goal_s": r.time_to_goal,
                "velocities_crc32c": format!("{:08x}", r.checksum),
            })
        })
        .collect();
    json!({
        "scene": scene.name(),
        "device": args.device.to_string(),
        "board": board,
        "stepped": args.stepped,
        "reached": runs.reached(),
        "ticks": runs.runs.iter().map(|r| r.ticks).sum::<u64>(),
        "missed": runs.runs.iter().map(|r| r.missed).sum::<u64>(),
        "host_late": runs.runs.iter().map(|r| r.host_late).sum::<u64>(),
        "min_gamma": finite(runs.min_gamma()),
        "min_gamma_with_margin": finite(runs.min_gamma_with_margin()),
        "time_to_goal_s": runs.time_to_goal(),
        "rtt_us": runs.rtt_us,
        "device_since_start": runs.statistics,
        "failures": verdict.failures,
        "remarks": verdict.remarks,
        "figure": figure,
        "runs": each,
    })
}

fn print_table(scene: &Scene, args: &Args, board: &str, runs: &Runs, verdict: &Verdict, figure: Option<&Path>) {
    let pace = if args.stepped { "stepped" } else { "1 kHz" };
    say!("{} on {} ({board}, {pace}): {}\n", scene.name(), args.device, counted(scene.obstacles().len(), "obstacle"));
    say!("  start                     reached  time s  min Gamma  nearest              ticks  missed");
    for r in &runs.runs {
        let coordinates: Vec<_> = r.start.iter().take(scene.dimension()).map(|x| format!("{x:.3}")).collect();
        let time = r.time_to_goal.map_or("-".into(), |t| format!("{t:.2}"));
        let gamma = finite(r.nearest.gamma).map_or("-".into(), |gamma| format!("{gamma:.3}"));
        say!(
            "  {:<24}  {:<7}  {time:>6}  {gamma:>9}  {:<18}  {:>6}  {:>6}",
            format!("({})", coordinates.join(", ")),
            if r.reached { "yes" } else { "NO" },
            r.nearest.of.as_deref().unwrap_or("-"),
            r.ticks,
            r.missed
        );
    }
    let rtt = runs.rtt_us;
    say!("\n  state to command: median {:.0} us, 99 % {:.0} us, longest {:.0} us", rtt.p50, rtt.p99, rtt.max);
    if verdict.failures.is_empty() {
        say!("  every start reached the goal and no hard core was touched");
    }
    verdict.failures.iter().for_each(|failure| say!("  FAILED: {failure}"));
    verdict.remarks.iter().for_each(|remark| say!("  {remark}"));
    if let Some(figure) = figure {
        say!("  figure: {} (and .svg beside it)", figure.display());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_is_too_slow_for_real_time_is_told_of_stepped() {
        let stopped = |reason| BridgeError::Stopped { device: "qemu".into(), mode: Mode::Stopped(reason) };
        let silent = || BridgeError::Silent { device: "qemu".into(), seconds: 3.0 };
        let help = |error, stepped| {
            let error = broken_off(error, stepped);
            assert_eq!(error.exit(), 1);
            error.to_json()["error"]["help"].as_str().map(String::from)
        };
        for error in [stopped(StopReason::LinkLost), silent()] {
            assert!(help(error, false).is_some_and(|help| help.contains("`--stepped`")));
        }
        // It would not help there.
        assert_eq!(help(stopped(StopReason::LinkLost), true), None);
        assert_eq!(help(silent(), true), None);
        assert_eq!(help(stopped(StopReason::Fault), false), None);
    }
}
