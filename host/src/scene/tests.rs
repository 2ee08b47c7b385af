use std::path::{Path, PathBuf};

use miette::Diagnostic;
use nalgebra::Vector3;
use proptest::prelude::*;

use super::*;

/// A scene that has everything, and is right.
const GOOD: &str = r#"[ds]
linear = { attractor = [0.0, 0.0], gain = 1.0 }
[modulation]
method = "deformable"
c = 0.03
steering = "with-flow"
[limits]
speed = 0.5
[[start]]
position = [0.37, 0.41]
[[obstacle]]
name = "foam"
shape = { ellipsoid = [0.04, 0.05] }
center = [0.20, 0.21]
angle = 0.0
stiffness = 1.6487
curvature = 1
margin = [1.0, 1.0]
velocity = [0.0, 0.0]
angular_velocity = 0.0
reference = [0.0, 0.0]
[goal]
timeout = 30.0
"#;

const SPATIAL: &str = r#"[ds]
linear = { attractor = [0.0, 0.0, 0.3], gain = 1.0 }
[[start]]
position = [0.6, 0.1, 0.3]
[[obstacle]]
name = "ball"
shape = { ellipsoid = [0.05, 0.06, 0.07] }
center = [0.3, 0.1, 0.3]
rotation = [1.0, 0.0, 0.0, 0.0]
layer = 0.02
angular_velocity = [0.0, 0.0, 0.1]
"#;

fn parse(text: &str) -> Result<Scene, SceneError> {
    Scene::parse("dir/bad.toml", text, Path::new("/nowhere"))
}

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name)
}

