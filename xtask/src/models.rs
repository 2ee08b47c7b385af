//! Learns the shipped skills anew from the shipped demonstrations.

use crate::failure::Failure;
use crate::workspace::{Workspace, run as run_command};

/// The skills in `models/`, each from the folder in `demos/` of its name, and their seeds. The hook's is the first whose model fixed point evaluates as near to
/// f64 as is allowed everywhere about its scenes; with 1 it is off by up to 1.4 times that where fast components blend far from the demonstrations.
const SKILLS: [(&str, &str); 3] = [("arch", "1"), ("hook", "4"), ("sbend", "1")];

/// Writes every model in `models/`, as a user would.
pub fn run(workspace: &Workspace) -> Result<(), Failure> {
    for (skill, seed) in SKILLS {
        let (from, to) = (format!("demos/{skill}"), format!("models/{skill}.toml"));
        let pliant =
            ["run", "--release", "--package", "pliant", "--", "learn", &from, "-o", &to, "--seed", seed, "--no-figure"];
        run_command(&mut workspace.cargo(&pliant))?;
    }
    Ok(())
}
