//! Proves the board without the application: what comes by a link goes back by it.
//!
//! Build it with `cargo build --profile firmware -p pliant-mps2-an386 --example echo --target thumbv7em-none-eabihf`
//! and give it to QEMU as README.md does the firmware. Over UDP a payload comes back as it is, over the serial line a
//! stuffed frame does. Three payloads are commands:
//!
//! - `?` is answered by [`Figures`](app::Figures), as little-endian `u32`;
//! - `!` panics, after a last answer of one byte;
//! - `~` reads where there is no memory: a hard fault;
//! - `#` never returns: the watchdog's business.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[rtic::app(device = pliant_mps2_an386::pac, peripherals = true)]
mod app {
    use pliant_mps2_an386::farewell::{self, Route};
    use pliant_mps2_an386::net::{Bytes, Net, Slots};
    use pliant_mps2_an386::pac::Interrupt;
    use pliant_mps2_an386::serial::Serial;
    use pliant_mps2_an386::timer::Ticker;
    use pliant_mps2_an386::watchdog::Watchdog;
    use pliant_mps2_an386::{clock, fault, log};
    use pliant_protocol::FRAME_MAX;

    /// What the tick measured.
    #[derive(Clone, Copy, Default)]
    pub struct Figures {
        /// Ticks that ran.
        ticks: u32,
        /// Ticks that were due and did not run.
        missed: u32,
        /// Milliseconds by the clock.
        millis: u32,
        /// Longest time from when a tick was due until it ran, in clocks.
        lateness: u32,
        /// Faults since power came on.
        faults: u32,
        /// Frames dropped or cut by the links.
        lost: u32,
    }

    impl Figures {
        fn bytes(self) -> [u8; 24] {
            let mut bytes = [0; 24];
            let words = [self.ticks, self.missed, self.millis, self.lateness, self.faults, self.lost];
            for (to, from) in bytes.chunks_exact_mut(4).zip(words) {
                to.copy_from_slice(&from.to_le_bytes());
            }
            bytes
        }
    }

    #[shared]
    struct Shared {
        figures: Figures,
        net: Option<Net>,
    }

    #[local]
    struct Local {
        ticker: Ticker<1000>,
        serial: Serial,
        watchdog: Watchdog,
    }

    #[init(local = [bytes: Bytes = Bytes::new(), slots: Slots = Slots::new()])]
    fn init(cx: init::Context) -> (Shared, Local) {
        clock::start(cx.device.timer1);
        log::start(cx.device.uart1);
        let last = fault::last();
        if let Some(last) = &last {
            defmt::warn!("after fault {=u32}: {=str}", last.count(), last.reason());
        }
        let net =
            Net::start(cx.device.ethernet, cx.local.bytes, cx.local.slots).inspect_err(|e| defmt::error!("{}", e)).ok();
        defmt::info!("echo");
        (
            Shared { figures: Figures { faults: last.map_or(0, |last| last.count()), ..Figures::default() }, net },
            Local {
                ticker: Ticker::start(cx.device.timer0),
                serial: Serial::start(cx.device.uart0),
                watchdog: Watchdog::start(cx.device.watchdog),
            },
        )
    }

    #[idle(local = [watchdog])]
    fn idle(cx: idle::Context) -> ! {
        loop {
            cx.local.watchdog.feed();
            cortex_m::asm::wfi();
        }
    }

    #[task(binds = TIMER0, priority = 3, local = [ticker], shared = [figures])]
    fn control(mut cx: control::Context) {
        let since = cx.local.ticker.since();
        let overdue = cx.local.ticker.acknowledge();
        cx.shared.figures.lock(|figures| {
            figures.ticks += 1;
            figures.missed += overdue;
            figures.millis = (clock::micros() / 1000) as u32;
            figures.lateness = figures.lateness.max(since);
        });
        rtic::pend(Interrupt::DUALTIMER);
    }

    #[task(binds = DUALTIMER, priority = 2, shared = [net])]
    fn replenish(mut cx: replenish::Context) {
        let waiting = cx.shared.net.lock(|net| net.as_mut().is_some_and(Net::replenish));
        if waiting {
            rtic::pend(Interrupt::ETHERNET);
        }
    }

    #[task(binds = ETHERNET, priority = 2, shared = [net, figures])]
    fn ethernet(cx: ethernet::Context) {
        let mut figures = cx.shared.figures;
        let mut net = cx.shared.net;
        net.lock(|net| {
            let Some(net) = net else { return };
            let more = net.poll();
            let mut room = [0; FRAME_MAX];
            while let Some((payload, from)) = net.receive(&mut room) {
                let lost = net.overruns() + net.dropped();
                let figures = figures.lock(|figures| {
                    figures.lost = lost;
                    *figures
                });
                let headers = match payload {
                    b"?" => net.send(&figures.bytes(), from),
                    payload => net.send(payload, from),
                };
                if let Some(headers) = headers {
                    farewell::note(Route::Udp(*headers), &[0, 41, 0]);
                }
                obey(payload);
            }
            if more {
                rtic::pend(Interrupt::ETHERNET);
            }
        });
    }

    #[task(binds = UART0_RX, priority = 2, local = [serial], shared = [figures])]
    fn uart_rx(mut cx: uart_rx::Context) {
        let mut room = [0; FRAME_MAX];
        let serial = cx.local.serial;
        serial.sent();
        while let Some(frame) = serial.receive(&mut room) {
            match frame {
                b"?" => serial.send(&cx.shared.figures.lock(|figures| *figures).bytes()),
                frame => serial.send(frame),
            }
            farewell::note(Route::Serial, &[0, 41, 0]);
            obey(frame);
        }
    }

    /// The commands that end a run.
    #[allow(clippy::panic, reason = "that is what is tried")]
    fn obey(payload: &[u8]) {
        match payload {
            b"!" => panic!("asked to"),
            b"~" => {
                // SAFETY: there is nothing at this address, so nothing is harmed: the read ends in a fault.
                let _nothing: u32 = unsafe { core::ptr::read_volatile(core::ptr::without_provenance(0xf000_0000)) };
            }
            b"#" => loop {
                core::hint::spin_loop();
            },
            _ => {}
        }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This is for the board: build it with --target thumbv7em-none-eabihf.");
}