/// Each line: what to replace in which scene, by what; the line and field of the complaint, and a word of it or of its help.
#[rustfmt::skip]
const BAD: &[(&str, &str, &str, usize, &str, &str)] = &[
    // syntax, types, keys
    (GOOD, "[0.20, 0.21]", "[0.20, 0.21", 15, "", "not TOML"),
    (GOOD, "c = 0.03", "c = \"fast\"", 5, "modulation.c", "expected a number"),
    (GOOD, "center = [0.20, 0.21]", "center = 0.2", 14, "obstacle.center", "expected an array"),
    (GOOD, "center = [0.20, 0.21]", "center = [0.2, \"a\"]", 14, "obstacle.center", "expected a number"),
    (GOOD, "curvature = 1", "curvature = 1.5", 17, "obstacle.curvature", "expected a whole number"),
    (GOOD, "speed = 0.5", "speed = true", 8, "limits.speed", "expected a number"),
    (GOOD, "stiffness =", "stifness =", 16, "obstacle.stifness", "did you mean `stiffness`"),
    (GOOD, "center =", "centre =", 14, "obstacle.centre", "did you mean `center`"),
    (GOOD, "position =", "pos =", 10, "start.pos", "`position`"),
    (GOOD, "[limits]", "[limit]", 7, "limit", "did you mean `limits`"),
    (GOOD, "[goal]", "[goal]\ncolour = 1", 23, "goal.colour", "no key `colour`"),
    (GOOD, "linear = { attractor", "linear = { atractor", 2, "ds.linear.atractor", "did you mean `attractor`"),
    (GOOD, "\"with-flow\"", "\"withflow\"", 6, "modulation.steering", "did you mean `with-flow`"),
    (GOOD, "\"deformable\"", "\"soft\"", 4, "modulation.method", "`original`"),
    (GOOD, "ellipsoid =", "polygon =", 13, "obstacle.shape.polygon", "`ellipsoid`"),
    (GOOD, "shape = { ellipsoid = [0.04, 0.05] }", "shape = 3", 13, "obstacle.shape", "wanted string or table"),
    (GOOD, "\"with-flow\"", "{ fixed = \"x\" }", 6, "modulation.steering.fixed", "expected a number"),
    (GOOD, "shape = { ellipsoid = [0.04, 0.05] }", "", 11, "obstacle.shape", "is missing"),
    (GOOD, "name = \"foam\"", "", 11, "obstacle.name", "is missing"),
    (GOOD, "center = [0.20, 0.21]", "", 11, "obstacle.center", "is missing"),
    (GOOD, "linear = { attractor = [0.0, 0.0], gain = 1.0 }", "", 1, "ds", "names no motion"),
    (GOOD, "[ds]\nlinear = { attractor = [0.0, 0.0], gain = 1.0 }\n", "", 1, "ds", "is missing"),
    (GOOD, "[[start]]\nposition = [0.37, 0.41]", "", 1, "start", "is missing"),
    (GOOD, "name = \"foam\"", "name = \"\"", 12, "obstacle.name", "empty"),
    // numbers
    (GOOD, "0.20, 0.21", "nan, 0.21", 14, "obstacle.center", "NaN is not a finite number"),
    (GOOD, "0.37, 0.41", "inf, 0.41", 10, "start.position", "inf is not a finite number"),
    (GOOD, "0.37, 0.41", "1000.1, 0.41", 10, "start.position", "too large"),
    (GOOD, "0.20, 0.21", "-2000, 0.21", 14, "obstacle.center", "too small"),
    (GOOD, "c = 0.03", "c = -0.1", 5, "modulation.c", "too small"),
    (GOOD, "\"with-flow\"", "{ fixed = inf }", 6, "modulation.steering.fixed", "not a finite"),
    (GOOD, "\"with-flow\"", "\"with-flow\"\nbeta = 11", 7, "modulation.beta", "too large"),
    (GOOD, "\"with-flow\"", "{ fixed = 0.785 }\nbeta = 1", 7, "modulation.beta", "fixed steering"),
    (GOOD, "speed = 0.5", "speed = 0", 8, "limits.speed", "too small"),
    (GOOD, "speed = 0.5", "speed = 0.5\nacceleration = 0.0", 9, "limits.acceleration", "too small"),
    (GOOD, "speed = 0.5", "speed = 0.5\ndeceleration = nan", 9, "limits.deceleration", "NaN"),
    (GOOD, "gain = 1.0", "gain = 0.0", 2, "ds.linear.gain", "too small"),
    (GOOD, "[goal]", "[ageing]\ntime_to_live = 2.0\nhold = 1.0\n[goal]", 24, "ageing.hold", "too small"),
    (GOOD, "[goal]", "[goal]\ntolerance = 0", 23, "goal.tolerance", "too small"),
    (GOOD, "timeout = 30.0", "timeout = -1", 23, "goal.timeout", "too small"),
    (GOOD, "stiffness = 1.6487", "stiffness = 0.9", 16, "obstacle.stiffness", "k >= 1"),
    (GOOD, "stiffness = 1.6487", "stiffness = 1e300", 16, "obstacle.stiffness", "times the hard one"),
    (GOOD, "stiffness = 1.6487", "layer = -0.01", 16, "obstacle.layer", "too small"),
    (GOOD, "stiffness = 1.6487", "layer = 100", 16, "obstacle.layer", "times the hard one"),
    (GOOD, "stiffness = 1.6487", "soft = [0.06, 0.04]", 16, "obstacle.soft", "smaller than the hard semi-axis 0.05"),
    (GOOD, "stiffness = 1.6487", "stiffness = 1.6487\nlayer = 0.02", 17, "obstacle.layer", "beside `stiffness`"),
    (GOOD, "stiffness = 1.6487", "layer = 0.02\nsoft = [1.0, 1.0]", 17, "obstacle.soft", "rigid obstacle"),
    (GOOD, "[0.04, 0.05]", "[0.04, 0.0]", 13, "obstacle.shape.ellipsoid", "too small"),
    (GOOD, "[0.04, 0.05]", "[-0.04, 0.05]", 13, "obstacle.shape.ellipsoid", "too small"),
    (GOOD, "curvature = 1", "curvature = 0", 17, "obstacle.curvature", "1 (ellipsoid"),
    (GOOD, "curvature = 1", "curvature = 9", 17, "obstacle.curvature", "is 9"),
    (GOOD, "curvature = 1", "curvature = -3", 17, "obstacle.curvature", "is -3"),
    (GOOD, "margin = [1.0, 1.0]", "margin = [1.0, 0.99]", 18, "obstacle.margin", "too small"),
    (GOOD, "velocity = [0.0, 0.0]", "velocity = [200.0, 0.0]", 19, "obstacle.velocity", "too large"),
    (GOOD, "velocity = [0.0, 0.0]", "velocity = [50.0, 0.0]", 19, "obstacle.velocity", "before the timeout"),
    (GOOD, "angular_velocity = 0.0", "angular_velocity = inf", 20, "obstacle.angular_velocity", "out of range"),
    (GOOD, "angle = 0.0", "angle = nan", 15, "obstacle.angle", "NaN"),
    (SPATIAL, "rotation = [1.0, 0.0, 0.0, 0.0]", "rotation = [2.0, 0.0, 0.0, 0.0]", 9, "obstacle.rotation", "made one: [1.0"),
    (SPATIAL, "rotation = [1.0, 0.0, 0.0, 0.0]", "rotation = [0, 0, 0, 0]", 9, "obstacle.rotation", "length 0"),
    (SPATIAL, "rotation = [1.0, 0.0, 0.0, 0.0]", "rotation = [1.0, 0.0, 0.0]", 9, "obstacle.rotation", "has 3 numbers"),
    // places
    (GOOD, "reference = [0.0, 0.0]", "reference = [0.0, 0.05]", 21, "obstacle.reference", "outside the hard core"),
    (GOOD, "0.37, 0.41", "0.21, 0.22", 10, "start.position", "hard core of obstacle \"foam\""),
    (GOOD, "0.20, 0.21", "0.01, 0.01", 14, "obstacle.center", "attractor inside the hard core"),
    // A margin makes the core larger.
    (GOOD, "margin = [1.0, 1.0]", "margin = [9.0, 9.0]", 14, "obstacle.center", "attractor inside the hard core"),
    // dimensions
    (GOOD, "attractor = [0.0, 0.0]", "attractor = [0.0]", 2, "ds.linear.attractor", "has 1 number"),
    (GOOD, "0.37, 0.41", "0.37, 0.41, 0.1", 10, "start.position", "has 3 numbers, but the scene has 2 dimensions"),
    (GOOD, "[0.04, 0.05]", "[0.04]", 13, "obstacle.shape.ellipsoid", "has 1 number,"),
    (GOOD, "0.20, 0.21", "", 14, "obstacle.center", "has 0 numbers"),
    (GOOD, "attractor = [0.0, 0.0]", "attractor = [0.0, 0.0, 0.0]", 13, "obstacle.shape.ellipsoid", "scene has 3 dimensions"),
    (GOOD, "angle = 0.0", "rotation = [1, 0, 0, 0]", 15, "obstacle.rotation", "takes `angle`"),
    (GOOD, "angular_velocity = 0.0", "angular_velocity = [0, 0, 1]", 20, "obstacle.angular_velocity", "2 dimensions"),
    (SPATIAL, "rotation = [1.0, 0.0, 0.0, 0.0]", "angle = 0.1", 9, "obstacle.angle", "takes `rotation"),
    (SPATIAL, "angular_velocity = [0.0, 0.0, 0.1]", "angular_velocity = 0.1", 11, "obstacle.angular_velocity", "3 dimensions"),
    // paths
    (GOOD, "velocity = [0.0, 0.0]", "path = []", 19, "obstacle.path", "no point"),
    (GOOD, "velocity = [0.0, 0.0]", "path = [[0.0, 0.2]]", 19, "obstacle.path", "a time and 2 coordinates make 3"),
    (GOOD, "velocity = [0.0, 0.0]", "path = [[1, 0.2, 0.2], [1, 0.3, 0.2]]", 19, "obstacle.path", "does not come after"),
    (GOOD, "velocity = [0.0, 0.0]", "path = [[-1, 0.2, 0.2]]", 19, "obstacle.path", "too small"),
    (GOOD, "velocity = [0.0, 0.0]", "path = [[1, 0.2, 0.2], [1.001, 9, 0.2]]", 19, "obstacle.path", "faster than 100 m/s"),
    (GOOD, "velocity = [0.0, 0.0]", "velocity = [0.1, 0.0]\npath = [[1, 0.2, 0.2]]", 19, "obstacle.velocity", "beside `path`"),
    (GOOD, "velocity = [0.0, 0.0]", "path = [[0, 0.3, 0.2]]", 14, "obstacle.center", "leave it out"),
    // models
    (GOOD, "linear = { attractor = [0.0, 0.0], gain = 1.0 }", "model = \"no.toml\"", 2, "ds.model", "`no.toml` cannot be read"),
    (GOOD, "linear =", "model = \"a.toml\"\nlinear =", 3, "ds.linear", "one of the two"),
];

