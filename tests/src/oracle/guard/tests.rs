use super::super::random_scene::{PointKind, Recipe, generate_from};
use super::super::scene::{OracleObstacle, OracleScan, OracleShape};
use super::super::{carried, evaluate};
use super::*;

fn v(values: &[f64]) -> DVector<f64> {
    DVector::from_column_slice(values)
}

fn bound(normal: &[f64], least: f64) -> Bound {
    Bound { normal: unit(&v(normal)).unwrap(), least }
}

fn scene(obstacles: Vec<OracleObstacle>) -> OracleScene {
    let mut scene = generate_from(&Recipe::plain(obstacles[0].center.len()), 2, 0).scene;
    scene.obstacles = obstacles;
    scene.limits.speed = 1.0;
    scene.guard = None;
    scene
}

#[test]
fn the_nearest_point_by_hand() {
    let wanted = v(&[-3.0, 1.0]);
    let near = |bounds: &[Bound], radius| nearest(bounds, &wanted, radius);
    assert!((near(&[], 10.0).unwrap() - &wanted).amax() == 0.0);
    assert!((near(&[bound(&[1.0, 0.0], -1.0)], 10.0).unwrap() - v(&[-1.0, 1.0])).amax() < 1e-15);
    // A corner, and the ball alone.
    let corner = [bound(&[1.0, 0.0], -1.0), bound(&[0.0, 1.0], 2.0)];
    assert!((near(&corner, 10.0).unwrap() - v(&[-1.0, 2.0])).amax() < 1e-15);
    assert!((near(&[], 1.0).unwrap() - &wanted / 10.0_f64.sqrt()).amax() < 1e-15);
    // A line and the rim: -0.6 and, of 1 and -1, the nearer.
    assert!((near(&[bound(&[1.0, 0.0], -0.6)], 1.0).unwrap() - v(&[-0.6, 0.8])).amax() < 1e-15);
    assert_eq!(near(&corner, 1.9), None);
    assert_eq!(near(&[bound(&[1.0, 0.0], 1.0), bound(&[-1.0, 0.0], -0.5)], 10.0), None);
}

#[test]
fn the_nearest_point_is_not_beaten_by_any_other() {
    for seed in 0..300 {
        let d = 2 + (seed % 2) as usize;
        let random = generate_from(&Recipe { scans: 0.0, clusters: 0.0, ..Recipe::plain(d) }, seed, 4);
        let take = |i: usize| v(&random.points[i % random.points.len()].x);
        let bounds: Vec<Bound> =
            (0..5).filter_map(|i| Some(Bound { normal: unit(&take(i))?, least: -0.4 + 0.1 * i as f64 })).collect();
        let wanted = take(7);
        let Some(best) = nearest(&bounds, &wanted, 1.0) else {
            // Then the least violation is above 0, and just that much makes it possible.
            let t = least_violation(&bounds, d, 1.0);
            let eased =
                |t: f64| -> Vec<Bound> { bounds.iter().map(|b| Bound { least: b.least - t, ..b.clone() }).collect() };
            assert!(t > 0.0 && nearest(&eased(t + 1e-6), &wanted, 1.0).is_some());
            assert!(nearest(&eased(t - 1e-6), &wanted, 1.0).is_none());
            continue;
        };
        let keeps = |u: &DVector<f64>| u.norm() <= 1.0 && bounds.iter().all(|b| b.normal.dot(u) >= b.least);
        let size = (&best - &wanted).norm();
        for i in 0..2000 {
            let i = f64::from(i);
            let other = DVector::from_fn(d, |j, _| ((i * [12.9, 78.2, 37.7][j]).sin() * 43758.5).fract());
            assert!(!keeps(&other) || (other - &wanted).norm() >= size - 1e-9);
            let near = &best + (&wanted - &best) * 1e-3 + DVector::from_fn(d, |j, _| 1e-3 * (i * (j + 1) as f64).sin());
            assert!(!keeps(&near) || (near - &wanted).norm() >= size - 1e-9);
        }
    }
}

