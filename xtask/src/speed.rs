//! What the method takes: times by criterion, and instructions by Callgrind, which a plain `cargo bench` cannot set up.

use crate::failure::Failure;
use crate::setup;
use crate::workspace::{Workspace, output, run as run_command, works};

/// Where the version of gungraun that the benches are built with is written.
const LIBRARY: &str = "gungraun";
/// The program it counts with, of the same version.
const RUNNER: &str = "gungraun-runner";

/// The task `bench`.
pub fn run(workspace: &Workspace) -> Result<(), Failure> {
    setup::program("Valgrind", "valgrind")?;
    let wanted = output(&mut workspace.cargo(&["pkgid", "--package", LIBRARY]))?;
    let version = version(&wanted).ok_or_else(|| Failure::new(format!("`cargo pkgid {LIBRARY}` gave no version")))?;
    if !has(workspace, version) {
        println!("setup: cargo install {RUNNER}@{version}");
        // Its build is nothing of ours.
        run_command(
            workspace
                .cargo(&["install", "--locked", "--quiet", &format!("{RUNNER}@{version}")])
                .env_remove("CARGO_TARGET_DIR"),
        )?;
    }
    run_command(&mut workspace.cargo(&["bench", "--package", "pliant-bench", "--features", "callgrind"]))
}

/// Is the runner there, in this version?
fn has(workspace: &Workspace, version: &str) -> bool {
    works(workspace.command("sh").arg("-c").arg(format!("{RUNNER} --version | grep -qF {version}")))
}

/// What is behind the last # or @ of a package's identifier.
fn version(identifier: &str) -> Option<&str> {
    identifier.trim().rsplit(['#', '@']).next().filter(|v| v.starts_with(|c: char| c.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_of_an_identifier() {
        assert_eq!(version("registry+https://example.org/index#gungraun@0.20.0\n"), Some("0.20.0"));
        assert_eq!(version("path+file:///x/gungraun#1.2.3"), Some("1.2.3"));
        assert_eq!(version("gungraun"), None);
    }
}
