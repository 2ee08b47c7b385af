//! Shapes, walls, and sizes that change.

use super::wrong::{Case, refused};
use super::*;

const BOX: &str = r#"[ds]
linear = { attractor = [0.0, 0.0], gain = 1.0 }
[[start]]
position = [0.4, 0.4]
[[obstacle]]
name = "crate"
shape = { box = [0.1, 0.05], rounding = 0.02 }
center = [0.3, 0.1]
"#;

const POLYGON: &str = r#"[ds]
linear = { attractor = [0.0, 0.0], gain = 1.0 }
[[start]]
position = [0.4, 0.4]
[[obstacle]]
name = "arrow"
center = [0.3, 0.1]
shape = { polygon = [
    [0.1, 0.0],
    [-0.06, 0.08],
    [-0.02, 0.0],
    [-0.06, -0.08],
] }
"#;

const ROUND: &str = r#"[ds]
linear = { attractor = [0.0, 0.0, 0.0], gain = 1.0 }
[[start]]
position = [0.4, 0.4, 0.0]
[[obstacle]]
name = "pipe"
shape = { cylinder = [0.05, 0.1], rounding = 0.01 }
center = [0.3, 0.1, 0.0]
"#;

const ROOM: &str = r#"[ds]
linear = { attractor = [0.3, 0.0], gain = 1.0 }
[[start]]
position = [-0.3, 0.1]
[[obstacle]]
name = "room"
shape = { box = [0.5, 0.4] }
wall = true
center = [0.0, 0.0]
layer = 0.1
growth = 0.0
reference = [0.0, 0.0]
"#;