#[test]
fn half_spaces_by_hand() {
    let of = |obstacle: OracleObstacle, x: &[f64]| {
        let spaces = half_spaces(&scene(vec![obstacle]), x, &vec![0.0; x.len()], 0.1).unwrap();
        assert!(spaces.complete);
        assert!(spaces.determined);
        spaces.all
    };
    // A disc: its radius away.
    let disc = of(OracleObstacle::still(&[0.0, 0.0], &[1.0, 1.0]), &[0.0, 2.0]);
    assert!((disc[0].gap - 1.0).abs() < 1e-15 && disc[0].normal == vec![0.0, 1.0]);
    // A curved one, along an axis; and from within.
    let curved = of(OracleObstacle::still(&[0.0, 0.0], &[1.0, 2.0]).curved(2), &[3.0, 0.0]);
    assert!((curved[0].gap - 2.0).abs() < 1e-14);
    let deep = of(OracleObstacle::still(&[0.0, 0.0], &[1.0, 2.0]), &[-0.25, 0.0]);
    assert!((deep[0].gap + 0.75).abs() < 1e-15 && deep[0].normal == vec![-1.0, 0.0]);
    // A box: its face, exactly.
    let block = OracleShape::Box { half: vec![1.0, 0.5], rounding: 0.1 };
    let block = of(OracleObstacle::of(&[0.0, 0.0], block), &[0.3, 2.0]);
    assert!((block[0].gap - 1.5).abs() < 1e-14 && (block[0].normal[1] - 1.0).abs() < 1e-14);
    // Within a ring of radius 2: gamma = 1/4, 1.2 p (2p - 1) L^2 = 1.2 (0.1/2)^2, |grad gamma| = 1/2.
    let ring = of(OracleObstacle::still(&[0.0, 0.0], &[2.0, 2.0]).inside_out(), &[1.0, 0.0]);
    assert!((ring[0].gap - (0.75 - 0.003) * 2.0).abs() < 1e-14 && ring[0].normal == vec![-1.0, 0.0]);
    // Within a room of 2 by 1 with corners of 0.3, near one of them, 0.1 from 1.7, 0.7.
    let room = OracleShape::Box { half: vec![2.0, 1.0], rounding: 0.3 };
    let room = of(OracleObstacle::of(&[0.0, 0.0], room).inside_out(), &[1.76, 0.78]);
    assert!((room[0].gap - (0.08_f64.sqrt() - 0.1)).abs() < 1e-14);
    assert!((room[0].normal[0] + 0.6).abs() < 1e-14 && (room[0].normal[1] + 0.8).abs() < 1e-14);
    // A diamond: straight above it, its corner; beside it, an edge.
    let diamond = || OracleShape::Polygon { vertices: vec![[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]] };
    let above = of(OracleObstacle::of(&[0.0, 0.0], diamond()), &[0.0, 3.0]);
    assert!(above.len() == 1 && (above[0].gap - 2.0).abs() < 1e-14 && (above[0].normal[1] - 1.0).abs() < 1e-14);
    let beside = of(OracleObstacle::of(&[0.0, 0.0], diamond()), &[1.0, 1.0]);
    assert!(beside.len() == 1 && (beside[0].gap - 0.5_f64.sqrt()).abs() < 1e-14);
    // Inside, the edge is the side that is least far.
    let inside = of(OracleObstacle::of(&[0.0, 0.0], diamond()), &[0.4, 0.4]);
    assert!((inside[0].gap + 0.2 * 0.5_f64.sqrt()).abs() < 1e-14);
    // From within, the sectors beyond the edges.
    let within = of(OracleObstacle::of(&[0.0, 0.0], diamond()).inside_out(), &[0.1, 0.1]);
    assert!((within[0].gap - 0.8 * 0.5_f64.sqrt()).abs() < 1e-14);
    assert!((within[0].normal[0] + 0.5_f64.sqrt()).abs() < 1e-14);
    // An L, cut at three of its corners: the outline of every piece has the one that x is beyond, so all have the same half-space.
    let vertices = vec![[11.0, -3.0], [11.0, 3.0], [3.0, 3.0], [3.0, 11.0], [-3.0, 11.0], [-3.0, -3.0]];
    let seen = of(OracleObstacle::of(&[0.0, 0.0], OracleShape::Polygon { vertices }), &[-4.0, 12.0]);
    let half = 0.5_f64.sqrt();
    let same = seen.iter().filter(|s| (s.normal[0] + half).abs() < 1e-14 && (s.gap - 2.0 * half).abs() < 1e-13);
    assert_eq!((seen.len(), same.count()), (4, 4));
    assert!(seen.iter().all(|s| s.gap > 1.4), "{seen:?}");
    // A star of four points: the narrow pieces on the other side of the origin are kept off by the line through it across x.
    let (tip, notch) = (5.0, 1.0);
    let vertices = vec![
        [tip, 0.0],
        [notch, notch],
        [0.0, tip],
        [-notch, notch],
        [-tip, 0.0],
        [-notch, -notch],
        [0.0, -tip],
        [notch, -notch],
    ];
    let seen = of(OracleObstacle::of(&[0.0, 0.0], OracleShape::Polygon { vertices }), &[0.0, 6.0]);
    let across = seen.iter().filter(|s| (s.normal[1] - 1.0).abs() < 1e-14 && (s.gap - 6.0).abs() < 1e-13);
    assert_eq!((seen.len(), across.count()), (4, 1), "{seen:?}");
}

