//! Instructions and cache misses of one modulated velocity, and of one nominal velocity, by Callgrind: the same on a busy machine as on an idle one.
//!
//! `cargo xtask bench`, which installs Valgrind and the runner of the same version as the library.
#![allow(missing_docs, reason = "made by gungraun's macros")]

use std::hint::black_box;

use gungraun::{library_benchmark, library_benchmark_group, main};
use pliant_bench::Number;
use pliant_bench::field::Field;
use pliant_bench::skill::Skill;

/// All positions of a field: what is reported is the sum over 256 of them.
fn velocities<S: Number, const D: usize>(field: &Field<S, D>) {
    for state in &field.states {
        black_box(field.velocity(black_box(state)));
    }
}

#[library_benchmark]
#[benches::obstacles(args = [1, 2, 5, 10, 20, 50], setup = Field::<f64, 2>::new)]
fn planar_f64(field: Field<f64, 2>) {
    velocities(&field);
}

#[library_benchmark]
#[benches::obstacles(args = [1, 2, 5, 10, 20, 50], setup = Field::<f32, 2>::new)]
fn planar_f32(field: Field<f32, 2>) {
    velocities(&field);
}

#[library_benchmark]
#[benches::obstacles(args = [1, 2, 5, 10, 20, 50], setup = Field::<f64, 3>::new)]
fn spatial_f64(field: Field<f64, 3>) {
    velocities(&field);
}

#[library_benchmark]
#[benches::obstacles(args = [1, 2, 5, 10, 20, 50], setup = Field::<f32, 3>::new)]
fn spatial_f32(field: Field<f32, 3>) {
    velocities(&field);
}

/// All positions of a skill: the sum over 256 of them.
fn nominal_velocities<S: Number, const D: usize>(skill: &Skill<S, D>) {
    for position in &skill.positions {
        black_box(skill.velocity(black_box(position)));
    }
}

#[library_benchmark]
#[benches::components(args = [1, 8, 16], setup = Skill::<f64, 2>::new)]
fn nominal_planar_f64(skill: Skill<f64, 2>) {
    nominal_velocities(&skill);
}

#[library_benchmark]
#[benches::components(args = [1, 8, 16], setup = Skill::<f32, 2>::new)]
fn nominal_planar_f32(skill: Skill<f32, 2>) {
    nominal_velocities(&skill);
}

#[library_benchmark]
#[benches::components(args = [1, 8, 16], setup = Skill::<f64, 3>::new)]
fn nominal_spatial_f64(skill: Skill<f64, 3>) {
    nominal_velocities(&skill);
}

#[library_benchmark]
#[benches::components(args = [1, 8, 16], setup = Skill::<f32, 3>::new)]
fn nominal_spatial_f32(skill: Skill<f32, 3>) {
    nominal_velocities(&skill);
}

library_benchmark_group!(name = modulated; benchmarks = planar_f64, planar_f32, spatial_f64, spatial_f32);
library_benchmark_group!(
    name = nominal;
    benchmarks = nominal_planar_f64, nominal_planar_f32, nominal_spatial_f64, nominal_spatial_f32
);
main!(library_benchmark_groups = modulated, nominal);
