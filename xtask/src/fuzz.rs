//! Runs every fuzz target for a while.
//!
//! The stable toolchain will do: libFuzzer is led by coverage there as well. Nightly adds what only it has, the address sanitiser, which finds little
//! in code without `unsafe`; it is used where it is installed.

use std::process::Command;

use crate::failure::Failure;
use crate::setup;
use crate::workspace::{Workspace, output, run as run_command, works};

/// Cargo's command for libFuzzer.
const RUNNER: &str = "cargo-fuzz";

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

/// Cargo of the toolchain that fuzzes, with its own target directory.
fn cargo(workspace: &Workspace, nightly: bool) -> Command {
    let mut command = if nightly {
        let mut rustup = workspace.command("rustup");
        rustup.args(["run", "nightly", "cargo"]).env_remove("CARGO");
        rustup
    } else {
        workspace.cargo(&[])
    };
    command.env_remove("CARGO_TARGET_DIR");
    command
}

/// libFuzzer is C++, and Cargo's command for it a program of its own.
fn set_up(workspace: &Workspace) -> Result<(), Failure> {
    setup::program("a C++ compiler", "g++")?;
    if works(&mut workspace.cargo(&["fuzz", "--version"])) {
        return Ok(());
    }
    println!("setup: cargo install {RUNNER}");
    // Its build is nothing of ours.
    run_command(workspace.cargo(&["install", "--locked", "--quiet", RUNNER]).env_remove("CARGO_TARGET_DIR"))
        .map_err(|_| Failure::new(format!("fuzzing needs {RUNNER}: run `cargo install --locked {RUNNER}`")))
}

/// Runs each target in turn; the first crash ends it.
pub fn run(workspace: &Workspace, seconds: u64) -> Result<(), Failure> {
    set_up(workspace)?;
    let nightly = works(cargo(workspace, true).arg("--version"));
    let sanitizer = if nightly { "address" } else { "none" };
    for package in FUZZED {
        let folder = workspace.root().join(package);
        if !folder.join("fuzz").is_dir() {
            println!("fuzz: {package} has no fuzz targets");
            continue;
        }
        let at_package = |arguments: &[&str]| -> Command {
            let mut command = cargo(workspace, nightly);
            command.current_dir(&folder).arg("fuzz").args(arguments);
            command
        };
        for target in output(&mut at_package(&["list"]))?.split_whitespace() {
            println!("fuzz: {package}/{target}, {seconds} s, sanitiser {sanitizer}");
            // What is found goes into the first folder: the repository's own corpus stays as it is.
            let found = workspace.scratch(&format!("fuzz-corpus/{package}/{target}"))?;
            let mut command = at_package(&["run", "--sanitizer", sanitizer, target]);
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