#[test]
fn a_scan_gives_one_half_space_a_point() {
    let mut next = scene(vec![OracleObstacle::still(&[9.0, 9.0], &[1.0, 1.0])]);
    next.scan = Some(OracleScan { points: vec![vec![0.0, 0.0], vec![0.0, 3.0]], radius: 0.25 });
    let spaces = half_spaces(&next, &[0.0, 1.0], &[0.0, -1.0], 0.1).unwrap();
    assert_eq!(spaces.all[1..].iter().map(|s| s.gap).collect::<Vec<_>>(), vec![0.75, 1.75]);
    // Half of the gap in one step, against 1 m/s: none of it binds. With a step of a second it does.
    let free = guarded(&spaces, &[0.0, 1.0], &[0.0, -1.0], 1.0, 0.5, 0.1);
    assert_eq!(free.velocity, Some(vec![0.0, -1.0]));
    let bound = guarded(&spaces, &[0.0, 1.0], &[0.0, -1.0], 1.0, 0.5, 1.0).velocity.unwrap();
    assert!((bound[1] + 0.5 * (0.75 - SKIN)).abs() < 1e-12);
    // Inside, out at once; or as far as the speed allows.
    let inside = half_spaces(&next, &[0.0, 0.2], &[0.3, -1.0], 0.1).unwrap();
    let out = guarded(&inside, &[0.0, 0.2], &[0.3, -1.0], 1.0, 0.5, 0.1).velocity.unwrap();
    let asked = (0.05 + SKIN) / 0.1;
    assert!((out[1] - asked).abs() < 1e-12 && (out[0] - 0.3).abs() < 1e-12);
    let slow = guarded(&inside, &[0.0, 0.2], &[0.3, -1.0], 0.2, 0.5, 0.1);
    assert!(slow.velocity.is_none() && (slow.violation - (asked - 0.2)).abs() < 1e-9);
    assert!((Guarded::missed(&inside, &[0.0, 0.2], &[0.0, 0.2], 0.5, 0.1) - (asked - 0.2)).abs() < 1e-12);
}

#[test]
fn what_keeps_the_half_spaces_ends_outside_of_every_core() {
    let (mut steps, mut changed, mut squeezed) = (0, 0, 0);
    for seed in 0..250 {
        let random = generate_from(&Recipe::new(2 + (seed % 2) as usize), seed, 4);
        let dt = 0.05;
        let next = carried(&random.scene, dt).unwrap();
        let speed = next.limits.speed;
        for point in random.points.iter().filter(|p| p.kind != PointKind::Hard) {
            let wanted = evaluate(&random.scene, &point.x, None).unwrap().limited;
            let spaces = half_spaces(&next, &point.x, &wanted, dt).unwrap();
            if !spaces.complete {
                continue;
            }
            let seen = guarded(&spaces, &point.x, &wanted, speed, 0.5, dt);
            let Some(u) = seen.velocity else {
                squeezed += 1;
                continue;
            };
            steps += 1;
            changed += usize::from(u.iter().zip(&wanted).any(|(a, b)| (a - b).abs() > 1e-9));
            for violation in violations(&next, &point.x, &u, dt).unwrap() {
                // On the surface to rounding, at worst.
                assert!(violation.gamma > 1.0 - 1e-7, "seed {seed}, {point:?}: {violation:?} {u:?}");
            }
        }
    }
    assert!(steps > 2000 && changed > 60 && squeezed < steps / 20, "{steps} {changed} {squeezed}");
}