#[rustfmt::skip]
const WRONG: &[Case] = &[
    // which shape
    (BOX, "{ box = [0.1, 0.05], rounding = 0.02 }", "{ rounding = 0.02 }", 7, "obstacle.shape", "names no shape"),
    (BOX, "{ box =", "{ ellipsoid = [1, 1], box =", 7, "obstacle.shape.box", "beside `ellipsoid`"),
    (BOX, "{ box =", "{ cube =", 7, "obstacle.shape.cube", "there is no key `cube`"),
    (BOX, "{ box =", "{ ellipsoid =", 7, "obstacle.shape.rounding", "not for `ellipsoid`"),
    (BOX, "center =", "curvature = 2\ncenter =", 8, "obstacle.curvature", "not for `box`"),
    (BOX, "{ box = [0.1, 0.05], rounding = 0.02 }", "{ capsule = [0.1, 0.05] }", 7, "obstacle.shape.capsule", "round at both ends"),
    (BOX, "{ box = [0.1, 0.05], rounding = 0.02 }", "{ cylinder = [0.1, 0.05] }", 7, "obstacle.shape.cylinder", "three dimensions"),
    (ROUND, "{ cylinder = [0.05, 0.1], rounding = 0.01 }", "{ polygon = [[0, 1]] }", 7, "obstacle.shape.polygon", "two dimensions"),
    // sizes
    (BOX, "[0.1, 0.05]", "[0.1]", 7, "obstacle.shape.box", "has 1 number"),
    (BOX, "[0.1, 0.05]", "[0.1, 0.0]", 7, "obstacle.shape.box", "too small"),
    (BOX, "rounding = 0.02", "rounding = 0.051", 7, "obstacle.shape.rounding", "too large"),
    (BOX, "rounding = 0.02", "rounding = 0", 7, "obstacle.shape.rounding", "too small"),
    (ROUND, "[0.05, 0.1]", "[0.05]", 7, "obstacle.shape.cylinder", "a radius and half a length make 2"),
    (ROUND, "[0.05, 0.1]", "[0.05, 0.1, 0.1]", 7, "obstacle.shape.cylinder", "has 3 numbers"),
    (ROUND, "[0.05, 0.1]", "[0.05, 0.0]", 7, "obstacle.shape.cylinder", "too small"),
    (ROUND, "rounding = 0.01", "rounding = 0.06", 7, "obstacle.shape.rounding", "too large"),
    (ROUND, "cylinder = [0.05, 0.1], rounding = 0.01", "capsule = [0.05, 0.1], rounding = 0.01", 7, "obstacle.shape.rounding", "capsule"),
    (ROUND, "cylinder = [0.05, 0.1], rounding = 0.01", "capsule = [0.05, -0.1]", 7, "obstacle.shape.capsule", "too small"),
    // corners
    (POLYGON, "    [-0.02, 0.0],\n    [-0.06, -0.08],\n", "", 8, "obstacle.shape.polygon", "has 2 corners"),
    (POLYGON, "    [0.1, 0.0],\n", "    [0.1, 0.0, 0.0],\n", 9, "obstacle.shape.polygon", "has 3 numbers"),
    (POLYGON, "[-0.02, 0.0]", "[0.02, 0.0]", 10, "obstacle.shape.polygon", "shows the origin its outer side"),
    (POLYGON, "[-0.02, 0.0]", "[nan, 0.0]", 11, "obstacle.shape.polygon", "NaN"),
    (POLYGON, "[-0.06, 0.08]", "[-0.06, 0.0]", 9, "obstacle.shape.polygon", "passes through it"),
    (POLYGON, "center =", "reference = [-0.05, 0.0]\ncenter =", 7, "obstacle.reference", "does not see the whole polygon"),
    // one factor for a polygon
    (POLYGON, "center =", "soft = [0.15, 0.1]\ncenter =", 7, "obstacle.soft", "1.5000 times as large along one axis and 1.2500 along the other"),
    (POLYGON, "center =", "soft = [0.15, 0.1]\ncenter =", 7, "obstacle.soft", "such as [0.15, 0.12]; or `stiffness`, or `layer`"),
    (POLYGON, "center =", "wall = true\nsoft = [0.08, 0.04]\ncenter =", 8, "obstacle.soft", "such as [0.05, 0.04]"),
    (POLYGON, "center =", "margin = [1.0, 1.2]\ncenter =", 7, "obstacle.margin", "is 1 along one axis and 1.2 along the other"),
    (POLYGON, "center =", "margin = [1.0, 1.2]\ncenter =", 7, "obstacle.margin", "such as [1.2, 1.2]"),
    (POLYGON, "center =", "layer = 2.0\ncenter =", 7, "obstacle.layer", "comes within 0.02 m of its centre, 1.0100e2 times"),
    (POLYGON, "center =", "wall = true\nlayer = 0.0199\ncenter =", 8, "obstacle.layer", "less than a hundredth"),
    // walls
    (ROOM, "wall = true", "wall = \"yes\"", 8, "obstacle.wall", "expected a boolean"),
    (ROOM, "[-0.3, 0.1]", "[-0.6, 0.1]", 4, "start.position", "outside the free space of the wall \"room\""),
    (ROOM, "[0.3, 0.0]", "[0.51, 0.0]", 9, "obstacle.center", "outside the wall's free space"),
    (ROOM, "layer = 0.1", "layer = 0.1\nmargin = [1.0, 5.0]", 4, "start.position", "outside the free space"),
    (ROOM, "layer = 0.1", "layer = 0.4", 10, "obstacle.layer", "less than a hundredth"),
    (ROOM, "layer = 0.1", "soft = [0.6, 0.3]", 10, "obstacle.soft", "larger than the hard semi-axis"),
    (ROOM, "reference = [0.0, 0.0]", "reference = [0.5, 0.0]", 12, "obstacle.reference", "outside the free space"),
    // growth
    (ROOM, "growth = 0.0", "growth = 101", 11, "obstacle.growth", "too large"),
    (ROOM, "growth = 0.0", "growth = 50.0", 11, "obstacle.growth", "larger than 1000 m before the timeout"),
];

#[test]
fn what_is_wrong_with_a_shape_is_named() {
    for good in [BOX, POLYGON, ROUND, ROOM] {
        parse(good).unwrap();
    }
    refused(WRONG);
}

#[test]
fn a_reference_point_shrinks_with_its_core() {
    let scene =
        parse(&ROOM.replace("growth = 0.0\nreference = [0.0, 0.0]", "growth = -0.01\nreference = [0.2, 0.0]")).unwrap();
    let room = scene.obstacles()[0].at(10.0);
    let core = room.to_core::<f64, 2>().unwrap();
    assert!((core.reference().x - 0.2 * room.shape.extent().x / 0.5).abs() < 1e-12, "{}", core.reference());
}

