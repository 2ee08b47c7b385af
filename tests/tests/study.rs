//! The paper's studies, short: what `pliant study` says, that it says the same again, and that devices agree.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

use std::fs;
use std::path::{Path, PathBuf};

use pliant_tests::programs::{self, lasa};
use serde_json::Value;

/// Percentage points between a figure of the paper's and the same measured here.
const TOLERANCE: f64 = 3.0;

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("pliant-study-{name}-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn study(folder: &Path, arguments: &[&str]) -> Value {
    let all = ["study"].iter().chain(arguments).chain(&["--json"]);
    let ended = programs::run(folder, all).unwrap();
    assert_eq!(ended.code, Some(0), "{arguments:?}: {}{}", ended.stdout, ended.stderr);
    ended.json()
}

/// A MATLAB v5 file, not compressed: an element is its kind, its length and its bytes, filled up to eight.
mod mat {
    fn element(kind: u32, bytes: &[u8]) -> Vec<u8> {
        let mut all = [kind.to_le_bytes(), u32::try_from(bytes.len()).unwrap().to_le_bytes()].concat();
        all.extend(bytes);
        all.resize(all.len().next_multiple_of(8), 0);
        all
    }

    fn matrix(name: &str, class: u8, size: [i32; 2], body: &[u8]) -> Vec<u8> {
        let flags = element(6, &[class, 0, 0, 0, 0, 0, 0, 0]);
        let size = element(5, &size.map(i32::to_le_bytes).concat());
        element(14, &[flags, size, element(1, name.as_bytes()), body.to_vec()].concat())
    }

    fn doubles(rows: i32, columns: &[f64]) -> Vec<u8> {
        let bytes: Vec<u8> = columns.iter().flat_map(|x| x.to_le_bytes()).collect();
        matrix("", 6, [rows, i32::try_from(columns.len()).unwrap() / rows], &element(9, &bytes))
    }

    /// Demonstrations of the plane as LASA's: a cell `demos` of structs with `pos` and `t`; of each the times (s) and the places.
    pub fn demonstrations(all: &[(Vec<f64>, Vec<[f64; 2]>)]) -> Vec<u8> {
        let one = |(t, at): &(Vec<f64>, Vec<[f64; 2]>)| {
            let names = [(4_u32 << 16) | 5, 8].map(u32::to_le_bytes).concat();
            let names = [names, element(1, b"pos\0\0\0\0\0t\0\0\0\0\0\0\0")].concat();
            matrix("", 2, [1, 1], &[names, doubles(2, &at.concat()), doubles(1, t)].concat())
        };
        let cells: Vec<u8> = all.iter().flat_map(one).collect();
        let mut file = vec![b' '; 124];
        file[..10].copy_from_slice(b"MATLAB 5.0");
        file.extend([0, 1, b'I', b'M']);
        file.extend(matrix("demos", 1, [1, i32::try_from(all.len()).unwrap()], &cells));
        file
    }
}

