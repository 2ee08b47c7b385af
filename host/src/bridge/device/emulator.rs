//! QEMU, and the firmware images it runs: found, or built now from this tool's own source.

use std::env;
use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use crate::bridge::BridgeError;

const EMULATOR: &str = "qemu-system-arm";
/// Names the firmware's ELF file, and with it the folder where its like are.
const FIRMWARE: &str = "PLIANT_FIRMWARE";

/// A machine QEMU has, and what it runs.
pub(crate) struct Image {
    /// QEMU's name of the machine.
    pub machine: &'static str,
    /// The package that is the image.
    pub package: &'static str,
    /// What it is built for.
    pub target: &'static str,
}

/// The default board's firmware.
pub(super) const BOARD: Image =
    Image { machine: "mps2-an386", package: "pliant-mps2-an386", target: "thumbv7em-none-eabihf" };

/// An image and a QEMU to run it, found (and built) before a port is chosen: a build takes long, and a free port may not stay so.
pub(crate) struct Emulator {
    program: PathBuf,
    machine: &'static str,
    elf: PathBuf,
}

/// A running QEMU, killed when dropped.
pub(crate) struct Process(pub(super) Child);

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Emulator {
    /// Finds both.
    ///
    /// # Errors
    /// The sentence says what is missing, and what to do.
    pub(crate) fn find(image: &Image) -> Result<Self, BridgeError> {
        let program = find_program(EMULATOR).ok_or_else(|| {
            BridgeError::Emulator(format!(
                "{EMULATOR} is not installed: run `sudo apt-get install {EMULATOR}` (or `cargo xtask setup`)"
            ))
        })?;
        Ok(Self { program, machine: image.machine, elf: image.find()? })
    }

    /// Starts it: `options` come between those of the machine and the image; semihosting is on, with these `words` for the image.
    pub(crate) fn start<O: AsRef<OsStr>>(
        &self,
        options: impl IntoIterator<Item = O>,
        words: &[String],
        stdout: Stdio,
    ) -> Result<Process, BridgeError> {
        // Should this process be killed outright, the system ends QEMU for us.
        let mut command = match find_program("setpriv") {
            Some(setpriv) => {
                let mut command = Command::new(setpriv);
                command.args(["--pdeathsig", "KILL"]).arg(&self.program);
                command
            }
            None => Command::new(&self.program),
        };
        let words: String = words.iter().map(|word| format!(",arg={word}")).collect();
        command.args(["-machine", self.machine, "-display", "none", "-monitor", "none"]).args(options);
        command.arg("-semihosting-config").arg(format!("enable=on,target=native{words}"));
        command.arg("-kernel").arg(&self.elf);
        command.stdin(Stdio::null()).stdout(stdout).stderr(Stdio::piped());
        let child = command
            .spawn()
            .map_err(|error| BridgeError::Emulator(format!("cannot start {}: {error}", self.program.display())))?;
        Ok(Process(child))
    }
}

impl Process {
    /// If QEMU has ended already: the sentence that says so, with its own words.
    pub(super) fn ended(&mut self) -> Option<BridgeError> {
        let status = self.0.try_wait().ok()??;
        Some(self.sentence(&status.to_string()))
    }

    /// If QEMU has ended already: an error.
    pub(super) fn check(&mut self) -> io::Result<()> {
        match self.ended() {
            None => Ok(()),
            Some(error) => Err(io::Error::new(io::ErrorKind::BrokenPipe, error.to_string())),
        }
    }

    /// Waits until the image has ended QEMU by itself; an error if not with success.
    pub(crate) fn finish(mut self) -> Result<(), BridgeError> {
        match self.0.wait() {
            Ok(status) if status.success() => Ok(()),
            Ok(status) => Err(self.sentence(&status.to_string())),
            Err(error) => Err(BridgeError::Emulator(format!("QEMU was lost: {error}"))),
        }
    }

    /// What it prints, if that was asked for.
    pub(crate) fn stdout(&mut self) -> Option<std::process::ChildStdout> {
        self.0.stdout.take()
    }

