//! The core's property campaigns at length: the same tests as in the suite, optimised and with many more samples.

use crate::failure::Failure;
use crate::workspace::{Workspace, run as run_command};

/// Samples of each campaign where no number is asked for.
const SAMPLES: u64 = 100_000_000;

/// Runs them; `--samples N` is the only option.
pub fn run(workspace: &Workspace, options: &[&str]) -> Result<(), Failure> {
    let samples = match options {
        [] => SAMPLES,
        ["--samples", number] => number.parse().ok().filter(|n| *n > 0).ok_or_else(|| {
            Failure::usage(format!("`--samples {number}`: a whole number of samples, 1 or more, is wanted"))
        })?,
        _ => return Err(Failure::usage("`campaign` takes `--samples N` and nothing else")),
    };
    let tests = ["--test", "penetration", "--test", "finite"];
    let mut command = workspace.cargo(&["test", "--release", "--package", "pliant-core"]);
    command.args(tests).args(["--", "--nocapture"]).env("PLIANT_SAMPLES", samples.to_string());
    run_command(&mut command)
}
