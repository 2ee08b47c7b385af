//! What the board has: interrupt numbers, the vector table and the peripherals, in the shape RTIC expects.
//!
//! Numbers and addresses are those of `hw/arm/mps2.c` in QEMU (machine `mps2-an386`) and of Arm's DAI0386. Only what
//! this firmware uses is listed.

use crate::registers::{Block, Registers};
use cortex_m::interrupt::InterruptNumber;

/// Bits of priority that the interrupt controller has.
///
/// QEMU implements all eight; three is the least that a Cortex-M4 may have, and suits both, for priorities are kept in
/// the top bits.
pub const NVIC_PRIO_BITS: u8 = 3;

/// Lines of the interrupt controller.
const LINES: usize = 32;

/// An entry of the vector table.
#[derive(Clone, Copy)]
pub union Vector {
    handler: unsafe extern "C" fn(),
    reserved: usize,
}

/// Makes the enum, the handlers' declarations and the vector table from one list. `device.x` has the names once more.
macro_rules! interrupts {
    ($($(#[$doc:meta])* $name:ident = $number:literal,)*) => {
        /// An interrupt of this board.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u16)]
        #[allow(non_camel_case_types, reason = "named like the handlers that RTIC binds")]
        pub enum Interrupt {
            $($(#[$doc])* $name = $number,)*
        }

        unsafe extern "C" {
            $(fn $name();)*
        }

        /// The vector table behind the core's own entries; cortex-m-rt places it by its section.
        #[unsafe(link_section = ".vector_table.interrupts")]
        #[unsafe(no_mangle)]
        pub static __INTERRUPTS: [Vector; LINES] = {
            let mut table = [Vector { reserved: 0 }; LINES];
            $(table[$number] = Vector { handler: $name };)*
            table
        };
    };
}

interrupts! {
    /// UART0 has a byte for us.
    UART0_RX = 0,
    /// UART0 has room for a byte.
    UART0_TX = 1,
    /// UART1 has a byte for us.
    UART1_RX = 2,
    /// UART1 has room for a byte.
    UART1_TX = 3,
    /// The first timer has run down.
    TIMER0 = 8,
    /// The second timer has run down.
    TIMER1 = 9,
    /// The dual timer has run down. Nobody starts it, so the line is free to be pended by software; among equal
    /// priorities it goes before [`ETHERNET`](Self::ETHERNET), for its number is lower.
    DUALTIMER = 10,
    /// A byte was lost in UART0, 1 or 2.
    UART_OVERFLOW = 12,
    /// The Ethernet controller asks for attention.
    ETHERNET = 13,
}

/// The name by which RTIC looks for [`Interrupt`].
pub use Interrupt as interrupt;

// SAFETY: each number is the line that the interrupt has in the vector table, and below the number of lines.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}

/// Kinds of peripherals, as markers for [`Registers`].
pub mod block {
    use super::Block;

    /// CMSDK APB timer: see [`timer`](crate::timer).
    pub enum Timer {}
    /// CMSDK APB UART: see [`uart`](crate::uart).
    pub enum Uart {}
    /// CMSDK APB watchdog: see [`watchdog`](crate::watchdog).
    pub enum Watchdog {}
    /// LAN9118: see [`lan9118`](crate::lan9118).
    pub enum Ethernet {}

    impl Block for Timer {
        const SIZE: usize = 0x1000;
    }
    impl Block for Uart {
        const SIZE: usize = 0x1000;
    }
    impl Block for Watchdog {
        const SIZE: usize = 0x1000;
    }
    impl Block for Ethernet {
        const SIZE: usize = 0x100;
    }
}

/// Every peripheral that this firmware uses, once. RTIC gives it to `init`.
pub struct Peripherals {
    /// The first timer: the tick.
    pub timer0: Registers<block::Timer>,
    /// The second timer: the clock.
    pub timer1: Registers<block::Timer>,
    /// The first UART: the serial link.
    pub uart0: Registers<block::Uart>,
    /// The second UART: the log.
    pub uart1: Registers<block::Uart>,
    /// The watchdog.
    pub watchdog: Registers<block::Watchdog>,
    /// The Ethernet controller.
    pub ethernet: Registers<block::Ethernet>,
}

impl Peripherals {
    /// All peripherals, whoever may own them already.
    ///
    /// # Safety
    ///
    /// Nobody else may use any of them from now on, or only while this value is not used.
    pub const unsafe fn steal() -> Self {
        // SAFETY: `hw/arm/mps2.c` and DAI0386 have these peripherals at these addresses; that they are used by one
        // owner only is what the caller promises.
        unsafe {
            Self {
                timer0: Registers::at(0x4000_0000),
                timer1: Registers::at(0x4000_1000),
                uart0: Registers::at(0x4000_4000),
                uart1: Registers::at(0x4000_5000),
                watchdog: Registers::at(0x4000_8000),
                ethernet: Registers::at(0x4020_0000),
            }
        }
    }
}
