//! Both links, and the half of the application that faces them.
//!
//! Requests are answered where they came from. Commands go to the desk's host; a stray datagram does not take them away.

use crate::farewell::{self, Route};
use crate::net::Net;
use crate::serial::Serial;
use pliant_firmware::{Control, Desk, Gauges, Identity, Locked};
use pliant_protocol::{FRAME_MAX, ToHost};
use smoltcp::wire::IpEndpoint;

/// Who is at the other end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Peer {
    /// Whoever is on the serial line.
    Serial,
    /// Whoever sends from this address.
    Udp(IpEndpoint),
}

/// The links.
pub struct Links {
    desk: Desk<Peer>,
    /// None where the Ethernet controller did not start.
    net: Option<Net>,
    serial: Serial,
    /// Frames dropped for want of room to send them, as far as it was logged.
    dropped: u32,
}

/// Gives the desk a control half that an RTIC lock guards.
pub struct Lock<M>(pub M);

impl<M: rtic::Mutex<T = Control>> Locked for Lock<M> {
    fn with<R>(&mut self, work: impl FnOnce(&mut Control) -> R) -> R {
        self.0.lock(work)
    }
}

impl Links {
    /// Links that have heard nothing yet.
    pub fn new(identity: Identity, net: Option<Net>, serial: Serial) -> Self {
        Self { desk: Desk::new(identity), net, serial, dropped: 0 }
    }

    /// Answers the Ethernet controller's interrupt. True where it must be called again, after others had their turn.
    #[must_use]
    pub fn ethernet(&mut self, control: &mut impl Locked) -> bool {
        let more = self.net.as_mut().is_some_and(Net::poll);
        let mut room = [0; FRAME_MAX];
        while let Some((frame, from)) = self.net.as_mut().and_then(|net| net.receive(&mut room)) {
            self.answer(frame, Peer::Udp(from), control);
        }
        more
    }

    /// Answers the interrupt of a byte received.
    pub fn uart_received(&mut self, control: &mut impl Locked) {
        let mut room = [0; FRAME_MAX];
        while let Some(frame) = self.serial.receive(&mut room) {
            self.answer(frame, Peer::Serial, control);
        }
    }

    /// Answers the interrupt of a byte sent.
    pub fn uart_sent(&mut self) {
        self.serial.sent();
    }

    /// What there is to do after a tick: sends its command, if it has one, and lets the network take frames again. True
    /// where [`ethernet`](Self::ethernet) must be called.
    #[must_use]
    pub fn tick(&mut self, command: Option<&ToHost>, gauges: Gauges) -> bool {
        let overruns = self.serial.overruns().saturating_add(self.net.as_ref().map_or(0, Net::overruns));
        self.desk.gauges = Gauges { overruns, damaged: self.serial.malformed(), ..gauges };
        let dropped = self.serial.dropped().saturating_add(self.net.as_ref().map_or(0, Net::dropped));
        if dropped != self.dropped {
            self.dropped = dropped;
            defmt::warn!("{=u32} frames dropped: the link is too slow for them", dropped);
        }
        // A command that would have to wait for the link is left out: the next one is newer.
        if let (Some(command), Some(host)) = (command, self.desk.host())
            && self.idle(host)
        {
            self.send(command, host);
        }
        self.net.as_mut().is_some_and(Net::replenish)
    }

    fn idle(&self, peer: Peer) -> bool {
        match peer {
            Peer::Serial => self.serial.idle(),
            Peer::Udp(_) => self.net.as_ref().is_some_and(Net::idle),
        }
    }

    fn answer(&mut self, frame: &[u8], from: Peer, control: &mut impl Locked) {
        let Some(answer) = self.desk.receive(from, frame, control) else { return };
        self.send(&answer, from);
    }

    fn send(&mut self, message: &ToHost, to: Peer) {
        let mut room = [0; FRAME_MAX];
        let Some(frame) = self.desk.frame(message, &mut room) else { return };
        let route = match to {
            Peer::Serial => {
                self.serial.send(frame);
                Some(Route::Serial)
            }
            Peer::Udp(to) => self.net.as_mut().and_then(|net| net.send(frame, to)).map(|headers| Route::Udp(*headers)),
        };
        // Only the host that is commanded must learn of a fault.
        if let (Some(route), true) = (route, self.desk.host() == Some(to)) {
            farewell::note(route, frame);
        }
    }
}
