//! Links if and only if no panic can be reached from the tick, or from what changes obstacles, scan and attractor between two ticks.
//!
//! The panic handler calls a function that is nowhere. Whole-program optimisation takes out what can be seen never to be called; if a call of
//! the handler is left, the linker misses that function. So what is shown is shown for all inputs, and for the code as it runs on a board.
//!
//! `cargo xtask no-panic` builds it for both cores, and once more with `--features planted`, which must fail.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod roots;

#[cfg(target_os = "none")]
mod image {
    use cortex_m_rt::entry;

    unsafe extern "C" {
        /// Is nowhere, but with the feature `found`.
        fn a_panic_can_be_reached() -> !;
    }

    #[panic_handler]
    fn panic(_info: &core::panic::PanicInfo) -> ! {
        // SAFETY: nothing that calls it is ever linked, or else it is the one below.
        unsafe { a_panic_can_be_reached() }
    }

    #[cfg(feature = "found")]
    mod found {
        #[inline(never)]
        // SAFETY: there is no other of this name.
        #[unsafe(no_mangle)]
        extern "C" fn a_panic_can_be_reached() -> ! {
            loop {
                core::hint::spin_loop();
            }
        }
    }

    #[entry]
    fn main() -> ! {
        crate::roots::keep();
        loop {
            core::hint::spin_loop();
        }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This is for a board, and only to be linked: `cargo xtask no-panic`.");
}
