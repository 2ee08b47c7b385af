//! How deep the stack went.
//!
//! Before the program starts, cortex-m-rt paints all RAM that the stack may take (`paint-stack`). The deepest word that
//! is no longer painted is the mark. `idle` looks for it a little at a time, over and over: the last [`DEPTH`] bytes
//! take it about an eighth of a second.

use core::ptr;
use core::sync::atomic::{AtomicU32, Ordering};

/// How far down it looks, in bytes. A stack that is deeper is reported as this.
pub const DEPTH: usize = 256 * 1024;
/// Words looked at in one call.
const STEP: usize = 512;
/// What cortex-m-rt paints with.
const PAINT: u32 = 0xcccc_cccc;
const WORD: usize = size_of::<u32>();

static USED: AtomicU32 = AtomicU32::new(0);

unsafe extern "C" {
    /// Where the stack starts; it grows down from there. Only the address means anything.
    static _stack_start: u32;
    /// Where it must end.
    static _stack_end: u32;
}

/// Most stack found used so far, in bytes.
pub fn used() -> u32 {
    USED.load(Ordering::Relaxed)
}

/// The search for the mark.
#[derive(Default)]
pub struct Survey {
    /// Where to go on, in bytes above the deepest that is looked at.
    cursor: usize,
}

impl Survey {
    /// A search that begins.
    pub const fn new() -> Self {
        Self { cursor: 0 }
    }

    /// Goes on by a little.
    pub fn step(&mut self) {
        let start = (&raw const _stack_start).addr();
        let bottom = (&raw const _stack_end).addr().max(start - DEPTH);
        let mark = start - used() as usize;
        let from = (bottom + self.cursor).min(mark);
        let to = (from + STEP * WORD).min(mark);
        let touched = (from..to).step_by(WORD).find(|&address| {
            // SAFETY: the linker script has RAM from `_stack_end` to `_stack_start`, both multiples of four. Interrupts
            // may write it between two reads; the reads are volatile and any value will do.
            let word: u32 = unsafe { ptr::read_volatile(ptr::with_exposed_provenance(address)) };
            word != PAINT
        });
        if let Some(address) = touched {
            // At most `DEPTH`.
            USED.store((start - address) as u32, Ordering::Relaxed);
        }
        // All below the mark was seen painted: once more from the bottom.
        self.cursor = if touched.is_some() || to == mark { 0 } else { to - bottom };
    }
}