#[test]
fn a_rounding_that_is_left_out_is_a_tenth_of_the_least_half_side() {
    let of = |text: &str, from: &str, to: &str| parse(&text.replace(from, to)).unwrap().obstacles()[0].shape().clone();
    let half = Vector3::new(0.1, 0.05, 0.0);
    assert_eq!(of(BOX, ", rounding = 0.02", ""), Shape::Box { half, rounding: 0.05 * 0.1 });
    let can = Shape::Cylinder { radius: 0.05, half_length: 0.1, rounding: 0.05 * 0.1 };
    assert_eq!(of(ROUND, ", rounding = 0.01", ""), can);
}

#[test]
fn a_clockwise_polygon_is_turned_round() {
    let other_way = r"[[0.1, 0.0], [-0.06, -0.08], [-0.02, 0.0], [-0.06, 0.08]]";
    let (from, to) = (POLYGON.find("[\n").unwrap(), POLYGON.find("] }").unwrap());
    let text = format!("{}{other_way}{}", &POLYGON[..from], &POLYGON[to + 1..]);
    let shape = |text: &str| parse(text).unwrap().obstacles()[0].shape().clone();
    assert_eq!(shape(&text), shape(POLYGON));
    // The corner that is named is the one in the file.
    let error = parse(&text.replace("[-0.02, 0.0]", "[0.02, 0.0]")).unwrap_err();
    let label = error.labels().unwrap().next().unwrap();
    let (from, to) = (label.offset(), label.offset() + label.len());
    let text = text.replace("[-0.02, 0.0]", "[0.02, 0.0]");
    assert!(["[0.02, 0.0]", "[-0.06, 0.08]", "[-0.06, -0.08]"].contains(&&text[from..to]), "{}", &text[from..to]);
}

#[test]
fn a_walls_inside_is_free_and_its_soft_layer_within() {
    let scene = parse(ROOM).unwrap();
    let room = scene.obstacles()[0].at(0.0);
    let at = |x: f64| Vector3::new(x, 0.0, 0.0);
    assert!(room.gamma(&at(0.49)) > 1.0 && room.gamma(&at(0.51)) < 1.0);
    assert!(room.gamma_soft(&at(0.39)) > 1.0 && room.gamma_soft(&at(0.41)) < 1.0);
    assert!((room.soft_surface(&at(1.0)).x - 0.4).abs() < 1e-12);
}

#[test]
fn growth_lengthens_every_half_extent_and_ends_small() {
    let reach = |text: &str, rate: f64, t: f64, axis: usize| {
        let scene = parse(&text.replace("center =", &format!("growth = {rate:?}\ncenter ="))).unwrap();
        let o = &scene.obstacles()[0];
        assert!(o.is_moving());
        let mut direction = Vector3::zeros();
        direction[axis] = 1.0;
        let posed = o.at(t);
        (posed.surface(&direction) - posed.pose.center).norm()
    };
    let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
    assert!(near(reach(BOX, 0.02, 2.0, 0), 0.14) && near(reach(BOX, 0.02, 2.0, 1), 0.09));
    assert!(near(reach(BOX, -0.02, 2.0, 0), 0.06) && near(reach(BOX, -0.02, 2.0, 1), 0.01));
    assert!(near(reach(ROUND, 0.02, 2.0, 2), 0.14));
    // A polygon grows in proportion, its nearest edge by 4 cm.
    let nearest = 0.0016 / 0.04f64.hypot(0.08);
    assert!(near(reach(POLYGON, 0.02, 2.0, 0), 0.1 * (1.0 + 0.04 / nearest)));
    let scene = parse(&BOX.replace("center =", "growth = -0.02\ncenter =")).unwrap();
    let last = scene.obstacles()[0].at(20.0);
    assert!(last.shape.extent().y < 2e-4 && last.growth == 0.0, "{:?}", last.shape);
}

