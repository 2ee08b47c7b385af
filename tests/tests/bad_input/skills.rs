//! Models and demonstrations.

use super::*;

#[test]
fn models() {
    let folder = Folder::new("model");
    let good = fs::read_to_string(root().join("models/sbend.toml")).unwrap();
    folder.write("good.toml", &good);
    assert_eq!(folder.run(&["check", "good.toml"]).code, Some(0));
    // The sign of one component's matrix: it now runs away from the goal.
    let at = good.match_indices("a = [").nth(1).unwrap().0;
    let end = at + good[at..].find("]]").unwrap() + 2;
    folder.write("unstable.toml", format!("{}a = [[1.0, 0.0], [0.0, 1.0]]{}", &good[..at], &good[end..]));
    // The file, the line and the component, and only once.
    let place = format!("unstable.toml, line {}:", good[..at].matches('\n').count() + 1);
    refused(&folder, &["check", "unstable.toml"], &[&place, "component 2", "certificate"]);
    refused(&folder, &["move", "unstable.toml", "-o", "m.toml", "--scale", "2"], &[&place, "component 2"]);
    let scene = SCENE.replacen("linear = { attractor = [0.0, 0.0], gain = 1.0 }", "model = \"unstable.toml\"", 1);
    folder.write("scene.toml", scene);
    refused(&folder, &["run", "scene.toml"], &["unstable.toml", "component 2"]);
    // An entry of any one matrix, or P for another: the component at fault is named.
    for (k, (at, _)) in good.match_indices("\na = [[").enumerate() {
        let from = at + "\na = [[".len();
        let to = from + good[from..].find(',').unwrap();
        folder.write("edited.toml", format!("{}900.0{}", &good[..from], &good[to..]));
        refused(&folder, &["check", "edited.toml"], &[&format!("component {}:", k + 1), "not negative definite"]);
    }
    let at = good.find("lyapunov = ").unwrap();
    let end = at + good[at..].find("]]").unwrap() + 2;
    folder.write("edited.toml", format!("{}lyapunov = [[1.0, 0.0], [0.0, 1e-5]]{}", &good[..at], &good[end..]));
    refused(&folder, &["check", "edited.toml"], &["component ", "not negative definite"]);
    let cases: &[(&str, &str, &str)] = &[
        ("dimension = 2", "dimension = 7", "dimension"),
        ("format = 1", "format = 9", "format"),
        ("[[component]]", "[[komponent]]", "komponent"),
        ("prior = ", "prior = -", "prior"),
        ("name = ", "nme = ", "nme"),
        ("[learnt]", "[learnt]\nsedd = 1", "sedd"),
    ];
    for (from, to, word) in cases {
        assert!(good.contains(from), "{from}");
        folder.write("bad.toml", good.replacen(from, to, 1));
        refused(&folder, &["check", "bad.toml"], &["bad.toml", word]);
    }
    folder.write("bad.toml", &good[..good.len() / 2]);
    refused(&folder, &["check", "bad.toml"], &["bad.toml"]);
    refused(&folder, &["check", "missing.toml"], &["missing.toml"]);
    for arguments in [&["check", "unstable.toml"][..], &["run", "scene.toml"], &["check", "missing.toml"]] {
        let said = folder.run(arguments).stderr;
        let reason = if arguments.contains(&"missing.toml") { "os error 2" } else { "is not negative definite" };
        assert_eq!(said.split_whitespace().collect::<Vec<_>>().join(" ").matches(reason).count(), 1, "{said}");
    }
}

