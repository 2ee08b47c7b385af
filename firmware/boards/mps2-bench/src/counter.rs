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
    timer: SYST,
    /// Clocks between start and stop with nothing between them.
    reading: u32,
}

/// Starts the count; what is due to reading it is found here, and left out from then on.
pub fn start() -> Option<Instructions> {
    let mut timer = Peripherals::take()?.SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(RELOAD);
    timer.enable_counter();
    let mut clock = Instructions { timer, reading: 0 };
    let reading = (0..100).filter_map(|_| {
        clock.start();
        clock.clocks()
    });
    let reading = reading.min().unwrap_or_default();
    Some(Instructions { reading, ..clock })
}

impl Instructions {
    /// Clocks since the start. It counts down, and says whether it has come to zero since it was started.
    #[inline(always)]
    fn clocks(&mut self) -> Option<u32> {
        let now = SYST::get_current();
        // The first clock after the start loads it.
        (!self.timer.has_wrapped()).then_some(RELOAD.wrapping_sub(now) & RELOAD)
    }
}

impl Clock for Instructions {
    #[inline(always)]
    fn start(&mut self) {
        // Also forgets that it has come to zero.
        self.timer.clear_current();
    }

    #[inline(always)]
    fn stop(&mut self) -> Option<u32> {
        let clocks = self.clocks()?;
        Some((clocks.saturating_sub(self.reading) * 5 + 4) / 8)
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
