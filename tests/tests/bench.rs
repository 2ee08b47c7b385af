//! Commands of the boards have the bits of this machine's, over every shape, motion and kind of scene; and the bench says what it measured.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

use pliant_tests::programs;

/// Ticks whose bits are compared, on each board.
const BITS: u64 = 100_000;

#[test]
fn boards_compute_the_same_bits_and_count_instructions() {
    let folder = std::env::temp_dir();
    let bits = BITS.to_string();
    let arguments = ["bench", "--device", "qemu", "--ticks", "50", "--bits", &bits, "--json"];
    let ended = programs::run(&folder, arguments).unwrap();
    assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
    let report = ended.json();
    let compared = report["bits"].as_array().unwrap();
    assert_eq!(compared.len(), 2, "{report}");
    for bits in compared {
        assert_eq!(bits["ticks"], BITS);
        assert_eq!(bits["board"], bits["host"]);
    }
    // Every case that is asked for is there, and more obstacles take longer.
    let ticks = report["ticks"].as_array().unwrap();
    let typical = |core: &str, dimension: u64, obstacles: u64| {
        let case =
            |t: &&serde_json::Value| t["core"] == core && t["dimension"] == dimension && t["obstacles"] == obstacles;
        ticks.iter().find(case).unwrap()["instructions_per_tick"].as_u64().unwrap()
    };
    let planar = [0, 8, 16, 64].map(|n| typical("Cortex-M4F", 2, n));
    assert!(planar.is_sorted() && planar[0] > 500 && planar[0] < 3000, "{planar:?}");
    assert!(typical("Cortex-M4F", 3, 0) < typical("Cortex-M4F", 3, 16));
    assert!(typical("Cortex-M0", 2, 0) < typical("Cortex-M0", 2, 8));
    let upserts = report["upserts"].as_array().unwrap();
    assert_eq!(upserts.len(), 8, "{report}");
    assert!(upserts.iter().all(|u| u["worst"].as_u64() >= u["median"].as_u64() && u["median"].as_u64() > Some(100)));
    assert!(ticks.iter().all(|t| t["worst"].as_u64() >= t["instructions_per_tick"].as_u64()));
}

/// Counted, so the same on every machine: a tick among ellipsoids stays within what was aimed at, in each of its 10 000.
#[test]
fn a_tick_among_ellipsoids_takes_no_more_than_aimed_at() {
    let folder = std::env::temp_dir();
    let ended = programs::run(&folder, ["bench", "--device", "qemu", "--scene", "ellipsoids", "--bits", "0", "--json"])
        .unwrap();
    assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
    let report = ended.json();
    for (core, obstacles, most) in [("Cortex-M4F", 16, 9_000), ("Cortex-M4F", 64, 25_000), ("Cortex-M0", 8, 60_000)] {
        let case = |t: &&serde_json::Value| t["core"] == core && t["dimension"] == 2 && t["obstacles"] == obstacles;
        let ticks = report["ticks"].as_array().unwrap().iter().find(case).unwrap();
        assert_eq!(ticks["scenes"][0]["ticks"], 10_000);
        assert!(ticks["worst"].as_u64().unwrap() <= most, "{ticks}");
    }
}
