//! The CMSDK APB timer (DDI0479, chapter 4.4; QEMU `hw/timer/cmsdk-apb-timer.c`) as the source of the tick.
//!
//! It counts down at [`CLOCK_HZ`]. On the step from 1 to 0 it raises its interrupt, stays at 0 for one clock and then
//! begins again from RELOAD, so a period is one clock longer than the number in RELOAD.

use crate::pac::block;
use crate::registers::Registers;
use crate::{CLOCK_HZ, clock};

const CTRL: usize = 0x0;
const VALUE: usize = 0x4;
const RELOAD: usize = 0x8;
/// Interrupt status when read, interrupt clear when written.
const INTERRUPT: usize = 0xc;

const CTRL_ENABLE: u32 = 1 << 0;
const CTRL_INTERRUPT: u32 = 1 << 3;

/// An interrupt at a fixed rate of `HZ`.
pub struct Ticker<const HZ: u32> {
    registers: Registers<block::Timer>,
    /// When the next tick is due, by the [`clock`].
    due: u64,
}

impl<const HZ: u32> Ticker<HZ> {
    const PERIOD: u32 = {
        assert!(HZ > 0 && CLOCK_HZ.is_multiple_of(HZ) && CLOCK_HZ / HZ > 1);
        CLOCK_HZ / HZ
    };
    const RELOAD: u32 = Self::PERIOD - 1;

    /// Starts a timer. The [`clock`] must have been started.
    pub fn start(mut registers: Registers<block::Timer>) -> Self {
        // Read before the timer starts, so that no tick comes before it is due.
        let due = clock::cycles() + u64::from(Self::PERIOD);
        registers.write::<CTRL>(0);
        registers.write::<RELOAD>(Self::RELOAD);
        registers.write::<VALUE>(Self::RELOAD);
        registers.write::<INTERRUPT>(1);
        registers.write::<CTRL>(CTRL_ENABLE | CTRL_INTERRUPT);
        Self { registers, due }
    }

    /// Clocks since the timer ran down last: how late its interrupt is being answered, up to one period.
    pub fn since(&self) -> u32 {
        Self::RELOAD.saturating_sub(self.registers.read::<VALUE>())
    }

    /// Takes note of a tick. Gives the ticks before it that were due and never ran, because the interrupt was answered
    /// too late to tell them apart.
    pub fn acknowledge(&mut self) -> u32 {
        // In this order: a tick that becomes due between the two is lost, and counted by the next one.
        let now = clock::cycles();
        self.registers.write::<INTERRUPT>(1);
        let late = u32::try_from(now.saturating_sub(self.due)).unwrap_or(u32::MAX);
        let overdue = late / Self::PERIOD;
        self.due += (u64::from(overdue) + 1) * u64::from(Self::PERIOD);
        overdue
    }
}

/// A count that runs down over all 32 bits, without an interrupt.
pub struct Counter(Registers<block::Timer>);

impl Counter {
    /// Starts the count at its greatest value.
    pub fn start(mut registers: Registers<block::Timer>) -> Self {
        registers.write::<CTRL>(0);
        registers.write::<RELOAD>(u32::MAX);
        registers.write::<VALUE>(u32::MAX);
        registers.write::<CTRL>(CTRL_ENABLE);
        Self(registers)
    }

    /// Clocks since the start; goes round after 2^32, which is 172 s.
    pub fn elapsed(&self) -> u32 {
        !self.0.read::<VALUE>()
    }
}
