//! SMSC LAN9118 (data sheet DS00002266; QEMU `hw/net/lan9118.c`): an Ethernet MAC and PHY with packet FIFOs, as a
//! smoltcp device.
//!
//! The board itself has a LAN9220, which is the same to software. Frames are copied by the core, a word at a time. The
//! PHY is left to negotiate by itself, and full duplex is taken for granted.

use crate::pac::block;
use crate::registers::Registers;
use smoltcp::phy::{self, DeviceCapabilities, Medium};
use smoltcp::time::Instant;

const RX_DATA: usize = 0x00;
const TX_DATA: usize = 0x20;
const RX_STATUS: usize = 0x40;
const TX_STATUS: usize = 0x48;
const IRQ_CFG: usize = 0x54;
const INT_STS: usize = 0x58;
const INT_EN: usize = 0x5c;
const BYTE_TEST: usize = 0x64;
const FIFO_INT: usize = 0x68;
const RX_CFG: usize = 0x6c;
const TX_CFG: usize = 0x70;
const HW_CFG: usize = 0x74;
const RX_FIFO_INF: usize = 0x7c;
const TX_FIFO_INF: usize = 0x80;
const MAC_CSR_CMD: usize = 0xa4;
const MAC_CSR_DATA: usize = 0xa8;

/// What BYTE_TEST reads where the chip is there and its bytes are in order.
const BYTE_ORDER: u32 = 0x8765_4321;
/// The interrupt line: driven both ways, active high, on.
const IRQ_CFG_ON: u32 = 1 << 8 | 1 << 4 | 1 << 0;
/// The receive status FIFO is above its level.
const INT_RSFL: u32 = 1 << 3;
/// A receive status level of 0: any frame is above it. The transmit levels stay out of reach.
const FIFO_INT_ANY_FRAME: u32 = 0xff << 24;
const TX_CFG_STOP: u32 = 1 << 2;
const TX_CFG_ON: u32 = 1 << 1;
const TX_CFG_DUMP: u32 = 1 << 15 | 1 << 14;
const HW_CFG_RESET: u32 = 1 << 0;
/// A bit that must be one, and 5 KiB of transmit FIFO.
const HW_CFG_FIFO: u32 = 1 << 20 | 5 << 16;
const MAC_CSR_BUSY: u32 = 1 << 31;
const MAC_CSR_READ: u32 = 1 << 30;

/// Registers of the MAC, reached through MAC_CSR_CMD.
const MAC_CR: u32 = 1;
const MAC_ADDRH: u32 = 2;
const MAC_ADDRL: u32 = 3;
const MAC_CR_RECEIVE: u32 = 1 << 2;
const MAC_CR_TRANSMIT: u32 = 1 << 3;
const MAC_CR_PROMISCUOUS: u32 = 1 << 18;
const MAC_CR_FULL_DUPLEX: u32 = 1 << 20;

/// The frame has an error that makes it useless.
const RX_STATUS_ERROR: u32 = 1 << 15;
/// The buffer is the first and the last of its frame.
const TX_COMMAND_WHOLE: u32 = 1 << 13 | 1 << 12;

/// Longest frame without its check sequence.
pub const FRAME_MAX: usize = 1514;
/// The check sequence behind a received frame.
const FCS: usize = 4;
/// Reads of a register before a command of the chip is given up.
const PATIENCE: u32 = 100_000;
/// Length of the Ethernet, IPv4 and UDP headers together.
pub const HEADERS: usize = 14 + 20 + 8;

/// Why the chip could not be started.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum Error {
    /// There is no such chip at the address.
    NotFound {
        /// What BYTE_TEST read.
        byte_test: u32,
    },
    /// The chip did not end a command in time.
    Timeout,
}

/// The chip without buffers.
pub struct Chip(Registers<block::Ethernet>);

