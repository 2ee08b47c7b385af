use std::collections::HashMap;

use nalgebra::{DMatrix, SymmetricEigen};

use super::super::cluster::clusters;
use super::super::evaluation::{Region, evaluate};
use super::super::scene::{OracleMotion, OracleShape, OracleSpin};
use super::*;

#[test]
fn a_seed_always_gives_the_same_scene() {
    assert_eq!(generate(7, 3), generate(7, 3));
    assert_ne!(generate(7, 3), generate(9, 3));
    assert_eq!((generate(8, 1).scene.dimension, generate(9, 1).scene.dimension), (2, 3));
}

#[test]
fn every_kind_is_frequent() {
    let scenes = 400;
    let mut points: HashMap<PointKind, usize> = HashMap::new();
    let mut with_intersection = 0;
    let (mut moving, mut fixed, mut original, mut lpv) = (0, 0, 0, 0);
    let mut counts = [0; 11];
    let mut curvatures = [0; 4];
    let mut shapes = [0; 5];
    let (mut walls, mut scans, mut drifting, mut growing, mut ageing, mut clustered) = (0, 0, 0, 0, 0, 0);
    for seed in 0..scenes {
        let random = generate(seed, 2);
        for point in &random.points {
            *points.entry(point.kind).or_default() += 1;
        }
        let RandomScene { scene, .. } = &random;
        with_intersection += usize::from(random.points.iter().any(|p| p.kind == PointKind::Intersection));
        moving += usize::from(scene.obstacles.iter().any(|o| o.velocity.iter().any(|v| *v != 0.0)));
        fixed += usize::from(matches!(scene.steering, OracleSteering::Fixed { .. }));
        original += usize::from(scene.method == OracleMethod::Original);
        lpv += usize::from(matches!(scene.motion, OracleMotion::Lpv { .. }));
        counts[scene.obstacles.len()] += 1;
        walls += usize::from(scene.obstacles.iter().any(|o| o.wall));
        scans += usize::from(scene.scan.is_some());
        drifting += usize::from(scene.drift.is_some());
        growing += usize::from(scene.obstacles.iter().any(|o| o.grown != 0.0));
        ageing += usize::from(scene.obstacles.iter().any(|o| o.aged != 0.0));
        clustered += usize::from(clusters(scene).unwrap().is_some_and(|all| !all.is_empty()));
        for obstacle in &scene.obstacles {
            let kind = match &obstacle.shape {
                OracleShape::Ellipsoid { curvature, .. } => {
                    curvatures[usize::from(*curvature)] += 1;
                    0
                }
                OracleShape::Box { .. } => 1,
                OracleShape::Cylinder { .. } => 2,
                OracleShape::Capsule { .. } => 3,
                OracleShape::Polygon { .. } => 4,
            };
            shapes[kind] += 1;
        }
    }
    let scenes = scenes as usize;
    for kind in PointKind::ALL {
        let least = if kind == PointKind::Intersection { scenes } else { scenes * 3 / 2 };
        assert!(points[&kind] >= least, "{kind:?} {points:?}");
    }
    assert!(with_intersection * 2 > scenes, "{with_intersection}");
    for (what, count) in [("moving", moving), ("fixed", fixed), ("lpv", lpv)] {
        assert!(count * 4 > scenes && count * 4 < 3 * scenes, "{what} {count}");
    }
    let rarer =
        [("walls", walls), ("scans", scans), ("drifting", drifting), ("growing", growing), ("clustered", clustered)];
    for (what, count) in rarer {
        assert!(count * 8 > scenes && count * 2 < scenes, "{what} {count}");
    }
    assert!(original * 20 > scenes && ageing * 12 > scenes);
    assert!(shapes.iter().all(|n| *n > 100), "{shapes:?}");
    assert!(counts[0] == 0 && counts[1..].iter().all(|n| *n > 10), "{counts:?}");
    assert!(curvatures[0] == 0 && curvatures[1..].iter().all(|n| *n > 150), "{curvatures:?}");
}

#[test]
fn points_are_what_they_were_drawn_for() {
    for seed in 0..60 {
        let random = generate(seed, 4);
        for point in &random.points {
            let seen = evaluate(&random.scene, &point.x, Some(&random.tick)).unwrap();
            match point.kind {
                PointKind::Free | PointKind::Far => assert_eq!(seen.region, Region::Free),
                PointKind::Soft => assert_eq!(seen.region, Region::Soft),
                PointKind::Intersection => assert_eq!(seen.region, Region::Intersection),
                PointKind::Hard => assert_eq!(seen.region, Region::Hard),
                PointKind::Surface => assert!(seen.min_gamma > 1.0 && seen.min_gamma < 1.11),
            }
            assert!(point.x.iter().all(|c| f64::from(*c as f32) == *c));
        }
    }
}

#[test]
fn reference_points_are_well_inside() {
    for seed in 0..60 {
        let scene = generate(seed, 0).scene;
        for obstacle in &scene.obstacles {
            let extents = obstacle.shape.semi_extents();
            let gamma: f64 = obstacle.reference.iter().zip(&extents).map(|(r, e)| (r / e).powi(2)).sum();
            assert!(gamma < 0.4 && gamma > 0.0);
            assert!(matches!(obstacle.spin, OracleSpin::Planar(_)) || scene.dimension == 3);
        }
    }
}

#[test]
fn what_has_grown_and_aged_has_done_so_since_its_age() {
    let mut old = 0;
    for seed in 0..200 {
        let random = generate(seed, 0);
        let RandomAgeing { time_to_live, rate, ages } = &random.ageing;
        assert_eq!(ages.len(), random.scene.obstacles.len());
        for (obstacle, age) in random.scene.obstacles.iter().zip(ages) {
            assert_eq!(obstacle.grown, obstacle.growth * age);
            assert_eq!(obstacle.aged, rate * (age - time_to_live).max(0.0));
            assert_eq!(obstacle.ageing, if age >= time_to_live { *rate } else { 0.0 });
            assert!(*age == 0.0 || obstacle.spin == OracleSpin::Planar(0.0));
            old += usize::from(*age > *time_to_live);
        }
    }
    assert!(old > 50);
}

#[test]
fn lpv_motions_have_their_certificate() {
    let square = |rows: &[Vec<f64>]| DMatrix::from_fn(rows.len(), rows.len(), |i, j| rows[i][j]);
    let mut checked = 0;
    for seed in 0..100 {
        let scene = generate(seed, 0).scene;
        let OracleMotion::Lpv { lyapunov, components, .. } = &scene.motion else {
            continue;
        };
        let p = square(lyapunov);
        assert_eq!(p, p.transpose());
        assert!(SymmetricEigen::new(p.clone()).eigenvalues.min() > 0.3);
        for component in components {
            let a = square(&component.a);
            let slope = a.transpose() * &p + &p * &a;
            assert!(SymmetricEigen::new(slope).eigenvalues.max() < -0.5);
            let covariance = square(&component.covariance);
            assert_eq!(covariance, covariance.transpose());
            assert!(SymmetricEigen::new(covariance).eigenvalues.min() > 0.01);
            checked += 1;
        }
    }
    assert!(checked > 100);
}
