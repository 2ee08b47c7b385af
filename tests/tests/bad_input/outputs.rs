//! What is written, and over what.

use super::skills::{FOREIGN, motion};
use super::*;

/// One file of each kind that a command reads.
fn inputs(name: &str) -> Folder {
    let folder = Folder::new(name);
    folder.write("scene.toml", SCENE);
    folder.write("points.csv", "x,y\n0.1,0.2\n");
    folder.write("a.csv", motion(200, 1.0));
    folder.write("foreign.yml", FOREIGN);
    folder
}

#[test]
fn every_command_makes_the_folders_it_writes_into() {
    let folder = inputs("folders");
    for (arguments, file) in [
        (&["learn", "a.csv", "--components", "2"][..], "learnt/deep/m.toml"),
        (&["move", "learnt/deep/m.toml", "--scale", "2"], "moved/deep/m.toml"),
        (&["import", "foreign.yml"], "imported/deep/m.toml"),
        (&["eval", "scene.toml", "--points", "points.csv"], "evaluated/deep/v.csv"),
        (&["plot", "scene.toml"], "drawn/deep/scene.svg"),
    ] {
        let mut all = arguments.to_vec();
        all.extend(["-o", file]);
        let ended = folder.run(&all);
        assert_eq!(ended.code, Some(0), "{all:?}: {}", ended.stderr);
        assert!(folder.0.join(file).is_file(), "{file}");
        // Where a file is in the way, there is a sentence.
        let blocked = format!("a.csv/{file}");
        let last = all.len() - 1;
        all[last] = &blocked;
        refused(&folder, &all, &[&blocked, "cannot be written"]);
    }
}

#[test]
fn a_model_is_not_written_under_the_name_of_another_kind_of_file() {
    let folder = inputs("kinds");
    for (arguments, file) in [
        (&["learn", "a.csv"][..], "m.json"),
        (&["import", "foreign.yml"], "m.YML"),
        (&["move", "m.toml", "--scale", "2"], "m.csv"),
    ] {
        let mut all = arguments.to_vec();
        all.extend(["-o", file]);
        refused(&folder, &all, &[file, "a model is TOML"]);
        assert!(!folder.0.join(file).exists(), "{file}");
    }
}

#[test]
fn what_is_read_is_not_written_over() {
    let folder = inputs("over");
    for (arguments, file) in [
        (&["learn", "a.csv"][..], "a.csv"),
        (&["import", "foreign.yml"], "./foreign.yml"),
        (&["eval", "scene.toml", "--points", "points.csv"], "points.csv"),
        (&["eval", "scene.toml", "--points", "points.csv"], "scene.toml"),
    ] {
        let before = fs::read(folder.0.join(file)).unwrap();
        let mut all = arguments.to_vec();
        all.extend(["-o", file]);
        refused(&folder, &all, &[file, "would be written over"]);
        assert_eq!(fs::read(folder.0.join(file)).unwrap(), before);
    }
    // A model to which a demonstration is added is written anew: that is what was asked for.
    let learn = |more: &[&str]| {
        let mut all = vec!["learn", "a.csv", "-o", "m.toml", "--components", "2", "--no-figure"];
        all.extend(more);
        folder.run(&all).code
    };
    assert_eq!((learn(&[]), learn(&["--add-to", "m.toml"])), (Some(0), Some(0)));
}
