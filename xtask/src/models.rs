//! Learns the shipped skills anew from the shipped demonstrations.

use crate::failure::Failure;
use crate::workspace::{Workspace, run as run_command};

/// The skills in `models/`, each from the folder in `demos/` of its name.
const SKILLS: [&str; 3] = ["arch", "hook", "sbend"];

/// Writes every model in `models/`, as a user would.
pub fn run(workspace: &Workspace) -> Result<(), Failure> {
    for skill in SKILLS {
        let (from, to) = (format!("demos/{skill}"), format!("models/{skill}.toml"));
        let pliant = ["run", "--release", "--package", "pliant", "--", "learn", &from, "-o", &to, "--no-figure"];
        run_command(&mut workspace.cargo(&pliant))?;
    }
    Ok(())
}
