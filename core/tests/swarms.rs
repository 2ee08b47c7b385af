//! Discs that close in from all sides, where there is an exact answer to whether a way is left: is `INFEASIBLE` said where one is?
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod world;

use pliant_core::scalar::Fixed;
use pliant_core::{
    Ageing, Controller, Guard, Motion, Obstacle, ObstacleSpec, RobotState, Scalar, Settings, Shape, Status, Vector,
};
use rand::Rng;
use world::{Random, gamma, numbers, on_grid, random, share, vector, within};

/// Centre and radius, m.
type Disc = (Vector<f64, 2>, f64);

/// Time steps, s, and radii, m, as powers of ten.
#[derive(Clone, Copy, Debug)]
struct Swarm {
    step: (f64, f64),
    radius: (f64, f64),
}

/// At the usual rate; and at any.
const USUAL: Swarm = Swarm { step: (-3.01, -2.99), radius: (-2.65, -1.5) };
const ANY: Swarm = Swarm { step: (-3.7, -2.3), radius: (-2.65, -1.5) };

fn direction(r: &mut Random) -> Vector<f64, 2> {
    let angle: f64 = r.random_range(0.0..std::f64::consts::TAU);
    Vector::<f64, 2>::new(angle.cos(), angle.sin())
}

/// A place within a step of x and outside of all discs, each larger by `margin` (m), if there is one: what is free has a corner on two of the circles, or
/// else a whole circle for its edge.
fn free(x: &Vector<f64, 2>, step: f64, discs: &[Disc], margin: f64) -> Option<Vector<f64, 2>> {
    let larger = discs.iter().map(|(c, r)| (*c, r + margin));
    let near: Vec<Disc> = larger.filter(|(c, r)| (c - x).norm() < r + step).collect();
    let is_free = |p: &Vector<f64, 2>| {
        (p - x).norm() <= step * (1.0 + 1e-12) && near.iter().all(|(c, r)| (p - c).norm() >= r - 1e-11)
    };
    let circles: Vec<Disc> = near.iter().copied().chain([(*x, step)]).collect();
    let mut candidates = vec![*x];
    for (i, (c, r)) in circles.iter().enumerate() {
        candidates.push(c + Vector::<f64, 2>::new(0.6, 0.8) * *r);
        for (d, q) in &circles[..i] {
            let way = d - c;
            let length = way.norm();
            let along = (length * length + r * r - q * q) / (2.0 * length);
            let across = (r * r - along * along).sqrt();
            let side = Vector::<f64, 2>::new(-way.y, way.x) / length;
            candidates.extend([across, -across].map(|h| c + way / length * along + side * h));
        }
    }
    // Circles that do not meet have given no numbers, and these are not free.
    candidates.into_iter().find(is_free)
}

fn world<S: Scalar>(r: &mut Random, swarm: Swarm) -> (Controller<S, 2, 40>, Vector<f64, 2>, f64) {
    let range = |r: &mut Random, (low, high): (f64, f64)| 10f64.powf(r.random_range(low..high));
    let x: Vector<f64, 2> = vector(&on_grid(within(r, 0.4)));
    // It rests at its goal, or goes to another.
    let goal = if r.random_bool(0.5) { x } else { vector(&within(r, 0.4)) };
    let forever = S::from_f64(3600.0);
    let mut settings: Settings<S> = Settings {
        guard: Some(Guard { approach: S::from_f64(range(r, (-2.0, 0.0))) }),
        ageing: Ageing { time_to_live: forever, hold: forever, ..Ageing::default() },
        ..Settings::default()
    };
    settings.limits.speed = S::from_f64(range(r, (-1.5, 0.3)));
    let mut controller = Controller::new(Motion::linear(goal.map(S::from_f64), S::one()).unwrap(), settings);
    // A multiple of 2^-20 s: every number type has it.
    let dt = (range(r, swarm.step) * 1_048_576.0).round() / 1_048_576.0;
    let when = r.random_range(2.0..10.0) * dt;
    for id in 0..r.random_range(2..40u16) {
        let (away, speed, radius) = (direction(r), r.random_range(0.1..2.0), range(r, swarm.radius));
        let gap = speed * when + radius * r.random_range(0.0..1.5);
        let disc = Obstacle::new(ObstacleSpec {
            shape: Shape::ellipsoid(vector(&[radius; 3])),
            center: (x - away * (radius + gap)).map(S::from_f64),
            velocity: (away * speed).map(S::from_f64),
            ..ObstacleSpec::default()
        });
        controller.upsert(id, disc.unwrap(), S::zero()).unwrap();
    }
    (controller, x, dt)
}

#[derive(Debug, Default)]
struct Tally {
    ticks: u64,
    infeasible: u64,
    missed: u64,
}

fn campaign<S: Scalar>(swarm: Swarm, most: impl Fn(&Tally) -> u64) {
    let mut tally = Tally::default();
    let wanted = share(6);
    for seed in 0.. {
        if tally.ticks >= wanted {
            break;
        }
        let (mut controller, mut x, dt) = world::<S>(&mut random(seed), swarm);
        let speed = controller.settings().limits.speed.to_f64();
        let mut afterwards = 0;
        for tick in 0..40 {
            let state = RobotState::new(x.map(S::from_f64)).unwrap();
            if tick == 0 && gamma(&controller, state.position()) < S::one() {
                break;
            }
            let command = controller.tick(&state, S::from_f64(dt));
            let here = numbers(state.position());
            x = here + numbers(&command.velocity) * dt;
            tally.ticks += 1;
            let infeasible = command.status.contains(Status::INFEASIBLE);
            assert!(
                infeasible || gamma(&controller, &x.map(S::from_f64)) >= S::one(),
                "seed {seed} tick {tick}: entered"
            );
            if infeasible {
                tally.infeasible += 1;
                afterwards += 1;
                let disc = |o: &Obstacle<S, 2>| (numbers(&o.spec().center), o.spec().shape.extent()[0].to_f64());
                let discs: Vec<Disc> = controller.table().iter().map(|e| disc(e.obstacle())).collect();
                // By more than rounding.
                let margin = (16.0 * S::EPSILON.to_f64()).max(1e-9);
                if let Some(way) = free(&here, speed * dt * (1.0 - 1e-6), &discs, margin) {
                    println!("{swarm:?} seed {seed} tick {tick}: {way} is free");
                    tally.missed += 1;
                }
            }
            if afterwards > 10 {
                break;
            }
        }
    }
    println!("{swarm:?}: {tally:?}");
    assert!(tally.infeasible * 10 > tally.ticks, "nothing was tried: {tally:?}");
    assert!(tally.missed <= most(&tally), "too many missed: {tally:?}");
}

/// A millisecond.
#[test]
fn no_way_is_missed_at_the_usual_rate() {
    let most = |_: &Tally| 0;
    campaign::<f64>(USUAL, most);
    campaign::<f32>(USUAL, most);
    campaign::<Fixed>(USUAL, most);
}

/// 0.2 to 5 ms: a step may be longer than a disc is large.
#[test]
fn a_way_is_rarely_missed_at_any() {
    let most = |tally: &Tally| 1 + tally.infeasible / 100_000;
    campaign::<f64>(ANY, most);
    campaign::<f32>(ANY, most);
    campaign::<Fixed>(ANY, most);
}
