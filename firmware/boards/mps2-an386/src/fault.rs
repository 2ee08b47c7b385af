//! What happens when the firmware fails: panic, hard fault, a watchdog that was not fed, an interrupt nobody expects.
//!
//! All take the same path. Interrupts go off for good, so no task runs and no further command leaves but one: zero
//! velocity, stopped by a fault ([`farewell`]). The reason is kept in memory that a reset leaves alone,
//! and logged. Then the board resets and comes back idle, for the host to see; from the [`LIMIT`]th fault since power
//! came on it stays stopped instead. With the feature `qemu` the emulator exits with a failure.

use crate::farewell;
use crate::log;
use crate::pac::Peripherals;
use crate::watchdog::Watchdog;
use core::cell::UnsafeCell;
use core::fmt::{self, Write};
use core::mem::MaybeUninit;
use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, Ordering};
use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use pliant_protocol::checksum;

/// Faults since power came on after which the board does not start again by itself.
pub const LIMIT: u32 = 3;

/// Most bytes of a reason.
const REASON: usize = 160;

/// A fault, as it is found after the reset that it ended in.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Fault {
    /// How many there have been since power came on.
    count: u32,
    length: u32,
    reason: [u8; REASON],
    /// Over all before; memory that just got power does not fit it.
    checksum: u32,
}

impl Fault {
    /// How many faults there have been since power came on, this one included.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Why.
    pub fn reason(&self) -> &str {
        let bytes = self.reason.get(..self.length as usize).unwrap_or(&self.reason);
        core::str::from_utf8(bytes).unwrap_or("(reason unreadable)")
    }

    fn new(count: u32, reason: fmt::Arguments) -> Self {
        let mut fault = Self { count, length: 0, reason: [0; REASON], checksum: 0 };
        // A reason too long is cut.
        let _cut = fault.write_fmt(reason);
        fault.checksum = fault.expected();
        fault
    }

    fn expected(&self) -> u32 {
        checksum(&self.reason) ^ checksum(&self.count.to_le_bytes()) ^ self.length
    }
}

impl Write for Fault {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for character in text.chars() {
            let mut bytes = [0; 4];
            let bytes = character.encode_utf8(&mut bytes).as_bytes();
            let start = self.length as usize;
            let room = self.reason.get_mut(start..start + bytes.len()).ok_or(fmt::Error)?;
            room.copy_from_slice(bytes);
            self.length += bytes.len() as u32;
        }
        Ok(())
    }
}

/// Memory that neither the start of the program nor a reset touches.
struct Record(UnsafeCell<MaybeUninit<Fault>>);

// SAFETY: only `read` and `write` reach it, and both are called with interrupts off: `read` by `init`, `write` by
// `fail`, which never returns.
unsafe impl Sync for Record {}

#[unsafe(link_section = ".uninit.FAULT")]
static RECORD: Record = Record(UnsafeCell::new(MaybeUninit::uninit()));

impl Record {
    fn read(&self) -> Option<Fault> {
        // SAFETY: nobody writes meanwhile (see `Sync`), and every pattern of bits is a `Fault`, for it is made of
        // numbers only. The read is volatile because the memory is older than this program's run.
        let fault = unsafe { self.0.get().cast::<Fault>().read_volatile() };
        (fault.checksum == fault.expected() && fault.count > 0).then_some(fault)
    }

    fn write(&self, fault: Fault) {
        // SAFETY: nobody reads or writes meanwhile (see `Sync`). Volatile, for this run does not read it again.
        unsafe { self.0.get().cast::<Fault>().write_volatile(fault) }
    }
}

/// The fault that ended the run before this one, if there was one since power came on. For `init`, once.
pub fn last() -> Option<Fault> {
    RECORD.read()
}

/// Ends the run.
fn fail(reason: fmt::Arguments) -> ! {
    static FAILING: AtomicBool = AtomicBool::new(false);
    cortex_m::interrupt::disable();
    // A fault while a fault is dealt with: what matters most has been tried, so only stop.
    if FAILING.swap(true, Ordering::Relaxed) {
        stop();
    }
    let fault = Fault::new(RECORD.read().map_or(0, |last| last.count).saturating_add(1), reason);
    RECORD.write(fault);
    // SAFETY: interrupts are off and stay so; whoever owned the peripherals never runs again.
    farewell::say(unsafe { Peripherals::steal() });
    log::seize();
    defmt::error!("fault {=u32}: {=str}", fault.count, fault.reason());
    log::flush();

    #[cfg(feature = "qemu")]
    cortex_m_semihosting::debug::exit(cortex_m_semihosting::debug::EXIT_FAILURE);
    if fault.count < LIMIT {
        SCB::sys_reset();
    }
    stop()
}

/// Does nothing for ever, and lets nothing change that.
fn stop() -> ! {
    // SAFETY: as in `fail`: nobody else runs any more.
    Watchdog::stop(unsafe { Peripherals::steal() }.watchdog);
    loop {
        cortex_m::asm::wfi();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    match info.location() {
        Some(place) => fail(format_args!("panic at {place}: {}", info.message())),
        None => fail(format_args!("panic: {}", info.message())),
    }
}

// SAFETY: it never returns, so what the faulting code left behind is never used.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    // SAFETY: the configurable fault status register may be read at any time.
    let status = unsafe { (*SCB::PTR).cfsr.read() };
    fail(format_args!("hard fault at {:#010x}, lr {:#010x}, status {status:#010x}", frame.pc(), frame.lr()))
}

// SAFETY: as in `HardFault`.
#[exception]
unsafe fn NonMaskableInt() {
    fail(format_args!("the watchdog was not fed"))
}

// SAFETY: as in `HardFault`.
#[exception]
unsafe fn DefaultHandler(line: i16) {
    fail(format_args!("unexpected interrupt {line}"))
}
