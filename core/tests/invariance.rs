//! What must not matter does not: the frame, the order of obstacles; and the limits of the method are what they should be.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod world;

use pliant_core::scalar::Fixed;
use pliant_core::{
    Controller, Matrix, Motion, Obstacle, ObstacleSpec, RobotState, Scalar, Settings, Shape, SteeringPolicy, Vector,
    rotation,
};
use rand::{Rng, seq::SliceRandom};
use world::{Kind, Random, motion, numbers, obstacle, random, samples, vector};

const KIND: Kind = Kind { obstacles: 8, speed: 0.5, walls: false, scans: false };

fn controller<S: Scalar, const D: usize>(
    motion: Motion<S, D>,
    settings: Settings<S>,
    obstacles: impl IntoIterator<Item = Obstacle<S, D>>,
) -> Controller<S, D, 16> {
    named(motion, settings, (0..).zip(obstacles))
}

fn named<S: Scalar, const D: usize>(
    motion: Motion<S, D>,
    settings: Settings<S>,
    obstacles: impl IntoIterator<Item = (u16, Obstacle<S, D>)>,
) -> Controller<S, D, 16> {
    let mut controller = Controller::new(motion, settings);
    for (id, o) in obstacles {
        controller.upsert(id, o, S::zero()).unwrap();
    }
    controller
}

fn some<S: Scalar, const D: usize>(r: &mut Random) -> Vec<Obstacle<S, D>> {
    (0..r.random_range(1..8)).filter_map(|_| obstacle(r, &KIND)).collect()
}

fn with_flow<S: Scalar>() -> Settings<S> {
    Settings { gain: S::from_f64(0.1), ..Settings::default() }
}

fn place<S: Scalar, const D: usize>(r: &mut Random) -> Vector<S, D> {
    Vector::from_fn(|_, _| S::from_f64(r.random_range(-0.8..0.8)))
}

/// Where some Gamma is close to one, or the flow nearly opposite, rounding is magnified without a bound; such places say nothing.
fn is_plain<S: Scalar, const D: usize>(c: &Controller<S, D, 16>, x: &Vector<S, D>) -> bool {
    let gamma = world::gamma(c, x).to_f64();
    gamma > 1.05
}

/// The whole world turned by `q` and moved by `t`.
fn moved(o: &ObstacleSpec<f64, 3>, q: &Matrix<f64, 3>, t: &Vector<f64, 3>) -> ObstacleSpec<f64, 3> {
    ObstacleSpec {
        center: q * o.center + t,
        rotation: q * o.rotation,
        velocity: q * o.velocity,
        spin: skew(q * o.spin * q.transpose()),
        ..o.clone()
    }
}

fn skew(m: Matrix<f64, 3>) -> Matrix<f64, 3> {
    (m - m.transpose()) * 0.5
}

#[test]
fn the_frame_does_not_matter() {
    let r = &mut random(1);
    let mut compared = 0;
    for _ in 0..samples(60_000) {
        let (a, b, c, d): (f64, f64, f64, f64) = r.random();
        let length = (a * a + b * b + c * c + d * d).sqrt().max(1e-3);
        let Some(q) = rotation::spatial([a, b, c, d].map(|x| x / length)) else { continue };
        let t: Vector<f64, 3> = place(r);
        let obstacles = some::<f64, 3>(r);
        let attractor = place(r);
        // The side on which a saddle is left is fixed in the world's frame; it is a hundredth of the flow. Without it nothing is.
        let settings = Settings { steering: SteeringPolicy::WithFlow { beta: 0.0 }, ..Settings::default() };
        let here = controller(Motion::linear(attractor, 1.0).unwrap(), settings, obstacles.clone());
        let there = obstacles.iter().map(|o| Obstacle::new(moved(o.spec(), &q, &t)).unwrap());
        let there = controller(Motion::linear(q * attractor + t, 1.0).unwrap(), settings, there);
        let x = place(r);
        if !is_plain(&here, &x) {
            continue;
        }
        let one = here.evaluate(&RobotState::new(x).unwrap());
        let other = there.evaluate(&RobotState::new(q * x + t).unwrap());
        let error = (q * one.adapted - other.adapted).norm();
        assert!(error < 1e-7 * (1.0 + one.nominal.norm()), "{error}: {one:?} {other:?}");
        compared += 1;
    }
    assert!(compared > 20_000);
}

fn order<S: Scalar, const D: usize>(seed: u64, tolerance: f64) {
    let r = &mut random(seed);
    let mut compared = 0;
    for _ in 0..samples(40_000) {
        let mut obstacles: Vec<(u16, Obstacle<S, D>)> = (0..).zip(some::<S, D>(r)).collect();
        let motion = motion::<S, D>(r);
        let one = named(motion.clone(), with_flow(), obstacles.clone());
        obstacles.shuffle(r);
        let other = named(motion, with_flow(), obstacles);
        let x = place(r);
        if !is_plain(&one, &x) {
            continue;
        }
        let (a, b) = (one.modulated(&RobotState::new(x).unwrap()), other.modulated(&RobotState::new(x).unwrap()));
        let (a, b) = (numbers(&a), numbers(&b));
        assert!((a - b).norm() <= tolerance * (1.0 + a.norm()), "{a} {b} at {x:?} {one:?}");
        compared += 1;
    }
    assert!(compared > 10_000);
}

#[test]
fn the_order_of_obstacles_does_not_matter() {
    order::<f64, 2>(2, 1e-9);
    order::<f64, 3>(3, 1e-9);
    order::<f32, 2>(4, 2e-2);
    order::<f32, 3>(5, 2e-2);
    order::<Fixed, 2>(6, 5e-2);
    order::<Fixed, 3>(7, 5e-2);
}