impl Chip {
    /// Resets the chip and starts both directions with an address. The interrupt is still masked.
    ///
    /// # Errors
    ///
    /// [`Error::NotFound`] where something else answers, [`Error::Timeout`] where it does not come out of reset.
    pub fn start(registers: Registers<block::Ethernet>, address: [u8; 6]) -> Result<Self, Error> {
        let mut chip = Self(registers);
        let byte_test = chip.0.read::<BYTE_TEST>();
        if byte_test != BYTE_ORDER {
            return Err(Error::NotFound { byte_test });
        }
        chip.0.write::<HW_CFG>(HW_CFG_RESET);
        chip.wait::<HW_CFG>(HW_CFG_RESET)?;
        chip.0.write::<HW_CFG>(HW_CFG_FIFO);
        chip.0.write::<INT_EN>(0);
        chip.0.write::<INT_STS>(u32::MAX);
        chip.0.write::<IRQ_CFG>(IRQ_CFG_ON);
        chip.0.write::<FIFO_INT>(FIFO_INT_ANY_FRAME);
        chip.0.write::<RX_CFG>(0);
        chip.0.write::<TX_CFG>(TX_CFG_ON);
        let [a, b, c, d, e, f] = address;
        chip.write_mac(MAC_ADDRL, u32::from_le_bytes([a, b, c, d]))?;
        chip.write_mac(MAC_ADDRH, u32::from_le_bytes([e, f, 0, 0]))?;
        let control = chip.read_mac(MAC_CR)? & !MAC_CR_PROMISCUOUS;
        chip.write_mac(MAC_CR, control | MAC_CR_RECEIVE | MAC_CR_TRANSMIT | MAC_CR_FULL_DUPLEX)?;
        Ok(chip)
    }

    /// Takes over a chip that was started and may have been interrupted anywhere: a frame half sent is dropped, and
    /// no interrupt comes any more.
    pub fn seize(registers: Registers<block::Ethernet>) -> Self {
        let mut chip = Self(registers);
        chip.0.write::<INT_EN>(0);
        chip.0.write::<TX_CFG>(TX_CFG_STOP);
        // Where it does not stop in time, the dump still leaves it able to take another frame.
        let _late = chip.wait::<TX_CFG>(TX_CFG_ON);
        chip.0.write::<TX_CFG>(TX_CFG_DUMP);
        chip.0.write::<TX_CFG>(TX_CFG_ON);
        chip
    }

    /// Lets a received frame raise the interrupt, or not.
    pub fn listen(&mut self, on: bool) {
        self.0.write::<INT_EN>(if on { INT_RSFL } else { 0 });
    }

    /// Acknowledges the interrupt. QEMU raises it again with the next frame only, so frames that are left must be
    /// remembered: [`has_frame`](Self::has_frame).
    pub fn acknowledge(&mut self) {
        self.0.write::<INT_STS>(INT_RSFL);
    }

    /// Whether a received frame waits.
    pub fn has_frame(&self) -> bool {
        self.frames() != 0
    }

    /// Whether the chip takes another frame of any length.
    pub fn has_room(&mut self) -> bool {
        // Each frame sent leaves a status, which nobody needs and which would fill its FIFO.
        for _ in 0..self.0.read::<TX_FIFO_INF>() >> 16 & 0xff {
            self.0.read::<TX_STATUS>();
        }
        // Behind the two command words.
        self.0.read::<TX_FIFO_INF>() & 0xffff >= FRAME_MAX as u32 + 8
    }

    /// Sends a frame, to which the chip adds the check sequence. There must be room.
    pub fn send(&mut self, frame: &[u8]) {
        // At most FRAME_MAX by the callers; the command has eleven bits for it.
        let length = frame.len() as u32 & 0x7ff;
        self.0.write::<TX_DATA>(TX_COMMAND_WHOLE | length);
        self.0.write::<TX_DATA>(length << 16 | length);
        for bytes in frame.chunks(4) {
            let mut word = [0; 4];
            for (to, from) in word.iter_mut().zip(bytes) {
                *to = *from;
            }
            self.0.write::<TX_DATA>(u32::from_le_bytes(word));
        }
    }

    /// Moves the next good frame into `room` and gives its length. Others are dropped and counted in `dropped`.
    fn take(&mut self, room: &mut [u8; FRAME_MAX], dropped: &mut u32) -> Option<usize> {
        for _ in 0..self.frames() {
            let status = self.0.read::<RX_STATUS>();
            let received = (status >> 16 & 0x3fff) as usize;
            let length = received.saturating_sub(FCS);
            // An unwanted frame is read too: QEMU's way to skip one leaves its FIFO count wrong.
            let mut bytes = room.get_mut(..length).filter(|_| status & RX_STATUS_ERROR == 0 && length > 0);
            for n in 0..received.div_ceil(4) {
                let word = self.0.read::<RX_DATA>().to_le_bytes();
                let rest = bytes.as_deref_mut().and_then(|bytes| bytes.get_mut(4 * n..)).unwrap_or_default();
                for (to, from) in rest.iter_mut().zip(word) {
                    *to = from;
                }
            }
            if bytes.is_some() {
                return Some(length);
            }
            *dropped = dropped.saturating_add(1);
        }
        None
    }

