//! The virtual device: the firmware's application in a thread, behind the same bytes as a real one.

use std::io;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use pliant_firmware::{Device, Identity, TICK_HZ};
use pliant_protocol::FRAME_MAX;

use crate::bridge::link::Link;

/// Our end of the line; the device ends when it is dropped.
pub struct VirtualLink {
    to: Option<Sender<Vec<u8>>>,
    from: Receiver<Vec<u8>>,
    thread: Option<JoinHandle<()>>,
}

/// Starts a device.
pub fn start() -> io::Result<VirtualLink> {
    let (to, inbox) = channel();
    let (outbox, from) = channel();
    let thread = Builder::new().name("virtual device".into()).spawn(move || live(&inbox, &outbox))?;
    Ok(VirtualLink { to: Some(to), from, thread: Some(thread) })
}

fn live(inbox: &Receiver<Vec<u8>>, outbox: &Sender<Vec<u8>>) {
    let version = [env!("CARGO_PKG_VERSION_MAJOR"), env!("CARGO_PKG_VERSION_MINOR"), env!("CARGO_PKG_VERSION_PATCH")];
    let mut device = Device::new(Identity { board: "virtual", firmware: version.map(|v| v.parse().unwrap_or(0)) });
    let period = Duration::from_secs(1) / u32::from(TICK_HZ);
    let mut next = Instant::now() + period;
    let mut room = [0; FRAME_MAX];
    loop {
        let now = Instant::now();
        if now >= next {
            let overdue = now.duration_since(next).as_nanos() / period.as_nanos();
            let overdue = u32::try_from(overdue).unwrap_or(u32::MAX);
            next += period * (overdue + 1);
            if let Some(frame) = device.tick(overdue, &mut room)
                && outbox.send(frame.to_vec()).is_err()
            {
                return;
            }
        }
        match inbox.recv_timeout(next.saturating_duration_since(Instant::now())) {
            Ok(frame) => {
                if let Some(answer) = device.receive(&frame, &mut room)
                    && outbox.send(answer.to_vec()).is_err()
                {
                    return;
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

impl Link for VirtualLink {
    fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        let gone = || io::Error::new(io::ErrorKind::BrokenPipe, "the virtual device has ended");
        self.to.as_ref().ok_or_else(gone)?.send(frame.to_vec()).map_err(|_| gone())
    }

    fn receive(&mut self, timeout: Duration) -> io::Result<Option<Vec<u8>>> {
        match self.from.recv_timeout(timeout) {
            Ok(frame) => Ok(Some(frame)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => {
                Err(io::Error::new(io::ErrorKind::BrokenPipe, "the virtual device has ended"))
            }
        }
    }
}

impl Drop for VirtualLink {
    fn drop(&mut self) {
        self.to = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