#[test]
fn a_layer_of_no_thickness_is_none_and_the_original_method_has_no_push() {
    let r = &mut random(8);
    for _ in 0..samples(40_000) {
        let obstacles = some::<f64, 2>(r);
        let motion = motion::<f64, 2>(r);
        let soft = |ratio: f64| {
            let of = |o: &Obstacle<f64, 2>| {
                let soft_ratio = Vector::<f64, 2>::repeat(ratio);
                Obstacle::new(ObstacleSpec { soft_ratio, ..o.spec().clone() }).unwrap()
            };
            obstacles.iter().map(of).collect::<Vec<_>>()
        };
        let x = RobotState::new(place(r)).unwrap();
        let rigid = controller(motion.clone(), with_flow(), soft(1.0)).evaluate(&x);
        let thin = controller(motion.clone(), with_flow(), soft(1.0 + 1e-9)).evaluate(&x);
        assert!((rigid.adapted - thin.adapted).norm() < 1e-6);
        assert_eq!(rigid.adapted, rigid.modulated);
        let original = Settings { deformable: false, ..with_flow() };
        let original = controller(motion, original, soft(1.8)).evaluate(&x);
        assert_eq!(original.adapted, original.modulated);
        assert_eq!(original.adapted, rigid.adapted);
    }
}

fn attractor_rests<S: Scalar, const D: usize>(seed: u64) {
    let r = &mut random(seed);
    let still = Kind { speed: 0.0, ..KIND };
    for _ in 0..samples(40_000) {
        let obstacles: Vec<Obstacle<S, D>> = (0..r.random_range(1..8)).filter_map(|_| obstacle(r, &still)).collect();
        let motion = motion::<S, D>(r);
        let x = RobotState::new(*motion.attractor()).unwrap();
        let mut controller = controller(motion, with_flow(), obstacles);
        if world::gamma(&controller, x.position()).to_f64() <= 1.05 {
            continue;
        }
        let command = controller.tick(&x, S::from_f64(0.001));
        assert_eq!(command.velocity, Vector::<S, D>::zeros(), "{command:?}");
    }
}

#[test]
fn the_attractor_is_an_equilibrium_wherever_layers_lie() {
    attractor_rests::<f64, 2>(9);
    attractor_rests::<f64, 3>(10);
    attractor_rests::<f32, 2>(11);
    attractor_rests::<f32, 3>(12);
    attractor_rests::<Fixed, 2>(13);
    attractor_rests::<Fixed, 3>(14);
}

/// The steepest slope of the adapted velocity along random lines in steps of `step`, outside of cores.
fn steepest<const D: usize>(seed: u64, step: f64, kind: &Kind) -> (f64, String) {
    let r = &mut random(seed);
    let mut steepest = (0.0, String::new());
    for _ in 0..samples(1_500) {
        let obstacles: Vec<Obstacle<f64, D>> = (0..r.random_range(1..6)).filter_map(|_| obstacle(r, kind)).collect();
        let attractor = place(r);
        let controller = controller(Motion::linear(attractor, 1.0).unwrap(), with_flow(), obstacles);
        let (from, to): (Vector<f64, D>, Vector<f64, D>) = (place(r), place(r));
        let way = (to - from).normalize();
        let mut last: Option<Vector<f64, D>> = None;
        for i in 0..400 {
            let x = from + way * (step * f64::from(i));
            if world::gamma(&controller, &x) < 1.02 {
                last = None;
                continue;
            }
            let v = controller.evaluate(&RobotState::new(x).unwrap()).adapted;
            if let Some(last) = last {
                let slope = (v - last).norm() / step;
                if slope > steepest.0 {
                    steepest = (slope, format!("{x} {v} {last} {controller:?}"));
                }
            }
            last = Some(v);
        }
    }
    steepest
}

#[test]
fn with_the_flow_the_velocity_is_continuous() {
    for kind in [Kind { speed: 0.0, ..KIND }, KIND] {
        for (coarse, fine) in [
            (steepest::<2>(20, 1e-5, &kind), steepest::<2>(20, 1e-8, &kind)),
            (steepest::<3>(21, 1e-5, &kind), steepest::<3>(21, 1e-8, &kind)),
        ] {
            // A jump would be 1000 times as steep in steps a thousandth as long.
            println!("slopes {} {}", coarse.0, fine.0);
            assert!(fine.0 < 20.0 * coarse.0.max(100.0), "{} after {} 1/s: {}", fine.0, coarse.0, fine.1);
        }
    }
}

#[test]
fn one_ball_alone_bends_the_flow_as_in_the_book() {
    // Potential flow round a cylinder: M applied to a uniform flow.
    let o: Obstacle<f64, 2> =
        Obstacle::new(ObstacleSpec { shape: Shape::ellipsoid(vector(&[0.1, 0.1, 0.0])), ..ObstacleSpec::default() })
            .unwrap();
    let far = Motion::linear(vector(&[900.0, 0.0, 0.0]), 1.0).unwrap();
    let c = controller(far, Settings::default(), [o]);
    for i in 0..100 {
        let angle = f64::from(i) * 0.063;
        let x = Vector::<f64, 2>::new(angle.cos(), angle.sin()) * 0.15;
        let v = c.modulated(&RobotState::new(x).unwrap()) / 900.0;
        let (s, ratio) = ((2.0 * angle).sin_cos(), (0.1f64 / 0.15).powi(2));
        let book = Vector::<f64, 2>::new(1.0 - ratio * s.1, -ratio * s.0);
        assert!((v - book).norm() < 1e-3, "{v} {book}");
    }
}
