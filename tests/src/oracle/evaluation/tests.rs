use super::super::scene::{
    OracleDrift, OracleLimits, OracleMethod, OracleMotion, OracleObstacle, OracleScan, OracleSpin,
};
use super::*;

const FREE_OF_LIMITS: OracleLimits = OracleLimits { speed: f64::INFINITY, acceleration: None };

fn scene(attractor: &[f64], obstacles: Vec<OracleObstacle>) -> OracleScene {
    OracleScene {
        dimension: attractor.len(),
        motion: OracleMotion::Linear { attractor: attractor.to_vec(), gain: 1.0 },
        obstacles,
        method: OracleMethod::Deformable,
        steering: OracleSteering::WithFlow { beta: 1.0 },
        gain: 0.1,
        limits: FREE_OF_LIMITS,
        scan: None,
        drift: None,
        guard: None,
    }
}

fn close(a: &[f64], b: &[f64], tolerance: f64) {
    assert_eq!(a.len(), b.len());
    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance), "{a:?} is not {b:?}");
}

fn at(scene: &OracleScene, x: &[f64]) -> Evaluation {
    evaluate(scene, x, None).unwrap()
}

#[test]
fn without_obstacles_every_stage_is_the_nominal_motion() {
    let seen = at(&scene(&[1.0, 1.0], vec![]), &[0.0, 3.0]);
    for stage in [&seen.nominal, &seen.modulated, &seen.adapted, &seen.limited] {
        assert_eq!(stage.as_slice(), &[1.0, -2.0]);
    }
    assert_eq!((seen.min_gamma, seen.nearest, seen.region), (f64::INFINITY, None, Region::Free));
}

#[test]
fn one_obstacle_is_its_own_modulation() {
    // Gamma = 4 on the axis: 3/4 of the speed towards the centre.
    let one = scene(&[-4.0, 0.0], vec![OracleObstacle::still(&[0.0, 0.0], &[1.0, 1.0])]);
    let seen = at(&one, &[2.0, 0.0]);
    close(&seen.modulated, &[-4.5, 0.0], 1e-14);
    close(&seen.modulated, &seen.obstacles[0].velocity, 0.0);
    assert_eq!((seen.min_gamma, seen.nearest, seen.region), (4.0, Some(0), Region::Free));
    assert_eq!(seen.obstacles[0].weight, 1.0);
}

#[test]
fn obstacles_that_are_too_far_are_left_out() {
    // Gamma = (900 / 0.01)^4 = 6.6e19 and (800 / 0.001)^2 = 6.4e11.
    let mut sharp = OracleObstacle::still(&[900.0, 0.0], &[0.01, 0.01]).curved(2);
    sharp.velocity = vec![5.0, 5.0];
    let small = OracleObstacle::still(&[0.0, 800.0], &[0.001, 0.001]);
    let seen = at(&scene(&[1.0, 0.0], vec![sharp.clone()]), &[0.0, 0.0]);
    assert_eq!(seen.modulated, seen.nominal);
    assert!(!seen.obstacles[0].counted && seen.min_gamma > 1e19 && seen.nearest == Some(0));
    let seen = at(&scene(&[1.0, 0.0], vec![sharp, small]), &[0.0, 0.0]);
    assert_eq!(seen.nearest, Some(1));
    assert_eq!((seen.obstacles[0].weight, seen.obstacles[1].weight), (0.0, 1.0));
    close(&seen.modulated, &[1.0, 0.0], 1e-11);
}

