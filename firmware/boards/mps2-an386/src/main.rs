//! The Pliant device on Arm's MPS2 board with the AN386 image: the board's interrupts, bound to the application.
//!
//! | task | bound to | priority | |
//! |---|---|---|---|
//! | `control` | TIMER0, 1 kHz | 3 | the tick; waits for nobody |
//! | `uart_received`, `uart_sent` | UART0 | 2 | the serial link |
//! | `report` | DUALTIMER, pended by `control` | 2 | sends the tick's command |
//! | `ethernet` | ETHERNET | 2 | the UDP link |
//! | `drain` | UART1 | 1 | lets messages out |
//! | `idle` | | 0 | finds which obstacles overlap, feeds the watchdog, measures the stack, sleeps |
//!
//! The links share everything but the control half without locks, for none of them interrupts another. Among them, the
//! one with the lower interrupt number goes first, so a command never waits for more than one call of `ethernet`. The
//! control half is locked against the tick only for the short steps in which the application applies a request, and for
//! one piece at a time of the search for overlapping obstacles, the longest of them; in a stepped run a robot's state makes the tick there, and the timer's tick has nothing to do.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[rtic::app(device = pliant_mps2_an386::pac, peripherals = true)]
mod app {
    use core::sync::atomic::{AtomicU32, Ordering};
    use pliant_firmware::{Control, Gauges, Identity, TICK_HZ};
    use pliant_mps2_an386::links::{Links, Lock};
    use pliant_mps2_an386::net::{Bytes, Net, Slots};
    use pliant_mps2_an386::pac::Interrupt;
    use pliant_mps2_an386::serial::Serial;
    use pliant_mps2_an386::stack::{self, Survey};
    use pliant_mps2_an386::timer::Ticker;
    use pliant_mps2_an386::watchdog::Watchdog;
    use pliant_mps2_an386::{clock, fault, log};

    const IDENTITY: Identity = Identity {
        board: "mps2-an386",
        firmware: [
            number(env!("CARGO_PKG_VERSION_MAJOR")),
            number(env!("CARGO_PKG_VERSION_MINOR")),
            number(env!("CARGO_PKG_VERSION_PATCH")),
        ],
    };

    const fn number(text: &str) -> u8 {
        match u8::from_str_radix(text, 10) {
            Ok(number) => number,
            Err(_) => u8::MAX,
        }
    }

    /// Longest computation of a tick so far, in us.
    static WORST_TICK: AtomicU32 = AtomicU32::new(0);

    #[shared]
    struct Shared {
        control: Control,
        #[lock_free]
        links: Links,
    }

    #[local]
    struct Local {
        ticker: Ticker<{ TICK_HZ as u32 }>,
        watchdog: Watchdog,
    }

    #[init(local = [bytes: Bytes = Bytes::new(), slots: Slots = Slots::new()])]
    fn init(cx: init::Context) -> (Shared, Local) {
        clock::start(cx.device.timer1);
        log::start(cx.device.uart1);
        if let Some(last) = fault::last() {
            defmt::warn!("started again after fault {=u32}: {=str}", last.count(), last.reason());
        }
        let net = Net::start(cx.device.ethernet, cx.local.bytes, cx.local.slots)
            .inspect_err(|error| defmt::error!("no network: {}", error))
            .ok();
        let serial = Serial::start(cx.device.uart0);
        let [major, minor, patch] = IDENTITY.firmware;
        defmt::info!("{=str} {=u8}.{=u8}.{=u8}", IDENTITY.board, major, minor, patch);
        (
            Shared { control: Control::new(), links: Links::new(IDENTITY, net, serial) },
            Local { ticker: Ticker::start(cx.device.timer0), watchdog: Watchdog::start(cx.device.watchdog) },
        )
    }

    #[idle(local = [watchdog, survey: Survey = Survey::new()], shared = [control])]
    fn idle(mut cx: idle::Context) -> ! {
        loop {
            cx.local.watchdog.feed();
            // A change that comes after the last look waits for the next interrupt, a tick at most.
            if cx.shared.control.lock(Control::settle) {
                continue;
            }
            cx.local.survey.step();
            cortex_m::asm::wfi();
        }
    }

    #[task(binds = TIMER0, priority = 3, local = [ticker], shared = [control])]
    fn control(mut cx: control::Context) {
        let overdue = cx.local.ticker.acknowledge();
        let begun = clock::micros();
        cx.shared.control.lock(|control| control.tick(overdue));
        let took = u32::try_from(clock::micros() - begun).unwrap_or(u32::MAX);
        WORST_TICK.fetch_max(took, Ordering::Relaxed);
        rtic::pend(Interrupt::DUALTIMER);
    }

    #[task(binds = DUALTIMER, priority = 2, shared = [control, links])]
    fn report(mut cx: report::Context) {
        let command = cx.shared.control.lock(Control::take_report);
        let worst_tick_us = WORST_TICK.load(Ordering::Relaxed);
        let gauges = Gauges { stack_used: stack::used(), worst_tick_us, ..Gauges::default() };
        if cx.shared.links.tick(command.as_ref(), gauges) {
            rtic::pend(Interrupt::ETHERNET);
        }
    }

    #[task(binds = ETHERNET, priority = 2, shared = [control, links])]
    fn ethernet(cx: ethernet::Context) {
        if cx.shared.links.ethernet(&mut Lock(cx.shared.control)) {
            rtic::pend(Interrupt::ETHERNET);
        }
    }

    #[task(binds = UART0_RX, priority = 2, shared = [control, links])]
    fn uart_received(cx: uart_received::Context) {
        cx.shared.links.uart_received(&mut Lock(cx.shared.control));
    }

    #[task(binds = UART0_TX, priority = 2, shared = [links])]
    fn uart_sent(cx: uart_sent::Context) {
        cx.shared.links.uart_sent();
    }

    #[task(binds = UART1_TX, priority = 1)]
    fn drain(_: drain::Context) {
        log::drain();
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!(
        "This is firmware. Build it for its board:\n    \
         cargo build --profile firmware -p pliant-mps2-an386 --target thumbv7em-none-eabihf"
    );
    std::process::exit(2);
}
