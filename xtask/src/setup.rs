//! What the machine must have: two rustup targets, clippy and rustfmt, QEMU for Arm.
//!
//! On a fresh Debian or Ubuntu with rustup's stable toolchain everything missing is installed, one line
//! each. Where nothing is missing, nothing is said and no network is asked.

use std::io::IsTerminal;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::failure::Failure;
use crate::workspace::{THUMBV6M, THUMBV7EM, Workspace, output, works, written};

const QEMU: &str = "qemu-system-arm";

/// Installs what is missing.
pub fn run(workspace: &Workspace) -> Result<(), Failure> {
    targets()?;
    components(workspace)?;
    qemu()
}

/// The compiled core library of each microcontroller the project builds for.
fn targets() -> Result<(), Failure> {
    let mut missing = Vec::new();
    for target in [THUMBV7EM, THUMBV6M] {
        let libraries = output(Command::new("rustc").args(["--print", "target-libdir", "--target", target]))?;
        if !Path::new(libraries.trim()).is_dir() {
            missing.push(target);
        }
    }
    rustup(&["target", "add"], &missing)
}

fn components(workspace: &Workspace) -> Result<(), Failure> {
    let missing: Vec<&str> = [("clippy", "clippy"), ("fmt", "rustfmt")]
        .into_iter()
        .filter(|(tool, _)| !works(&mut workspace.cargo(&[tool, "--version"])))
        .map(|(_, component)| component)
        .collect();
    rustup(&["component", "add"], &missing)
}

/// Asks rustup explicitly: it may be told not to install anything of its own accord.
fn rustup(request: &[&str], missing: &[&str]) -> Result<(), Failure> {
    if missing.is_empty() {
        return Ok(());
    }
    let mut command = Command::new("rustup");
    command.args(request).args(missing);
    println!("setup: {}", written(&command));
    match quietly(&mut command) {
        Ok(()) => Ok(()),
        Err(said) => Err(Failure::new(format!(
            "the Rust toolchain lacks {}: run `{}` ({said})",
            missing.join(" and "),
            written(&command)
        ))),
    }
}

fn qemu() -> Result<(), Failure> {
    program("QEMU for Arm", QEMU)
}

/// A program of a Debian package of the same name.
pub fn program(what: &str, name: &str) -> Result<(), Failure> {
    if works(Command::new(name).arg("--version")) {
        return Ok(());
    }
    if !works(Command::new("apt-get").arg("--version")) {
        return Err(Failure::new(format!("{what} is missing: install your system's package that has `{name}`")));
    }
    let privilege = Privilege::of_this_process();
    let mut install = privilege.apt_get(&["install", "--yes", "--no-install-recommends", name]);
    println!("setup: apt-get install {name}");
    // Lists that are absent or out of date fail the first attempt: only then are they fetched.
    let attempt = quietly(&mut install).or_else(|_| {
        let mut update = privilege.apt_get(&["update"]);
        println!("setup: apt-get update");
        quietly(&mut update).and_then(|()| quietly(&mut install))
    });
    attempt.map_err(|said| Failure::new(format!("{what} is missing: run `sudo apt-get install {name}` ({said})")))
}

/// How apt-get gets the rights it needs.
#[derive(Clone, Copy)]
enum Privilege {
    Root,
    /// sudo, which may ask for a password where there is someone to ask.
    Sudo {
        interactive: bool,
    },
    /// Neither: apt-get will say that it may not.
    None,
}

impl Privilege {
    fn of_this_process() -> Self {
        let user = Command::new("id").arg("-u").output();
        if user.is_ok_and(|output| output.stdout.trim_ascii() == b"0") {
            Self::Root
        } else if works(Command::new("sudo").arg("--version")) {
            Self::Sudo { interactive: std::io::stdin().is_terminal() }
        } else {
            Self::None
        }
    }

    fn apt_get(self, arguments: &[&str]) -> Command {
        // `env` because sudo does not pass the environment on.
        let words = ["env", "DEBIAN_FRONTEND=noninteractive", "apt-get"];
        // Another package manager at work is waited for, not tripped over.
        let patience = ["-o", "DPkg::Lock::Timeout=300"];
        let before: &[&str] = match self {
            Self::Root | Self::None => &[],
            Self::Sudo { interactive: true } => &["sudo"],
            Self::Sudo { interactive: false } => &["sudo", "--non-interactive"],
        };
        let mut all = before.iter().chain(&words).chain(&patience).chain(arguments);
        let mut command = Command::new(all.next().unwrap_or(&"apt-get"));
        command.args(all);
        command
    }
}

/// Runs a command without its talk; where it fails, returns why.
fn quietly(command: &mut Command) -> Result<(), String> {
    let output = command.stdout(Stdio::null()).stderr(Stdio::piped()).output().map_err(|error| error.to_string())?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    Err(reason(&said).unwrap_or("it gave no reason").to_owned())
}

/// The line of an error output that tells most: rustup's or apt's first error, or else the last line.
fn reason(text: &str) -> Option<&str> {
    let marked = text.lines().find_map(|line| line.strip_prefix("error: ").or_else(|| line.strip_prefix("E: ")));
    marked.or_else(|| text.lines().rfind(|line| !line.trim().is_empty()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reason_is_the_error_or_the_last_line() {
        let rustup = "info: syncing\nerror: no such target\n\nStack backtrace:\n  0: main\n";
        assert_eq!(reason(rustup), Some("no such target"));
        assert_eq!(reason("W: old\nE: not root\nE: no lock\n"), Some("not root"));
        assert_eq!(reason("one\ntwo\n\n"), Some("two"));
        assert_eq!(reason("\n"), None);
    }

    #[test]
    fn sudo_never_waits_for_a_password_nobody_can_type() {
        let command = Privilege::Sudo { interactive: false }.apt_get(&["update"]);
        assert_eq!(
            written(&command),
            "sudo --non-interactive env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 update"
        );
        let command = Privilege::Root.apt_get(&["update"]);
        assert!(written(&command).starts_with("env DEBIAN_FRONTEND"));
    }

    #[test]
    fn a_failing_command_gives_its_reason() {
        let reason = quietly(Command::new("sh").args(["-c", "echo no luck >&2; exit 3"]));
        assert_eq!(reason, Err("no luck".to_owned()));
    }
}
