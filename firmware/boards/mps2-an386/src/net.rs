//! The UDP link: one frame a datagram, on port 9000.
//!
//! The address is fixed, 10.0.2.15/24 behind the gateway 10.0.2.2: what QEMU's user network gives its guest
//! (`-nic user,model=lan9118,hostfwd=udp:127.0.0.1:PORT-:9000`; with `restrict=on` it drops what the guest sends).
//!
//! Work is bounded: a call of [`poll`](Net::poll) takes [`BURST`] frames, so that commands leave between two calls; and
//! a tick takes [`BUDGET`], after which the chip's interrupt is masked until [`replenish`](Net::replenish), so that a
//! flood does not take the whole processor.

use crate::clock;
use crate::lan9118::{self, Buffers, Chip, HEADERS, Lan9118};
use crate::pac::block;
use crate::registers::Registers;
use pliant_protocol::FRAME_MAX;
use smoltcp::iface::{Config, Interface, SocketHandle, SocketSet, SocketStorage};
use smoltcp::socket::udp::{PacketBuffer, PacketMetadata, RecvError, Socket};
use smoltcp::time::Instant;
use smoltcp::wire::{EthernetAddress, IpAddress, IpCidr, IpEndpoint, Ipv4Address};

/// Locally administered, so nobody else's.
const MAC: EthernetAddress = EthernetAddress([0x02, b'p', b'l', b'i', b'a', b'n']);
const ADDRESS: IpCidr = IpCidr::new(IpAddress::v4(10, 0, 2, 15), 24);
const GATEWAY: Ipv4Address = Ipv4Address::new(10, 0, 2, 2);
/// The port that the device listens on.
pub const PORT: u16 = 9000;
/// Frames received in one call, of whatever kind.
pub const BURST: usize = 8;
/// Frames received in one tick: about as many small ones as the chip holds.
pub const BUDGET: u32 = 64;
/// Datagrams that wait, each way: what one call brings, with its answers.
const QUEUE: usize = BURST;

/// Why there is no network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum Error {
    /// The chip did not start.
    Chip(lan9118::Error),
    /// smoltcp was built with room for no address or no route.
    NoRoom,
    /// The port is not to be had.
    Port,
}

/// The memory that the link needs for bytes. Apart from [`Slots`], for it starts as zeros and so takes no flash.
pub struct Bytes {
    buffers: Buffers,
    received: [u8; QUEUE * FRAME_MAX],
    sent: [u8; QUEUE * FRAME_MAX],
}

/// The memory that the link needs for everything else.
pub struct Slots {
    sockets: [SocketStorage<'static>; 1],
    received: [PacketMetadata; QUEUE],
    sent: [PacketMetadata; QUEUE],
}

impl Bytes {
    /// Empty memory.
    pub const fn new() -> Self {
        Self { buffers: Buffers::new(), received: [0; QUEUE * FRAME_MAX], sent: [0; QUEUE * FRAME_MAX] }
    }
}

impl Slots {
    /// Empty memory.
    pub const fn new() -> Self {
        Self {
            sockets: [SocketStorage::EMPTY],
            received: [PacketMetadata::EMPTY; QUEUE],
            sent: [PacketMetadata::EMPTY; QUEUE],
        }
    }
}

impl Default for Bytes {
    fn default() -> Self {
        Self::new()
    }
}

impl Default for Slots {
    fn default() -> Self {
        Self::new()
    }
}

/// The UDP link.
pub struct Net {
    nic: Lan9118,
    interface: Interface,
    sockets: SocketSet<'static>,
    socket: SocketHandle,
    /// Frames that may still be received before the next tick.
    budget: u32,
    overruns: u32,
    dropped: u32,
}

impl Net {
    /// Starts the chip and listens.
    ///
    /// # Errors
    ///
    /// See [`Error`]. The device is then without a network, and the serial link is unharmed.
    pub fn start(
        registers: Registers<block::Ethernet>,
        bytes: &'static mut Bytes,
        slots: &'static mut Slots,
    ) -> Result<Self, Error> {
        let chip = Chip::start(registers, MAC.0).map_err(Error::Chip)?;
        let mut nic = Lan9118::new(chip, &mut bytes.buffers);
        let mut interface = Interface::new(Config::new(MAC.into()), &mut nic, now());
        let mut added = Ok(());
        interface.update_ip_addrs(|addresses| added = addresses.push(ADDRESS));
        added.map_err(|_| Error::NoRoom)?;
        interface.routes_mut().add_default_ipv4_route(GATEWAY).map_err(|_| Error::NoRoom)?;
        let mut socket = Socket::new(
            PacketBuffer::new(&mut slots.received[..], &mut bytes.received[..]),
            PacketBuffer::new(&mut slots.sent[..], &mut bytes.sent[..]),
        );
        socket.bind(PORT).map_err(|_| Error::Port)?;
        let mut sockets = SocketSet::new(&mut slots.sockets[..]);
        let socket = sockets.add(socket);
        nic.chip().listen(true);
        Ok(Self { nic, interface, sockets, socket, budget: BUDGET, overruns: 0, dropped: 0 })
    }

