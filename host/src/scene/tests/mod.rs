mod random;
mod shapes;
mod shipped;
mod surroundings;
mod wrong;

use std::path::{Path, PathBuf};

use miette::Diagnostic;
use nalgebra::Vector3;

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

#[test]
fn the_caret_is_under_the_fault() {
    let error = parse(&GOOD.replace("[0.04, 0.05]", "[0.04, -7.25]")).unwrap_err();
    let label = error.labels().unwrap().next().unwrap();
    let text = GOOD.replace("[0.04, 0.05]", "[0.04, -7.25]");
    assert_eq!(&text[label.offset()..label.offset() + label.len()], "-7.25");
    let handler = miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::unicode_nocolor());
    let mut out = String::new();
    handler.render_report(&mut out, &error).unwrap();
    assert!(out.contains("dir/bad.toml, line 13: ") && out.contains("help: allowed:"), "{out}");
}

#[test]
fn a_file_that_is_not_there_and_one_that_is_not_text() {
    let error = Scene::load("no/such/scene.toml").unwrap_err();
    assert_eq!(error.kind(), SceneErrorKind::Unreadable);
    assert!(error.to_string().starts_with("no/such/scene.toml: cannot be read"));
    assert!(error.help().unwrap().to_string().starts_with("give the path of a scene file"));
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
    let certificate =
        "m.toml, line 10: model `m` has no valid certificate: component 1: a' P + P a is not negative definite";
    for (text, word) in [("format = ", "m.toml, line 1: "), (unstable.as_str(), certificate)] {
        let error = model(text).unwrap_err();
        assert_eq!((error.kind(), error.line(), error.field()), (SceneErrorKind::Model, Some(2), "ds.model"));
        // What is read is what `pliant check` says of the model; and where the scene names it.
        assert!(error.to_string().starts_with(word), "{error}");
        let source = error.source_code().unwrap();
        let label = error.labels().unwrap().next().unwrap();
        assert_eq!(source.read_span(label.inner(), 0, 0).unwrap().name(), Some("m.toml"));
        assert_eq!(error.help().unwrap().to_string(), "it is named by s.toml, line 2: ds.model");
        assert!(error.diagnostic_source().is_none(), "said once");
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

/// The page of all keys, and each key's line in it.
#[test]
fn every_key_is_in_the_docs_as_errors_quote_it() {
    let page = std::fs::read_to_string(folder("docs").join("scenes.md")).unwrap();
    let rows: Vec<_> = page.lines().filter(|line| line.starts_with("| `")).collect();
    let wanted: Vec<String> = fields::ALLOWED.iter().map(|(key, what)| format!("| `{key}` | {what} |")).collect();
    assert_eq!(rows.len(), wanted.len(), "a row a key:\n{}", wanted.join("\n"));
    for (row, wanted) in rows.iter().zip(&wanted) {
        assert_eq!(row, wanted);
    }
}
