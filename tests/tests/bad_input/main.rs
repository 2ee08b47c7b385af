//! What is wrong gets one clear message - file, line, field, what is allowed - and exit 2, never a panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod outputs;
mod skills;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use pliant_tests::programs::{self, Ended, root};

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        // Tests run side by side, and two may choose one name.
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let (process, count) = (std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(format!("pliant-bad-{name}-{process}-{count}"));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }
    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.0.join(name), bytes).unwrap();
    }
    fn run(&self, arguments: &[&str]) -> Ended {
        programs::run(&self.0, arguments).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Exit 2, all the words on stderr, nothing on stdout, no panic; and with `--json` one object that has them too.
fn refused(folder: &Folder, arguments: &[&str], words: &[&str]) {
    let ended = folder.run(arguments);
    let (out, said) = (&ended.stdout, &ended.stderr);
    assert_eq!(ended.code, Some(2), "{arguments:?}: {out}{said}");
    assert!(!said.contains("panicked"), "{arguments:?}: {said}");
    assert!(out.is_empty(), "{arguments:?}: {out}");
    // Messages may be wrapped to the width of a screen.
    let flat = said.split_whitespace().filter(|w| *w != "│").collect::<Vec<_>>().join(" ");
    for word in words {
        assert!(flat.contains(word), "{arguments:?} does not say `{word}`:\n{said}");
    }
    let mut with_json = arguments.to_vec();
    with_json.push("--json");
    let ended = folder.run(&with_json);
    assert_eq!(ended.code, Some(2));
    assert_eq!(ended.json()["error"]["exit"], 2, "{}", ended.stdout);
}

const SCENE: &str = "\
[ds]
linear = { attractor = [0.0, 0.0], gain = 1.0 }
[modulation]
c = 0.03
[limits]
speed = 0.5
[[start]]
position = [0.5, 0.0]
[[obstacle]]
name = \"foam\"
shape = { ellipsoid = [0.04, 0.04] }
center = [0.25, 0.01]
stiffness = 1.6487
";

#[test]
fn scenes() {
    let folder = Folder::new("scene");
    folder.write("good.toml", SCENE);
    assert_eq!(folder.run(&["run", "good.toml", "--stepped", "--headless"]).code, Some(0));
    // What is replaced, by what, the line at fault, and words of the message.
    let cases: &[(&str, &str, usize, &[&str])] = &[
        ("speed = 0.5", "spede = 0.5", 6, &["spede", "speed"]),
        ("speed = 0.5", "speed = \"fast\"", 6, &["speed", "number"]),
        ("speed = 0.5", "speed = nan", 6, &["speed"]),
        ("speed = 0.5", "speed = 0", 6, &["speed", "above 0"]),
        ("c = 0.03", "c = inf", 4, &["c"]),
        ("[limits]", "[limitz]", 5, &["limitz", "limits"]),
        ("stiffness = 1.6487", "stiffness = 0.9", 13, &["stiffness", "1"]),
        ("stiffness = 1.6487", "stiffness = 1.5\nlayer = 0.02", 14, &["stiffness", "layer"]),
        ("[0.04, 0.04]", "[0.04, 0.0]", 11, &["ellipsoid"]),
        ("[0.04, 0.04]", "[0.04, -0.04]", 11, &["ellipsoid"]),
        ("[0.04, 0.04]", "[0.04, 0.04, 0.04]", 11, &["ellipsoid", "2"]),
        ("ellipsoid", "pyramid", 11, &["pyramid", "ellipsoid"]),
        ("stiffness = 1.6487", "curvature = 0", 13, &["curvature"]),
        ("stiffness = 1.6487", "rotation = [1.0, 0.0, 0.0, 0.0]", 13, &["rotation"]),
        ("stiffness = 1.6487", "reference = [0.05, 0.0]", 13, &["reference", "core"]),
        ("stiffness = 1.6487", "margin = [0.5, 1.0]", 13, &["margin"]),
        ("center = [0.25, 0.01]", "center = [0.0, 0.01]", 12, &["center", "attractor", "core"]),
        ("center = [0.25, 0.01]", "center = [0.5, 0.01]", 8, &["position", "core"]),
        ("position = [0.5, 0.0]", "position = [0.5, nan]", 8, &["position"]),
        ("position = [0.5, 0.0]", "position = [5000.0, 0.0]", 8, &["position", "1000"]),
        ("c = 0.03", "c = = 0.03", 4, &[]),
        ("linear = { attractor = [0.0, 0.0], gain = 1.0 }", "model = \"nowhere.toml\"", 2, &["nowhere.toml"]),
    ];
    for (from, to, line, words) in cases {
        assert!(SCENE.contains(from), "{from}");
        folder.write("bad.toml", SCENE.replacen(from, to, 1));
        let place = format!("bad.toml, line {line}");
        let mut all = vec![place.as_str()];
        all.extend_from_slice(words);
        refused(&folder, &["run", "bad.toml", "--stepped", "--headless"], &all);
    }
    // A rotation that is none, in space where there are rotations.
    let spatial = SCENE
        .replace("[0.0, 0.0]", "[0.0, 0.0, 0.0]")
        .replace("[0.5, 0.0]", "[0.5, 0.0, 0.0]")
        .replace("[0.04, 0.04]", "[0.04, 0.04, 0.04]")
        .replace("[0.25, 0.01]", "[0.25, 0.01, 0.0]");
    folder.write("bad.toml", format!("{spatial}rotation = [1.0, 0.1, 0.0, 0.0]\n"));
    refused(&folder, &["run", "bad.toml"], &["bad.toml, line 14", "rotation"]);
    // A fault of the model is told as `pliant check` tells it, to the letter, and where the scene names the model.
    folder.write("model.toml", "format = 1\nname = 7\n");
    folder
        .write("bad.toml", SCENE.replace("linear = { attractor = [0.0, 0.0], gain = 1.0 }", "model = \"model.toml\""));
    let alone = folder.run(&["check", "model.toml"]).stderr;
    assert!(alone.contains("model.toml, line 2"), "{alone}");
    let ended = folder.run(&["run", "bad.toml"]);
    assert_eq!(
        (ended.code, ended.stderr),
        (Some(2), format!("{alone}  help: it is named by bad.toml, line 2: ds.model\n"))
    );
    let objects = [["check", "model.toml", "--json"], ["run", "bad.toml", "--json"]].map(|a| folder.run(&a).json());
    for key in ["exit", "message", "file", "line", "column", "causes"] {
        assert_eq!(objects[0]["error"][key], objects[1]["error"][key], "{key}");
    }
    refused(&folder, &["run", "missing.toml"], &["missing.toml", "cannot be read"]);
    refused(&folder, &["plot", "good.toml", "-o", "figure.gif"], &["figure.gif", ".svg or .png"]);
}

#[test]
fn points() {
    let folder = Folder::new("points");
    folder.write("scene.toml", SCENE);
    let cases: &[(&str, &[&str])] = &[
        ("a,b\n0,0\n", &["line 1", "x,y"]),
        ("x,y,z\n0,0,0\n", &["line 1", "x,y"]),
        ("x,y\n0,0\n0,nan\n", &["line 3", "`y`"]),
        ("x,y\n0,0\n0,2000\n", &["line 3", "1000"]),
        ("x,y\n0,0\n0\n", &["line 3"]),
    ];
    for (text, words) in cases {
        folder.write("p.csv", text);
        let mut all = vec!["p.csv"];
        all.extend_from_slice(words);
        refused(&folder, &["eval", "scene.toml", "--points", "p.csv"], &all);
    }
    folder.write("p.csv", "x,y\n0,0\n");
    let arguments = ["eval", "scene.toml", "--points", "p.csv", "--device", "virtual", "--stage", "nominal"];
    refused(&folder, &arguments, &["--stage", "final"]);
}

#[test]
fn devices() {
    let folder = Folder::new("device");
    folder.write("scene.toml", SCENE);
    let run = |device: &str, words: &[&str]| refused(&folder, &["run", "scene.toml", "--device", device], words);
    run("udp:nowhere.invalid:9000", &["nowhere.invalid"]);
    run("serial:/dev/none", &["/dev/none"]);
    // Somebody listens there, and never answers.
    let silent = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    let address = format!("udp:{}", silent.local_addr().unwrap());
    let ended = folder.run(&["run", "scene.toml", "--device", &address]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("did not answer"), "{}", ended.stderr);
    // Words clap refuses.
    for bad in [&["run", "--device", "qmeu"][..], &["fly"], &["run", "--fast"]] {
        let ended = folder.run(bad);
        assert_eq!(ended.code, Some(2), "{bad:?}");
        assert!(!ended.stderr.contains("panicked"));
    }
}

#[test]
fn a_missing_emulator_is_named_with_the_command_that_installs_it() {
    let folder = Folder::new("emulator");
    folder.write("scene.toml", SCENE);
    let ended = programs::run_with(
        &folder.0,
        ["run", "scene.toml", "--device", "qemu"],
        &[("PATH", Path::new("/nonexistent").to_str().unwrap())],
    )
    .unwrap();
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("apt-get install qemu-system-arm"), "{}", ended.stderr);
}

