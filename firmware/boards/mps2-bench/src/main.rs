//! The method measured in QEMU: instructions a tick, and digests of commands. What is printed, and how to ask for it, is in
//! `pliant_bench::report`.
//!
//! Built for a core with an FPU it measures single precision:
//!
//! ```sh
//! cargo build --profile firmware -p pliant-mps2-bench --target thumbv7em-none-eabihf
//! qemu-system-arm -machine mps2-an386 -display none -monitor none -serial null \
//!   -icount shift=6,align=off,sleep=off -semihosting-config enable=on,target=native,arg=bench,arg=ticks=1000 \
//!   -kernel target/thumbv7em-none-eabihf/firmware/pliant-mps2-bench
//! ```
//!
//! and for `thumbv6m-none-eabi`, run by `-machine mps2-an385`, fixed point. That board's core is a Cortex-M3, which runs the Cortex-M0's
//! instructions one for one: what is counted is what an M0 would execute.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod counter;

#[cfg(target_os = "none")]
mod board {
    use crate::counter;
    use cortex_m_rt::entry;
    use cortex_m_semihosting::{debug, hio};
    use panic_semihosting as _;
    use pliant_bench::report::{Bench, MAX_TICKS};

    #[entry]
    fn main() -> ! {
        static mut COUNTS: [u32; MAX_TICKS] = [0; MAX_TICKS];
        let wanted = counter::wanted();
        let parts = counter::start().ok_or(()).and_then(|clock| Ok((clock, hio::hstdout()?)));
        let done = parts.map_err(|()| core::fmt::Error).and_then(|(clock, out)| {
            #[cfg(target_abi = "eabihf")]
            let done = Bench { core: "Cortex-M4F", clock, counts: COUNTS, out, wanted }.with_fpu();
            #[cfg(not(target_abi = "eabihf"))]
            let done = Bench { core: "Cortex-M0", clock, counts: COUNTS, out, wanted }.without_fpu();
            done
        });
        debug::exit(if done.is_ok() { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
        loop {
            cortex_m::asm::wfi();
        }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This is for a board: build it with --target thumbv7em-none-eabihf or thumbv6m-none-eabi.");
}
