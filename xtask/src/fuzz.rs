//! Runs every fuzz target for a while.

use std::process::Command;

use crate::failure::Failure;
use crate::workspace::{Workspace, output, run as run_command, works};

/// Packages with a `fuzz` folder.
pub const FUZZED: [&str; 2] = ["protocol", "host"];

/// The time for each target where none is asked for.
const SECONDS: u64 = 600;

/// Reads the task's options.
pub fn seconds(options: &[&str]) -> Result<u64, Failure> {
    match options {
        [] => Ok(SECONDS),
        ["--seconds", number] => number.parse().ok().filter(|n| *n > 0).ok_or_else(|| {
            Failure::usage(format!("`--seconds {number}`: a whole number of seconds, 1 or more, is wanted"))
        }),
        _ => Err(Failure::usage("`fuzz` takes `--seconds N` and nothing else")),
    }
}

/// Runs each target in turn; the first crash ends it.
pub fn run(workspace: &Workspace, seconds: u64) -> Result<(), Failure> {
    let nightly = || {
        let mut command = workspace.command("rustup");
        command
            .args(["run", "nightly", "cargo"])
            // Nightly's own cargo and compiler, and cargo-fuzz's own target directory.
            .env_remove("CARGO")
            .env_remove("CARGO_TARGET_DIR");
        command
    };
    if !works(nightly().arg("--version")) {
        return Err(Failure::new(
            "fuzzing needs the nightly toolchain: run `rustup toolchain install nightly --profile minimal`",
        ));
    }
    if !works(nightly().args(["fuzz", "--version"])) {
        return Err(Failure::new("fuzzing needs cargo-fuzz: run `cargo install --locked cargo-fuzz`"));
    }
    for package in FUZZED {
        let folder = workspace.root().join(package);
        if !folder.join("fuzz").is_dir() {
            println!("fuzz: {package} has no fuzz targets");
            continue;
        }
        let at_package = |arguments: &[&str]| -> Command {
            let mut command = nightly();
            command.current_dir(&folder).arg("fuzz").args(arguments);
            command
        };
        for target in output(&mut at_package(&["list"]))?.split_whitespace() {
            println!("fuzz: {package}/{target}, {seconds} s");
            // What is found goes into the first folder: the repository's own corpus stays as it is.
            let found = workspace.scratch(&format!("fuzz-corpus/{package}/{target}"))?;
            let mut command = at_package(&["run", target]);
            command.arg(found);
            let known = format!("fuzz/corpus/{target}");
            if folder.join(&known).is_dir() {
                command.arg(known);
            }
            command.args(["--", &format!("-max_total_time={seconds}")]);
            run_command(&mut command)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options() {
        assert_eq!(seconds(&[]).unwrap(), SECONDS);
        assert_eq!(seconds(&["--seconds", "5"]).unwrap(), 5);
        for bad in [&["--seconds", "0"][..], &["--seconds"], &["--seconds", "soon"], &["5"]] {
            assert_eq!(seconds(bad).unwrap_err().exit_code(), 2);
        }
    }
}
