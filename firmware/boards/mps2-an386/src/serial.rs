//! The serial link: frames over UART0, stuffed and ended by a zero byte.

use crate::pac::block;
use crate::registers::Registers;
use crate::uart::Uart;
use heapless::Deque;
use pliant_protocol::serial::stuff;
use pliant_protocol::{Collector, FRAME_MAX, SERIAL_MAX};

/// Room for frames that wait for the line: as many as one request can cause, and more.
const QUEUE: usize = 4 * SERIAL_MAX;

/// The serial link.
pub struct Serial {
    uart: Uart,
    collector: Collector,
    queue: Deque<u8, QUEUE>,
    overruns: u32,
    dropped: u32,
}

impl Serial {
    /// Starts the link on a UART.
    pub fn start(registers: Registers<block::Uart>) -> Self {
        Self { uart: Uart::start(registers), collector: Collector::new(), queue: Deque::new(), overruns: 0, dropped: 0 }
    }

    /// Takes the bytes that came, up to the end of a frame, and gives the frame.
    pub fn receive<'a>(&mut self, room: &'a mut [u8; FRAME_MAX]) -> Option<&'a [u8]> {
        self.overruns = self.overruns.saturating_add(self.uart.overran().into());
        while let Some(byte) = self.uart.take() {
            if let Some(frame) = self.collector.push(byte) {
                let room = room.get_mut(..frame.len())?;
                room.copy_from_slice(frame);
                return Some(room);
            }
        }
        None
    }

    /// Whether nothing waits to be sent.
    pub fn idle(&self) -> bool {
        self.queue.is_empty()
    }

    /// Queues a frame and begins to send. A frame that does not fit whole is dropped whole, and counted.
    pub fn send(&mut self, frame: &[u8]) {
        let mut room = [0; SERIAL_MAX];
        match stuff(frame, &mut room) {
            Ok(line) if line.len() <= self.queue.capacity() - self.queue.len() => {
                self.queue.extend(line.iter().copied());
                self.pump();
            }
            _ => self.dropped = self.dropped.saturating_add(1),
        }
    }

    /// Answers the interrupt of a byte sent.
    pub fn sent(&mut self) {
        self.uart.acknowledge_sent();
        self.pump();
    }

    /// Bytes lost because they were not taken in time, and frames longer than any.
    pub fn overruns(&self) -> u32 {
        self.overruns.saturating_add(self.collector.overruns())
    }

    /// Frames whose stuffing was damaged on the way.
    pub fn malformed(&self) -> u32 {
        self.collector.malformed()
    }

    /// Frames that were never sent because the queue was full.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }

    /// Gives the UART what it takes: a byte on hardware, all there is in QEMU.
    fn pump(&mut self) {
        while self.uart.has_room() {
            let Some(byte) = self.queue.pop_front() else { return };
            self.uart.put(byte);
        }
    }
}
