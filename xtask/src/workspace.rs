//! Where the workspace is, and commands started in it.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::failure::Failure;

/// The board that QEMU runs, and on which the firmware is tested.
pub const BOARD: &str = "pliant-mps2-an386";
/// The image that does not link if the tick can panic.
pub const NO_PANIC: &str = "pliant-no-panic";
/// What the method is measured with on boards.
pub const BENCH: &str = "pliant-mps2-bench";
/// The default board's target: Cortex-M4F and M7.
pub const THUMBV7EM: &str = "thumbv7em-none-eabihf";
/// Cores without an FPU, as Cortex-M0+: the libraries must build for them too.
pub const THUMBV6M: &str = "thumbv6m-none-eabi";

/// The workspace's root and its target directory, as cargo sees them.
pub struct Workspace {
    root: PathBuf,
    target: PathBuf,
}

impl Workspace {
    /// Asks cargo.
    pub fn locate() -> Result<Self, Failure> {
        let metadata = output(Command::new(cargo_program()).args(["metadata", "--no-deps", "--format-version", "1"]))?;
        let metadata: Value = serde_json::from_str(&metadata)
            .map_err(|error| Failure::new(format!("`cargo metadata` is not JSON: {error}")))?;
        let path = |key: &str| {
            metadata[key]
                .as_str()
                .map(PathBuf::from)
                .ok_or_else(|| Failure::new(format!("`cargo metadata` gave no `{key}`")))
        };
        Ok(Self { root: path("workspace_root")?, target: path("target_directory")? })
    }

    /// The repository's root.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The release `pliant` tool, once built.
    pub fn pliant(&self) -> PathBuf {
        self.target.join("release").join(format!("pliant{}", std::env::consts::EXE_SUFFIX))
    }

    /// The default board's ELF image, once built.
    pub fn firmware(&self) -> PathBuf {
        self.image(THUMBV7EM, BOARD)
    }

    /// A package's ELF image for a microcontroller, once built.
    pub fn image(&self, target: &str, package: &str) -> PathBuf {
        self.target.join(target).join("firmware").join(package)
    }

    /// A folder in the target directory for what need not be kept.
    pub fn scratch(&self, name: &str) -> Result<PathBuf, Failure> {
        let folder = self.target.join(name);
        std::fs::create_dir_all(&folder)
            .map_err(|error| Failure::new(format!("cannot create {}: {error}", folder.display())))?;
        Ok(folder)
    }

    /// A command run at the root.
    pub fn command(&self, program: impl AsRef<OsStr>) -> Command {
        let mut command = Command::new(program);
        command
            .current_dir(&self.root)
            // A relative CARGO_TARGET_DIR means something else from another directory.
            .env("CARGO_TARGET_DIR", &self.target);
        command
    }

    /// A cargo command for the host.
    pub fn cargo(&self, arguments: &[&str]) -> Command {
        let mut command = self.command(cargo_program());
        command.args(arguments);
        command
    }

    /// A cargo command for a microcontroller.
    pub fn cargo_for(&self, target: &str, arguments: &[&str]) -> Command {
        let mut command = self.cargo(arguments);
        command
            .args(["--target", target])
            // These would replace the linker script that .cargo/config.toml asks for.
            .env_remove("RUSTFLAGS")
            .env_remove("CARGO_ENCODED_RUSTFLAGS");
        command
    }

    /// Builds the release `pliant` tool.
    pub fn build_pliant(&self) -> Result<(), Failure> {
        run(&mut self.cargo(&["build", "--release", "--package", "pliant"]))
    }

    /// Builds the default board's firmware as it is flashed.
    pub fn build_firmware(&self) -> Result<(), Failure> {
        self.build_image(THUMBV7EM, BOARD)
    }

    /// Builds what the method is measured with on boards.
    pub fn build_bench(&self) -> Result<(), Failure> {
        [THUMBV7EM, THUMBV6M].into_iter().try_for_each(|target| self.build_image(target, BENCH))
    }

    fn build_image(&self, target: &str, package: &str) -> Result<(), Failure> {
        run(&mut self.cargo_for(target, &["build", "--profile", "firmware", "--package", package]))
    }
}

/// The cargo that started this task, so that all builds are by one toolchain.
fn cargo_program() -> OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

/// Runs a command whose output goes where ours goes.
pub fn run(command: &mut Command) -> Result<(), Failure> {
    let status = command.status().map_err(|error| cannot_start(command, &error))?;
    if status.success() { Ok(()) } else { Err(Failure::new(format!("`{}` failed", written(command)))) }
}

/// Runs a command and returns what it wrote on stdout; what it wrote on stderr is shown.
pub fn output(command: &mut Command) -> Result<String, Failure> {
    let output = command.stderr(Stdio::inherit()).output().map_err(|error| cannot_start(command, &error))?;
    if !output.status.success() {
        return Err(Failure::new(format!("`{}` failed", written(command))));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Whether a command can be started and succeeds; nothing of it is shown.
pub fn works(command: &mut Command) -> bool {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

/// The sentence for a program that could not be started.
pub fn cannot_start(command: &Command, error: &std::io::Error) -> Failure {
    Failure::new(format!("cannot start `{}`: {error}", written(command)))
}

/// The command as one would type it.
pub fn written(command: &Command) -> String {
    let program = Path::new(command.get_program());
    let mut words = vec![program.file_name().unwrap_or(command.get_program()).to_string_lossy().into_owned()];
    words.extend(command.get_args().map(|word| word.to_string_lossy().into_owned()));
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_written_as_typed() {
        let mut command = Command::new("/somewhere/bin/cargo");
        command.args(["fmt", "--all"]);
        assert_eq!(written(&command), "cargo fmt --all");
    }

    #[test]
    fn a_missing_program_does_not_work() {
        assert!(!works(&mut Command::new("no-such-program-at-all")));
    }
}
