//! The digests that a board prints, computed here: `cargo run --release -p pliant-bench --example bits -- [ticks]`.

use pliant_bench::{Number, bits};
use pliant_core::scalar::Fixed;

fn main() {
    let ticks = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(100_000);
    print::<f32>(ticks);
    print::<Fixed>(ticks);
}

fn print<S: Number>(ticks: u32) {
    let scalar = S::NAME;
    let digest = bits::run::<S>(ticks, |block, digest| {
        println!(r#"{{"block":{block},"scalar":"{scalar}","core":"host","digest":"{digest:016x}"}}"#);
    });
    println!(r#"{{"bits":{ticks},"scalar":"{scalar}","core":"host","digest":"{digest:016x}"}}"#);
}
