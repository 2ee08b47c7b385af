//! Range points, a goal that moves, and the guard.

use pliant_core::Guard;

use super::wrong::{Case, refused};
use super::*;

const SCANNED: &str = r#"[ds]
linear = { attractor = [0.0, 0.0], gain = 1.0 }
[guard]
approach = 0.25
[attractor]
path = [[1.0, 0.1, 0.0], [3.0, 0.1, 0.4]]
[scan]
radius = 0.05
points = [
    [0.3, 0.1],
    [0.3, 0.2],
]
[[start]]
position = [0.4, 0.4]
"#;

#[rustfmt::skip]
const WRONG: &[Case] = &[
    // scan
    (SCANNED, "    [0.3, 0.1],\n    [0.3, 0.2],\n", "", 9, "scan.points", "has 0 points"),
    (SCANNED, "radius = 0.05\n", "", 7, "scan.radius", "is missing"),
    (SCANNED, "radius = 0.05", "radius = 0.0", 8, "scan.radius", "too small"),
    (SCANNED, "radius = 0.05", "radius = 101", 8, "scan.radius", "too large"),
    (SCANNED, "[0.3, 0.2]", "[0.3, 0.2, 0.1]", 11, "scan.points", "has 3 numbers"),
    (SCANNED, "[0.3, 0.2]", "[0.3, 2000]", 11, "scan.points", "too large"),
    (SCANNED, "[0.3, 0.2]", "[0.03, 0.02]", 11, "scan.points", "the attractor is within the radius"),
    // The end of its path counts too.
    (SCANNED, "[0.3, 0.2]", "[0.13, 0.42]", 11, "scan.points", "the attractor is within the radius"),
    (SCANNED, "[0.4, 0.4]", "[0.31, 0.21]", 14, "start.position", "one of the scan's points"),
    (SCANNED, "points = [", "dots = [", 9, "scan.dots", "did you mean `points`"),
    // attractor
    (SCANNED, "path = [[1.0, 0.1, 0.0], [3.0, 0.1, 0.4]]\n", "", 5, "attractor", "neither `velocity` nor `path`"),
    (SCANNED, "path = [[", "velocity = [0.1, 0.0]\npath = [[", 6, "attractor.velocity", "beside `path`"),
    (SCANNED, "[1.0, 0.1, 0.0]", "[1.0, 0.1]", 6, "attractor.path", "a time and 2 coordinates make 3"),
    (SCANNED, "[1.0, 0.1, 0.0]", "[4.0, 0.1, 0.0]", 6, "attractor.path", "does not come after 4"),
    (SCANNED, "path = [[1.0, 0.1, 0.0], [3.0, 0.1, 0.4]]", "velocity = [40.0, 0.0]", 6, "attractor.velocity", "before the timeout"),
    (SCANNED, "path = [[1.0, 0.1, 0.0], [3.0, 0.1, 0.4]]", "velocity = [400.0, 0.0]", 6, "attractor.velocity", "too large"),
    // guard
    (SCANNED, "approach = 0.25", "approach = 0", 4, "guard.approach", "too small"),
    (SCANNED, "approach = 0.25", "approach = 1.5", 4, "guard.approach", "too large"),
    (SCANNED, "approach = 0.25", "enabled = false\napproach = 0.25", 5, "guard.approach", "beside `enabled = false`"),
    (SCANNED, "approach = 0.25", "enabled = 0", 4, "guard.enabled", "expected a boolean"),
];

#[test]
fn what_is_wrong_with_the_surroundings_is_named() {
    parse(SCANNED).unwrap();
    refused(WRONG);
    let ball = "[[obstacle]]\nname = \"b\"\nshape = { ellipsoid = [0.05, 0.05] }\ncenter = [0.1, 0.38]\n";
    let error = parse(&format!("{SCANNED}{ball}")).unwrap_err();
    assert_eq!(error.field(), "obstacle.center");
    assert!(error.to_string().contains("the end of the attractor's path inside the hard core"), "{error}");
    let many = (0..129).map(|i| format!("[{i}, 9],")).collect::<String>();
    let error = parse(&SCANNED.replace("    [0.3, 0.1],\n", &many)).unwrap_err();
    assert!(error.field() == "scan.points" && error.to_string().contains("has 130 points"), "{error}");
}

#[test]
fn a_scan_is_the_cores() {
    let scene = parse(SCANNED).unwrap();
    let scan = scene.scan().unwrap();
    let core = scene.core_scan::<f64, 2>().unwrap().unwrap();
    for x in [[0.3, 0.15], [0.0, 0.0], [0.301, 0.199]] {
        let x = Vector3::new(x[0], x[1], 0.0);
        assert!((scan.gamma(&x) / core.gamma(&x.xy()) - 1.0).abs() < 1e-12);
    }
    let controller = scene.controller::<f64, 2, 4>(0.0).unwrap();
    assert_eq!(controller.table().scan().points().len(), 2);
}

#[test]
fn the_goal_follows_its_path() {
    let scene = parse(SCANNED).unwrap();
    assert!(scene.attractor_moves() && scene.attractor() == Vector3::zeros());
    // From where the motion has it to the path's first point, along the path, and at rest at its end.
    for (t, x, v) in [(0.5, [0.05, 0.0], [0.1, 0.0]), (2.0, [0.1, 0.2], [0.0, 0.2]), (9.0, [0.1, 0.4], [0.0, 0.0])] {
        let (position, velocity) = scene.attractor_at(t);
        assert!((position.xy() - nalgebra::Vector2::from(x)).norm() < 1e-12, "{t}: {position}");
        assert!((velocity.xy() - nalgebra::Vector2::from(v)).norm() < 1e-12, "{t}: {velocity}");
        let core = scene.controller::<f64, 2, 1>(t).unwrap();
        assert!((core.motion().attractor() - position.xy()).norm() < 1e-12);
        assert_eq!(*core.motion().drift(), velocity.xy());
    }
    // A path that begins at once may begin anywhere; a velocity begins at home.
    let path = "path = [[1.0, 0.1, 0.0], [3.0, 0.1, 0.4]]";
    let elsewhere = parse(&SCANNED.replace(path, "path = [[0.0, -0.1, 0.0]]")).unwrap();
    assert!(elsewhere.attractor_moves() && elsewhere.attractor().x == -0.1);
    let straight = parse(&SCANNED.replace(path, "velocity = [0.1, 0.0]")).unwrap();
    assert!((straight.attractor_at(2.0).0.x - 0.2).abs() < 1e-12);
    let at_rest = parse(&SCANNED.replace(path, "velocity = [0.0, 0.0]")).unwrap();
    assert!(!at_rest.attractor_moves());
}

#[test]
fn the_guard_is_on_unless_it_is_off() {
    let guard = |text: &str| parse(&SCANNED.replace("approach = 0.25", text)).unwrap().settings::<f64>().guard;
    assert_eq!(guard(""), Some(Guard::default()));
    assert_eq!(guard("enabled = true"), Some(Guard::default()));
    assert_eq!(guard("approach = 0.25"), Some(Guard { approach: 0.25 }));
    assert_eq!(guard("enabled = false"), None);
}