/// A number that is none or out of its range, also a negative one, gets the sentence that says what is allowed.
#[test]
fn numbers_on_the_command_line() {
    let folder = Folder::new("numbers");
    for (arguments, allowed) in [
        (&["run", "--duration", "-1"][..], "allowed is a number of seconds above 0"),
        (&["run", "--duration", "0"], "allowed is a number of seconds above 0"),
        (&["learn", "a.csv", "--sigma", "-1"], "allowed is 0 to 10 1/s"),
        (&["learn", "a.csv", "--sigma", "nan"], "allowed is 0 to 10 1/s"),
        (&["learn", "a.csv", "--pace", "-0.5"], "allowed is 0 to 10"),
        (&["learn", "a.csv", "--components", "-1"], "allowed is a whole number from 1 to 16"),
        (&["learn", "a.csv", "--components", "17"], "allowed is a whole number from 1 to 16"),
        (&["learn", "a.csv", "--seed", "-1"], "allowed is a whole number from 0"),
        (&["study", "paper", "--placements", "0"], "allowed is a whole number from 1"),
        (&["study", "placements", "--placements", "-3"], "allowed is a whole number from 1"),
        (&["study", "time", "--seed", "-3"], "allowed is a whole number from 0"),
        (&["move", "m.toml", "-o", "n.toml", "--scale", "-2"], "allowed is 0.001 to 1000"),
        (&["move", "m.toml", "-o", "n.toml", "--turn", "x"], "allowed is a number of degrees"),
        (&["study", "lasa", "--seed", "x"], "allowed is a whole number from 0"),
    ] {
        refused(&folder, arguments, &[arguments[arguments.len() - 2], allowed]);
    }
    assert!(fs::read_dir(&folder.0).unwrap().next().is_none(), "nothing is written");
}

