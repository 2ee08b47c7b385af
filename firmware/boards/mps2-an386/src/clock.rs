//! Time since the start, from the second timer.
//!
//! The timer goes round every 172 s. [`cycles`] counts the rounds, so it must be called at least that often; the
//! control task does, a thousand times a second.

use crate::CLOCK_HZ;
use crate::pac::block;
use crate::registers::Registers;
use crate::timer::Counter;
use core::cell::RefCell;
use critical_section::Mutex;

const CYCLES_PER_MICRO: u64 = CLOCK_HZ as u64 / 1_000_000;

struct Clock {
    counter: Counter,
    /// What the counter read last.
    seen: u32,
    rounds: u32,
}

static CLOCK: Mutex<RefCell<Option<Clock>>> = Mutex::new(RefCell::new(None));

/// Starts the clock at zero.
pub fn start(registers: Registers<block::Timer>) {
    let clock = Clock { counter: Counter::start(registers), seen: 0, rounds: 0 };
    critical_section::with(|cs| CLOCK.replace(cs, Some(clock)));
}

/// Clocks of the core since [`start`]; zero before it.
pub fn cycles() -> u64 {
    critical_section::with(|cs| {
        // Only a fault in the middle of this very function finds the clock borrowed: it must not fault again.
        let Ok(mut clock) = CLOCK.borrow(cs).try_borrow_mut() else { return 0 };
        let Some(clock) = clock.as_mut() else { return 0 };
        let now = clock.counter.elapsed();
        clock.rounds = clock.rounds.wrapping_add(u32::from(now < clock.seen));
        clock.seen = now;
        u64::from(clock.rounds) << 32 | u64::from(now)
    })
}

/// Microseconds since [`start`].
pub fn micros() -> u64 {
    cycles() / CYCLES_PER_MICRO
}
