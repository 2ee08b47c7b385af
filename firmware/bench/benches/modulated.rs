//! The time of one modulated velocity, by number of obstacles: `cargo bench -p pliant-bench --bench modulated`.
#![allow(missing_docs, reason = "made by criterion's macros")]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use pliant_bench::Number;
use pliant_bench::field::{COUNTS, Field};

fn modulated<S: Number, const D: usize>(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group(format!("modulated/{}/{D}d", S::NAME));
    for obstacles in COUNTS {
        let field = Field::<S, D>::new(obstacles);
        let mut states = field.states.iter().cycle();
        group.bench_function(BenchmarkId::from_parameter(obstacles), |bencher| {
            bencher.iter(|| states.next().map(|state| black_box(field.velocity(black_box(state)))));
        });
    }
    group.finish();
}

criterion_group!(benches, modulated::<f64, 2>, modulated::<f32, 2>, modulated::<f64, 3>, modulated::<f32, 3>);
criterion_main!(benches);