    /// Answers the chip's interrupt: moves frames from the chip to the socket and lets smoltcp answer those that are
    /// not ours. True where frames are left that this tick has a budget for: call it again, but let others go first.
    #[must_use]
    pub fn poll(&mut self) -> bool {
        self.nic.chip().acknowledge();
        for _ in 0..BURST {
            if self.budget == 0 || !self.nic.chip().has_frame() {
                break;
            }
            self.budget -= 1;
            self.interface.poll_ingress_single(now(), &mut self.nic, &mut self.sockets);
        }
        // A datagram may have waited for the answer to an address request.
        self.flush();
        if self.budget == 0 {
            self.nic.chip().listen(false);
            return false;
        }
        self.nic.chip().has_frame()
    }

    /// Gives the link a new budget, once a tick. True where frames waited for it: [`poll`](Self::poll) must be called.
    #[must_use]
    pub fn replenish(&mut self) -> bool {
        let exhausted = self.budget == 0;
        self.budget = BUDGET;
        if exhausted {
            self.nic.chip().listen(true);
        }
        exhausted && self.nic.chip().has_frame()
    }

    /// The next datagram, and who sent it. One too long for a frame is passed over and counted.
    pub fn receive<'a>(&mut self, room: &'a mut [u8; FRAME_MAX]) -> Option<(&'a [u8], IpEndpoint)> {
        let socket = self.sockets.get_mut::<Socket>(self.socket);
        loop {
            match socket.recv_slice(room) {
                Ok((length, from)) => return Some((room.get(..length)?, from.endpoint)),
                Err(RecvError::Truncated) => self.overruns = self.overruns.saturating_add(1),
                Err(RecvError::Exhausted) => return None,
            }
        }
    }

    /// Sends a datagram. Where too many wait already it is dropped, and counted.
    ///
    /// Gives the headers it went with, or none where it still waits for the address of the next hop.
    pub fn send(&mut self, frame: &[u8], to: IpEndpoint) -> Option<&[u8; HEADERS]> {
        let socket = self.sockets.get_mut::<Socket>(self.socket);
        let taken = socket.send_slice(frame, to).is_ok();
        self.dropped = self.dropped.saturating_add(u32::from(!taken));
        self.flush();
        (taken && self.idle()).then_some(self.nic.sent())
    }

    /// Whether nothing waits to be sent. While the address of the next hop is being asked for, something does.
    pub fn idle(&self) -> bool {
        self.sockets.get::<Socket>(self.socket).send_queue() == 0
    }

    /// Datagrams too long for a frame, and Ethernet frames damaged or too long.
    pub fn overruns(&self) -> u32 {
        self.overruns.saturating_add(self.nic.dropped())
    }

    /// Datagrams that were never sent because too many waited.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }

    /// Sends what waits, one datagram a round and no more than the queue holds.
    fn flush(&mut self) {
        for _ in 0..QUEUE {
            if self.idle() {
                return;
            }
            self.interface.poll_egress(now(), &mut self.nic, &mut self.sockets);
        }
    }
}

fn now() -> Instant {
    Instant::from_micros(clock::micros().cast_signed())
}
