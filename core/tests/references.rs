//! Reference points: from outside, every normal leads away from them, whatever overlaps, shrinks or is thin; and scans, which have none.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod world;

use pliant_core::shape::Polygon;
use pliant_core::{
    Ageing, Controller, Fixed, Motion, Obstacle, ObstacleSpec, RobotState, Scalar, Scan, Settings, Shape, Status,
    Vector, rotation,
};
use rand::Rng;
use world::{Kind, Random, is_long, random, share};

type V = Vector<f64, 2>;

fn controller<S: Scalar, const D: usize>(attractor: Vector<S, D>) -> Controller<S, D, 16> {
    let forever = S::from_f64(1000.0);
    let ageing = Ageing { time_to_live: forever, growth: S::from_f64(0.02), hold: forever };
    Controller::new(Motion::linear(attractor, S::one()).unwrap(), Settings { ageing, ..Settings::default() })
}

fn polygon(corners: &[[f64; 2]]) -> ObstacleSpec<f64, 2> {
    ObstacleSpec { shape: Shape::Polygon(Polygon::new(corners).unwrap()), ..ObstacleSpec::default() }
}

fn ball(center: V, radius: f64) -> ObstacleSpec<f64, 2> {
    ObstacleSpec { shape: Shape::ellipsoid(V::repeat(radius)), center, ..ObstacleSpec::default() }
}

/// The star and the bracket of `scenes/polygon-star.toml`.
fn star() -> ObstacleSpec<f64, 2> {
    polygon(&[
        [0.140, 0.000],
        [0.053, 0.038],
        [0.043, 0.133],
        [-0.020, 0.062],
        [-0.113, 0.082],
        [-0.065, 0.000],
        [-0.113, -0.082],
        [-0.020, -0.062],
        [0.043, -0.133],
        [0.053, -0.038],
    ])
}
fn bracket() -> ObstacleSpec<f64, 2> {
    polygon(&[[0.11, -0.03], [0.11, 0.03], [0.03, 0.03], [0.03, 0.11], [-0.03, 0.11], [-0.03, -0.03]])
}

/// The cosine between g and r where an obstacle is seen worst from outside, at points around it.
fn worst_sight<const D: usize>(o: &Obstacle<f64, D>, r: &mut Random, points: usize) -> f64 {
    (0..points).fold(1.0, |worst, _| {
        let direction = Vector::<f64, D>::from_fn(|_, _| r.random_range(-1.0..1.0));
        let far = 1.0 + 10f64.powf(r.random_range(-6.0..1.0));
        let x = o.spec().center + (o.surface(&direction) - o.spec().center) * far;
        let (g, arm) = (o.gradient(&x), x - o.reference());
        worst.min(g.dot(&arm) / (g.norm() * arm.norm()))
    })
}

/// And g.r over g.(x - c), at least: of a polygon g is along m, and as m.r0 <= 0.8 for every edge's and m.q >= 0.9 outside, that is
/// 1 - 0.8/0.9 = 1/9 or more.
fn worst_share<const D: usize>(o: &Obstacle<f64, D>, r: &mut Random, points: usize) -> f64 {
    (0..points).fold(1.0, |worst, _| {
        let direction = Vector::<f64, D>::from_fn(|_, _| r.random_range(-1.0..1.0));
        let far = 1.0 + 10f64.powf(r.random_range(-6.0..1.0));
        let x = o.spec().center + (o.surface(&direction) - o.spec().center) * far;
        let g = o.gradient(&x);
        worst.min(g.dot(&(x - o.reference())) / g.dot(&(x - o.spec().center)))
    })
}

#[test]
fn a_ball_at_a_polygons_end_leaves_it_its_reference_point() {
    for (spec, at) in [(star(), V::new(0.14, 0.0)), (bracket(), V::new(0.11, 0.0))] {
        for ids in [[1, 2], [2, 1]] {
            let mut c = controller(V::new(-0.6, 0.02));
            c.upsert(ids[0], Obstacle::new(spec.clone()).unwrap(), 0.0).unwrap();
            c.upsert(ids[1], Obstacle::new(ball(at, 0.03)).unwrap(), 0.0).unwrap();
            let r = &mut random(1);
            for entry in c.table().iter() {
                assert!(worst_sight(entry.obstacle(), r, 20_000) > 0.05, "{entry:?}");
            }
            let mut lost = 0;
            for i in 0..100 {
                let (sin, cos) = (f64::from(i) * 0.0628).sin_cos();
                let (mut c, mut x) = (c.clone(), V::new(cos, sin) * 0.25);
                for _ in 0..8000 {
                    let command = c.tick(&RobotState::new(x).unwrap(), 0.001);
                    assert!(!command.status.contains(Status::REFERENCE) && command.status.contains(Status::CLUSTER));
                    x += command.velocity * 0.001;
                }
                lost += u32::from((x - V::new(-0.6, 0.02)).norm() > 0.01);
            }
            // In the pocket between ball and arm.
            assert!(lost <= 6, "{lost} of 100 did not arrive");
        }
    }
}

