//! The firmware in QEMU: builds it, starts it, and always stops it.

use std::env;
use std::fs;
use std::io;
use std::net::{SocketAddr, TcpStream, UdpSocket};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::bridge::BridgeError;
use crate::bridge::link::{Link, Serial, Udp};

const TARGET: &str = "thumbv7em-none-eabihf";
const PACKAGE: &str = "pliant-mps2-an386";
const EMULATOR: &str = "qemu-system-arm";
/// Where the firmware listens, inside.
const PORT: u16 = 9000;

/// A link into a machine that ends with it.
pub struct Machine<L> {
    link: L,
    // Dropped after the link, so that nobody writes into a dead machine.
    process: Process,
}

/// Killed when dropped.
struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The machine, with its network port on loopback.
pub fn start_udp() -> Result<Machine<Udp>, BridgeError> {
    let parts = Parts::find()?;
    let failed = |error: io::Error| BridgeError::Emulator(format!("no port for QEMU on loopback: {error}"));
    let peer = {
        let free = UdpSocket::bind(("127.0.0.1", 0)).map_err(failed)?;
        free.local_addr().map_err(failed)?
    };
    let process = parts.start(&["-serial".into(), "null".into(), "-nic".into(), nic(peer)])?;
    let link = Udp::to(peer).map_err(failed)?;
    Ok(Machine { link, process })
}

/// The machine, with its first UART on a loopback connection.
pub fn start_serial() -> Result<Machine<Serial<TcpStream>>, BridgeError> {
    let parts = Parts::find()?;
    let failed = |error: io::Error| BridgeError::Emulator(format!("cannot connect to QEMU's serial line: {error}"));
    let peer = {
        let free = std::net::TcpListener::bind(("127.0.0.1", 0)).map_err(failed)?;
        free.local_addr().map_err(failed)?
    };
    let line = format!("tcp:127.0.0.1:{},server=on,wait=off,nodelay=on", peer.port());
    let mut process = parts.start(&["-serial".into(), line, "-nic".into(), "none".into()])?;
    let deadline = Instant::now() + Duration::from_secs(10);
    let stream = loop {
        match TcpStream::connect(peer) {
            Ok(stream) => break stream,
            Err(_) if Instant::now() < deadline && process.0.try_wait().is_ok_and(|s| s.is_none()) => {
                std::thread::sleep(Duration::from_millis(20));
            }
            Err(error) => return Err(process.ended().unwrap_or_else(|| failed(error))),
        }
    };
    stream.set_nodelay(true).map_err(failed)?;
    Ok(Machine { link: Serial::over(stream), process })
}

fn nic(peer: SocketAddr) -> String {
    format!("user,model=lan9118,hostfwd=udp:127.0.0.1:{}-:{PORT}", peer.port())
}

/// What a machine is made of, found (and built) before a port is chosen: a build takes long, and a free port may not stay so.
struct Parts {
    emulator: PathBuf,
    firmware: PathBuf,
}

impl Parts {
    fn find() -> Result<Self, BridgeError> {
        Ok(Self { emulator: find_emulator()?, firmware: firmware()? })
    }

    fn start(&self, links: &[String]) -> Result<Process, BridgeError> {
        start(&self.emulator, &self.firmware, links)
    }
}

fn start(emulator: &Path, firmware: &Path, links: &[String]) -> Result<Process, BridgeError> {
    // Should this process be killed outright, the system ends QEMU for us.
    let mut command = match find_program("setpriv") {
        Some(setpriv) => {
            let mut command = Command::new(setpriv);
            command.args(["--pdeathsig", "KILL"]).arg(emulator);
            command
        }
        None => Command::new(emulator),
    };
    command.args(["-machine", "mps2-an386", "-display", "none", "-monitor", "none"]).args(links);
    command.args(["-semihosting-config", "enable=on,target=native"]).arg("-kernel").arg(firmware);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    let child = command
        .spawn()
        .map_err(|error| BridgeError::Emulator(format!("cannot start {}: {error}", emulator.display())))?;
    Ok(Process(child))
}

