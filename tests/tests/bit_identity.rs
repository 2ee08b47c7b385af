//! Every velocity from the firmware in QEMU has the bits of the virtual device's, for the same inputs; and every run does its job.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

use std::fs;
use std::path::{Path, PathBuf};

use pliant_tests::programs::{self, lasa, root};
use serde_json::Value;

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("pliant-bits-{name}-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn stepped(folder: &Path, scene: &Path, device: &str) -> Value {
    let scene = scene.to_str().unwrap();
    let ended = programs::run(folder, ["run", scene, "--device", device, "--stepped", "--headless", "--json"]).unwrap();
    assert_eq!(ended.code, Some(0), "{scene} on {device}: {}{}", ended.stdout, ended.stderr);
    ended.json()
}

/// Runs a scene on both devices; the velocities must agree to the last bit.
fn same_bits(folder: &Path, scene: &Path) {
    let (here, there) = (stepped(folder, scene, "virtual"), stepped(folder, scene, "qemu"));
    assert_eq!(there["board"], "mps2-an386");
    assert_eq!(here["runs"], there["runs"], "{}", scene.display());
    assert_eq!(here["reached"], true);
    assert!(here["min_gamma"].as_f64().unwrap() > 1.0);
    assert!(here["ticks"].as_u64().unwrap() > 500, "{here}");
    for run in here["runs"].as_array().unwrap() {
        assert_eq!(run["velocities_crc32c"].as_str().unwrap().len(), 8);
    }
    let (ticks, checksum) = (&here["ticks"], &here["runs"][0]["velocities_crc32c"]);
    println!("{}: {ticks} ticks, velocities {checksum}", scene.display());
}

#[test]
fn own_skills_and_every_shipped_scene() {
    let folder = folder("own");
    let mut scenes: Vec<_> = fs::read_dir(root().join("scenes")).unwrap().map(|e| e.unwrap().path()).collect();
    scenes.retain(|p| p.extension().is_some_and(|e| e == "toml"));
    assert!(scenes.len() >= 6);
    for scene in scenes {
        same_bits(&folder, &scene);
    }
    fs::remove_dir_all(folder).unwrap();
}

/// A 4 cm core in a 6 cm shell on the path of a LASA motion, where the motion is halfway.
#[test]
fn lasa_motions_past_a_foam_cylinder() {
    let Some(data) = lasa() else {
        // Not by println!, which the test harness keeps to itself.
        let note =
            b"SKIPPED: lasa_motions_past_a_foam_cylinder: no LASA motions here (set PLIANT_LASA to their folder)\n";
        std::io::Write::write_all(&mut std::io::stderr(), note).unwrap();
        return;
    };
    let folder = folder("lasa");
    // Starts of the demonstrations and a point on the path, m, at ten times the size of the handwriting.
    for (name, start, center) in [
        ("Sshape", [0.367, 0.410], [0.20, 0.21]),
        ("Angle", [-0.41, 0.015], [-0.10, 0.26]),
        ("Leaf_1", [-0.23, 0.30], [-0.36, 0.12]),
    ] {
        let mat = data.join(format!("{name}.mat"));
        let model = folder.join(format!("{name}.toml"));
        let ended = programs::run(&folder, ["learn", mat.to_str().unwrap(), "-o", model.to_str().unwrap()]).unwrap();
        assert_eq!(ended.code, Some(0), "{name}: {}", ended.stderr);
        let scene = folder.join(format!("{name}-foam.toml"));
        let text = format!(
            "[ds]\nmodel = \"{name}.toml\"\n[[start]]\nposition = {start:?}\n[[obstacle]]\nname = \"foam cylinder\"\n\
             shape = {{ ellipsoid = [0.04, 0.04] }}\nsoft = [0.06, 0.06]\ncenter = {center:?}\n"
        );
        fs::write(&scene, text).unwrap();
        same_bits(&folder, &scene);
    }
    fs::remove_dir_all(folder).unwrap();
}
