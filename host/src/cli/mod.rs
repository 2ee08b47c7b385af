//! The command line: a contract with scripts.
//!
//! Exit 0 is success, 1 that what ran failed (goal missed, core touched), 2 bad input. With `--json` stdout has one JSON object and
//! nothing else.

/// Prints a line; like `println!`, but whoever closed standard output does not want to know.
macro_rules! say {
    ($($arguments:tt)*) => {
        $crate::cli::print(&(format!($($arguments)*) + "\n"))
    };
}

mod bench;
mod check;
mod eval;
mod import;
mod learn;
mod number;
mod plot;
mod progress;
mod relocate;
mod run;
mod study;
mod verdict;

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::error::{Error, Outcome};
use crate::scene::Scene;

/// Motion among things that give: learn a skill, run it past soft obstacles on a microcontroller, watch it arrive.
///
/// Without a command, `pliant` runs its built-in scene on the virtual device.
#[derive(Debug, Parser)]
///
/// A file that is written (-o, --figure) gets the folders it needs, and replaces what is there.
#[command(version, propagate_version = true, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    /// Print one JSON object on stdout, all else on stderr.
    #[arg(long, global = true)]
    json: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Drive a simulated robot through a scene with a device's velocities (the built-in scene if none is given).
    Run(run::Args),
    /// Learn a skill from demonstrations: .mat (LASA), .npz, .csv, folders of them.
    Learn(learn::Args),
    /// Import a model that another tool has learnt, with a certificate: .yml (ds-opt), .json (lpvds).
    Import(import::Args),
    /// Move a skill to another goal or start, make it larger, turn it: with its certificate.
    Move(relocate::Args),
    /// Check a model's stability certificate in the precision that will run.
    Check(check::Args),
    /// Evaluate the velocity at the points of a CSV file.
    Eval(eval::Args),
    /// Draw a scene: streamlines, hard and soft regions, trajectories.
    Plot(plot::Args),
    /// Run the paper's studies and experiments again, or learn a whole set of motions: tables and figures.
    Study(study::Args),
    /// Measure how long the method takes: here, or in instructions on emulated boards.
    Bench(bench::Args),
}

/// Parses the command line, runs it, reports, and gives the exit code.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // clap prints help to stdout and mistakes to stderr, and knows which of them is exit 0 and which 2.
            let _ = error.print();
            if error.use_stderr() && std::env::args_os().any(|a| a == "--json") {
                print_json(&Error::bad_input(error.to_string()).to_json());
            }
            return ExitCode::from(error.exit_code() as u8);
        }
    };
    let json = cli.json;
    let result = match cli.command.unwrap_or_else(|| Command::Run(run::Args::default())) {
        Command::Run(args) => run::main(&args, json),
        Command::Learn(args) => learn::main(&args, json),
        Command::Import(args) => import::main(&args, json),
        Command::Move(args) => relocate::main(&args, json),
        Command::Check(args) => check::main(&args, json),
        Command::Eval(args) => eval::main(&args, json),
        Command::Plot(args) => plot::main(&args, json),
        Command::Study(args) => study::main(&args, json),
        Command::Bench(args) => bench::main(&args, json),
    };
    crate::error::report(result, json)
}

/// What a command ends with: its exit code, or why it could not run.
type Finished = Result<Outcome, Error>;

/// The scene of a file, or the built-in one.
fn scene(path: Option<&Path>) -> Result<Scene, Error> {
    Ok(match path {
        Some(path) => Scene::load(path)?,
        None => Scene::builtin()?,
    })
}

/// Prints to standard output; whoever closed it does not want to know.
fn print(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}

/// Tells a person what may not be as it was meant.
fn warn<W: std::fmt::Display>(warnings: &[W]) {
    for warning in warnings {
        let _ = writeln!(std::io::stderr(), "warning: {warning}");
    }
}

/// A point on the command line: numbers with commas between.
#[derive(Clone, Debug, PartialEq)]
struct Point(Vec<f64>);

impl std::str::FromStr for Point {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<f64>, _> = text.split(',').map(|c| c.trim().parse()).collect();
        match numbers {
            Ok(p) if (2..=3).contains(&p.len()) && p.iter().all(|c: &f64| c.is_finite()) => Ok(Self(p)),
            _ => Err("allowed is X,Y or X,Y,Z, numbers with commas between and no spaces".into()),
        }
    }
}

/// Prints the one JSON object.
fn print_json(value: &serde_json::Value) {
    print(&format!("{value:#}\n"));
}

/// A number for JSON, which has no infinity.
fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}
