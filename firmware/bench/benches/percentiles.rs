//! How long one modulated velocity takes, and how long it takes at worst: every call is timed by itself.
//!
//! `cargo bench -p pliant-bench --bench percentiles`. What reading the clock costs is found first and left out.

use std::hint::black_box;
use std::time::Instant;

use pliant_bench::Number;
use pliant_bench::field::{COUNTS, Field};

/// Calls that are timed for each line.
const CALLS: usize = 1_000_000;

fn main() {
    // `cargo test` runs benches too, to see that they run.
    let calls = if std::env::args().any(|a| a == "--bench") { CALLS } else { 100 };
    println!(
        "{:>6} {:>3} {:>9} {:>11} {:>9} {:>9} {:>9}",
        "scalar", "dim", "obstacles", "median, ns", "p99", "p99.9", "worst"
    );
    series::<f64, 2>(calls);
    series::<f32, 2>(calls);
    series::<f64, 3>(calls);
    series::<f32, 3>(calls);
}

fn series<S: Number, const D: usize>(calls: usize) {
    for obstacles in COUNTS {
        let field = Field::<S, D>::new(obstacles);
        let reading = percentile(&times(calls, || ()), 500);
        let mut states = field.states.iter().cycle();
        let all = times(calls, || {
            if let Some(state) = states.next() {
                black_box(field.velocity(black_box(state)));
            }
        });
        let [median, p99, p999, worst] = [500, 990, 999, 1000].map(|p| percentile(&all, p).saturating_sub(reading));
        println!("{:>6} {D:>3} {obstacles:>9} {median:>11} {p99:>9} {p999:>9} {worst:>9}", S::NAME);
    }
}

/// What each of so many calls takes, ns, sorted.
fn times(calls: usize, mut call: impl FnMut()) -> Vec<u64> {
    let mut all: Vec<u64> = (0..calls)
        .map(|_| {
            let start = Instant::now();
            call();
            u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX)
        })
        .collect();
    all.sort_unstable();
    all
}

fn percentile(sorted: &[u64], thousandths: usize) -> u64 {
    sorted.get((sorted.len() * thousandths / 1000).min(sorted.len() - 1)).copied().unwrap_or_default()
}