#[test]
fn demonstrations() {
    let folder = Folder::new("demo");
    let mut zeros = vec![0; 128];
    zeros[124..128].copy_from_slice(&[0, 1, b'I', b'M']);
    let cases: &[(&str, &[u8], &[&str])] = &[
        ("empty.csv", b"", &["empty.csv"]),
        ("header.csv", b"t,x,y\n", &["header.csv"]),
        ("one.csv", b"t,x,y\n0,0.1,0.2\n", &["one.csv"]),
        ("same.csv", b"t,x,y\n0,0.1,0.2\n1,0.1,0.2\n2,0.1,0.2\n", &["same.csv"]),
        ("nan.csv", b"t,x,y\n0,0.1,0.2\n0.1,NaN,0.2\n0.2,0,0\n", &["nan.csv", "line 3"]),
        ("word.csv", b"t,x,y\n0,0.1,0.2\n0.1,left,0.2\n", &["word.csv", "line 3", "left"]),
        ("wrong.csv", b"time,px,py\n0,0,0\n", &["wrong.csv", "t,x,y"]),
        ("text.mat", b"this is no MATLAB file", &["text.mat"]),
        ("other.mat", &zeros, &["other.mat", "demos"]),
        ("what.xyz", b"?", &["what.xyz"]),
        ("back.csv", b"t,x,y\n0,1,0\n1,0.5,0\n0.5,0,0\n", &["back.csv", "line 4", "goes back from 1 to 0.5"]),
        ("inf.csv", b"t,x,y,vx,vy\n0,1,0,0,0\n1,0,0,inf,0\n", &["inf.csv", "line 3", "vx"]),
        ("far.csv", b"t,x,y\n0,5000,0\n1,2500,0\n2,0,0\n", &["far.csv", "1000 m", "--unit"]),
        ("huge.csv", b"t,x,y\n0,1e308,0\n1,-1e308,0\n2,0,0\n", &["huge.csv"]),
        ("long.csv", b"t,x,y\n0,0.1,0.2\n1e300,0,0\n", &["long.csv", "lasts 1e300 s", "times in seconds"]),
        ("rubbish.csv", &[0xff, 0x00, 0x80, 0x0a], &["rubbish.csv", "line 1"]),
        ("empty.mat", b"", &["empty.mat", "no MATLAB v5 header"]),
        ("empty.npz", b"", &["empty.npz", "no ZIP archive"]),
        ("rubbish.npz", &[0xff, 0x00, 0x80, 0x0a], &["rubbish.npz", "no ZIP archive"]),
        ("ends.csv", b"t,x,y\n0,1,0\n1,0,0\n0,1,0\n1,0,0.5\n", &["ends.csv, demonstration", "mean end point"]),
    ];
    for (name, bytes, words) in cases {
        folder.write(name, bytes);
        refused(&folder, &["learn", name, "-o", "m.toml"], words);
        assert!(!folder.0.join("m.toml").exists(), "{name} left a model behind");
    }
    folder.write("a.csv", "t,x,y\n0,0.3,0.2\n0.5,0.2,0.1\n1,0,0\n");
    folder.write("b.csv", "t,x,y,z\n0,0.3,0.2,0\n0.5,0.2,0.1,0\n1,0,0,0\n");
    refused(&folder, &["learn", "a.csv", "b.csv"], &["b.csv"]);
    refused(&folder, &["learn", "nowhere.csv"], &["nowhere.csv"]);
    refused(&folder, &["learn", "."], &["back.csv"]);
    refused(&folder, &["learn"], &["DEMO"]);
}

/// A motion of a second: `samples` rows, lengths times `factor`.
pub fn motion(samples: usize, factor: f64) -> String {
    let row = |i: usize| {
        let s = i as f64 / (samples - 1) as f64;
        let fade = factor * (1.0 - s) * (1.0 - s);
        format!("{s},{},{}\n", 0.3 * fade * (3.0 * s).cos(), 0.2 * fade)
    };
    (0..samples).fold("t,x,y\n".to_owned(), |text, i| text + &row(i))
}

/// Exit 0, and the words in a warning on stderr and in the object on stdout.
fn warned(folder: &Folder, arguments: &[&str], words: &[&str]) {
    let mut with_json = arguments.to_vec();
    with_json.push("--json");
    let ended = folder.run(&with_json);
    assert_eq!(ended.code, Some(0), "{arguments:?}: {}", ended.stderr);
    let warnings = ended.json()["warnings"].as_array().unwrap().clone();
    let warnings: String = warnings.iter().map(|w| format!("warning: {}\n", w.as_str().unwrap())).collect();
    for word in words {
        assert!(warnings.contains(word), "{arguments:?} does not say `{word}`:\n{warnings}");
    }
    assert!(ended.stderr.contains(&warnings), "{}", ended.stderr);
}