impl Process {
    /// If QEMU has ended already: the sentence that says so, with its own words.
    fn ended(&mut self) -> Option<BridgeError> {
        let status = self.0.try_wait().ok()??;
        let mut words = String::new();
        if let Some(mut stderr) = self.0.stderr.take() {
            let _ = io::Read::read_to_string(&mut stderr, &mut words);
        }
        let words = words.trim();
        Some(BridgeError::Emulator(format!(
            "QEMU ended by itself ({status}){}{words}",
            if words.is_empty() { "" } else { ": " }
        )))
    }

    fn check(&mut self) -> io::Result<()> {
        match self.ended() {
            None => Ok(()),
            Some(error) => Err(io::Error::new(io::ErrorKind::BrokenPipe, error.to_string())),
        }
    }
}

fn find_program(name: &str) -> Option<PathBuf> {
    env::split_paths(&env::var_os("PATH")?).map(|folder| folder.join(name)).find(|path| path.is_file())
}

fn find_emulator() -> Result<PathBuf, BridgeError> {
    find_program(EMULATOR).ok_or_else(|| {
        BridgeError::Emulator(format!(
            "{EMULATOR} is not installed: run `sudo apt-get install {EMULATOR}` (or `cargo xtask setup`)"
        ))
    })
}

/// The firmware's ELF file: the one named by `PLIANT_FIRMWARE`, or one built now from this tool's own source.
fn firmware() -> Result<PathBuf, BridgeError> {
    if let Some(path) = env::var_os("PLIANT_FIRMWARE") {
        let path = PathBuf::from(path);
        return if path.is_file() {
            Ok(path)
        } else {
            Err(BridgeError::Emulator(format!("PLIANT_FIRMWARE names {}, which is not a file", path.display())))
        };
    }
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    if !source.join("firmware").is_dir() {
        return Err(BridgeError::Emulator(
            "the firmware's source is not where this tool was built: set PLIANT_FIRMWARE to the firmware's ELF file"
                .into(),
        ));
    }
    build(&source)
}

fn build(source: &Path) -> Result<PathBuf, BridgeError> {
    ensure_target()?;
    let target = env::var_os("CARGO_TARGET_DIR").map_or_else(|| source.join("target"), PathBuf::from);
    let elf = target.join(TARGET).join("firmware").join(PACKAGE);
    if !elf.exists() {
        eprintln!("building the firmware for {TARGET} (once)");
    }
    let output = cargo(source, &target).output();
    let output =
        output.map_err(|error| BridgeError::Emulator(format!("cannot run cargo to build the firmware: {error}")))?;
    if !output.status.success() {
        let words = String::from_utf8_lossy(&output.stderr);
        return Err(BridgeError::Emulator(format!("the firmware does not build:\n{words}")));
    }
    fs::canonicalize(&elf).map_err(|error| BridgeError::Emulator(format!("no firmware at {}: {error}", elf.display())))
}

fn cargo(source: &Path, target: &Path) -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(source).args(["build", "--profile", "firmware", "--target", TARGET, "-p", PACKAGE]);
    command.arg("--target-dir").arg(target).stdin(Stdio::null());
    // Flags of the environment would take the place of the linker script's in .cargo/config.toml.
    command.env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS");
    command
}

/// Asks rustup for the firmware's target, saying so; where there is no rustup, the build itself will tell.
fn ensure_target() -> Result<(), BridgeError> {
    let Ok(installed) = Command::new("rustup").args(["target", "list", "--installed"]).output() else {
        return Ok(());
    };
    if String::from_utf8_lossy(&installed.stdout).lines().any(|line| line.trim() == TARGET) {
        return Ok(());
    }
    eprintln!("installing the Rust target {TARGET} (rustup target add {TARGET})");
    match Command::new("rustup").args(["target", "add", TARGET]).output() {
        Ok(output) if output.status.success() => Ok(()),
        _ => {
            Err(BridgeError::Emulator(format!("the Rust target {TARGET} is missing: run `rustup target add {TARGET}`")))
        }
    }
}

impl<L: Link> Link for Machine<L> {
    fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        self.link.send(frame)
    }
    fn receive(&mut self, timeout: Duration) -> io::Result<Option<Vec<u8>>> {
        let got = self.link.receive(timeout);
        if !timeout.is_zero() && !matches!(got, Ok(Some(_))) {
            self.process.check()?;
        }
        got
    }
}