#[test]
fn what_is_wrong_is_named_with_file_line_and_field() {
    assert!(parse(GOOD).is_ok() && parse(SPATIAL).is_ok());
    for (good, from, to, line, field, word) in BAD {
        let case = format!("`{from}` -> `{to}`");
        assert_eq!(good.matches(from).count(), 1, "{case}: the case itself");
        let error = parse(&good.replace(from, to)).expect_err(&case);
        let message = error.to_string();
        assert_eq!(error.line(), Some(*line), "{case}: {message}");
        assert_eq!(error.field(), *field, "{case}: {message}");
        assert!(message.starts_with(&format!("dir/bad.toml:{line}: ")), "{case}: {message}");
        assert!(message.contains(field), "{case}: {message}");
        let help = error.help().map(|h| h.to_string()).unwrap_or_default();
        assert!(help.len() > "allowed: ".len(), "{case}: no help with {message}");
        assert!(message.contains(word) || help.contains(word), "{case}: {message} / {help}");
    }
}

#[test]
fn the_caret_is_under_the_fault() {
    let error = parse(&GOOD.replace("[0.04, 0.05]", "[0.04, -7.25]")).unwrap_err();
    let label = error.labels().unwrap().next().unwrap();
    let text = GOOD.replace("[0.04, 0.05]", "[0.04, -7.25]");
    assert_eq!(&text[label.offset()..label.offset() + label.len()], "-7.25");
    let handler = miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::unicode_nocolor());
    let mut out = String::new();
    handler.render_report(&mut out, &error).unwrap();
    assert!(out.contains("dir/bad.toml:13:") && out.contains("help: allowed:"), "{out}");
}