    fn frames(&self) -> u32 {
        self.0.read::<RX_FIFO_INF>() >> 16 & 0xff
    }

    /// Waits until the bits of `mask` read zero.
    fn wait<const OFFSET: usize>(&self, mask: u32) -> Result<(), Error> {
        (0..PATIENCE).any(|_| self.0.read::<OFFSET>() & mask == 0).then_some(()).ok_or(Error::Timeout)
    }

    fn write_mac(&mut self, register: u32, value: u32) -> Result<(), Error> {
        self.wait::<MAC_CSR_CMD>(MAC_CSR_BUSY)?;
        self.0.write::<MAC_CSR_DATA>(value);
        self.0.write::<MAC_CSR_CMD>(MAC_CSR_BUSY | register);
        self.wait::<MAC_CSR_CMD>(MAC_CSR_BUSY)
    }

    fn read_mac(&mut self, register: u32) -> Result<u32, Error> {
        self.wait::<MAC_CSR_CMD>(MAC_CSR_BUSY)?;
        self.0.write::<MAC_CSR_CMD>(MAC_CSR_BUSY | MAC_CSR_READ | register);
        self.wait::<MAC_CSR_CMD>(MAC_CSR_BUSY)?;
        Ok(self.0.read::<MAC_CSR_DATA>())
    }
}

/// Room for a frame each way.
pub struct Buffers {
    received: [u8; FRAME_MAX],
    sent: [u8; FRAME_MAX],
}

impl Buffers {
    /// Empty buffers.
    pub const fn new() -> Self {
        Self { received: [0; FRAME_MAX], sent: [0; FRAME_MAX] }
    }
}

impl Default for Buffers {
    fn default() -> Self {
        Self::new()
    }
}

/// The chip with its buffers: what smoltcp runs on.
pub struct Lan9118 {
    chip: Chip,
    buffers: &'static mut Buffers,
    dropped: u32,
}

impl Lan9118 {
    /// A chip with buffers.
    pub fn new(chip: Chip, buffers: &'static mut Buffers) -> Self {
        Self { chip, buffers, dropped: 0 }
    }

    /// The chip itself, for its interrupt.
    pub fn chip(&mut self) -> &mut Chip {
        &mut self.chip
    }

    /// Frames received and dropped, because they were damaged or too long.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }

    /// The first bytes of the frame sent last; older bytes where it was shorter.
    pub fn sent(&self) -> &[u8; HEADERS] {
        const { assert!(HEADERS <= FRAME_MAX) };
        self.buffers.sent.first_chunk().unwrap_or(&[0; HEADERS])
    }
}

/// A received frame.
pub struct RxToken<'a>(&'a [u8]);

impl phy::RxToken for RxToken<'_> {
    fn consume<R, F: FnOnce(&[u8]) -> R>(self, f: F) -> R {
        f(self.0)
    }
}

/// Room for a frame to send.
pub struct TxToken<'a> {
    chip: &'a mut Chip,
    room: &'a mut [u8; FRAME_MAX],
}

impl phy::TxToken for TxToken<'_> {
    fn consume<R, F: FnOnce(&mut [u8]) -> R>(self, length: usize, f: F) -> R {
        // smoltcp keeps to the length that `capabilities` gives.
        let length = length.min(FRAME_MAX);
        let frame = &mut self.room[..length];
        let result = f(frame);
        self.chip.send(frame);
        result
    }
}

impl phy::Device for Lan9118 {
    type RxToken<'a> = RxToken<'a>;
    type TxToken<'a> = TxToken<'a>;

    fn receive(&mut self, _: Instant) -> Option<(RxToken<'_>, TxToken<'_>)> {
        // smoltcp may want to answer at once.
        if !self.chip.has_room() {
            return None;
        }
        let Buffers { received, sent } = &mut *self.buffers;
        let length = self.chip.take(received, &mut self.dropped)?;
        Some((RxToken(received.get(..length)?), TxToken { chip: &mut self.chip, room: sent }))
    }

    fn transmit(&mut self, _: Instant) -> Option<TxToken<'_>> {
        self.chip.has_room().then_some(TxToken { chip: &mut self.chip, room: &mut self.buffers.sent })
    }

    fn capabilities(&self) -> DeviceCapabilities {
        let mut capabilities = DeviceCapabilities::default();
        capabilities.medium = Medium::Ethernet;
        capabilities.max_transmission_unit = FRAME_MAX;
        capabilities.max_burst_size = Some(1);
        capabilities
    }
}
