//! A device that fails says so with its last frame: zero velocity, stopped by a fault. The board's own example stands in for the
//! application, because it can be told to fail.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

use std::net::UdpSocket;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use pliant_protocol::message::{Mode, StopReason};
use pliant_protocol::{ToHost, decode};
use pliant_tests::programs::root;

const BOARD: &str = "pliant-mps2-an386";
const TARGET: &str = "thumbv7em-none-eabihf";

struct Machine(Child);

impl Drop for Machine {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The board's example, built for it.
fn echo() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    let status = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .current_dir(root())
        .args(["build", "--quiet", "--profile", "firmware", "-p", BOARD, "--example", "echo", "--target", TARGET])
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .status()
        .unwrap();
    assert!(status.success(), "the board's example does not build");
    target.join(TARGET).join("firmware/examples/echo")
}

fn boot(elf: &PathBuf) -> (Machine, UdpSocket) {
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let nic = format!("user,model=lan9118,hostfwd=udp:127.0.0.1:{port}-:9000");
    let child = Command::new("qemu-system-arm")
        .args(["-machine", "mps2-an386", "-display", "none", "-monitor", "none", "-serial", "null", "-nic", &nic])
        .arg("-kernel")
        .arg(elf)
        .stdin(Stdio::null())
        .spawn()
        .expect("qemu-system-arm is installed");
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.connect(("127.0.0.1", port)).unwrap();
    socket.set_read_timeout(Some(Duration::from_millis(200))).unwrap();
    let machine = Machine(child);
    awake(&socket);
    (machine, socket)
}

/// Waits until the device echoes.
fn awake(socket: &UdpSocket) {
    let deadline = Instant::now() + Duration::from_secs(30);
    let mut room = [0; 512];
    while Instant::now() < deadline {
        let _ = socket.send(b"are you there");
        if matches!(socket.recv(&mut room), Ok(n) if &room[..n] == b"are you there") {
            // What is still on the way is not to be taken for an answer.
            while socket.recv(&mut room).is_ok() {}
            return;
        }
    }
    panic!("the device does not answer");
}

/// Everything the device sends within some seconds that is a frame.
fn last_words(socket: &UdpSocket, seconds: u64) -> Vec<ToHost> {
    let deadline = Instant::now() + Duration::from_secs(seconds);
    let mut room = [0; 512];
    let mut words = Vec::new();
    while Instant::now() < deadline && words.is_empty() {
        if let Ok(n) = socket.recv(&mut room)
            && let Ok(frame) = decode::<ToHost>(&room[..n])
        {
            words.push(frame.message);
        }
    }
    words
}

#[test]
fn a_panic_a_hard_fault_and_a_hang_end_with_a_stop() {
    let elf = echo();
    // The watchdog gives a hang five seconds of the device's time.
    for (name, trigger, seconds) in [("panic", b"!", 10), ("hard fault", b"~", 10), ("hang", b"#", 60)] {
        let (_machine, socket) = boot(&elf);
        socket.send(trigger).unwrap();
        let words = last_words(&socket, seconds);
        let stopped = Mode::Stopped(StopReason::Fault);
        assert!(
            matches!(&words[..], [ToHost::Command { velocity: [0.0, 0.0, 0.0], mode, .. }] if *mode == stopped),
            "{name}: {words:?}"
        );
        // It starts again by itself.
        awake(&socket);
    }
}
