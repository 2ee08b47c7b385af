//! One body or room that moves, turns and grows at once, so that what these come to may cancel where the robot is: it is never entered unsaid.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod world;

use pliant_core::scalar::Fixed;
use pliant_core::{
    Ageing, Controller, Guard, Matrix, Motion, Obstacle, ObstacleSpec, RobotState, Scalar, Settings, Shape, Status,
    Vector, rotation,
};
use rand::Rng;
use world::{Random, numbers, random, room, shape, share, turn, vector, within};

/// How fast it grows or shrinks at most, m/s.
const GROWTH: f64 = 2.0;

struct Case<S: Scalar, const D: usize> {
    controller: Controller<S, D, 4>,
    state: RobotState<S, D>,
    dt: f64,
}

fn case<S: Scalar, const D: usize>(r: &mut Random, wall: bool) -> Option<Case<S, D>> {
    let shape: Shape<S, D> = if r.random_bool(0.7) { room::narrow(r) } else { shape(r, 0.02, true) };
    let spin = rotation::spatial_spin(&if D == 2 {
        nalgebra::Vector3::new(0.0, 0.0, r.random_range(-5.0..5.0))
    } else {
        nalgebra::Vector3::from(within(r, 2.8))
    });
    let growth = r.random_range(-GROWTH..GROWTH);
    let spec = ObstacleSpec::<S, D> {
        shape,
        rotation: turn(r),
        wall,
        spin: Matrix::from_fn(|i, j| S::from_f64(spin[(i, j)])),
        growth: S::from_f64(growth),
        ..ObstacleSpec::default()
    };
    let still = Obstacle::new(spec.clone()).ok()?;
    let dt = if r.random_bool(0.5) { 1.0 / 1024.0 } else { 5.0 / 1024.0 };
    let surface = numbers(&still.surface(&vector(&within(r, 1.0))));
    let any: Vector<f64, D> = vector(&within(r, 1.0));
    let fast = r.random_range(0.0..2.0);
    let x = if wall {
        surface * r.random_range(0.0..1.0)
    } else {
        surface + any * ((fast + growth.abs() + 0.1) * dt * 1.5)
    };
    let state = RobotState::new(x.map(S::from_f64))?;
    // Half of the time away from the robot just as fast as it grows.
    let normal = numbers(&still.gradient(state.position()));
    let velocity = if r.random_bool(0.5) && normal.norm() > 0.0 { normal.normalize() * -growth } else { any * fast };
    let obstacle = Obstacle::new(ObstacleSpec { velocity: velocity.map(S::from_f64), ..spec }).ok()?;
    if obstacle.gamma(state.position()) < S::one() {
        return None;
    }
    let forever = S::from_f64(3600.0);
    let mut settings: Settings<S> = Settings {
        guard: Some(Guard { approach: S::from_f64(10f64.powf(r.random_range(-1.7..0.0))) }),
        ageing: Ageing { time_to_live: forever, hold: forever, ..Ageing::default() },
        ..Settings::default()
    };
    settings.limits.speed = S::from_f64(10f64.powf(r.random_range(-3.0..0.0)));
    let mut controller = Controller::new(Motion::linear(*state.position(), S::one()).unwrap(), settings);
    controller.upsert(1, obstacle, S::zero()).unwrap();
    Some(Case { controller, state, dt })
}

fn campaign<S: Scalar, const D: usize>(wall: bool) {
    let (mut tried, mut said) = (0_u64, 0_u64);
    let wanted = share(6);
    for seed in 0.. {
        if tried >= wanted {
            break;
        }
        let Some(Case { mut controller, state, dt }) = case::<S, D>(&mut random(seed), wall) else { continue };
        let command = controller.tick(&state, S::from_f64(dt));
        let end = numbers(state.position()) + numbers(&command.velocity) * dt;
        let obstacle = controller.table().iter().next().unwrap().obstacle();
        let after = obstacle.gamma(&end.map(S::from_f64));
        let infeasible = command.status.contains(Status::INFEASIBLE);
        tried += 1;
        said += u64::from(infeasible);
        assert!(after >= S::one() || infeasible, "seed {seed}: Gamma {after} at {end}, {command:?}, {obstacle:?}");
    }
    assert!(said > 0 && said * 4 < tried * 3, "{said} of {tried} infeasible");
}

#[test]
fn bodies_are_not_entered_unsaid() {
    campaign::<f64, 2>(false);
    campaign::<f64, 3>(false);
    campaign::<f32, 2>(false);
    campaign::<f32, 3>(false);
    campaign::<Fixed, 2>(false);
    campaign::<Fixed, 3>(false);
}

#[test]
fn rooms_are_not_left_unsaid() {
    campaign::<f64, 2>(true);
    campaign::<f64, 3>(true);
    campaign::<f32, 2>(true);
    campaign::<f32, 3>(true);
    campaign::<Fixed, 2>(true);
    campaign::<Fixed, 3>(true);
}
