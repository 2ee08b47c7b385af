//! The shipped skills are what `pliant learn` makes of the shipped demonstrations.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use pliant_tests::programs::{self, root};

/// Names in a folder, without their ending.
fn names(folder: &str) -> BTreeSet<String> {
    let name = |p: PathBuf| p.file_stem().unwrap().to_string_lossy().into_owned();
    fs::read_dir(root().join(folder)).unwrap().map(|e| name(e.unwrap().path())).collect()
}

fn copied(folder: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(folder).unwrap() {
        let file = entry.unwrap();
        fs::copy(file.path(), to.join(file.file_name())).unwrap();
    }
}

/// `pliant learn demos/NAME -o models/NAME.toml`, with the seed that the file says, gives the file that is there, to the byte.
#[test]
fn every_shipped_model_is_learnt_again_to_the_byte() {
    let skills = names("demos");
    assert_eq!(skills, names("models"), "a folder of demonstrations a model");
    // A model names its sources relative to itself: beside copies of them it is the same.
    let folder = std::env::temp_dir().join(format!("pliant-models-{}", std::process::id()));
    fs::create_dir_all(folder.join("models")).unwrap();
    for skill in skills {
        let (from, to) = (format!("demos/{skill}"), format!("models/{skill}.toml"));
        copied(&root().join(&from), &folder.join(&from));
        let shipped = fs::read_to_string(root().join(&to)).unwrap();
        let seed = shipped.lines().find_map(|l| l.strip_prefix("seed = ")).unwrap();
        let ended = programs::run(&folder, ["learn", &from, "-o", &to, "--seed", seed, "--no-figure"]).unwrap();
        assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
        let again = fs::read_to_string(folder.join(&to)).unwrap();
        assert!(again == shipped, "{to} is not what is learnt from {from}: cargo xtask models");
    }
    fs::remove_dir_all(folder).unwrap();
}
