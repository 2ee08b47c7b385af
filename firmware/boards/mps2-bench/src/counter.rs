//! Instructions counted under QEMU, and what it was asked to measure.
//!
//! With `-icount shift=6` an instruction takes 64 ns of the emulated time, which is 1.6 clocks of the 25 MHz that SysTick counts.

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{Peripherals, SYST};
use pliant_bench::report::Wanted;
use pliant_bench::timing::Clock;

/// SysTick, 24 bits.
const RELOAD: u32 = 0x00ff_ffff;

/// The count of instructions.
pub struct Instructions {
    /// Clocks between two readings with nothing between them.
    reading: u32,
}

/// Starts the count; what is due to reading it is found here, and left out from then on.
pub fn start() -> Instructions {
    if let Some(mut core) = Peripherals::take() {
        core.SYST.set_clock_source(SystClkSource::Core);
        core.SYST.set_reload(RELOAD);
        core.SYST.clear_current();
        core.SYST.enable_counter();
    }
    let reading = (0..100).map(|_| clocks(SYST::get_current(), SYST::get_current())).min();
    Instructions { reading: reading.unwrap_or_default() }
}

/// It counts down.
fn clocks(start: u32, end: u32) -> u32 {
    start.wrapping_sub(end) & RELOAD
}

impl Clock for Instructions {
    #[inline(always)]
    fn now(&mut self) -> u32 {
        SYST::get_current()
    }

    fn between(&self, start: u32, end: u32) -> u32 {
        (clocks(start, end).saturating_sub(self.reading) * 5 + 4) / 8
    }
}

/// What QEMU was told by `-semihosting-config arg=...`.
pub fn wanted() -> Wanted {
    /// SYS_GET_CMDLINE of Arm's semihosting.
    const GET_COMMAND_LINE: usize = 0x15;
    let mut text = [0_u8; 256];
    let mut field = [text.as_mut_ptr().expose_provenance(), text.len()];
    // SAFETY: the call takes the address of two words, those of a buffer and its length, and writes no further. Both live until it is back.
    #[allow(clippy::unnecessary_mut_passed, reason = "the host writes the length into it")]
    let status = unsafe { cortex_m_semihosting::syscall(GET_COMMAND_LINE, &mut field) };
    let length = if status == 0 { field[1].min(text.len()) } else { 0 };
    let words = text.get(..length).and_then(|text| core::str::from_utf8(text).ok());
    Wanted::parse(words.unwrap_or_default())
}
