//! Properties that hold in any scene, on random ones.

use std::f64::consts::PI;

use nalgebra::DVector;
use proptest::prelude::*;

use super::carry::product;
use super::geometry::{length, rotation_matrix, turned_about_z};
use super::random_scene::{PointKind, RandomScene, Recipe, generate, generate_from};
use super::{
    Evaluation, ObstacleView, OracleLimits, OracleMethod, OracleMotion, OracleObstacle, OracleRotation, OracleScene,
    OracleShape, OracleSpin, OracleSteering, evaluate, reference_in_world,
};

fn norm(v: &[f64]) -> f64 {
    length(&DVector::from_column_slice(v))
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn at(random: &RandomScene, x: &[f64]) -> Evaluation {
    evaluate(&random.scene, x, Some(&random.tick)).unwrap()
}

/// Rounding does not decide which branch is taken, nor is it magnified beyond what the comparison allows.
fn settled(seen: &Evaluation) -> bool {
    let near = &seen.switches;
    [near.hard, near.soft, near.far, near.reference, near.nearest].iter().all(|distance| *distance > 1e-7)
        && near.sign > 1e-7
        && norm(&seen.nominal) > 1e-3
        && near.standstill > 1e-3
}

/// The points of a random scene where a comparison to rounding makes sense.
fn settled_points(random: &RandomScene) -> Vec<(Vec<f64>, Evaluation)> {
    random
        .points
        .iter()
        .map(|point| (point.x.clone(), at(random, &point.x)))
        .filter(|(_, seen)| settled(seen))
        .collect()
}

/// The flow amplified by close obstacles, as the scale of an error.
fn scale(seen: &Evaluation) -> f64 {
    1.0 + seen.obstacles.iter().map(|o| norm(&o.velocity)).fold(norm(&seen.nominal), f64::max)
}

/// Applies a motion of the whole world, given by what it does to points and to vectors.
fn moved(
    scene: &OracleScene,
    point: impl Fn(&[f64]) -> Vec<f64>,
    vector: impl Fn(&[f64]) -> Vec<f64>,
    rotation: impl Fn(OracleRotation) -> OracleRotation,
) -> OracleScene {
    let mut image = scene.clone();
    if let OracleMotion::Linear { attractor, .. } = &mut image.motion {
        *attractor = point(attractor);
    }
    if let Some(scan) = &mut image.scan {
        scan.points.iter_mut().for_each(|p| *p = point(p));
    }
    if let Some(drift) = &mut image.drift {
        (drift.displacement, drift.velocity) = (vector(&drift.displacement), vector(&drift.velocity));
    }
    for obstacle in &mut image.obstacles {
        obstacle.center = point(&obstacle.center);
        obstacle.velocity = vector(&obstacle.velocity);
        obstacle.rotation = rotation(obstacle.rotation);
        if let OracleSpin::Spatial(w) = obstacle.spin {
            let w = vector(&w);
            obstacle.spin = OracleSpin::Spatial([w[0], w[1], w[2]]);
        }
    }
    image
}

fn linear(dimension: usize) -> Recipe {
    Recipe { lpv: 0.0, ..Recipe::new(dimension) }
}

/// A scene of the plane at z = 0 in space.
fn lifted(scene: &OracleScene) -> OracleScene {
    let with_zero = |v: &[f64], z: f64| vec![v[0], v[1], z];
    let mut space = OracleScene { dimension: 3, ..scene.clone() };
    if let OracleMotion::Linear { attractor, .. } = &mut space.motion {
        attractor.push(0.0);
    }
    space.obstacles = scene
        .obstacles
        .iter()
        .map(|flat| OracleObstacle {
            center: with_zero(&flat.center, 0.0),
            shape: match &flat.shape {
                OracleShape::Ellipsoid { axes, curvature } => {
                    OracleShape::Ellipsoid { axes: with_zero(axes, 0.3), curvature: *curvature }
                }
                OracleShape::Box { half, rounding } => {
                    OracleShape::Box { half: with_zero(half, rounding + 0.3), rounding: *rounding }
                }
                other => other.clone(),
            },
            soft_ratio: with_zero(&flat.soft_ratio, 1.4),
            margin: with_zero(&flat.margin, 1.1),
            reference: with_zero(&flat.reference, 0.0),
            hub: flat.hub.as_ref().map(|hub| with_zero(hub, 0.0)),
            velocity: with_zero(&flat.velocity, 0.0),
            ..flat.clone()
        })
        .collect();
    if let Some(scan) = &mut space.scan {
        scan.points.iter_mut().for_each(|p| p.push(0.0));
    }
    if let Some(drift) = &mut space.drift {
        drift.displacement.push(0.0);
        drift.velocity.push(0.0);
    }
    space
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn everything_is_finite_and_the_weights_sum_to_one(seed: u64) {
        let random = generate(seed, 3);
        for point in &random.points {
            let seen = at(&random, &point.x);
            for stage in [&seen.nominal, &seen.modulated, &seen.adapted, &seen.limited] {
                prop_assert!(stage.iter().all(|c| c.is_finite()));
            }
            let sum: f64 = seen.obstacles.iter().chain(&seen.scan).map(|o| o.weight).sum();
            let all = || seen.obstacles.iter().chain(&seen.scan);
            prop_assert!((sum - 1.0).abs() < 1e-13 || all().all(|o| !o.counted));
            if !seen.mixture.is_empty() {
                prop_assert!((seen.mixture.iter().sum::<f64>() - 1.0).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn limits_hold(seed: u64) {
        let random = generate(seed, 3);
        for point in &random.points {
            let speed_only = evaluate(&random.scene, &point.x, None).unwrap();
            prop_assert!(norm(&speed_only.limited) <= random.scene.limits.speed * (1.0 + 1e-15));
            if let Some(acceleration) = random.scene.limits.acceleration {
                let seen = at(&random, &point.x);
                let previous = DVector::from_column_slice(&random.tick.previous);
                let change = DVector::from_column_slice(&seen.limited) - &previous;
                // A limit lowered below the last speed may ask for more, by no more than what it is lower.
                let lowered = (length(&previous) - random.scene.limits.speed).max(0.0);
                prop_assert!(norm(&seen.limited) <= random.scene.limits.speed * (1.0 + 1e-15));
                prop_assert!(length(&change) <= acceleration * random.tick.dt * (1.0 + 1e-12) + lowered);
            }
        }
    }

    #[test]
    fn a_single_obstacle_is_the_closed_form(seed: u64, dimension in 2_usize..=3) {
        let random = generate_from(&Recipe { obstacles: 1..=1, scans: 0.0, ..Recipe::new(dimension) }, seed, 3);
        let obstacle = &random.scene.obstacles[0];
        for (x, seen) in settled_points(&random) {
            let v = |values: &[f64]| DVector::from_column_slice(values);
            let s = v(&seen.obstacles[0].surface_velocity);
            let u = v(&seen.nominal) - &s;
            let n = v(&seen.obstacles[0].normal);
            let r = v(&x) - v(&reference_in_world(&random.scene, 0).unwrap());
            let r = if obstacle.wall { -r } else { r };
            let cosine = n.dot(&r) / length(&r);
            let sum = |v: &DVector<f64>| v.iter().map(|c| c.abs()).sum::<f64>();
            let expected = if !seen.obstacles[0].counted {
                v(&seen.nominal)
            } else if n.dot(&r) <= 1e-6 * sum(&n) * sum(&r) {
                s
            } else {
                let inverse = 1.0 / seen.min_gamma.max(1.0);
                s + &u * (1.0 + inverse) - &r * (2.0 * inverse * n.dot(&u) / n.dot(&r))
            };
            let allowed = 1e-12 * scale(&seen) / cosine.abs().min(1.0);
            prop_assert!(difference(expected.as_slice(), &seen.modulated) < allowed);
        }
    }

    #[test]
    fn nothing_flows_through_the_surface(seed: u64) {
        let random = generate(seed, 4);
        for point in random.points.iter().filter(|point| point.kind == PointKind::Surface) {
            let seen = at(&random, &point.x);
            let Some(nearest) = seen.nearest else { continue };
            let Some(obstacle) = seen.obstacles.get(nearest) else { continue };
            // The part along the radius keeps 1 - 1/Gamma; the weights of the others vanish as fast.
            let through: f64 = obstacle.normal.iter().zip(&seen.modulated).zip(&obstacle.surface_velocity)
                .map(|((n, u), s)| n * (u - s)).sum();
            let most = 40.0 * scale(&seen) * (seen.min_gamma - 1.0) * (1.0 + 1.0 / gap(&seen, nearest));
            prop_assert!(through.abs() <= most, "{through} {most}");
        }
    }

    #[test]
    fn the_speed_is_the_weighted_mean(seed: u64) {
        // Nothing turns back among obstacles at rest, and nothing fades.
        let recipe = Recipe { obstacles: 2..=6, moving: 0.0, growing: 0.0, ..Recipe::new(2) };
        let random = generate_from(&recipe, seed, 3);
        for point in &random.points {
            let seen = at(&random, &point.x);
            let all = || seen.obstacles.iter().chain(&seen.scan).filter(|o| o.counted);
            let turns = |o: &ObstacleView| o.velocity.iter().zip(&seen.nominal).map(|(v, f)| v * f).sum::<f64>() < 0.0;
            let mean: f64 = all().map(|o| o.weight * norm(&o.velocity)).sum();
            if all().count() >= 2 && norm(&seen.nominal) > 0.05 * mean && !all().any(turns) {
                prop_assert!((norm(&seen.modulated) - mean).abs() < 1e-12 * scale(&seen));
            }
        }
    }

    #[test]
    fn the_order_of_the_obstacles_does_not_matter(seed: u64) {
        let random = generate(seed, 3);
        let mut turned = random.clone();
        turned.scene.obstacles.reverse();
        let count = random.scene.obstacles.len();
        for (x, seen) in settled_points(&random) {
            let other = at(&turned, &x);
            prop_assert!(difference(&seen.adapted, &other.adapted) < 1e-11 * scale(&seen));
            prop_assert_eq!(seen.region, other.region);
            prop_assert_eq!(seen.nearest, other.nearest.map(|n| if n < count { count - 1 - n } else { n }));
        }
    }

    #[test]
    fn the_place_of_the_world_does_not_matter(seed: u64, dimension in 2_usize..=3) {
        let random = generate_from(&linear(dimension), seed, 3);
        let shift = [0.5, -0.25, 1.25];
        let shifted = |x: &[f64]| x.iter().zip(&shift).map(|(x, s)| x + s).collect::<Vec<f64>>();
        let mut elsewhere = random.clone();
        elsewhere.scene = moved(&random.scene, shifted, <[f64]>::to_vec, |r| r);
        for (x, seen) in settled_points(&random) {
            let other = at(&elsewhere, &shifted(&x));
            let allowed = 1e-10 * scale(&seen) * sensitivity(&seen);
            prop_assert!(difference(&seen.adapted, &other.adapted) < allowed);
        }
    }

    #[test]
    fn the_direction_of_the_plane_does_not_matter(seed: u64, angle in -PI..PI) {
        let random = generate_from(&Recipe { fixed: 0.0, ..linear(2) }, seed, 3);
        let turn = |v: &[f64]| turned_about_z(&DVector::from_column_slice(v), angle).as_slice().to_vec();
        let mut elsewhere = random.clone();
        elsewhere.scene = moved(&random.scene, turn, turn, |rotation| match rotation {
            OracleRotation::Angle(own) => OracleRotation::Angle(own + angle),
            other => other,
        });
        for (x, seen) in settled_points(&random) {
            let other = at(&elsewhere, &turn(&x));
            let allowed = 1e-10 * scale(&seen) * sensitivity(&seen);
            prop_assert!(difference(&turn(&seen.modulated), &other.modulated) < allowed);
            prop_assert!(difference(&turn(&seen.adapted), &other.adapted) < allowed);
        }
    }

    #[test]
    fn the_direction_of_space_does_not_matter_to_the_modulation(seed: u64) {
        let random = generate_from(&linear(3), seed, 3);
        let half = [0.8, -0.2, 0.4, 0.4];
        let matrix = rotation_matrix(OracleRotation::Quaternion(half), 3).unwrap();
        let turn = |v: &[f64]| (&matrix * DVector::from_column_slice(v)).as_slice().to_vec();
        let mut elsewhere = random.clone();
        elsewhere.scene = moved(&random.scene, turn, turn, |rotation| match rotation {
            OracleRotation::Quaternion(own) => OracleRotation::Quaternion(product(half, own)),
            other => other,
        });
        for (x, seen) in settled_points(&random) {
            let other = at(&elsewhere, &turn(&x));
            let allowed = 1e-10 * scale(&seen) * sensitivity(&seen);
            prop_assert!(difference(&turn(&seen.modulated), &other.modulated) < allowed);
        }
    }

    #[test]
    fn the_plane_is_a_part_of_space(seed: u64) {
        let recipe = Recipe { walls: 0.0, growing: 0.0, ..linear(2) };
        let random = generate_from(&recipe, seed, 3);
        prop_assume!(random.scene.obstacles.iter().all(|o| !matches!(o.shape, OracleShape::Polygon { .. })));
        let space = lifted(&random.scene);
        for (x, seen) in settled_points(&random) {
            let other = evaluate(&space, &[x[0], x[1], 0.0], None).unwrap();
            let flat = |v: &[f64]| vec![v[0], v[1], 0.0];
            let allowed = 1e-11 * scale(&seen) * sensitivity(&seen);
            prop_assert!(difference(&flat(&seen.modulated), &other.modulated) < allowed);
            prop_assert_eq!(seen.region, other.region);
            // The lean of `with-flow` is to another side in space.
            if matches!(random.scene.steering, OracleSteering::Fixed { .. }) {
                prop_assert!(difference(&flat(&seen.adapted), &other.adapted) < allowed);
            }
        }
    }

    #[test]
    fn faster_time_is_only_faster(seed: u64, factor in 0.2..5.0_f64) {
        let random = generate_from(&linear(3), seed, 3);
        let mut faster = random.clone();
        let scene = &mut faster.scene;
        if let OracleMotion::Linear { gain, .. } = &mut scene.motion {
            *gain *= factor;
        }
        scene.gain *= factor;
        if let Some(drift) = &mut scene.drift {
            drift.velocity.iter_mut().for_each(|v| *v *= factor);
        }
        for obstacle in &mut scene.obstacles {
            obstacle.velocity.iter_mut().for_each(|v| *v *= factor);
            obstacle.growth *= factor;
            obstacle.ageing *= factor;
            if let OracleSpin::Spatial(w) = &mut obstacle.spin {
                w.iter_mut().for_each(|c| *c *= factor);
            }
        }
        for (x, seen) in settled_points(&random) {
            let expected: Vec<f64> = seen.adapted.iter().map(|c| c * factor).collect();
            let allowed = 1e-10 * factor * scale(&seen) * sensitivity(&seen);
            prop_assert!(difference(&expected, &at(&faster, &x).adapted) < allowed);
        }
    }

    #[test]
    fn original_is_deformable_without_layers(seed: u64) {
        let random = generate(seed, 3);
        let mut original = random.clone();
        original.scene.method = OracleMethod::Original;
        let mut rigid = random.clone();
        rigid.scene.method = OracleMethod::Deformable;
        for obstacle in &mut rigid.scene.obstacles {
            obstacle.soft_ratio.iter_mut().for_each(|rho| *rho = 1.0);
        }
        for point in &random.points {
            let (a, b) = (at(&original, &point.x), at(&rigid, &point.x));
            prop_assert_eq!(&a, &b);
            prop_assert_eq!(&a.modulated, &a.adapted);
            prop_assert_eq!(&a.modulated, &at(&random, &point.x).modulated);
        }
    }

    #[test]
    fn with_flow_stays_within_its_bounds(seed: u64) {
        let recipe = Recipe { fixed: 0.0, original: 0.0, ..Recipe::new(2) };
        let mut random = generate_from(&recipe, seed, 3);
        random.scene.limits = OracleLimits { speed: f64::INFINITY, acceleration: None };
        let OracleSteering::WithFlow { beta } = random.scene.steering else {
            return Err(TestCaseError::fail("steering"));
        };
        for point in &random.points {
            let seen = at(&random, &point.x);
            let push: Vec<f64> = seen.adapted.iter().zip(&seen.modulated).map(|(a, u)| a - u).collect();
            let fades: Vec<f64> = seen.obstacles.iter().map(|o| o.fade).collect();
            let speed_up: f64 = (0..fades.len())
                .map(|n| fades[n] * (0..fades.len()).filter(|m| *m != n).map(|m| 1.0 - fades[m]).product::<f64>())
                .sum();
            prop_assert!(speed_up < 1.0 + 1e-12);
            let most = beta * seen.switches.standstill * speed_up + 0.8 * norm(&seen.modulated);
            prop_assert!(norm(&push) <= most * (1.0 + 1e-12) + 1e-15);
            if fades.iter().all(|phi| *phi == 0.0) {
                prop_assert_eq!(&seen.adapted, &seen.modulated);
            }
        }
    }
}

/// Least Gamma - 1 of the obstacles other than the nearest, and of the scan.
fn gap(seen: &Evaluation, nearest: usize) -> f64 {
    seen.obstacles
        .iter()
        .chain(&seen.scan)
        .enumerate()
        .filter(|(n, _)| *n != nearest)
        .map(|(_, o)| o.gamma - 1.0)
        .fold(f64::INFINITY, f64::min)
}

/// How much an input's rounding is magnified: by Gamma - 1 in the weights, by the
/// small nominal speed in the tangential direction, and inside a core by an oblique reference point.
fn sensitivity(seen: &Evaluation) -> f64 {
    let near = &seen.switches;
    1.0 + 1.0 / near.hard + scale(seen) / near.standstill + 1.0 / near.reference
}