#[test]
fn points_to_evaluate() {
    let folder = Folder::new("points");
    folder.write("scene.toml", SCENE);
    for (text, words) in [
        ("", &["points.csv, line 1", "empty", "`x,y`"][..]),
        ("a,b\n1,2\n", &["points.csv, line 1", "`a,b`", "`x,y`"]),
        ("x,y\n", &["points.csv", "no points"]),
        ("x,y\n0.1,0.2\n0.3\n", &["points.csv, line 3", "1 field", "one for each of `x,y`"]),
        ("x,y\n0.1,left\n", &["points.csv, line 2", "`left`"]),
    ] {
        folder.write("points.csv", text);
        refused(&folder, &["eval", "scene.toml", "--points", "points.csv"], words);
        assert!(!folder.run(&["eval", "scene.toml", "--points", "points.csv"]).stderr.contains("CSV"));
    }
    refused(&folder, &["eval", "scene.toml", "--points", "none.csv"], &["none.csv", "cannot be read"]);
}

#[test]
fn a_model_is_no_scene() {
    let folder = Folder::new("model-as-scene");
    folder.write("m.toml", fs::read_to_string(root().join("models/sbend.toml")).unwrap());
    for command in ["run", "plot"] {
        refused(&folder, &[command, "m.toml"], &["m.toml", "a model", "[ds]"]);
    }
}

#[test]
fn a_scene_is_no_model() {
    let folder = Folder::new("scene-as-model");
    folder.write("scene.toml", SCENE);
    let words = ["scene.toml, line 1", "a scene, not a model", "`pliant learn`", "`pliant run scene.toml --stepped`"];
    refused(&folder, &["check", "scene.toml"], &words);
    refused(&folder, &["move", "scene.toml", "-o", "n.toml", "--scale", "2"], &words);
    // The one it names is said, as it is reached from here.
    let learnt = SCENE.replace("linear = { attractor = [0.0, 0.0], gain = 1.0 }", "model = \"skills/m.toml\"");
    fs::create_dir(folder.0.join("sub")).unwrap();
    folder.write("sub/scene.toml", learnt);
    refused(&folder, &["check", "sub/scene.toml"], &["sub/scene.toml, line 1", "`sub/skills/m.toml`"]);
}