#[test]
fn mirrored_obstacles_keep_the_robot_on_the_axis() {
    let pair = vec![
        OracleObstacle::still(&[0.0, 1.3], &[1.0, 1.0]).soft(1.5),
        OracleObstacle::still(&[0.0, -1.3], &[1.0, 1.0]).soft(1.5),
    ];
    let pair = scene(&[3.0, 0.0], pair);
    for x in [-2.0, -0.9, -0.4, 0.0, 0.7] {
        let seen = at(&pair, &[x, 0.0]);
        assert!(seen.modulated[1].abs() < 1e-14 && seen.modulated[0] > 0.0);
        let single = seen.obstacles[0].velocity.iter().map(|c| c * c).sum::<f64>().sqrt();
        assert!((seen.modulated[0] - single).abs() < 1e-14);
        assert_eq!((seen.obstacles[0].weight, seen.obstacles[1].weight), (0.5, 0.5));
    }
    // In the middle: Gamma = 1.69 and no normal flow, so 1 + 1/1.69 of the speed; Gamma_k = 1.69/2.25, so
    // twice c / Gamma_k^2 less, and both leans cancel.
    let seen = at(&pair, &[0.0, 0.0]);
    let u = 3.0 * (1.0 + 1.0 / 1.69);
    close(&seen.modulated, &[u, 0.0], 1e-13);
    assert_eq!(seen.region, Region::Intersection);
    let slow = 2.0 * 0.1 * (2.25_f64 / 1.69).powi(2);
    close(&seen.adapted, &[u - slow, 0.0], 1e-13);
}

#[test]
fn regions() {
    let soft = |center: &[f64]| OracleObstacle::still(center, &[1.0, 1.0]).soft(1.5);
    let mut thick = soft(&[0.0, 10.0]);
    thick.margin = vec![1.6, 1.6];
    let mut scene = scene(&[9.0, 9.0], vec![soft(&[0.0, 0.0]), soft(&[2.4, 0.0]), thick]);
    let region = |scene: &OracleScene, x: &[f64]| at(scene, x).region;
    assert_eq!(region(&scene, &[-1.51, 0.0]), Region::Free);
    assert_eq!(region(&scene, &[-1.2, 0.0]), Region::Soft);
    assert_eq!(region(&scene, &[1.2, 0.0]), Region::Intersection);
    assert_eq!(region(&scene, &[0.5, 0.0]), Region::Hard);
    // In the core of the first, also in the soft layer of the second.
    assert_eq!(region(&scene, &[0.95, 0.0]), Region::Hard);
    assert!(at(&scene, &[0.95, 0.0]).obstacles[1].soft_here);
    // A margin that swallows the soft layer leaves none.
    assert_eq!(region(&scene, &[0.0, 11.55]), Region::Hard);
    assert_eq!(region(&scene, &[0.0, 11.65]), Region::Free);
    scene.method = OracleMethod::Original;
    assert_eq!(region(&scene, &[-1.2, 0.0]), Region::Free);
    assert_eq!(region(&scene, &[1.2, 0.0]), Region::Free);
}

#[test]
fn the_original_method_has_no_adaptive_motion() {
    let soft = OracleObstacle::still(&[0.0, 0.0], &[1.0, 1.0]).soft(1.5);
    let mut scene = scene(&[3.0, 0.5], vec![soft]);
    assert!(at(&scene, &[-1.2, 0.1]).adapted != at(&scene, &[-1.2, 0.1]).modulated);
    scene.method = OracleMethod::Original;
    assert_eq!(at(&scene, &[-1.2, 0.1]).adapted, at(&scene, &[-1.2, 0.1]).modulated);
}

#[test]
fn inside_a_core_its_own_layer_does_not_push() {
    let soft = OracleObstacle::still(&[0.0, 0.0], &[1.0, 1.0]).soft(1.5);
    let mut scene = scene(&[3.0, 0.5], vec![soft]);
    for steering in [OracleSteering::WithFlow { beta: 1.0 }, OracleSteering::Fixed { angle: 0.7 }] {
        scene.steering = steering;
        let seen = at(&scene, &[-0.9, 0.1]);
        assert_eq!((seen.region, &seen.adapted), (Region::Hard, &seen.modulated));
        assert!(at(&scene, &[-1.1, 0.1]).adapted != at(&scene, &[-1.1, 0.1]).modulated);
    }
}