#[test]
fn what_a_person_may_have_meant_is_a_warning() {
    let folder = Folder::new("warned");
    let learn =
        |file: &str, words: &[&str]| warned(&folder, &["learn", file, "-o", "m.toml", "--components", "2"], words);
    folder.write("large.csv", motion(200, 100.0));
    learn("large.csv", &["m across", "--unit"]);
    folder.write("small.csv", motion(200, 0.001));
    learn("small.csv", &["m across"]);
    let rest: String = (1..60).map(|i| format!("{},0,0\n", 1.0 + f64::from(i) * 0.01)).collect();
    folder.write("rest.csv", motion(100, 1.0) + &rest);
    learn("rest.csv", &["stands still"]);
    let twice: String = motion(100, 1.0).lines().skip(1).map(|l| format!("{l}\n{l}\n")).collect();
    folder.write("twice.csv", "t,x,y\n".to_owned() + &twice);
    learn("twice.csv", &["100 of 200 samples repeat"]);
    folder.write("ends.csv", motion(100, 1.0) + "0,0.3,0.2\n0.5,0.1,0.1\n1,0,0.02\n");
    learn("ends.csv", &["from the mean end point"]);
    folder.write("once.csv", motion(100, 1.0));
    warned(
        &folder,
        &["learn", "once.csv", "once.csv", "-o", "m.toml", "--components", "2"],
        &["once.csv: it is given twice; of 2 demonstrations 1 repeat another"],
    );
    let slow: String = motion(100, 1.0).lines().skip(1).map(|l| format!("{l},0,0\n")).collect();
    folder.write("velocity.csv", "t,x,y,vx,vy\n".to_owned() + &slow.replace(",0,0\n", ",-0.001,-0.001\n"));
    learn("velocity.csv", &["velocities are"]);
    // One sample that cannot be meant is named, and only it.
    let jump: Vec<String> = motion(100, 1.0).lines().map(str::to_owned).collect();
    let with = |line: usize, row: &str| {
        let mut all = jump.clone();
        all[line] = row.into();
        all.join("\n") + "\n"
    };
    let t = jump[31].split(',').next().unwrap();
    folder.write("jump.csv", with(31, &format!("{t},0.9,-0.7")));
    learn("jump.csv", &[&format!("jump.csv: sample 31 (t = {t}) lies 1.")]);
    let moving: String = motion(100, 1.0).lines().skip(1).map(|l| l.to_owned() + ",-0.3,-0.2\n").collect();
    let mut rows: Vec<&str> = moving.lines().collect();
    let (at, absurd) = (format!("{t},"), format!("{},250,0", jump[31]));
    let i = rows.iter().position(|row| row.starts_with(&at)).unwrap();
    rows[i] = &absurd;
    folder.write("absurd.csv", "t,x,y,vx,vy\n".to_owned() + &rows.join("\n"));
    refused(
        &folder,
        &["learn", "absurd.csv", "-o", "m.toml"],
        &["absurd.csv: the velocity of sample 31", "is 250.0000 m/s, where positions move at"],
    );
    let forward = absurd.replace(",250,0", ",-250,0");
    rows[i] = &forward;
    folder.write("absurd.csv", "t,x,y,vx,vy\n".to_owned() + &rows.join("\n"));
    learn("absurd.csv", &["absurd.csv: the velocity of sample 31", "is 250.0000 m/s, where positions move at"]);
    // The same file in its unit says nothing.
    folder.write("mm.csv", motion(200, 1000.0));
    let ended = folder.run(&["learn", "mm.csv", "--unit", "mm", "-o", "m.toml", "--components", "2"]);
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
}

/// A knot that one linear system cannot follow: what was there before stays as it was.
#[test]
fn a_skill_that_does_not_arrive_is_not_written() {
    let folder = Folder::new("stranded");
    let knot = |i: usize| {
        let s = i as f64 / 60.0;
        format!("{},{},{}\n", 3.0 * s, 0.3 * (19.0 * s).cos(), 0.3 * (37.0 * s).sin())
    };
    folder.write("knot.csv", (0..=60).map(knot).fold("t,x,y\n".to_owned(), |text, row| text + &row));
    folder.write("m.toml", "as it was");
    let learn = ["learn", "knot.csv", "-o", "m.toml", "--components", "1", "--json"];
    let ended = folder.run(&learn);
    let error = &ended.json()["error"];
    assert_eq!((ended.code, &error["exit"]), (Some(1), &1.into()), "{}{}", ended.stdout, ended.stderr);
    let said = error["message"].as_str().unwrap();
    assert!(said.starts_with("nothing is written: from the start of knot.csv"), "{said}");
    assert_eq!(std::fs::read_to_string(folder.0.join("m.toml")).unwrap(), "as it was");
    assert!(!folder.0.join("m.svg").exists());
    // What it says helps.
    let help = error["help"].as_str().unwrap();
    let sigma = help.split_whitespace().skip_while(|w| *w != "--sigma").nth(1).unwrap();
    let ended = folder.run(&[&learn[..], &["--sigma", sigma]].concat());
    assert_eq!((ended.code, &ended.json()["converged"]), (Some(0), &1.into()), "{}", ended.stderr);
    assert_eq!(folder.run(&["check", "m.toml"]).code, Some(0));
}

