//! The steps of `cargo xtask test`: every check, then every test, in one order everywhere.
//!
//! Cheap checks come first and the first failure ends the run. The dependency tree is built in few ways,
//! since that is where the time goes: metadata only (clippy and docs share it), release (the tool), the
//! firmware's profile, and the development profile (tests).

use std::io::{BufRead, BufReader, Write};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::failure::Failure;
use crate::tally::Tally;
use crate::workspace::{BENCH, BOARD, NO_PANIC, THUMBV6M, THUMBV7EM, Workspace, cannot_start, run as run_command};
use crate::{deny, fuzz, no_panic, setup};

/// One check: its name for people, and what it does.
struct Step {
    name: &'static str,
    run: fn(&Workspace) -> Result<Done, Failure>,
}

/// How a step that did not fail ended.
enum Done {
    /// It passed.
    Passed,
    /// It could not be run here, and why.
    Skipped(String),
    /// Tests were run, and some may have failed.
    Tested {
        /// Their counts.
        tally: Tally,
        /// Whether cargo was content.
        success: bool,
    },
}

const STEPS: [Step; 11] = [
    Step { name: "set-up", run: |workspace| setup::run(workspace).map(|()| Done::Passed) },
    Step { name: "format", run: format },
    Step { name: "clippy, host", run: clippy_host },
    Step { name: "clippy, firmware", run: clippy_firmware },
    Step { name: "docs", run: docs },
    Step { name: "build, tool", run: |workspace| workspace.build_pliant().map(|()| Done::Passed) },
    Step { name: "build, firmware", run: |workspace| workspace.build_firmware().map(|()| Done::Passed) },
    Step { name: "build, bench", run: |workspace| workspace.build_bench().map(|()| Done::Passed) },
    Step { name: "no panic", run: |workspace| no_panic::run(workspace).map(|()| Done::Passed) },
    Step { name: "tests", run: tests },
    Step { name: "deny", run: deny_in_ci_or_if_installed },
];

fn cargo(workspace: &Workspace, arguments: &[&str]) -> Result<Done, Failure> {
    run_command(&mut workspace.cargo(arguments)).map(|()| Done::Passed)
}

fn format(workspace: &Workspace) -> Result<Done, Failure> {
    run_command(&mut workspace.cargo(&["fmt", "--all", "--check"]))?;
    // Fuzz targets are workspaces of their own.
    for package in fuzz::FUZZED {
        let manifest = format!("{package}/fuzz/Cargo.toml");
        if workspace.root().join(&manifest).is_file() {
            cargo(workspace, &["fmt", "--check", "--manifest-path", &manifest])?;
        }
    }
    Ok(Done::Passed)
}

fn clippy_host(workspace: &Workspace) -> Result<Done, Failure> {
    const EVERYTHING: [&str; 7] =
        ["clippy", "--workspace", "--exclude", BOARD, "--all-targets", "--features", "pliant-bench/callgrind"];
    run_command(workspace.cargo(&EVERYTHING).args(["--", "--deny", "warnings"])).map(|()| Done::Passed)
}

fn clippy_firmware(workspace: &Workspace) -> Result<Done, Failure> {
    const LIBRARIES: [&str; 7] =
        ["clippy", "--package", "pliant-core", "--package", "pliant-protocol", "--package", "pliant-firmware"];
    const IMAGES: [&str; 5] = ["clippy", "--package", BENCH, "--package", NO_PANIC];
    // Named, because tests cannot be built for a board.
    const WHOLE_BOARD: [&str; 5] = ["clippy", "--package", BOARD, "--bins", "--examples"];
    let both = [THUMBV7EM, THUMBV6M].into_iter().flat_map(|target| [(target, &LIBRARIES[..]), (target, &IMAGES[..])]);
    for (target, arguments) in both.chain([(THUMBV7EM, &WHOLE_BOARD[..])]) {
        run_command(workspace.cargo_for(target, arguments).args(["--", "--deny", "warnings"]))?;
    }
    Ok(Done::Passed)
}

fn docs(workspace: &Workspace) -> Result<Done, Failure> {
    let strict = |command: &mut Command| run_command(command.env("RUSTDOCFLAGS", "-D warnings"));
    strict(&mut workspace.cargo(&["doc", "--no-deps", "--workspace", "--exclude", BOARD]))?;
    strict(&mut workspace.cargo_for(THUMBV7EM, &["doc", "--no-deps", "--package", BOARD]))?;
    Ok(Done::Passed)
}

fn tests(workspace: &Workspace) -> Result<Done, Failure> {
    let mut command = workspace.cargo(&["test", "--workspace", "--exclude", BOARD]);
    command
        // All failures at once are worth more than the first one soon.
        .arg("--no-fail-fast")
        .env("PLIANT_BIN", workspace.pliant())
        .env("PLIANT_FIRMWARE", workspace.firmware())
        .stdout(Stdio::piped());
    let mut child = command.spawn().map_err(|error| cannot_start(&command, &error))?;
    let mut tally = Tally::default();
    if let Some(stdout) = child.stdout.take() {
        let lost = |error| Failure::new(format!("the tests' output was lost: {error}"));
        let mut out = std::io::stdout();
        for line in BufReader::new(stdout).split(b'\n') {
            let line = line.map_err(lost)?;
            let line = String::from_utf8_lossy(&line);
            tally.line(&line);
            writeln!(out, "{line}").map_err(lost)?;
        }
    }
    let status = child.wait().map_err(|error| Failure::new(format!("the tests were lost: {error}")))?;
    Ok(Done::Tested { tally: tally.finish(), success: status.success() })
}