#[test]
fn a_file_that_is_not_there_and_one_that_is_not_text() {
    let error = Scene::load("no/such/scene.toml").unwrap_err();
    assert_eq!(error.kind(), SceneErrorKind::Unreadable);
    assert!(error.to_string().starts_with("no/such/scene.toml: cannot be read"));
    assert!(Scene::load(".").is_err());
}

#[test]
fn a_bad_model_is_the_scenes_fault_at_its_line() {
    let model = |text: &str| {
        let text = text.to_owned();
        check::scene("s.toml", "[ds]\nmodel = \"m.toml\"\n[[start]]\nposition = [1, 1]\n", &move |p: &Path| {
            Ok((p.to_owned(), text.clone()))
        })
    };
    let good = "format = 1\nname = \"m\"\ndimension = 2\nattractor = [0.0, 0.0]\nlyapunov = [[1.0, 0.0], [0.0, 1.0]]\n\
        [[component]]\nprior = 1.0\nmean = [0.0, 0.0]\ncovariance = [[1.0, 0.0], [0.0, 1.0]]\na = [[-1.0, 0.0], [0.0, -1.0]]\n";
    assert!(model(good).is_ok());
    let unstable = good.replace("a = [[-1.0", "a = [[1.0");
    for (text, word) in [("format = ", "m.toml"), (unstable.as_str(), "not negative definite")] {
        let error = model(text).unwrap_err();
        assert_eq!((error.kind(), error.line(), error.field()), (SceneErrorKind::Model, Some(2), "ds.model"));
        assert!(error.to_string().contains(word), "{error}");
        assert!(error.diagnostic_source().is_some());
    }
}

#[test]
fn obstacles_are_counted_and_named_once() {
    let obstacle = GOOD.split("[[obstacle]]").nth(1).unwrap().split("[goal]").next().unwrap();
    let twice = format!("{GOOD}[[obstacle]]{obstacle}");
    let error = parse(&twice).unwrap_err();
    assert_eq!((error.line(), error.field()), (Some(25), "obstacle.name"));
    let many = |n: usize| {
        (1..n).fold(GOOD.to_owned(), |text, i| {
            text + "[[obstacle]]" + &obstacle.replace("\"foam\"", &format!("\"foam {i}\""))
        })
    };
    assert_eq!(parse(&many(64)).unwrap().obstacles().len(), 64);
    let error = parse(&many(65)).unwrap_err();
    assert_eq!((error.kind(), error.field()), (SceneErrorKind::Value, "obstacle"));
    assert!(error.to_string().contains("65"));
}

#[test]
fn the_three_ways_to_say_soft_agree_where_they_can() {
    let with = |text: &str| {
        let scene = parse(&GOOD.replace("stiffness = 1.6487", text).replace("[0.04, 0.05]", "[0.04, 0.04]")).unwrap();
        scene.obstacles()[0].soft_ratio()
    };
    let half = 0.5f64.exp();
    for same in [format!("stiffness = {half}"), "soft = [0.06, 0.06]".into(), "layer = 0.02".into()] {
        assert!((with(&same) - Vector3::new(1.5, 1.5, 0.0)).norm() < 1e-12, "{same}");
    }
    assert_eq!(with(""), Vector3::new(1.0, 1.0, 0.0));
    assert_eq!(with("stiffness = 1"), Vector3::new(1.0, 1.0, 0.0));
}