/// What a device makes of a sighting while it waits for the next is never smaller than what is then seen.
#[test]
fn what_grows_or_shrinks_is_extrapolated_on_the_safe_side() {
    for (text, rate) in [(BOX, "0.05"), (POLYGON, "0.05"), (BOX, "-0.005"), (POLYGON, "-0.005")] {
        let scene = parse(&text.replace("center =", &format!("growth = {rate}\ncenter ="))).unwrap();
        let o = &scene.obstacles()[0];
        for i in 0..90 {
            let angle = f64::from(i) * std::f64::consts::TAU / 90.0;
            let direction = Vector3::new(angle.cos(), angle.sin(), 0.0);
            let grown = o.at(1.0 + 0.033).surface(&direction);
            let mut table = pliant_core::Table::<f64, 2, 1>::new();
            let seen = o.at(1.0).to_core::<f64, 2>().unwrap();
            table.upsert(0, seen, 0.033, &pliant_core::Ageing::default()).unwrap();
            let gamma = table.iter().next().unwrap().obstacle().gamma(&grown.xy());
            assert!(gamma < 1.0 + 1e-9, "{gamma} at {angle}");
        }
    }
}

/// A star, whose notches' edges point past its centre, and the notched polygon above.
const OUTLINES: [&str; 2] = [
    "[[0.14, 0.0], [0.053, 0.038], [0.043, 0.133], [-0.02, 0.062], [-0.113, 0.082], \
     [-0.065, 0.0], [-0.113, -0.082], [-0.02, -0.062], [0.043, -0.133], [0.053, -0.038]]",
    "[[0.1, 0.0], [-0.06, 0.08], [-0.02, 0.0], [-0.06, -0.08]]",
];

/// An obstacle with this outline and layer, or a wall, whose inside then holds the start and the goal.
fn layered(outline: &str, wall: bool, layer: f64) -> Scene {
    let place = if wall { "[0.2, 0.1]" } else { "[0.0, 0.0]" };
    parse(&format!(
        "ds.linear = {{ attractor = [0.2, 0.1], gain = 1.0 }}\n[[start]]\nposition = [0.201, 0.1]\n[[obstacle]]\nname = \"p\"\n\
         shape = {{ polygon = {outline} }}\nwall = {wall}\nlayer = {layer:?}\ncenter = {}\n",
        if wall { place } else { "[-3.0, 0.0]" }
    ))
    .unwrap()
}

/// How thick the layer is from the centre outwards, in 3600 directions and towards each corner: the least and the largest.
fn seen_from_the_centre(scene: &Scene) -> (f64, f64) {
    let o = scene.obstacles()[0].at(0.0);
    let Shape::Polygon { vertices } = &o.shape else { panic!("a polygon") };
    let corners = vertices.iter().map(|[x, y]| y.atan2(*x));
    let ways = (0..3600).map(|i| f64::from(i) * std::f64::consts::TAU / 3600.0).chain(corners);
    let thickness = |way: f64| {
        let direction = Vector3::new(way.cos(), way.sin(), 0.0);
        (o.surface(&direction) - o.soft_surface(&direction)).norm()
    };
    ways.map(thickness).fold((f64::INFINITY, 0.0), |(least, most), t| (t.min(least), t.max(most)))
}

#[test]
fn a_polygons_layer_is_as_thick_as_asked_where_its_boundary_is_nearest_and_nowhere_thinner() {
    for outline in OUTLINES {
        for wall in [false, true] {
            let (least, _) = seen_from_the_centre(&layered(outline, wall, 0.01));
            assert!((0.01 - 1e-9..0.01 + 1e-6).contains(&least), "{least} (wall: {wall})");
        }
    }
}

/// The line of a notch's edge passes 3 cm from the centre of this room, the boundary nowhere within 30 cm.
#[test]
fn a_notch_does_not_thicken_a_rooms_layer() {
    let room = "[[0.5, -0.5], [0.5, 0.5], [0.05, 0.5], [0.0, 0.3], [-0.05, 0.5], [-0.5, 0.5], [-0.5, -0.5]]";
    for wall in [false, true] {
        let (least, most) = seen_from_the_centre(&layered(room, wall, 0.05));
        // In proportion: the corners are sqrt(0.5) m from the centre.
        let proportion = 0.5f64.sqrt() / 0.3;
        assert!((least - 0.05).abs() < 1e-6 && (most - 0.05 * proportion).abs() < 1e-6, "{least} to {most}");
    }
}
