//! The last frame of a device that failed: zero velocity, stopped by a fault.
//!
//! It is made when nothing can be relied on - any task may have been interrupted anywhere - so it uses neither smoltcp
//! nor the link's queues. All it needs is noted with each frame sent: over which link it went, its number, and for UDP
//! its headers, which a second datagram to the same peer shares but for lengths and checksums.

use crate::clock;
use crate::lan9118::{Chip, HEADERS};
use crate::net;
use crate::pac::Peripherals;
use crate::uart::Uart;
use core::cell::Cell;
use critical_section::Mutex;
use pliant_protocol::message::{Mode, Region, StopReason, ToHost};
use pliant_protocol::serial::stuff;
use pliant_protocol::{FRAME_MAX, SERIAL_MAX, encode};
use smoltcp::wire::{EthernetFrame, EthernetProtocol, IpProtocol, Ipv4Packet, UdpPacket};

const ETHERNET: usize = 14;
const IPV4: usize = 20;
const UDP: usize = 8;

/// How the last frame reached the host.
#[derive(Clone, Copy)]
pub enum Route {
    /// By the serial line.
    Serial,
    /// In a datagram with these headers.
    Udp([u8; HEADERS]),
}

static LAST: Mutex<Cell<Option<(Route, u16)>>> = Mutex::new(Cell::new(None));

/// Notes that a frame went this way.
pub fn note(route: Route, frame: &[u8]) {
    // As `pliant_protocol::frame` has it: the version, then the number.
    let sequence = match frame {
        [_, low, high, ..] => u16::from_le_bytes([*low, *high]),
        _ => 0,
    };
    critical_section::with(|cs| LAST.borrow(cs).set(Some((route, sequence))));
}

/// Sends the last frame, if any was sent before. Interrupts must be off for good.
pub(crate) fn say(peripherals: Peripherals) {
    let Some((route, sequence)) = critical_section::with(|cs| LAST.borrow(cs).get()) else { return };
    let stop = ToHost::Command {
        // Never behind the last: a tick takes a millisecond or more.
        tick: u32::try_from(clock::micros() / 1000).unwrap_or(u32::MAX),
        state: 0,
        revision: 0,
        velocity: [0.0; 3],
        gamma: f32::INFINITY,
        nearest: None,
        region: Region::Free,
        status: 0,
        mode: Mode::Stopped(StopReason::Fault),
    };
    let mut room = [0; FRAME_MAX];
    let Ok(frame) = encode(sequence.wrapping_add(1), &stop, &mut room) else { return };
    match route {
        Route::Serial => {
            let mut uart = Uart::resume(peripherals.uart0);
            let mut room = [0; SERIAL_MAX];
            let Ok(line) = stuff(frame, &mut room) else { return };
            // Ends a frame that was under way.
            uart.send_waiting(&[0]);
            uart.send_waiting(line);
        }
        Route::Udp(headers) => {
            let mut room = [0; HEADERS + FRAME_MAX];
            if let Some(datagram) = datagram(&headers, frame, &mut room) {
                Chip::seize(peripherals.ethernet).send(datagram);
            }
        }
    }
}

/// A datagram with the addresses and ports of `headers` and another payload.
fn datagram<'a>(headers: &[u8; HEADERS], payload: &[u8], room: &'a mut [u8; HEADERS + FRAME_MAX]) -> Option<&'a [u8]> {
    const { assert!(HEADERS == ETHERNET + IPV4 + UDP) };
    let all = room.get_mut(..HEADERS + payload.len())?;
    let (head, body) = all.split_at_mut_checked(HEADERS)?;
    head.copy_from_slice(headers);
    body.copy_from_slice(payload);

    let mut frame = EthernetFrame::new_checked(&mut *all).ok()?;
    if frame.ethertype() != EthernetProtocol::Ipv4 {
        return None;
    }
    let mut ip = Ipv4Packet::new_unchecked(frame.payload_mut());
    if usize::from(ip.header_len()) != IPV4 || ip.next_header() != IpProtocol::Udp {
        return None;
    }
    ip.set_total_len(u16::try_from(IPV4 + UDP + payload.len()).ok()?);
    ip.fill_checksum();
    let (from, to) = (ip.src_addr().into(), ip.dst_addr().into());
    let mut udp = UdpPacket::new_unchecked(ip.payload_mut());
    if udp.src_port() != net::PORT {
        return None;
    }
    udp.set_len(u16::try_from(UDP + payload.len()).ok()?);
    udp.fill_checksum(&from, &to);
    Some(all)
}
