//! How long one modulated velocity takes, and how long it takes at worst: every call is timed by itself.
//!
//! `cargo bench -p pliant-bench --bench percentiles`. What reading the clock costs is found first and left out. The tail of
//! single calls is partly the machine's; *slowest position* is the largest of all positions' medians, which is the method's own.

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
        "{:>6} {:>3} {:>9} {:>11} {:>9} {:>9} {:>9} {:>16}",
        "scalar", "dim", "obstacles", "median, ns", "p99", "p99.9", "worst", "slowest position"
    );
    series::<f64, 2>(calls);
    series::<f32, 2>(calls);
    series::<f64, 3>(calls);
    series::<f32, 3>(calls);
}

fn series<S: Number, const D: usize>(calls: usize) {
    for obstacles in COUNTS {
        let field = Field::<S, D>::new(obstacles);
        let reading = percentile(&sorted(&times(calls, || ())), 500);
        let mut states = field.states.iter().cycle();
        let all = times(calls, || {
            if let Some(state) = states.next() {
                black_box(field.velocity(black_box(state)));
            }
        });
        // What the machine does besides strikes any call; what a position costs, it costs each time.
        let slowest = (0..field.states.len().min(calls))
            .map(|first| sorted(&all.iter().copied().skip(first).step_by(field.states.len()).collect::<Vec<_>>()))
            .map(|own| percentile(&own, 500).saturating_sub(reading))
            .max()
            .unwrap_or_default();
        let all = sorted(&all);
        let [median, p99, p999, worst] = [500, 990, 999, 1000].map(|p| percentile(&all, p).saturating_sub(reading));
        println!("{:>6} {D:>3} {obstacles:>9} {median:>11} {p99:>9} {p999:>9} {worst:>9} {slowest:>16}", S::NAME);
    }
}

/// What each of so many calls takes, ns.
fn times(calls: usize, mut call: impl FnMut()) -> Vec<u64> {
    (0..calls)
        .map(|_| {
            let start = Instant::now();
            call();
            u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX)
        })
        .collect()
}

fn sorted(times: &[u64]) -> Vec<u64> {
    let mut sorted = times.to_vec();
    sorted.sort_unstable();
    sorted
}

fn percentile(sorted: &[u64], thousandths: usize) -> u64 {
    sorted.get((sorted.len() * thousandths / 1000).min(sorted.len() - 1)).copied().unwrap_or_default()
}