/// Our own demonstrations as a folder of the LASA set, in centimetres, all but the S-shape's as fast as they were shown, that so many times slower.
fn as_lasa(folder: &Path, slower: f64) {
    for (skill, file, slower) in [("sbend", "Sshape", slower), ("arch", "Angle", 1.0), ("hook", "Leaf_1", 1.0)] {
        let read = |i: u32| {
            let text = fs::read_to_string(programs::root().join(format!("demos/{skill}/{skill}-{i}.csv"))).unwrap();
            let rows =
                text.lines().skip(1).map(|l| l.split(',').map(|x| x.parse::<f64>().unwrap()).collect::<Vec<_>>());
            rows.map(|r| (r[0] * slower, [r[1] * 100.0, r[2] * 100.0])).unzip()
        };
        let all: Vec<(Vec<f64>, Vec<[f64; 2]>)> = (1..=3).map(read).collect();
        fs::write(folder.join(format!("{file}.mat")), mat::demonstrations(&all)).unwrap();
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// What must hold on any motion.
fn check_claims(found: &Value) {
    let claims = &found["claims"];
    assert!((number(&claims["soft_region_speed_gain_percent"]) - 26.34).abs() <= TOLERANCE, "{claims}");
    assert!((number(&claims["intersection_speed_change_percent"]) + 32.32).abs() <= TOLERANCE, "{claims}");
    let cases = found["cases"].as_object().unwrap();
    assert_eq!(cases.keys().collect::<Vec<_>>(), ["A1", "A2", "A3", "B1", "B2", "B3", "B4", "C1", "D1"]);
    for (id, case) in cases {
        assert_eq!((&case["reached"], &case["touched"]), (&true.into(), &false.into()), "{id}: {case}");
        assert!(number(&case["min_gamma"]) > 1.0 && number(&case["time_s"]) > 1.0, "{id}: {case}");
        let ours = ["A1", "B1", "C1", "D1"].contains(&id.as_str());
        assert_eq!(case["column"], if ours { "pliant" } else { "original" });
        assert_eq!(case["letter"].is_object(), ours, "{id}: what the paper's text gives stands beside it");
    }
    // What is measured of smoothness is the obstacle's doing: with a soft layer that the method knows of another figure than without.
    let jump = |id: &str| number(&cases[id]["largest_velocity_jump"]);
    assert!(jump("A1") > 0.0 && jump("A1") != jump("A3") && jump("B1") != jump("B3"), "{} {}", jump("A1"), jump("A3"));
    let off = |id: &str| number(&cases[id]["mean_deviation_m"]);
    assert!(off("A1") < off("A2"), "{} against {}", off("A1"), off("A2"));
    assert!(number(&cases["A1"]["mean_speed_soft"]) > number(&cases["A3"]["mean_speed_soft"]));
    assert!(number(&cases["B1"]["mean_speed_intersection"]) < number(&cases["B3"]["mean_speed_intersection"]));
}

/// The whole study, with fewer random places.
fn check_paper(found: &Value, files: &Path, places: u64) {
    check_claims(found);
    let times = found["claims"]["time_vs_k"].as_array().unwrap();
    assert_eq!(times.len(), 7);
    for pair in times.windows(2) {
        assert!(
            number(&pair[1]["k"]) > number(&pair[0]["k"]) && number(&pair[1]["mean_s"]) < number(&pair[0]["mean_s"])
        );
    }
    assert!(times.iter().all(|t| t["arrived"] == 25), "{times:?}");
    let reduction = &found["claims"]["time_reduction_percent"];
    assert!(number(&reduction["max"]) > number(&reduction["mean"]) && number(&reduction["mean"]) > 0.0, "{reduction}");
    assert!(number(&reduction["through_the_layer"]["mean"]) > number(&reduction["mean"]), "{reduction}");
    assert!(number(&reduction["rank_correlation_with_min_gamma"]) < -0.5, "{reduction}");
    for row in found["trajectories"].as_array().unwrap().iter().filter(|r| r["column"] == "pliant") {
        assert_eq!(row["reached"], row["starts"], "{row}");
        assert_eq!(row["touched"], 0, "{row}");
    }
    let placements = &found["placements"];
    assert_eq!(placements["count"], places);
    let sum = |column: &str, what: &str| {
        let of = &placements[column][what];
        number(&of["left"]) + number(&of["right"])
    };
    assert_eq!(sum("pliant", "penetrated"), 0.0, "{placements}");
    // The default stays out of cores by its velocity; the guard keeps the letter out, but does not make it arrive.
    let ablation = &placements["ablation"];
    let of = |column: &str, guard: &str, what: &str| number(&ablation[column][guard][what]);
    for column in ["letter", "pliant", "original"] {
        assert_eq!(of(column, "with_guard", "penetrated"), 0.0, "{ablation}");
        let own = if column == "pliant" { "with_guard" } else { "without_guard" };
        assert_eq!(of(column, own, "penetrated"), sum(column, "penetrated"), "{ablation}");
        assert_eq!(of(column, own, "would_stall"), sum(column, "would_stall"), "{ablation}");
    }
    assert_eq!(of("pliant", "without_guard", "penetrated"), 0.0, "{ablation}");
    assert!(of("letter", "with_guard", "not_reached") > 0.0, "{ablation}");
    assert!(sum("letter", "would_stall") <= sum("letter", "penetrated") + sum("letter", "stalled"), "{placements}");
    assert!(sum("letter", "slower") > 5.0 * sum("pliant", "slower") + 1.0, "{placements}");
    assert!(sum("letter", "penetrated") > 0.0, "{placements}");
    let jump = |column: &str| number(&placements[column]["velocity_jump"]["p95"]);
    assert!(jump("pliant") < jump("letter"), "{placements}");
    for verdict in found["verdicts"].as_array().unwrap() {
        assert!(verdict["holds"].is_boolean() && verdict["vital"].is_boolean() && verdict["measured"].is_string());
    }
    let report = fs::read_to_string(files.join("report.md")).unwrap();
    for name in [
        "trajectories",
        "time",
        "experiments-a",
        "experiments-b",
        "velocities",
        "experiment-c",
        "experiment-d",
        "placements",
        "angles",
    ] {
        assert!(report.contains(&format!("({name}.png)")), "{name}");
        assert!(fs::read(files.join(format!("{name}.png"))).unwrap().len() > 5000);
        assert!(fs::read_to_string(files.join(format!("{name}.svg"))).unwrap().starts_with("<svg"));
    }
    for name in [
        "placements-ablation",
        "claims",
        "experiments",
        "time-vs-k",
        "time-reduction",
        "trajectories",
        "placements",
        "speed-spread",
    ] {
        assert!(fs::read_to_string(files.join(format!("{name}.csv"))).unwrap().lines().count() > 2, "{name}");
    }
}

#[test]
fn the_paper_on_our_own_motions_twice_the_same() {
    let folder = folder("own");
    let mut found = ["one", "two"].map(|to| study(&folder, &["paper", "--placements", "60", "-o", to, "--seed", "4"]));
    for one in &mut found {
        one["folder"] = Value::Null;
    }
    assert_eq!(found[0], found[1], "the same seed, the same findings");
    assert_eq!(found[0]["data"], "own");
    check_paper(&found[0], &folder.join("one"), 60);
    // The exit code was 0, though a claim fails that is not vital: at one place of our own the sign is another one.
    let fails = |v: &&Value| v["holds"] == false;
    let failed: Vec<&Value> = found[0]["verdicts"].as_array().unwrap().iter().filter(fails).collect();
    assert!(!failed.is_empty() && failed.iter().all(|v| v["vital"] == false), "{failed:?}");
    let files = |to: &str| fs::read(folder.join(to).join("experiments-b.svg")).unwrap();
    assert_eq!(files("one"), files("two"));
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_scene_of_an_experiment_runs_by_itself() {
    let folder = folder("scenes");
    study(&folder, &["experiments", "-o", "out"]);
    let names = |of: &str| -> Vec<String> {
        let all = fs::read_dir(folder.join("out").join(of)).unwrap();
        all.map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
    };
    let (scenes, models) = (names("scenes"), names("models"));
    assert!(scenes.len() == 13 && models.len() == 2, "{scenes:?} {models:?}");
    let scene = folder.join("out/scenes/A1-pliant.toml");
    let ended = programs::run(&folder, ["run", scene.to_str().unwrap(), "--stepped", "--headless", "--json"]).unwrap();
    assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
    assert_eq!(ended.json()["reached"], true);
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_firmware_in_qemu_drives_experiments_bit_for_bit_like_the_virtual_device() {
    let folder = folder("qemu");
    let found = study(&folder, &["experiments", "-o", "out", "--device", "qemu"]);
    let devices = found["devices"].as_array().unwrap();
    assert_eq!(devices.iter().map(|d| d["case"].as_str().unwrap()).collect::<Vec<_>>(), ["A1", "B1", "D1"]);
    for d in devices {
        assert!(d["device"].as_str().unwrap().contains("mps2-an386"), "{d}");
        assert_eq!((&d["identical"], &d["reached"]), (&true.into(), &true.into()), "{d}");
        assert!(d["ticks"].as_u64().unwrap() > 1000 && number(&d["min_gamma"]) > 1.0, "{d}");
        // f32 there, f64 here: the same path but for rounding.
        assert!(number(&d["apart_m"]) < 1e-4, "{d}");
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_paper_on_lasa_handwriting() {
    let Some(data) = lasa() else {
        // Not by println!, which the test harness keeps to itself.
        let note = b"SKIPPED: the_paper_on_lasa_handwriting: no LASA motions here (set PLIANT_LASA to their folder)\n";
        std::io::Write::write_all(&mut std::io::stderr(), note).unwrap();
        return;
    };
    let folder = folder("lasa");
    let found = study(&folder, &["paper", "--data", data.to_str().unwrap(), "--placements", "60", "-o", "out"]);
    assert_eq!(found["data"], "lasa");
    check_paper(&found, &folder.join("out"), 60);
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_vital_claim_that_fails_is_exit_code_1() {
    let folder = folder("fails");
    let run = |slower: f64, json: bool| {
        as_lasa(&folder, slower);
        let arguments =
            ["study", "trajectories", "--data", ".", "-o", "out"].into_iter().chain(json.then_some("--json"));
        programs::run(&folder, arguments).unwrap()
    };
    let well = run(1.0, true);
    assert_eq!((well.code, &well.json()["verdicts"][0]["holds"]), (Some(0), &true.into()), "{}", well.stderr);
    // Some minutes for a motion that is given up after half a minute: it does not arrive.
    let failed = run(60.0, true);
    let found = failed.json();
    assert_eq!(failed.code, Some(1), "{}{}", failed.stdout, failed.stderr);
    assert_eq!(
        (&found["verdicts"][0]["holds"], &found["verdicts"][0]["vital"]),
        (&false.into(), &true.into()),
        "{found}"
    );
    let rows = found["trajectories"].as_array().unwrap().iter().filter(|r| r["column"] == "pliant");
    let missed: Vec<&Value> = rows.filter(|r| number(&r["reached"]) < number(&r["starts"])).collect();
    assert!(!missed.is_empty() && missed.iter().all(|r| r["skill"] == "S-shape"), "{missed:?}");
    let claims = fs::read_to_string(folder.join("out/claims.csv")).unwrap();
    assert!(claims.lines().nth(1).unwrap().ends_with(",NO,yes"), "{claims}");
    let said = run(60.0, false);
    assert_eq!(said.code, Some(1));
    assert!(said.stdout.contains("  FAILS   every motion") && said.stdout.contains("exit code (1)"), "{}", said.stdout);
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_study_that_cannot_be_leaves_no_folder() {
    let folder = folder("traces");
    fs::create_dir_all(folder.join("empty")).unwrap();
    fs::create_dir_all(folder.join("there")).unwrap();
    for part in ["paper", "trajectories", "time", "experiments", "placements", "lasa"] {
        for out in ["new/out", "there"] {
            let ended = programs::run(&folder, ["study", part, "--data", "empty", "-o", out]).unwrap();
            assert_eq!(ended.code, Some(2), "{part}: {}{}", ended.stdout, ended.stderr);
        }
        assert!(!folder.join("new").exists(), "{part}");
        assert_eq!(fs::read_dir(folder.join("there")).unwrap().count(), 0, "{part}: what was there stays, empty");
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn help_says_which_parts_take_a_device() {
    let folder = folder("help");
    let help = programs::run(&folder, ["study", "--help"]).unwrap().stdout;
    for part in ["paper", "trajectories", "time", "experiments", "placements"] {
        let takes = programs::run(&folder, ["study", part, "--help"]).unwrap().stdout.contains("--device <DEVICE>");
        let line = help.lines().find(|l| l.trim_start().starts_with(part)).unwrap();
        let says = if takes { "takes --device" } else { "without --device" };
        assert!(line.contains(says), "{part}: {line}");
        assert_eq!(takes, ["paper", "experiments"].contains(&part), "{part}");
    }
    let learns = programs::run(&folder, ["study", "lasa", "--help"]).unwrap().stdout;
    assert!(learns.contains("Usage: pliant study lasa [OPTIONS] --data <DIR>"), "{learns}");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_folder_without_the_motions_is_bad_input_that_names_the_file() {
    let folder = folder("none");
    let ended = programs::run(&folder, ["study", "time", "--data", ".", "--json"]).unwrap();
    assert_eq!(ended.code, Some(2));
    assert!(ended.json()["error"]["message"].as_str().unwrap().contains(".mat"), "{}", ended.stdout);
    let help = ended.json()["error"]["help"].as_str().unwrap().to_owned();
    assert!(["Sshape.mat", "Angle.mat", "Leaf_1.mat"].iter().all(|file| help.contains(file)), "{help}");
    assert!(!folder.join("out").exists(), "nothing was found, so there is nothing to look at");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_folder_that_cannot_be_written_to_is_bad_input_at_once() {
    let folder = folder("unwritable");
    fs::write(folder.join("file"), "").unwrap();
    for arguments in [&["study", "paper"][..], &["study", "lasa", "--data", "."]] {
        let ended = programs::run(&folder, arguments.iter().chain(&["-o", "file/out", "--json"])).unwrap();
        assert_eq!(ended.code, Some(2));
        assert!(
            ended.json()["error"]["message"].as_str().unwrap().contains("cannot be written to"),
            "{}",
            ended.stdout
        );
    }
    fs::remove_dir_all(folder).unwrap();
}
