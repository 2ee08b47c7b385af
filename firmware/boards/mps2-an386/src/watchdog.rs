//! The CMSDK APB watchdog (DDI0479, chapter 4.6; QEMU `hw/watchdog/cmsdk-apb-watchdog.c`).
//!
//! It is fed by `idle`, the one place that is never reached while any task hangs. Not fed for [`PATIENCE_S`], it raises
//! the non-maskable interrupt, which ends like a panic; where even that hangs, the second run-down resets the board.

use crate::CLOCK_HZ;
use crate::pac::block;
use crate::registers::Registers;

const LOAD: usize = 0x0;
const CONTROL: usize = 0x8;
const INTERRUPT_CLEAR: usize = 0xc;
const LOCK: usize = 0xc00;

const CONTROL_INTERRUPT: u32 = 1 << 0;
const CONTROL_RESET: u32 = 1 << 1;
/// Opens the other registers for writing.
const UNLOCK: u32 = 0x1acc_e551;

/// How long the device may go without idling, in s: far above any work it has, and above the pauses of a busy host
/// that runs the emulator.
pub const PATIENCE_S: u32 = 5;

/// A watchdog that is running.
pub struct Watchdog(Registers<block::Watchdog>);

impl Watchdog {
    /// Starts it.
    pub fn start(mut registers: Registers<block::Watchdog>) -> Self {
        registers.write::<LOCK>(UNLOCK);
        registers.write::<LOAD>(PATIENCE_S * CLOCK_HZ);
        registers.write::<CONTROL>(CONTROL_INTERRUPT | CONTROL_RESET);
        Self(registers)
    }

    /// Begins its patience anew.
    pub fn feed(&mut self) {
        self.0.write::<INTERRUPT_CLEAR>(1);
    }

    /// Ends the watch.
    pub fn stop(mut registers: Registers<block::Watchdog>) {
        registers.write::<LOCK>(UNLOCK);
        registers.write::<CONTROL>(0);
    }
}
