//! How frames get to a device and back.

use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use pliant_protocol::serial::{Collector, stuff};
use pliant_protocol::{FRAME_MAX, SERIAL_MAX};

/// A way to a device that carries whole frames, and may lose some.
pub trait Link: Send {
    /// Sends one frame.
    ///
    /// # Errors
    /// The link is broken.
    fn send(&mut self, frame: &[u8]) -> io::Result<()>;

    /// The next frame, or `None` if none came within `timeout`; zero takes only what is there already.
    ///
    /// # Errors
    /// The link is broken.
    fn receive(&mut self, timeout: Duration) -> io::Result<Option<Vec<u8>>>;
}

/// A frame a datagram.
#[derive(Debug)]
pub struct Udp {
    socket: UdpSocket,
    timeout: Option<Duration>,
}

impl Udp {
    /// A socket to `peer`.
    ///
    /// # Errors
    /// No socket to be had.
    pub fn to(peer: SocketAddr) -> io::Result<Self> {
        let any: SocketAddr = if peer.is_ipv4() { ([0, 0, 0, 0], 0).into() } else { ([0u16; 8], 0).into() };
        let socket = UdpSocket::bind(any)?;
        socket.connect(peer)?;
        Ok(Self { socket, timeout: None })
    }
}

impl Link for Udp {
    fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        match self.socket.send(frame) {
            // Nobody listened when the last datagram came there; somebody may by now.
            Err(e) if e.kind() == io::ErrorKind::ConnectionRefused => Ok(()),
            other => other.map(drop),
        }
    }

    fn receive(&mut self, timeout: Duration) -> io::Result<Option<Vec<u8>>> {
        if self.timeout != Some(timeout) {
            self.socket.set_nonblocking(timeout.is_zero())?;
            if !timeout.is_zero() {
                self.socket.set_read_timeout(Some(timeout))?;
            }
            self.timeout = Some(timeout);
        }
        let mut room = [0; 2 * FRAME_MAX];
        match self.socket.recv(&mut room) {
            Ok(n) => Ok(Some(room[..n].to_vec())),
            Err(e) if is_pause(&e) || e.kind() == io::ErrorKind::ConnectionRefused => {
                // A refusal comes at once: wait here, or a caller that retries would spin.
                if e.kind() == io::ErrorKind::ConnectionRefused {
                    std::thread::sleep(timeout.min(Duration::from_millis(50)));
                }
                Ok(None)
            }
            Err(e) => Err(e),
        }
    }
}

/// Bytes one after the other, as a serial line has them.
pub trait ByteStream: Send {
    /// Some bytes, or 0 if none came within `timeout`.
    ///
    /// # Errors
    /// The other end is gone.
    fn read(&mut self, bytes: &mut [u8], timeout: Duration) -> io::Result<usize>;
    /// Writes all bytes.
    ///
    /// # Errors
    /// The other end is gone, or takes nothing.
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()>;
}

/// Frames over a byte stream, COBS-stuffed and ended by a zero.
pub struct Serial<S> {
    stream: S,
    collector: Box<Collector>,
    /// Read, not yet looked at.
    pending: std::collections::VecDeque<u8>,
}

impl<S: ByteStream> Serial<S> {
    /// Frames over `stream`.
    pub fn over(stream: S) -> Self {
        Self { stream, collector: Box::default(), pending: std::collections::VecDeque::new() }
    }
}

impl<S: ByteStream> Link for Serial<S> {
    fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        let mut room = [0; SERIAL_MAX];
        let line = stuff(frame, &mut room).map_err(|e| io::Error::new(io::ErrorKind::InvalidInput, e))?;
        self.stream.write_all(line)
    }

    fn receive(&mut self, timeout: Duration) -> io::Result<Option<Vec<u8>>> {
        let deadline = Instant::now() + timeout;
        loop {
            while let Some(byte) = self.pending.pop_front() {
                if let Some(frame) = self.collector.push(byte) {
                    return Ok(Some(frame.to_vec()));
                }
            }
            let mut room = [0; 1024];
            let left = deadline.saturating_duration_since(Instant::now());
            match self.stream.read(&mut room, left)? {
                0 if Instant::now() >= deadline => return Ok(None),
                n => self.pending.extend(&room[..n]),
            }
        }
    }
}

impl ByteStream for serial2::SerialPort {
    fn read(&mut self, bytes: &mut [u8], timeout: Duration) -> io::Result<usize> {
        // Counted in whole milliseconds; zero does not wait.
        self.set_read_timeout(if timeout.is_zero() { timeout } else { timeout.max(Duration::from_millis(1)) })?;
        match serial2::SerialPort::read(self, bytes) {
            Ok(0) => Err(io::Error::new(io::ErrorKind::BrokenPipe, "the serial port was closed")),
            Err(e) if is_pause(&e) => Ok(0),
            other => other,
        }
    }
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        serial2::SerialPort::write_all(self, bytes)
    }
}

impl ByteStream for std::net::TcpStream {
    fn read(&mut self, bytes: &mut [u8], timeout: Duration) -> io::Result<usize> {
        self.set_nonblocking(timeout.is_zero())?;
        if !timeout.is_zero() {
            self.set_read_timeout(Some(timeout))?;
        }
        match io::Read::read(self, bytes) {
            Ok(0) => Err(io::Error::new(io::ErrorKind::BrokenPipe, "the other end closed the connection")),
            Err(e) if is_pause(&e) => Ok(0),
            other => other,
        }
    }
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.set_nonblocking(false)?;
        io::Write::write_all(self, bytes)
    }
}

fn is_pause(e: &io::Error) -> bool {
    matches!(e.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted)
}
