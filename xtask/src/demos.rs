//! Writes the recorded demonstrations and the skills learnt from them anew.

use crate::failure::Failure;
use crate::workspace::{Workspace, run as run_command};

/// Runs the host's generator, which writes into demos/ and models/.
pub fn run(workspace: &Workspace) -> Result<(), Failure> {
    run_command(&mut workspace.cargo(&["run", "--release", "--package", "pliant", "--example", "make-demos"]))
}