#[test]
fn what_is_left_out_has_its_documented_value() {
    let scene = parse("ds.linear = { attractor = [0, 0], gain = 1 }\n[[start]]\nposition = [1, 1]").unwrap();
    assert_eq!(scene.settings::<f64>(), pliant_core::Settings::default());
    assert_eq!(*scene.goal(), Goal { tolerance: 0.01, timeout: 30.0 });
    assert!(scene.obstacles().is_empty());
    assert_eq!(scene.name(), "bad");
}

#[test]
fn a_path_is_followed_with_its_velocity() {
    let path = "path = [[1.0, 0.3, 0.21], [3.0, 0.3, 0.41]]";
    let scene = parse(&GOOD.replace("velocity = [0.0, 0.0]\n", &format!("{path}\n"))).unwrap();
    let at = |t: f64| {
        let pose = scene.obstacles()[0].at(t).pose;
        (pose.center.xy(), pose.velocity.xy())
    };
    let near = |a: (nalgebra::Vector2<f64>, nalgebra::Vector2<f64>), b: [f64; 4]| {
        (a.0.x - b[0]).abs() + (a.0.y - b[1]).abs() + (a.1.x - b[2]).abs() + (a.1.y - b[3]).abs() < 1e-12
    };
    // From the centre at t = 0 to the path's first point, along it, and at rest at its end.
    assert!(near(at(0.5), [0.25, 0.21, 0.1, 0.0]));
    assert!(near(at(2.0), [0.3, 0.31, 0.0, 0.1]));
    assert!(near(at(9.0), [0.3, 0.41, 0.0, 0.0]));
    assert!(scene.obstacles()[0].is_moving());
}

#[test]
fn all_shipped_scenes_are_right_and_their_cores_apart() {
    let mut seen = 0;
    for entry in std::fs::read_dir(folder("scenes")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        let scene = Scene::load(&path).unwrap_or_else(|e| panic!("{e}"));
        seen += 1;
        for step in 0..=60 {
            let all: Vec<_> = scene.obstacles_at(scene.goal().timeout.min(15.0) * f64::from(step) / 60.0).collect();
            for (i, a) in all.iter().enumerate() {
                for b in &all[i + 1..] {
                    let reach = a.obstacle.axes().max() + b.obstacle.axes().max();
                    let apart = (a.pose.center - b.pose.center).norm() > reach;
                    assert!(
                        apart || !touching(a, b),
                        "{}: {} and {}",
                        path.display(),
                        a.obstacle.name(),
                        b.obstacle.name()
                    );
                }
            }
        }
    }
    assert!(seen >= 6, "{seen} scenes");
    assert!(Scene::builtin().is_ok_and(|s| s.name() == "sbend-foam"));
}

/// Is any point of a fine grid in both cores?
fn touching(a: &PosedObstacle<'_>, b: &PosedObstacle<'_>) -> bool {
    let axes = a.obstacle.axes();
    let n = 60;
    let side = |i: i32| f64::from(i) / f64::from(n);
    let depth = if axes.z > 0.0 { n } else { 0 };
    (-n..=n).any(|i| {
        (-n..=n).any(|j| {
            (-depth..=depth).any(|k| {
                let q = Vector3::new(side(i), side(j), side(k)).component_mul(&axes);
                let x = a.pose.center + a.pose.rotation * q;
                a.gamma(&x) <= 1.0 && b.gamma(&x) <= 1.0
            })
        })
    })
}