#[test]
fn the_soft_shell_is_crossed_without_a_jump() {
    let soft = |center: &[f64]| OracleObstacle::still(center, &[1.0, 1.0]).soft(1.5);
    let mut scene = scene(&[3.0, 0.5], vec![soft(&[0.0, 0.0]), soft(&[2.2, 0.4])]);
    let across = |scene: &OracleScene| {
        // Along y = 0.9 over the shells of both: the largest change of the push over 1e-6 m.
        let push = |i: i32| {
            let seen = at(scene, &[-2.0 + 0.01 * f64::from(i / 2) + 1e-6 * f64::from(i % 2), 1.15]);
            [seen.adapted[0] - seen.modulated[0], seen.adapted[1] - seen.modulated[1]]
        };
        (0..600)
            .map(|i| {
                let (before, after) = (push(2 * i), push(2 * i + 1));
                (before[0] - after[0]).hypot(before[1] - after[1])
            })
            .fold(0.0, f64::max)
    };
    assert!(across(&scene) < 1e-4);
    // The paper's push does jump: at the shell itself by c.
    scene.steering = OracleSteering::Fixed { angle: 0.7 };
    let at_shell = |offset: f64| {
        let seen = at(&scene, &[0.0, 1.5 + offset]);
        (seen.adapted[0] - seen.modulated[0]).hypot(seen.adapted[1] - seen.modulated[1])
    };
    assert!((at_shell(-1e-9) - 0.1).abs() < 1e-6 && at_shell(1e-9) == 0.0);
}

#[test]
fn the_attractor_in_a_soft_layer_stays_an_equilibrium() {
    let soft = OracleObstacle::still(&[0.0, 0.0], &[1.0, 1.0]).soft(1.5);
    let mut scene = scene(&[0.0, 1.2], vec![soft]);
    assert_eq!(at(&scene, &[0.0, 1.2]).limited, vec![0.0, 0.0]);
    let near = at(&scene, &[1e-6, 1.2]);
    assert!(near.adapted[0].hypot(near.adapted[1]) < 4e-6);
    scene.steering = OracleSteering::Fixed { angle: 0.7 };
    assert!(at(&scene, &[0.0, 1.2]).limited[0] != 0.0);
}

#[test]
fn a_moving_obstacle_carries_its_surface_along() {
    let mut moving = OracleObstacle::still(&[0.0, 0.0], &[1.0, 1.0]);
    moving.velocity = vec![-0.5, 0.2];
    moving.spin = OracleSpin::Planar(1.0);
    // On the surface at (-1, 0): s = (-0.5, 0.2 - 1); no flow relative to it along x, twice the flow along y.
    let seen = at(&scene(&[1.0, 0.0], vec![moving]), &[-1.0, 0.0]);
    close(&seen.obstacles[0].surface_velocity, &[-0.5, -0.8], 1e-15);
    close(&seen.modulated, &[-0.5, -0.8 + 2.0 * 0.8], 1e-14);
}

#[test]
fn an_oncoming_pair_averages_to_where_they_go() {
    // Everything on one line: one obstacle drives back towards the robot, the other leaves f alone in direction.
    let mut oncoming = OracleObstacle::still(&[2.0, 0.0], &[1.0, 1.0]);
    oncoming.velocity = vec![-6.0, 0.0];
    let behind = OracleObstacle::still(&[-1.0, 0.0], &[1.0, 1.0]);
    let seen = at(&scene(&[1.0, 0.0], vec![oncoming, behind]), &[0.5, 0.0]);
    // Gamma = 2.25 of both. f = 0.5: s + (5/9)(f - s) = -6 + 65/18 and (5/9)/2.
    let (first, second) = (-6.0 + 65.0 / 18.0, 5.0 / 18.0);
    close(&seen.obstacles[0].velocity, &[first, 0.0], 1e-14);
    close(&seen.obstacles[1].velocity, &[second, 0.0], 1e-14);
    close(&seen.modulated, &[(second + first) / 2.0, 0.0], 1e-14);
}

#[test]
fn past_the_opposite_of_f_nothing_jumps() {
    let mut oncoming = OracleObstacle::still(&[2.0, 0.0], &[1.0, 1.0]);
    oncoming.velocity = vec![-6.0, 0.3];
    let behind = OracleObstacle::still(&[-1.0, 0.1], &[1.0, 1.0]);
    let scene = scene(&[1.0, 0.0], vec![oncoming, behind]);
    let on = |i: i32| at(&scene, &[0.5, -0.2 + 1e-4 * f64::from(i)]).modulated;
    let jump = (0..4000).map(|i| (on(i), on(i + 1))).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
    assert!(jump.fold(0.0, f64::max) < 0.02);
}