#[test]
fn walls_keep_their_own_reference_points() {
    let room = |x: f64| ObstacleSpec {
        shape: Shape::Box { half: V::repeat(1.0), rounding: 0.1 },
        wall: true,
        center: V::new(x, 0.0),
        ..ObstacleSpec::default()
    };
    // What sticks out of both free spaces connects the walls.
    let specs = [room(0.0), room(0.05), ball(V::new(-0.9, 0.0), 0.2)];
    for ids in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        let mut c = controller(V::new(0.8, 0.0));
        for (id, spec) in ids.into_iter().zip(&specs) {
            c.upsert(id, Obstacle::new(spec.clone()).unwrap(), 0.0).unwrap();
        }
        for entry in c.table().iter().filter(|e| e.obstacle().spec().wall) {
            assert_eq!(entry.obstacle().reference(), entry.obstacle().spec().center, "{ids:?}");
        }
        for i in 0..1600 {
            let x = V::new(f64::from(i % 40) * 0.05 - 0.975, f64::from(i / 40) * 0.05 - 0.975);
            let seen = c.evaluate(&RobotState::new(x).unwrap());
            assert!(!(seen.gamma > 1.0 && seen.status.contains(Status::REFERENCE)), "{ids:?}: at {x:?}");
        }
    }
}

#[test]
fn no_reference_point_is_lost_in_clusters_of_polygons() {
    let r = &mut random(2);
    let kind = Kind { obstacles: 6, speed: 0.0, walls: false, scans: false, odd: true, thin: false };
    let (mut polygons, mut common, mut flagged) = (0, 0, 0);
    for n in 0..share(500) {
        let mut c = controller(V::new(2.0, 0.0));
        let mut last: Option<Obstacle<f64, 2>> = None;
        for id in 0..r.random_range(2..=6) {
            let Some(o) = world::obstacle::<f64, 2>(r, &kind) else { continue };
            // Its surface, or its middle, near that of the one before.
            let meets = last.as_ref().map_or(V::zeros(), |last| {
                let direction = V::from_fn(|_, _| r.random_range(-1.0..1.0));
                last.spec().center + (last.surface(&direction) - last.spec().center) * r.random_range(0.1..1.0)
            });
            let direction = V::from_fn(|_, _| r.random_range(-1.0..1.0));
            let own = (o.surface(&direction) - o.spec().center) * r.random_range(0.0..0.95);
            let o = Obstacle::new(ObstacleSpec { center: meets - own, ..o.spec().clone() }).unwrap();
            c.upsert(id, o.clone(), 0.0).unwrap();
            last = Some(o);
        }
        let at_all = |(i, e): (usize, &pliant_core::table::Entry<f64, 2>)| (i, e.obstacle().reference());
        let places: Vec<V> = c.table().iter().enumerate().map(at_all).map(|(_, x)| x).collect();
        common += u32::from(places.len() > 1 && places.iter().all(|x| (x - places[0]).norm() < 1e-12));
        flagged += u32::from(c.tick(&RobotState::new(V::repeat(1.9)).unwrap(), 0.001).status.contains(Status::CLUSTER));
        for entry in c.table().iter() {
            let o = entry.obstacle();
            assert!(o.gamma(&o.reference()) < 1.0, "{n}: {entry:?}");
            let is_polygon = matches!(o.spec().shape, Shape::Polygon(_));
            polygons += u32::from(is_polygon);
            // A core that is convex is seen whole from everywhere inside, if at a slant.
            let (sight, least) =
                if is_polygon { (worst_share(o, r, 300), 1.0 / 9.0 - 1e-9) } else { (worst_sight(o, r, 300), 0.0) };
            assert!(sight > least, "{n}: {sight} {entry:?}");
        }
    }
    println!("{polygons} polygons, {common} clusters with one point, {flagged} flagged");
    assert!(!is_long() || polygons > 500 && common > 100 && flagged > 100);
}