    fn sentence(&mut self, status: &str) -> BridgeError {
        let mut words = String::new();
        if let Some(mut stderr) = self.0.stderr.take() {
            let _ = io::Read::read_to_string(&mut stderr, &mut words);
        }
        let words = words.trim();
        let colon = if words.is_empty() { "" } else { ": " };
        BridgeError::Emulator(format!("QEMU ended by itself ({status}){colon}{words}"))
    }
}

fn find_program(name: &str) -> Option<PathBuf> {
    env::split_paths(&env::var_os("PATH")?).map(|folder| folder.join(name)).find(|path| path.is_file())
}

impl Image {
    /// The ELF file: the one named by `PLIANT_FIRMWARE` (or in the same target directory as that one), or one built now from this tool's
    /// own source.
    fn find(&self) -> Result<PathBuf, BridgeError> {
        if let Some(firmware) = env::var_os(FIRMWARE) {
            let firmware = PathBuf::from(firmware);
            if !firmware.is_file() {
                let sentence = format!("{FIRMWARE} names {}, which is not a file", firmware.display());
                return Err(BridgeError::Emulator(sentence));
            }
            if self.package == BOARD.package {
                return Ok(firmware);
            }
            // Cargo's: <target directory>/<target>/firmware/<package>
            let like = firmware.ancestors().nth(3).map(|folder| self.within(folder));
            if let Some(path) = like.filter(|path| path.is_file()) {
                return Ok(path);
            }
        }
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        if !source.join("firmware").is_dir() {
            return Err(BridgeError::Emulator(format!(
                "the firmware's source is not where this tool was built: set {FIRMWARE} to the firmware's ELF file"
            )));
        }
        self.build(&source)
    }

    fn within(&self, target: &Path) -> PathBuf {
        target.join(self.target).join("firmware").join(self.package)
    }

    fn build(&self, source: &Path) -> Result<PathBuf, BridgeError> {
        self.ensure_target()?;
        let target = env::var_os("CARGO_TARGET_DIR").map_or_else(|| source.join("target"), PathBuf::from);
        let elf = self.within(&target);
        if !elf.exists() {
            eprintln!("building {} for {} (once)", self.package, self.target);
        }
        let output = self.cargo(source, &target).output();
        let output = output
            .map_err(|error| BridgeError::Emulator(format!("cannot run cargo to build the firmware: {error}")))?;
        if !output.status.success() {
            let words = String::from_utf8_lossy(&output.stderr);
            return Err(BridgeError::Emulator(format!("the firmware does not build:\n{words}")));
        }
        fs::canonicalize(&elf)
            .map_err(|error| BridgeError::Emulator(format!("no firmware at {}: {error}", elf.display())))
    }

    fn cargo(&self, source: &Path, target: &Path) -> Command {
        let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        let arguments = ["build", "--profile", "firmware", "--target", self.target, "-p", self.package];
        command.current_dir(source).args(arguments);
        command.arg("--target-dir").arg(target).stdin(Stdio::null());
        // Flags of the environment would take the place of the linker script's in .cargo/config.toml.
        command.env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS");
        command
    }

    /// Asks rustup for the firmware's target, saying so; where there is no rustup, the build itself will tell.
    fn ensure_target(&self) -> Result<(), BridgeError> {
        let target = self.target;
        let Ok(installed) = Command::new("rustup").args(["target", "list", "--installed"]).output() else {
            return Ok(());
        };
        if String::from_utf8_lossy(&installed.stdout).lines().any(|line| line.trim() == target) {
            return Ok(());
        }
        eprintln!("installing the Rust target {target} (rustup target add {target})");
        match Command::new("rustup").args(["target", "add", target]).output() {
            Ok(output) if output.status.success() => Ok(()),
            _ => Err(BridgeError::Emulator(format!(
                "the Rust target {target} is missing: run `rustup target add {target}`"
            ))),
        }
    }
}