#[test]
fn a_scan_counts_as_one_obstacle() {
    // Gamma = 4 along the axis, as one_obstacle_is_its_own_modulation.
    let mut scene = scene(&[-4.0, 0.0], vec![]);
    scene.scan = Some(OracleScan { points: vec![vec![0.0, 0.0]], radius: 1.0 });
    let seen = at(&scene, &[2.0, 0.0]);
    close(&seen.modulated, &[-4.5, 0.0], 1e-14);
    assert_eq!((seen.min_gamma, seen.nearest, seen.region), (4.0, Some(0), Region::Free));
    // With a disc of the same size it shares the weight; and neither has a layer.
    scene.obstacles = vec![OracleObstacle::still(&[2.0, 2.0], &[1.0, 1.0])];
    let seen = at(&scene, &[2.0, 0.0]);
    assert_eq!((seen.obstacles[0].weight, seen.scan.as_ref().unwrap().weight), (0.5, 0.5));
    assert_eq!(seen.adapted, seen.modulated);
    assert_eq!(at(&scene, &[0.9, 0.0]).region, Region::Hard);
}

#[test]
fn a_wall_holds_the_flow_back() {
    // Gamma = 4 half way to the wall of radius 2: 3/4 of the outward flow, 5/4 of what goes along.
    let walled = scene(&[4.0, 0.0], vec![OracleObstacle::still(&[0.0, 0.0], &[2.0, 2.0]).inside_out()]);
    close(&at(&walled, &[1.0, 0.0]).modulated, &[2.25, 0.0], 1e-14);
    close(&at(&walled, &[0.0, 1.0]).modulated, &[5.0, -0.75], 1e-14);
    let on = at(&walled, &[2.0, 0.0]);
    close(&on.modulated, &[0.0, 0.0], 1e-14);
    assert_eq!((on.region, at(&walled, &[0.0, 0.0]).nominal), (Region::Hard, vec![4.0, 0.0]));
    // The middle of a wall is as far from it as can be.
    assert_eq!(at(&walled, &[0.0, 0.0]).modulated, vec![4.0, 0.0]);
    assert_eq!(at(&walled, &[2.1, 0.0]).region, Region::Hard);
}

#[test]
fn a_moving_attractor_is_followed_and_its_rest_has_no_push() {
    let soft = OracleObstacle::still(&[0.0, 0.0], &[1.0, 1.0]).soft(1.5);
    let mut scene = scene(&[0.0, 1.0], vec![soft]);
    scene.drift = Some(OracleDrift { displacement: vec![0.0, 0.2], velocity: vec![0.3, 0.0] });
    let seen = at(&scene, &[0.0, 1.2]);
    assert_eq!(seen.nominal, vec![0.3, 0.0]);
    assert!(seen.obstacles[0].fade == 1.0 && seen.switches.standstill == 0.0);
    assert_eq!(seen.adapted, seen.modulated);
}

#[test]
fn limits_come_last() {
    let soft = OracleObstacle::still(&[0.0, 0.0], &[1.0, 1.0]).soft(1.5);
    let mut scene = scene(&[3.0, 0.5], vec![soft]);
    scene.limits = OracleLimits { speed: 0.5, acceleration: Some(2.0) };
    let x = [-1.2, 0.1];
    let free = at(&scene, &x);
    let speed = free.adapted[0].hypot(free.adapted[1]);
    assert!(speed > 1.0);
    close(&free.limited, &[free.adapted[0] * 0.5 / speed, free.adapted[1] * 0.5 / speed], 1e-15);
    let tick = OracleTick { previous: vec![0.0, 0.0], dt: 0.001 };
    let first = evaluate(&scene, &x, Some(&tick)).unwrap();
    assert!((first.limited[0].hypot(first.limited[1]) - 0.002).abs() < 1e-17);
}

#[test]
fn what_does_not_fit_is_refused() {
    let good = scene(&[1.0, 0.0], vec![]);
    assert_eq!(evaluate(&good, &[0.0], None).err(), Some(OracleError::Shape("position")));
    assert_eq!(evaluate(&good, &[0.0, f64::NAN], None).err(), Some(OracleError::Value("position")));
    let flat = OracleScene { dimension: 1, ..good };
    assert_eq!(evaluate(&flat, &[0.0], None).err(), Some(OracleError::Dimension(1)));
}
