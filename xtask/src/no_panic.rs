//! That the tick cannot panic, shown by the linker; see `firmware/boards/no-panic`.

use std::process::Command;

use crate::callers;
use crate::failure::Failure;
use crate::workspace::{NO_PANIC, THUMBV6M, THUMBV7EM, Workspace, cannot_start, written};

/// What the panic handler calls, and nobody defines.
const MISSING: &str = "a_panic_can_be_reached";

/// Links the image for both cores, and then, to see that the check can fail, with a panic planted.
pub fn run(workspace: &Workspace) -> Result<(), Failure> {
    for target in [THUMBV7EM, THUMBV6M] {
        if !links(workspace, target, &[])? {
            let who = found(workspace, target, "found")?;
            return Err(Failure::new(format!("a panic can be reached on {target}:\n{who}")));
        }
        println!("no panic on {target}");
    }
    if links(workspace, THUMBV7EM, &["--features", "planted"])? {
        return Err(Failure::new("the check for panics does not see the one planted in `pliant-no-panic`"));
    }
    // What a failure would say is tried too: it must name the line that was planted.
    let who = found(workspace, THUMBV7EM, "found,planted")?;
    if !who.contains("no-panic/src/roots.rs") {
        return Err(Failure::new(format!("the planted panic is found, but not where it is:\n{who}")));
    }
    println!("the planted one is found: {}", who.trim());
    Ok(())
}

/// Does the image link? Any other error is a failure.
fn links(workspace: &Workspace, target: &str, options: &[&str]) -> Result<bool, Failure> {
    let mut command = workspace.cargo_for(target, &["build", "--profile", "firmware", "--package", NO_PANIC]);
    command.args(options);
    let (success, words) = ended(&mut command)?;
    if success || words.contains(MISSING) {
        return Ok(success);
    }
    eprint!("{words}");
    Err(Failure::new(format!("`{}` failed", written(&command))))
}

/// Who calls the panic handler, a line each.
fn found(workspace: &Workspace, target: &str, features: &str) -> Result<String, Failure> {
    let options = ["--profile", "firmware", "--package", NO_PANIC, "--features", features];
    let mut command = workspace.cargo_for(target, &["rustc"]);
    // With its relocations left in, the image says which instruction calls what.
    command.args(options).args(["--", "-C", "link-arg=--emit-relocs"]);
    let (success, words) = ended(&mut command)?;
    if !success {
        eprint!("{words}");
        return Err(Failure::new(format!("`{}` failed", written(&command))));
    }
    let path = workspace.image(target, NO_PANIC);
    let unreadable = |why: String| Failure::new(format!("cannot tell who panics from {}: {why}", path.display()));
    let bytes = std::fs::read(&path).map_err(|error| unreadable(error.to_string()))?;
    let callers = callers::of(&bytes, MISSING).map_err(unreadable)?;
    Ok(callers.iter().map(|caller| format!("  {caller}\n")).collect())
}

fn ended(command: &mut Command) -> Result<(bool, String), Failure> {
    let output = command.output().map_err(|error| cannot_start(command, &error))?;
    Ok((output.status.success(), String::from_utf8_lossy(&output.stderr).into_owned()))
}
