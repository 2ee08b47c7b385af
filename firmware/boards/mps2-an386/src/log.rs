//! defmt messages over UART1.
//!
//! A message costs its writer the encoding only: bytes go into a ring and leave by UART1's own interrupt, below
//! everything else. Where the ring is full a message is lost whole.
//!
//! The tick never logs. Nothing breaks if it did: a message that begins while another is being written is lost.
//!
//! Read them with `defmt-print -e ELF`, from the second `-serial` of QEMU.

use crate::clock;
use crate::pac::{Interrupt, block};
use crate::registers::Registers;
use crate::uart::Uart;
use core::cell::{RefCell, UnsafeCell};
use core::sync::atomic::{AtomicU8, Ordering};
use cortex_m::peripheral::NVIC;
use critical_section::Mutex;
use heapless::Deque;

/// Bytes that wait for the UART.
const RING: usize = 2048;
/// A message begins only where the ring has this much room; longer ones may be cut, and the reader skips them.
const MESSAGE: usize = 192;

struct Line {
    uart: Uart,
    ring: Deque<u8, RING>,
}

static LINE: Mutex<RefCell<Option<Line>>> = Mutex::new(RefCell::new(None));

/// Starts the log. What was logged before is lost.
pub fn start(registers: Registers<block::Uart>) {
    let line = Line { uart: Uart::start_sender(registers), ring: Deque::new() };
    critical_section::with(|cs| LINE.replace(cs, Some(line)));
}

/// Answers UART1's interrupt: sends what the UART takes.
pub fn drain() {
    with_line(|line| line.uart.acknowledge_sent());
    while with_line(|line| {
        let byte = if line.uart.has_room() { line.ring.pop_front() } else { None };
        byte.map(|byte| line.uart.put(byte)).is_some()
    }) == Some(true)
    {}
}

/// Gives the log to a fault: what waits is sent, a message under way is cut. What is logged from now on is sent by
/// [`flush`].
pub(crate) fn seize() {
    flush();
    with_line(|line| line.uart.send_waiting(&[0]));
    LOGGER.depth.store(0, Ordering::Relaxed);
}

/// Sends all that waits, and waits for it.
pub(crate) fn flush() {
    with_line(|line| {
        while let Some(byte) = line.ring.pop_front() {
            line.uart.send_waiting(&[byte]);
        }
    });
}

fn with_line<R>(f: impl FnOnce(&mut Line) -> R) -> Option<R> {
    critical_section::with(|cs| {
        // Borrowed only where a fault struck within this very function.
        let mut line = LINE.borrow(cs).try_borrow_mut().ok()?;
        line.as_mut().map(f)
    })
}

/// The encoder, owned by the first that begins a message until it ends it.
struct Logger {
    /// How many messages have begun and not ended. On one core they nest: whoever interrupts also ends first.
    depth: AtomicU8,
    encoder: UnsafeCell<defmt::Encoder>,
    /// The message under way found no room.
    skipped: UnsafeCell<bool>,
}

// SAFETY: the cells are reached only between `acquire` and `release`, by whoever found a depth of zero. Anyone who
// interrupts finds a greater one and leaves them alone.
unsafe impl Sync for Logger {}

static LOGGER: Logger = Logger {
    depth: AtomicU8::new(0),
    encoder: UnsafeCell::new(defmt::Encoder::new()),
    skipped: UnsafeCell::new(false),
};

fn put(bytes: &[u8]) {
    // The bytes that do not fit are left out, and with them the reader skips this message.
    with_line(|line| bytes.iter().try_for_each(|&byte| line.ring.push_back(byte)));
}

#[defmt::global_logger]
struct Defmt;

// SAFETY: between `acquire` and `release` the encoder has one user, see `Logger`. A message within a message is dropped,
// so that `write` never meets an encoder of another.
unsafe impl defmt::Logger for Defmt {
    fn acquire() {
        let free = with_line(|line| line.ring.capacity() - line.ring.len()).unwrap_or(0);
        if LOGGER.depth.fetch_add(1, Ordering::Relaxed) != 0 {
            return;
        }
        let skip = free < MESSAGE;
        // SAFETY: the depth was zero, so the cells are ours until `release`.
        unsafe {
            *LOGGER.skipped.get() = skip;
            if !skip {
                (*LOGGER.encoder.get()).start_frame(put);
            }
        }
    }

    unsafe fn flush() {}

    unsafe fn write(bytes: &[u8]) {
        // SAFETY: at depth one the cells are ours, as in `acquire`.
        unsafe {
            if LOGGER.depth.load(Ordering::Relaxed) == 1 && !*LOGGER.skipped.get() {
                (*LOGGER.encoder.get()).write(bytes, put);
            }
        }
    }

    unsafe fn release() {
        // SAFETY: as in `write`.
        unsafe {
            if LOGGER.depth.load(Ordering::Relaxed) == 1 && !*LOGGER.skipped.get() {
                (*LOGGER.encoder.get()).end_frame(put);
            }
        }
        LOGGER.depth.fetch_sub(1, Ordering::Relaxed);
        NVIC::pend(Interrupt::UART1_TX);
    }
}

defmt::timestamp!("{=u64:us}", clock::micros());
