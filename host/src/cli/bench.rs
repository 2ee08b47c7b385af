//! `pliant bench`

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ValueEnum, value_parser};
use pliant_bench::Kind;
use serde_json::json;

use super::{Finished, print_json, progress};
use crate::bench::emulated::{Report, Upserts, Wanted, measure};
use crate::bench::here::{Velocity, velocities};
use crate::error::Outcome;

/// Options of `pliant bench`.
#[derive(Clone, Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct Args {
    /// Where to measure.
    #[arg(long, value_enum, default_value = "host")]
    device: Where,
    /// Ticks of each case in QEMU.
    #[arg(long, default_value = "10000", value_parser = value_parser!(u32).range(1..=20_000))]
    ticks: u32,
    /// Ticks in QEMU whose bits are compared with this machine's.
    #[arg(long, default_value = "10000", value_parser = value_parser!(u32).range(0..=1_000_000))]
    bits: u32,
    /// In QEMU, only scenes of this kind.
    #[arg(long, value_parser = PossibleValuesParser::new(Kind::ALL.map(Kind::name)).try_map(|name| kind(&name)))]
    scene: Option<Kind>,
}

fn kind(name: &str) -> Result<Kind, &'static str> {
    Kind::ALL.into_iter().find(|kind| kind.name() == name).ok_or("no such scene")
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Where {
    /// This machine: nanoseconds for one modulated velocity.
    Host,
    /// Emulated boards: instructions for one tick, and the bits of its commands.
    Qemu,
}

pub(super) fn main(args: &Args, json: bool) -> Finished {
    match args.device {
        Where::Host => {
            let velocities = velocities();
            if json {
                print_json(&json!({ "velocities": velocities }))
            } else {
                print_velocities(&velocities)
            }
            Ok(Outcome::Success)
        }
        Where::Qemu => {
            let bar = progress::bar(json);
            let report = measure(Wanted { ticks: args.ticks, bits: args.bits, scene: args.scene }, |done| {
                bar.set_message(done.to_owned());
                bar.tick();
            })?;
            bar.finish_and_clear();
            if json {
                print_json(&json!(report))
            } else {
                print_report(&report)
            }
            Ok(if report.bits.iter().all(|bits| bits.equal()) { Outcome::Success } else { Outcome::Failed })
        }
    }
}

fn print_velocities(all: &[Velocity]) {
    say!("One modulated velocity on this machine, ns (ellipsoids at rest, linear motion)\n");
    say!("  {:>9}  {:>3}  {:>6}  {:>8}  {:>8}  {:>9}", "obstacles", "dim", "scalar", "median", "99.9 %", "longest");
    for Velocity { obstacles, dimension, scalar, median, p999, worst } in all {
        say!("  {obstacles:>9}  {dimension:>3}  {scalar:>6}  {median:>8.0}  {p999:>8.0}  {worst:>9.0}");
    }
}

fn print_report(report: &Report) {
    say!("Instructions a tick, counted by QEMU; half of all positions are adverse\n");
    say!(
        "  {:10}  {:6}  {:>3}  {:>2}  {:>9}  {:10}  {:>6}  {:>7}  {:>7}  {:>7}",
        "core",
        "scalar",
        "dim",
        "K",
        "obstacles",
        "scene",
        "points",
        "median",
        "99 %",
        "longest"
    );
    for t in &report.ticks {
        for s in &t.scenes {
            say!(
                "  {:10}  {:6}  {:>3}  {:>2}  {:>9}  {:10}  {:>6}  {:>7}  {:>7}  {:>7}",
                t.core,
                t.scalar,
                t.dimension,
                t.k,
                t.obstacles,
                s.scene,
                s.points,
                s.median,
                s.p99,
                s.worst
            );
        }
    }
    if !report.upserts.is_empty() {
        say!("\nInstructions to put an obstacle into a full table\n");
        say!(
            "  {:10}  {:6}  {:>3}  {:>4}  {:10}  {:>8}  {:>8}  {:>8}",
            "core",
            "scalar",
            "dim",
            "room",
            "scene",
            "median",
            "99 %",
            "longest"
        );
    }
    for Upserts { core, scalar, dimension, room, scene, median, p99, worst, .. } in &report.upserts {
        say!("  {core:10}  {scalar:6}  {dimension:>3}  {room:>4}  {scene:10}  {median:>8}  {p99:>8}  {worst:>8}");
    }
    for b in &report.bits {
        let (same, ticks) = (if b.equal() { "the same bits as" } else { "OTHER BITS than" }, b.ticks);
        say!("\n  {} commands in {} on {}: {same} here ({} there, {} here)", ticks, b.scalar, b.core, b.board, b.host);
    }
}
