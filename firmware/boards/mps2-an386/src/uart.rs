//! The CMSDK APB UART (DDI0479, chapter 4.3; QEMU `hw/char/cmsdk-apb-uart.c`): 8N1, a register each way and no FIFO.
//!
//! A received byte must be taken before the next one is complete, or that one is lost. At [`BAUD`] this is 87 us, so
//! on hardware a tick must not take longer; QEMU waits with the next byte until the last one is taken, and sends a byte
//! in no time at all.

use crate::CLOCK_HZ;
use crate::pac::block;
use crate::registers::Registers;

const DATA: usize = 0x00;
const STATE: usize = 0x04;
const CTRL: usize = 0x08;
/// Interrupt status when read, interrupt clear when written.
const INTERRUPT: usize = 0x0c;
const BAUD_DIVIDER: usize = 0x10;

const STATE_TX_FULL: u32 = 1 << 0;
const STATE_RX_FULL: u32 = 1 << 1;
const STATE_RX_OVERRUN: u32 = 1 << 3;
const CTRL_TX: u32 = 1 << 0;
const CTRL_RX: u32 = 1 << 1;
const CTRL_TX_INTERRUPT: u32 = 1 << 2;
const CTRL_RX_INTERRUPT: u32 = 1 << 3;
const INTERRUPT_TX: u32 = 1 << 0;
const INTERRUPT_RX: u32 = 1 << 1;
const INTERRUPT_ALL: u32 = 0xf;

/// Speed of both UARTs, in baud.
pub const BAUD: u32 = 115_200;
const DIVIDER: u32 = CLOCK_HZ / BAUD;
/// The UART takes no smaller divider.
const DIVIDER_MIN: u32 = 16;
const _: () = assert!(DIVIDER >= DIVIDER_MIN);

/// How often a byte is tried before it is given up: more than ten byte times on hardware.
const PATIENCE: u32 = 10_000;

/// A UART, both ways.
pub struct Uart(Registers<block::Uart>);

impl Uart {
    /// Starts both directions, with an interrupt for each byte received and each byte sent.
    pub fn start(registers: Registers<block::Uart>) -> Self {
        Self::start_with(registers, CTRL_TX | CTRL_RX | CTRL_TX_INTERRUPT | CTRL_RX_INTERRUPT)
    }

    /// Starts sending only, with an interrupt for each byte sent.
    pub fn start_sender(registers: Registers<block::Uart>) -> Self {
        Self::start_with(registers, CTRL_TX | CTRL_TX_INTERRUPT)
    }

    fn start_with(mut registers: Registers<block::Uart>, control: u32) -> Self {
        registers.write::<BAUD_DIVIDER>(DIVIDER);
        registers.write::<INTERRUPT>(INTERRUPT_ALL);
        registers.write::<CTRL>(control);
        Self(registers)
    }

    /// Takes over a UART that was started, without disturbing it.
    pub fn resume(registers: Registers<block::Uart>) -> Self {
        Self(registers)
    }

    /// Takes the byte received, if there is one, and acknowledges its interrupt.
    pub fn take(&mut self) -> Option<u8> {
        // Acknowledged first: a byte that comes after the read raises the interrupt again.
        self.0.write::<INTERRUPT>(INTERRUPT_RX);
        let full = self.0.read::<STATE>() & STATE_RX_FULL != 0;
        full.then(|| self.0.read::<DATA>().to_le_bytes()[0])
    }

    /// Whether a byte was lost since this was asked last.
    pub fn overran(&mut self) -> bool {
        let lost = self.0.read::<STATE>() & STATE_RX_OVERRUN != 0;
        if lost {
            self.0.write::<STATE>(STATE_RX_OVERRUN);
        }
        lost
    }

    /// Whether [`put`](Self::put) may be called.
    pub fn has_room(&self) -> bool {
        self.0.read::<STATE>() & STATE_TX_FULL == 0
    }

    /// Sends a byte. Without room it takes the place of the last one.
    pub fn put(&mut self, byte: u8) {
        self.0.write::<DATA>(byte.into());
    }

    /// Acknowledges the interrupt of a byte sent.
    pub fn acknowledge_sent(&mut self) {
        self.0.write::<INTERRUPT>(INTERRUPT_TX);
    }

    /// Sends bytes and waits for each; gives up where the line does not move. For faults only.
    pub fn send_waiting(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            if !(0..PATIENCE).any(|_| self.has_room()) {
                return;
            }
            self.put(byte);
        }
    }
}