/// Where nobody waits for it (`CI` is set), cargo-deny is installed; elsewhere its build would be minutes for a check
/// that seldom fails.
fn deny_in_ci_or_if_installed(workspace: &Workspace) -> Result<Done, Failure> {
    if std::env::var_os("CI").is_some() {
        return deny::install_and_check(workspace).map(|()| Done::Passed);
    }
    if !deny::is_installed(workspace) {
        return Ok(Done::Skipped(format!("cargo-deny is not installed; {}", deny::HOW_TO_INSTALL)));
    }
    deny::check(workspace).map(|()| Done::Passed)
}

/// Runs the steps and says what came of them.
pub fn run(workspace: &Workspace) -> Result<(), Failure> {
    let mut summary = Summary::default();
    for (index, step) in STEPS.iter().enumerate() {
        println!("== {}/{} {}", index + 1, STEPS.len(), step.name);
        let start = Instant::now();
        let done = (step.run)(workspace);
        let took = start.elapsed();
        let failure = summary.take(step.name, took, done);
        if let Some(failure) = failure {
            let never: Vec<&str> = STEPS[index + 1..].iter().map(|step| step.name).collect();
            summary.print(&never);
            return Err(failure);
        }
    }
    summary.print(&[]);
    Ok(())
}

/// What has been done so far.
#[derive(Default)]
struct Summary {
    lines: Vec<String>,
    tally: Option<Tally>,
}

impl Summary {
    /// Notes a step, and returns the sentence to stop with if it failed.
    fn take(&mut self, name: &str, took: Duration, done: Result<Done, Failure>) -> Option<Failure> {
        let (word, note, failure) = match done {
            Ok(Done::Passed) => ("passed", String::new(), None),
            Ok(Done::Skipped(why)) => {
                println!("skipped: {why}");
                ("skipped", why, None)
            }
            Ok(Done::Tested { tally, success }) => {
                let note = match tally.ignored() {
                    0 => String::new(),
                    ignored => format!("{ignored} ignored"),
                };
                let failure = match (success, tally.failed()) {
                    (true, 0) => None,
                    (_, 0) => Some(Failure::new("step `tests` failed: cargo could not build or run a test program")),
                    (_, 1) => Some(Failure::new("step `tests` failed: a test failed")),
                    (_, failed) => Some(Failure::new(format!("step `tests` failed: {failed} tests failed"))),
                };
                self.tally = Some(tally);
                (if failure.is_none() { "passed" } else { "FAILED" }, note, failure)
            }
            Err(failure) => {
                let failure = Failure::new(format!("step `{name}` failed: {failure}"));
                ("FAILED", String::new(), Some(failure))
            }
        };
        let line = format!("  {word:8}{name:18}{:>12}  {note}", duration(took));
        self.lines.push(line.trim_end().to_owned());
        failure
    }

    fn print(&self, never: &[&str]) {
        println!("== summary");
        for line in &self.lines {
            println!("{line}");
        }
        for name in never {
            println!("  not run {name}");
        }
        // Where no test was run there is nothing to count, and no line that could pass for a count.
        if let Some(tally) = &self.tally {
            println!("{}", tally.closing_line());
        }
    }
}

fn duration(took: Duration) -> String {
    let seconds = took.as_secs();
    match seconds {
        0..60 => format!("{:.1} s", took.as_secs_f64()),
        _ => format!("{} min {:2} s", seconds / 60, seconds % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tested(text: &str, success: bool) -> Result<Done, Failure> {
        let mut tally = Tally::default();
        text.lines().for_each(|line| tally.line(line));
        Ok(Done::Tested { tally: tally.finish(), success })
    }

    #[test]
    fn durations_are_short_to_read() {
        assert_eq!(duration(Duration::from_millis(1240)), "1.2 s");
        assert_eq!(duration(Duration::from_secs(187)), "3 min  7 s");
    }

    #[test]
    fn a_failed_step_stops_the_run_and_names_itself() {
        let mut summary = Summary::default();
        let failure = summary.take("format", Duration::ZERO, Err(Failure::new("no"))).unwrap();
        assert_eq!(failure.to_string(), "step `format` failed: no");
        assert!(summary.lines[0].contains("FAILED"));
        assert!(summary.tally.is_none());
    }

    #[test]
    fn tests_pass_only_if_cargo_and_the_counts_agree() {
        let good = "running 1 test\ntest result: ok. 1 passed; 0 failed; 2 ignored; 0 measured\n";
        let bad = "running 1 test\ntest result: FAILED. 0 passed; 1 failed; 0 ignored; 0 measured\n";
        let mut summary = Summary::default();
        let mut take = |done| summary.take("tests", Duration::ZERO, done).is_some();
        assert!(!take(tested(good, true)));
        assert!(take(tested(good, false)));
        assert!(take(tested(bad, false)));
        assert!(take(tested(bad, true)));
        assert!(summary.lines[0].ends_with("2 ignored"));
    }
}