#[test]
fn a_million_samples_are_learnt_from() {
    let folder = Folder::new("million");
    folder.write("a.csv", motion(1_000_000, 1.0));
    let ended = folder.run(&["learn", "a.csv", "-o", "m.toml", "--components", "2", "--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(folder.run(&["check", "m.toml"]).code, Some(0));
}

pub const FOREIGN: &str = "name: test\nK: 1.0\nM: 2.0\nPriors: [1.0]\nMu: [0.1, 0.2]\nSigma: [0.01, 0.0, 0.0, 0.02]
A: [-1.0, -3.5, 0.5, -1.0]\nattractor: [0.0, 0.5]\nx0_all: [0.4, 0.4]\n";

#[test]
fn models_of_other_tools() {
    let folder = Folder::new("import");
    folder.write("good.yml", FOREIGN);
    let ended = folder.run(&["import", "good.yml", "-o", "m.toml", "--json"]);
    assert_eq!((ended.code, ended.json()["lyapunov"].as_str()), (Some(0), Some("found")), "{}", ended.stderr);
    assert_eq!(ended.json()["name"], "test");
    // One that has no name is named by its file.
    folder.write("via-point.yml", FOREIGN.replacen("name: test\n", "", 1));
    assert_eq!(folder.run(&["import", "via-point.yml", "--json"]).json()["name"], "via-point");
    assert_eq!(folder.run(&["check", "m.toml"]).code, Some(0));
    let cases: &[(&str, &str, &[&str])] = &[
        ("Sigma: [0.01", "Sigma: [x", &["bad.yml, line 6", "Sigma", "`x`"]),
        ("Priors: [1.0]", "Priors: [1.0, 2.0]", &["bad.yml, line 4", "Priors", "2 numbers"]),
        ("attractor", "atractor", &["bad.yml", "attractor", "missing"]),
        ("A: [-1.0", "A: [9.0", &["bad.yml", "component 1", "certified"]),
        ("A: [", "B: [", &["bad.yml", "`A`"]),
        ("M: 2.0", "M: [", &["bad.yml"]),
        ("M: 2.0", "M: two", &["bad.yml, line 3", "`two`", "1 number,"]),
    ];
    for (from, to, words) in cases {
        assert!(FOREIGN.contains(from), "{from}");
        folder.write("bad.yml", FOREIGN.replacen(from, to, 1));
        refused(&folder, &["import", "bad.yml", "-o", "none.toml"], words);
    }
    folder.write("bad.json", [0xff, 0xfe]);
    refused(&folder, &["import", "bad.json"], &["bad.json, line 1", "UTF-8"]);
    refused(&folder, &["import", "missing.yml"], &["missing.yml"]);
    refused(&folder, &["import", "m.toml"], &["m.toml", ".json"]);
    assert!(!folder.0.join("none.toml").exists());
}

#[test]
fn skills_are_moved_and_added_to() {
    let folder = Folder::new("again");
    folder.write("a.csv", motion(200, 1.0));
    folder.write("b.csv", motion(150, 1.1));
    let good = |arguments: &[&str]| {
        let mut all = arguments.to_vec();
        all.push("--json");
        let ended = folder.run(&all);
        assert_eq!(ended.code, Some(0), "{arguments:?}: {}", ended.stderr);
        ended.json()
    };
    good(&["learn", "a.csv", "-o", "m.toml", "--components", "2"]);
    let moved = good(&["move", "m.toml", "-o", "moved.toml", "--attractor", "0.2,-0.1", "--start", "0.5,0.4"]);
    assert_eq!(moved["attractor"][1], -0.1);
    good(&["check", "moved.toml"]);
    // Rollouts begin where they are told to.
    let start = moved["starts"][0].as_array().unwrap().clone();
    assert!((start[0].as_f64().unwrap() - 0.5).abs() < 1e-6 && (start[1].as_f64().unwrap() - 0.4).abs() < 1e-6);

    let both = good(&["learn", "b.csv", "--add-to", "m.toml", "--components", "2"]);
    assert_eq!((both["demonstrations"].as_u64(), both["warnings"].as_array().unwrap().len()), (Some(2), 0));
    let text = fs::read_to_string(folder.0.join("m.toml")).unwrap();
    assert!(text.contains("a.csv") && text.contains("b.csv"), "{text}");
    // The same as learning from both at once.
    let at_once = good(&["learn", "a.csv", "b.csv", "-o", "once.toml", "--components", "2"]);
    assert_eq!(at_once["rmse_m_s"], both["rmse_m_s"]);

    fs::remove_file(folder.0.join("a.csv")).unwrap();
    warned(
        &folder,
        &["learn", "b.csv", "--add-to", "m.toml", "-o", "n.toml", "--components", "2"],
        &["a.csv", "is gone"],
    );
}

#[test]
fn moves_that_cannot_be() {
    let folder = Folder::new("move");
    fs::copy(root().join("models/sbend.toml"), folder.0.join("m.toml")).unwrap();
    let text = fs::read_to_string(folder.0.join("m.toml")).unwrap();
    folder.write("bare.toml", &text[..text.find("[learnt]").unwrap()]);
    let cases: &[(&[&str], &[&str])] = &[
        (&["--attractor", "1,2,3"], &["--attractor: attractor has 3 numbers"]),
        (&["--attractor", "1;2"], &["X,Y"]),
        (&["--attractor", "1e9,0"], &["--attractor: attractor = 1000000000", "-1000 to 1000 m"]),
        (&["--scale", "0"], &["scale", "0.001 to 1000"]),
        (&["--scale", "NaN"], &["scale"]),
        (&["--turn", "inf"], &["turn"]),
        (&["--start", "0,0", "--from", "1,0"], &["new start", "attractor"]),
        (&["--start", "1,0", "--scale", "2"], &["--scale"]),
    ];
    for (options, words) in cases {
        let mut arguments = vec!["move", "m.toml", "-o", "none.toml"];
        arguments.extend_from_slice(options);
        refused(&folder, &arguments, words);
    }
    refused(&folder, &["move", "bare.toml", "-o", "none.toml", "--start", "1,0"], &["bare.toml", "--from"]);
    refused(&folder, &["move", "missing.toml", "-o", "none.toml"], &["missing.toml"]);
    folder.write("a.csv", motion(100, 1.0));
    refused(&folder, &["learn", "a.csv", "--add-to", "bare.toml"], &["bare.toml", "no demonstration can be added"]);
    assert!(!folder.0.join("none.toml").exists());
}

#[test]
fn a_move_that_changes_nothing_is_refused() {
    let folder = Folder::new("still");
    folder.write("m.toml", fs::read_to_string(root().join("models/sbend.toml")).unwrap());
    refused(&folder, &["move", "m.toml", "-o", "n.toml"], &["m.toml: nothing to change", "--attractor", "--scale"]);
    assert!(!folder.0.join("n.toml").exists());
}

/// The same motion ten times as slow: a rate that suited it asks too much, the verdict says which to ask for, and that is followed closely.
#[test]
fn a_rate_too_high_for_a_slow_demonstration_is_named_and_lowering_it_helps() {
    let folder = Folder::new("rate");
    fs::create_dir(folder.0.join("slow")).unwrap();
    let arch = fs::read_dir(root().join("demos/arch")).unwrap().map(|f| fs::read_to_string(f.unwrap().path()).unwrap());
    for (i, text) in arch.enumerate() {
        let mut slow = String::from("t,x,y\n");
        for row in text.lines().filter(|l| l.starts_with(|c: char| c.is_ascii_digit() || c == '-')) {
            let mut row = row.split(',').map(|x| x.trim().parse::<f64>().unwrap());
            let mut next = || row.next().unwrap();
            slow += &format!("{},{},{}\n", 10.0 * next(), next(), next());
        }
        folder.write(&format!("slow/{i}.csv"), slow);
    }
    let learnt = |sigma: &str| {
        let ended = folder.run(&["learn", "slow", "-o", "m.toml", "--sigma", sigma, "--json"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let json = ended.json();
        let verdict =
            json["verdict"].as_array().unwrap().iter().map(|v| v.as_str().unwrap()).collect::<Vec<_>>().join("; ");
        (json["path_error_m"].as_f64().unwrap(), verdict)
    };
    let (far, said) = learnt("0.5");
    let advised =
        said.split("lower it, --sigma ").nth(1).unwrap_or_else(|| panic!("{said}")).split(' ').next().unwrap();
    let (near, said) = learnt(advised);
    assert!(near < 0.2 * far && !said.contains("sigma"), "{near} {far} {advised}: {said}");
}
