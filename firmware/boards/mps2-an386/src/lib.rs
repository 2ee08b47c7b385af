//! Arm's MPS2 board with the AN386 image, a Cortex-M4F at 25 MHz: the default board, because QEMU runs it.
//!
//! This library is the board: its registers, drivers and what it does when it fails. The binary beside it binds the
//! board-free application of `pliant_firmware` to it; the example `echo` proves the drivers without the application.
//!
//! | module | hardware | |
//! |---|---|---|
//! | [`pac`], [`registers`] | all | interrupt numbers, vector table, who owns which registers |
//! | [`timer`], [`clock`] | two CMSDK timers | the 1 kHz tick, and a time that does not stop |
//! | [`watchdog`] | CMSDK watchdog | a device that hangs starts again |
//! | [`uart`], [`serial`] | CMSDK UART0 | the serial link |
//! | [`lan9118`], [`net`] | SMSC LAN9118 | the UDP link |
//! | [`links`] | | both links and the application's half that faces them |
//! | [`log`] | CMSDK UART1 | defmt messages |
//! | [`stack`] | RAM | how deep the stack went |
//! | [`fault`], [`farewell`] | | panics and hard faults: one last command of zero, a record, a stop |
//!
//! # Where the numbers come from
//!
//! Addresses, interrupt numbers and the clock are those of Arm's application note DAI0386 (*ARM Cortex-M4 SMM on
//! V2M-MPS2*), as QEMU has them in `hw/arm/mps2.c`. The timers, UARTs and the watchdog are those of Arm's *Cortex-M
//! System Design Kit* (DDI0479). What QEMU does differently from hardware is said where it matters; none of this has
//! run on the board itself.
//!
//! # Unsafe code
//!
//! Only what hardware cannot be had without: [`registers`] (reads and writes at fixed addresses), [`pac`] (the vector
//! table), [`log`] (defmt's logger is an unsafe trait), [`stack`] (reads what is painted) and [`fault`] (a record that
//! outlives a reset). Each block says why it is sound; drivers have none.
// For a host the crate is empty, and this page with its links all that is left.
#![cfg_attr(not(target_os = "none"), allow(rustdoc::broken_intra_doc_links))]
#![no_std]
#![cfg(target_os = "none")]

pub mod clock;
pub mod farewell;
pub mod fault;
pub mod lan9118;
pub mod links;
pub mod log;
pub mod net;
pub mod pac;
pub mod registers;
pub mod serial;
pub mod stack;
pub mod timer;
pub mod uart;
pub mod watchdog;

/// Clock of the core, the timers, the UARTs and the watchdog, in Hz (`SYSCLK_FRQ` in `hw/arm/mps2.c`).
pub const CLOCK_HZ: u32 = 25_000_000;
