//! Licences, bans and sources of the dependency tree, by cargo-deny.
//!
//! Advisories are left out: they need a clone of a database that not every machine can reach.

use crate::failure::Failure;
use crate::workspace::{Workspace, run, works};

/// How to get cargo-deny, for people.
pub const HOW_TO_INSTALL: &str = "`cargo xtask deny` installs it, which takes some minutes";

/// Whether cargo-deny is there.
pub fn is_installed(workspace: &Workspace) -> bool {
    works(&mut workspace.cargo(&["deny", "--version"]))
}

/// Checks the tree against deny.toml.
pub fn check(workspace: &Workspace) -> Result<(), Failure> {
    run(&mut workspace.cargo(&["deny", "check", "bans", "licenses", "sources"]))
}

/// The task `deny`.
pub fn install_and_check(workspace: &Workspace) -> Result<(), Failure> {
    if !is_installed(workspace) {
        run(workspace
            .cargo(&["install", "--locked", "cargo-deny"])
            // Its build is nothing of ours.
            .env_remove("CARGO_TARGET_DIR"))?;
    }
    check(workspace)
}
