//! Every reader of files against files that were damaged: no panic, no hang, and no more memory than a large file may take.
//!
//! The seeds of the fuzz targets (`host/fuzz/corpus`), each damaged thousands of times, always the same. `PLIANT_SAMPLES` says how many there are of
//! each kind; longer, and led by what the code does with them: `cargo xtask fuzz`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

#[path = "../fuzz/src/lib.rs"]
mod readers;

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Damaged files of each kind.
const COUNT: usize = 10_000;
/// No file of some kilobytes takes this long, on a machine with much else to do.
const LONG: Duration = Duration::from_secs(20);
/// Nor this much memory, kB: an archive may unpack to 256 MiB.
const MOST_MEMORY: u64 = 1 << 20;

/// Values that stand for a count, a length or an offset which cannot be.
const WORDS: [u32; 8] = [0, 1, 0x7f, 0xff, 0xffff, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff];
/// Text that may stand for a number, and does not, or for one that no robot has.
const TEXTS: [&str; 14] =
    ["NaN", "inf", "-inf", "1e308", "-1e-320", "1e999", "", "-", "99999999999999999999", "0", "[", "]", "\n", ","];

fn count() -> usize {
    std::env::var("PLIANT_SAMPLES").ok().and_then(|n| n.parse().ok()).unwrap_or(COUNT)
}

/// A file with one to eight places changed.
fn damaged(file: &[u8], other: &[u8], rng: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = file.to_vec();
    for _ in 0..rng.random_range(1..=8) {
        let at = rng.random_range(0..=bytes.len());
        let end = (at + rng.random_range(0..40)).min(bytes.len());
        match rng.random_range(0..9) {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let again = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, again));
            }
            3 => {
                let from = rng.random_range(0..=other.len());
                let to = (from + rng.random_range(0..40)).min(other.len());
                drop(bytes.splice(at..end, other[from..to].iter().copied()));
            }
            4 => {
                let word = WORDS[rng.random_range(0..WORDS.len())].to_le_bytes();
                bytes.iter_mut().skip(at).zip(word).for_each(|(byte, new)| *byte = new);
            }
            5 => {
                // In the place of a number, where there is one.
                let digit = |b: &u8| b.is_ascii_digit() || b".-+e".contains(b);
                let from = bytes[at..].iter().position(|b| b.is_ascii_digit()).map_or(at, |i| at + i);
                let to = bytes[from..].iter().position(|b| !digit(b)).map_or(from, |i| from + i);
                drop(bytes.splice(from..to, TEXTS[rng.random_range(0..TEXTS.len())].bytes()));
            }
            6 => bytes.iter_mut().skip(at).take(1).for_each(|b| *b = rng.random()),
            _ => bytes.iter_mut().skip(at).take(1).for_each(|b| *b ^= 1 << rng.random_range(0..8)),
        }
    }
    bytes
}

/// The largest memory this process has had, kB, where the system says so.
fn peak() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?.split_whitespace().next()?.parse().ok()
}

fn survives(kind: &str, read: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(kind);
    let mut paths: Vec<_> = fs::read_dir(folder).expect("seeds").map(|e| e.expect("a file").path()).collect();
    paths.sort();
    let seeds: Vec<_> = paths.iter().map(|path| fs::read(path).expect("readable")).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for i in 0..count() {
        let other = &seeds[rng.random_range(0..seeds.len())];
        let bytes = damaged(&seeds[i % seeds.len()], other, &mut rng);
        let begin = Instant::now();
        let ended = std::panic::catch_unwind(|| read(&bytes));
        assert!(ended.is_ok(), "{kind} {i}: {bytes:?}");
        assert!(begin.elapsed() < LONG, "{kind} {i} took {:?}: {bytes:?}", begin.elapsed());
        if let Some(memory) = peak() {
            assert!(memory < MOST_MEMORY, "{kind} {i} took {memory} kB: {bytes:?}");
        }
    }
}

#[test]
fn csv() {
    survives("csv", readers::of_csv);
}

#[test]
fn mat() {
    survives("mat", readers::of_mat);
}

#[test]
fn npz() {
    survives("npz", readers::of_npz);
}

#[test]
fn models_of_other_tools() {
    survives("import", readers::of_import);
}

#[test]
fn models() {
    survives("model", readers::of_model);
}
