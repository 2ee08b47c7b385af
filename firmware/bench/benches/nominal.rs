//! The time of one nominal velocity f(x), by number of components: `cargo bench -p pliant-bench --bench nominal`.
#![allow(missing_docs, reason = "made by criterion's macros")]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use pliant_bench::Number;
use pliant_bench::skill::{COUNTS, Skill};

fn nominal<S: Number, const D: usize>(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group(format!("nominal/{}/{D}d", S::NAME));
    for components in COUNTS {
        let skill = Skill::<S, D>::new(components);
        let mut positions = skill.positions.iter().cycle();
        group.bench_function(BenchmarkId::from_parameter(components), |bencher| {
            bencher.iter(|| positions.next().map(|position| black_box(skill.velocity(black_box(position)))));
        });
    }
    group.finish();
}

criterion_group!(benches, nominal::<f64, 2>, nominal::<f32, 2>, nominal::<f64, 3>, nominal::<f32, 3>);
criterion_main!(benches);