prop_compose! {
    fn random_scene()(
        spatial in any::<bool>(),
        axes in prop::array::uniform3(1e-4..0.2f64),
        center in prop::array::uniform3(0.5..2.0f64),
        turn in (0.1..1.0f64, prop::array::uniform3(-1.0..1.0f64)),
        softness in 0..4,
        k in 1.0..1e6f64,
        curvature in 1..9u8,
        margin in prop::array::uniform3(1.0..1.5f64),
        reference in prop::array::uniform3(-0.9..0.9f64),
        velocity in prop::array::uniform3(-3.0..3.0f64),
        angular in -5.0..5.0f64,
        fixed in any::<bool>(),
    ) -> String {
        let d = if spatial { 3 } else { 2 };
        let list = |v: &[f64]| format!("{:?}", &v[..d]);
        let turn = [turn.0, turn.1[0], turn.1[1], turn.1[2]];
        let length = turn.iter().map(|x| x * x).sum::<f64>().sqrt();
        let unit: Vec<f64> = turn.iter().map(|x| x / length).collect();
        let soft: Vec<f64> = axes.iter().map(|a| a * 1.4).collect();
        let softness = match softness {
            0 => String::new(),
            1 => format!("stiffness = {k:?}"),
            2 => format!("soft = {}", list(&soft)),
            _ => format!("layer = {:?}", axes.iter().fold(f64::MAX, |m, a| m.min(*a)) * 0.3),
        };
        let mut point = [0.0; 3];
        for i in 0..3 { point[i] = reference[i] * axes[i] / 2.0; }
        let (turn, spin) = if spatial {
            (format!("rotation = {unit:?}"), format!("[{angular:?}, 0.5, -1.0]"))
        } else {
            (format!("angle = {:?}", turn[0]), format!("{angular:?}"))
        };
        let steering = if fixed { "{ fixed = 0.785 }" } else { "\"with-flow\"" };
        format!(
            "[ds]\nlinear = {{ attractor = {}, gain = 1.0 }}\n[modulation]\nsteering = {steering}\n[[start]]\nposition = {}\n\
             [[obstacle]]\nname = \"o\"\nshape = {{ ellipsoid = {} }}\ncenter = {}\n{turn}\n{softness}\ncurvature = {curvature}\n\
             margin = {}\nreference = {}\nvelocity = {}\nangular_velocity = {spin}\n",
            list(&[0.0; 3]), list(&[-1.0; 3]), list(&axes), list(&center), list(&margin), list(&point), list(&velocity)
        )
    }
}

fn converts<S: pliant_core::Scalar, const D: usize>(scene: &Scene, t: f64) -> bool {
    scene.settings::<S>().check().is_ok()
        && scene.controller::<S, D, 64>(t).is_ok()
        && scene.start_positions::<S, D>().is_ok_and(|s| s.iter().all(|x| pliant_core::RobotState::new(*x).is_some()))
}

proptest! {
    #[test]
    fn a_scene_that_was_read_always_converts(text in random_scene(), share in 0.0..1.0f64) {
        let scene = parse(&text).unwrap();
        let t = share * scene.goal().timeout;
        if scene.dimension() == 2 {
            prop_assert!(converts::<f32, 2>(&scene, t) && converts::<f64, 2>(&scene, t));
            prop_assert!(!converts::<f64, 3>(&scene, t));
        } else {
            prop_assert!(converts::<f32, 3>(&scene, t) && converts::<f64, 3>(&scene, t));
            prop_assert!(!converts::<f64, 2>(&scene, t));
        }
    }

    #[test]
    fn gamma_here_is_the_cores(text in random_scene(), x in prop::array::uniform3(-2.0..2.0f64), t in 0.0..5.0f64) {
        let scene = parse(&text).unwrap();
        let posed = scene.obstacles()[0].at(t);
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs().max(1.0);
        if scene.dimension() == 2 {
            let at = nalgebra::Vector2::new(x[0], x[1]);
            let core = posed.to_core::<f64, 2>().unwrap();
            let x = Vector3::new(x[0], x[1], 0.0);
            prop_assert!(near(posed.gamma(&x), core.gamma(&at)) && near(posed.gamma_soft(&x), core.gamma_soft(&at)));
        } else {
            let x = Vector3::from(x);
            let core = posed.to_core::<f64, 3>().unwrap();
            prop_assert!(near(posed.gamma(&x), core.gamma(&x)) && near(posed.gamma_soft(&x), core.gamma_soft(&x)));
        }
    }

    #[test]
    fn no_text_makes_it_panic(text in "[\\[\\]a-z={}\"0-9., \n]{0,200}") {
        let _ = parse(&text);
    }

    #[test]
    fn no_damage_to_a_scene_makes_it_panic(at in 0..GOOD.len(), with in "[\\[\\]a-z={}\"0-9.\n-]{0,3}", cut in 0..6usize) {
        let end = (at + cut).min(GOOD.len());
        let damaged = format!("{}{with}{}", &GOOD[..at], &GOOD[end..]);
        if let Err(error) = parse(&damaged) {
            prop_assert!(error.to_string().starts_with("dir/bad.toml:"));
        }
    }
}