#[test]
fn what_shrinks_keeps_its_reference_point_inside() {
    let r = &mut random(4);
    for n in 0..share(500) {
        let kind = Kind { obstacles: 1, speed: 0.0, walls: false, scans: false, odd: true, thin: false };
        let Some(o) = world::obstacle::<f64, 2>(r, &kind) else { continue };
        let wall = r.random_bool(0.2) && !matches!(o.spec().shape, Shape::Polygon(_));
        let direction = V::from_fn(|_, _| r.random_range(-1.0..1.0));
        let own = rotation::planar(0.0) * (o.surface(&direction) - o.spec().center);
        let reference = o.spec().rotation.tr_mul(&own).component_div(&o.spec().margin) * r.random_range(0.0..0.9);
        let growth = r.random_range(-0.2..0.05);
        let spec = ObstacleSpec { reference, growth, wall, center: V::zeros(), ..o.spec().clone() };
        let Ok(o) = Obstacle::new(spec) else { continue };
        let mut c = controller(V::new(2.0, 0.0));
        let mut settings = *c.settings();
        settings.ageing =
            Ageing { time_to_live: 0.2, growth: if r.random_bool(0.5) { 0.02 } else { 0.0 }, hold: 1000.0 };
        c.set_settings(settings);
        c.upsert(1, o, 0.0).unwrap();
        // Shared with another, which goes.
        if r.random_bool(0.5) && !wall {
            let at = c.table().iter().next().unwrap().obstacle().surface(&V::from_fn(|_, _| r.random_range(-1.0..1.0)));
            c.upsert(2, Obstacle::new(ball(at, 0.1)).unwrap(), 0.0).unwrap();
        }
        for _ in 0..8 {
            for _ in 0..50 {
                c.wait(0.001);
            }
            for entry in c.table().iter() {
                let o = entry.obstacle();
                assert!(o.gamma(&o.reference()) * if wall { -1.0 } else { 1.0 } < 1.0, "{n}: {o:?}");
                if wall {
                    assert!(o.gamma(&o.reference()) > 1.0, "{n}: {o:?}");
                } else {
                    assert!(worst_sight(o, r, 50) > 0.0, "{n}: {o:?}");
                }
            }
        }
    }
}

/// Through a corridor of two rows, from here; where it ends.
fn through<S: Scalar>(rows: &[V], start: V, reach: f64) -> V {
    let number = |v: &V| v.map(S::from_f64);
    let mut c = controller(number(&V::new(reach, 0.0)));
    let points: Vec<_> = rows.iter().map(number).collect();
    c.set_scan(Scan::new(&points, S::from_f64(0.03)).unwrap(), S::zero());
    let (mut x, dt) = (start, 0.001);
    for _ in 0..12_000 {
        let command = c.tick(&RobotState::new(number(&x)).unwrap(), S::from_f64(dt));
        x += command.velocity.map(|v| v.to_f64()) * dt;
    }
    x
}

#[test]
fn the_middle_of_a_corridor_of_points_is_no_dead_end() {
    let rows =
        |n: i32| -> Vec<V> { (0..n).flat_map(|i| [0.1, -0.1].map(|y| V::new(0.02 * f64::from(i), y))).collect() };
    for rows in [rows(40), rows(1)] {
        for i in -20..=20 {
            // 1 mm to each side, the middle itself, and a few micrometres beside it.
            let y = 1e-3 * (f64::from(i) / 20.0).powi(5);
            let start = V::new(-0.3, y);
            for (name, end) in [
                ("f64", through::<f64>(&rows, start, 1.2)),
                ("f32", through::<f32>(&rows, start, 1.2)),
                ("fixed", through::<Fixed>(&rows, start, 1.2)),
            ] {
                assert!((end - V::new(1.2, 0.0)).norm() < 0.01, "{name} from {start:?} to {end:?}");
            }
        }
    }
}

#[test]
fn a_notch_is_left_along_its_sides() {
    // Close to both sides of a notch one half-space a piece is kept, and what is wished runs along one of them.
    let goal = V::new(0.1355, -0.211);
    let mut lost = Vec::new();
    for i in 0..400 {
        let mut c = controller(goal);
        c.upsert(1, Obstacle::new(ObstacleSpec { soft_ratio: V::repeat(1.3), ..bracket() }).unwrap(), 0.0).unwrap();
        let start = V::new(0.0301 + 0.004 * f64::from(i % 20), 0.0301 + 0.004 * f64::from(i / 20));
        let mut x = start;
        for _ in 0..4000 {
            x += c.tick(&RobotState::new(x).unwrap(), 0.002).velocity * 0.002;
        }
        if (x - goal).norm() > 0.01 {
            lost.push((start, x));
        }
    }
    assert!(lost.is_empty(), "{} of 400, such as {:?}", lost.len(), lost.first());
}
