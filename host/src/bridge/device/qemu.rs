//! The firmware in QEMU: started with its links, and always stopped.

use std::io;
use std::net::{SocketAddr, TcpStream, UdpSocket};
use std::process::Stdio;
use std::time::{Duration, Instant};

use super::emulator::{BOARD, Emulator, Process};
use crate::bridge::BridgeError;
use crate::bridge::link::{Link, Serial, Udp};

/// Where the firmware listens, inside.
const PORT: u16 = 9000;

/// A link into a machine that ends with it.
pub struct Machine<L> {
    link: L,
    // Dropped after the link, so that nobody writes into a dead machine.
    process: Process,
}

/// The machine, with its network port on loopback.
pub fn start_udp() -> Result<Machine<Udp>, BridgeError> {
    let emulator = Emulator::find(&BOARD)?;
    let failed = |error: io::Error| BridgeError::Emulator(format!("no port for QEMU on loopback: {error}"));
    let peer = {
        let free = UdpSocket::bind(("127.0.0.1", 0)).map_err(failed)?;
        free.local_addr().map_err(failed)?
    };
    let process = emulator.start(["-serial", "null", "-nic", &nic(peer)], &[], Stdio::null())?;
    let link = Udp::to(peer).map_err(failed)?;
    Ok(Machine { link, process })
}

/// The machine, with its first UART on a loopback connection.
pub fn start_serial() -> Result<Machine<Serial<TcpStream>>, BridgeError> {
    let emulator = Emulator::find(&BOARD)?;
    let failed = |error: io::Error| BridgeError::Emulator(format!("cannot connect to QEMU's serial line: {error}"));
    let peer = {
        let free = std::net::TcpListener::bind(("127.0.0.1", 0)).map_err(failed)?;
        free.local_addr().map_err(failed)?
    };
    let line = format!("tcp:127.0.0.1:{},server=on,wait=off,nodelay=on", peer.port());
    let mut process = emulator.start(["-serial", &line, "-nic", "none"], &[], Stdio::null())?;
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
