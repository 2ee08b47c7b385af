//! Random worlds: every shape and motion, in any number type and dimension, from a seed.
#![allow(dead_code, reason = "each test uses a part of it")]

use pliant_core::shape::{MAX_VERTICES, Polygon};
use pliant_core::{
    Ageing, Component, Controller, Guard, LpvDs, Matrix, Motion, Obstacle, ObstacleSpec, RobotState, Scalar, Scan,
    Settings, Shape, SteeringPolicy, Vector, rotation,
};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub mod balls;
pub mod judge;
pub mod room;
pub mod scene;

pub type Random = ChaCha8Rng;

pub fn random(seed: u64) -> Random {
    ChaCha8Rng::seed_from_u64(seed)
}

/// Samples of one test of a campaign that takes PLIANT_SAMPLES (a million, unless set) for each scalar type, in so many tests.
pub fn share(tests: u64) -> u64 {
    let all: u64 = std::env::var("PLIANT_SAMPLES").ok().and_then(|n| n.parse().ok()).unwrap_or(1_000_000);
    all.div_ceil(tests)
}

/// Are there enough samples that rare cases must be among them?
pub fn is_long() -> bool {
    share(1) >= 1_000_000
}

pub fn vector<S: Scalar, const D: usize>(v: &[f64; 3]) -> Vector<S, D> {
    Vector::from_fn(|i, _| S::from_f64(v[i]))
}

pub fn numbers<S: Scalar, const D: usize>(v: &Vector<S, D>) -> Vector<f64, D> {
    v.map(|x| x.to_f64())
}

pub fn within(r: &mut Random, bound: f64) -> [f64; 3] {
    [(); 3].map(|()| r.random_range(-bound..bound))
}

pub fn turn<S: Scalar, const D: usize>(r: &mut Random) -> Matrix<S, D> {
    let [x, y, z] = if D == 2 { [0.0, 0.0, 1.0] } else { within(r, 1.0) };
    let w = r.random_range(-1.0..1.0f64);
    let length = (w * w + x * x + y * y + z * z).sqrt().max(0.1);
    let q = rotation::spatial([w, x, y, z].map(|q| q / length)).unwrap_or_else(nalgebra::Matrix3::identity);
    Matrix::from_fn(|i, j| S::from_f64(q[(i, j)]))
}

fn spin<S: Scalar, const D: usize>(r: &mut Random, most: f64) -> Matrix<S, D> {
    let rate = most * r.random_range(0.0..1.0f64);
    let w = if D == 2 { [0.0, 0.0, 1.0] } else { within(r, 0.57) };
    let m = rotation::spatial_spin(&(nalgebra::Vector3::from(w) * rate));
    Matrix::from_fn(|i, j| S::from_f64(m[(i, j)]))
}

pub fn shape<S: Scalar, const D: usize>(r: &mut Random, size: f64, odd: bool) -> Shape<S, D> {
    let s = S::from_f64;
    let length = |r: &mut Random| size * r.random_range(0.3..1.0f64);
    let sides = [length(r), length(r), length(r)];
    let least = sides[..D].iter().fold(f64::MAX, |m, x| m.min(*x));
    let rounding = s(least * r.random_range(0.15..0.95f64));
    match r.random_range(0..8u8) {
        0..=2 => Shape::Ellipsoid { axes: vector(&sides), curvature: r.random_range(1..=3) },
        3 => Shape::Ellipsoid { axes: vector(&sides), curvature: 1 },
        4 => Shape::Box { half: vector(&sides), rounding },
        5 if D == 3 => {
            Shape::Cylinder { radius: s(sides[0]), half_length: s(sides[2]), rounding: s(sides[0].min(sides[2]) * 0.3) }
        }
        6 if D == 3 => Shape::Capsule { radius: s(sides[0]), half_length: s(sides[1]) },
        _ if D == 2 && odd && r.random_bool(0.5) => Shape::Polygon(uneven_polygon(r, size)),
        _ if D == 2 => {
            let n = r.random_range(4..=MAX_VERTICES);
            let corners: Vec<[S; 2]> = (0..n)
                .map(|i| {
                    let angle = std::f64::consts::TAU * (i as f64) / n as f64;
                    let radius = length(r);
                    [s(radius * angle.cos()), s(radius * angle.sin())]
                })
                .collect();
            Shape::Polygon(Polygon::new(&corners).unwrap())
        }
        _ => Shape::Box { half: vector(&sides), rounding },
    }
}

/// A polygon with corners at any angles, up to `size` (m) away: notches, spikes, and edges as short as the number type holds apart.
pub fn uneven_polygon<S: Scalar>(r: &mut Random, size: f64) -> Polygon<S> {
    loop {
        let n = r.random_range(3..=MAX_VERTICES);
        let mut angles: Vec<f64> = (0..n).map(|_| r.random_range(0.0..std::f64::consts::TAU)).collect();
        if r.random_bool(0.3) {
            // Two corners close together.
            angles[1] = angles[0] + 10f64.powf(r.random_range(-5.0..-1.0));
        }
        angles.sort_by(f64::total_cmp);
        let kind = r.random_range(0..3u8);
        let corners: Vec<[S; 2]> = angles
            .iter()
            .map(|angle| {
                let radius = size
                    * match kind {
                        0 => r.random_range(0.2..1.0f64),
                        1 => 0.7,
                        _ => 10f64.powf(r.random_range(-1.3..0.0)),
                    };
                [S::from_f64(radius * angle.cos()), S::from_f64(radius * angle.sin())]
            })
            .collect();
        let polygon = Polygon::new(&corners).unwrap();
        let spec = ObstacleSpec { shape: Shape::Polygon(polygon.clone()), ..ObstacleSpec::<S, 2>::default() };
        if Obstacle::new(spec).is_ok() {
            return polygon;
        }
    }
}

/// What may be in a world.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// Most obstacles.
    pub obstacles: usize,
    /// m/s, and 2.5 times as many rad/s, and a tenth of it in growth.
    pub speed: f64,
    pub walls: bool,
    pub scans: bool,
    /// Polygons with corners at any angles, walls of up to tens of metres, and bodies from 1 cm to half a metre?
    pub odd: bool,
    /// Mostly bodies down to a millimetre thin, and up to 500 times as long?
    pub thin: bool,
}

pub fn obstacle<S: Scalar, const D: usize>(r: &mut Random, kind: &Kind) -> Option<Obstacle<S, D>> {
    let ones = [1.0; 3];
    let moving = kind.speed > 0.0 && r.random_bool(0.7);
    let fast = if moving { kind.speed } else { 1e-9 };
    let ratio = if r.random_bool(0.5) { ones } else { [r.random_range(1.0..2.5f64); 3] };
    let margin = if r.random_bool(0.6) { ones } else { [(); 3].map(|()| r.random_range(1.0..1.4f64)) };
    let velocity: Vector<S, D> = vector(&within(r, fast / 1.75));
    // Mostly as large as each other, some small, some large.
    let size = if !kind.odd || r.random_bool(0.8) { 0.15 } else { 10f64.powf(r.random_range(-1.5..-0.4)) };
    let shape = if kind.thin && r.random_bool(0.7) { room::narrow(r) } else { shape(r, size, kind.odd) };
    let margin = if let Shape::Polygon(_) = shape { [margin[0]; 3] } else { margin };
    let reference = vector(&[0.01, -0.005, 0.005].map(|x| if r.random_bool(0.3) { x } else { 0.0 }));
    let growth = if r.random_bool(0.3) { r.random_range(-0.1..0.1f64) * fast } else { 0.0 };
    let still = !moving;
    let spec = ObstacleSpec {
        center: vector(&within(r, 0.6)),
        rotation: turn(r),
        shape,
        wall: false,
        soft_ratio: vector(&ratio),
        margin: vector(&margin),
        reference,
        velocity: if still { Vector::zeros() } else { velocity },
        spin: if still { Matrix::zeros() } else { spin(r, fast * 2.5) },
        growth: if still { S::zero() } else { S::from_f64(growth) },
    };
    Obstacle::new(spec).ok()
}

pub fn wall<S: Scalar, const D: usize>(r: &mut Random, odd: bool) -> Obstacle<S, D> {
    // Some so large that what is near of them is nearly flat.
    let size = if odd && r.random_bool(0.25) { 10f64.powf(r.random_range(0.0..1.5)) } else { 1.0 };
    let half = Vector::<S, D>::from_fn(|_, _| S::from_f64(size * r.random_range(0.7..1.0f64)));
    let shape = match r.random_range(0..if odd { 4u8 } else { 3 }) {
        0 => Shape::ellipsoid(half),
        1 => Shape::Ellipsoid { axes: half, curvature: 3 },
        3 if D == 2 => Shape::Polygon(uneven_polygon(r, 1.5 * size)),
        _ => Shape::Box { half, rounding: S::from_f64(0.2 * size) },
    };
    // Its surface passes the robot's workspace all the same.
    let mut center = Vector::zeros();
    if odd {
        let way = Vector::<f64, D>::from_fn(|_, _| r.random_range(-1.0..1.0));
        center = (way * ((size - 1.0) / way.norm().max(0.1))).map(S::from_f64);
    }
    Obstacle::new(ObstacleSpec { shape, center, wall: true, rotation: turn(r), ..ObstacleSpec::default() }).unwrap()
}

/// A stable motion: straight, or of some components by construction (A = -(rate I) + skew, so P = I proves it).
pub fn motion<S: Scalar, const D: usize>(r: &mut Random) -> Motion<S, D> {
    let attractor = vector(&on_grid(within(r, 0.4)));
    if r.random_bool(0.4) {
        return Motion::linear(attractor, S::from_f64(r.random_range(0.2..5.0f64))).unwrap();
    }
    Motion::Lpv(LpvDs::new(attractor, Matrix::identity(), &components(r)).unwrap().certify().unwrap())
}

/// Multiples of 2^-12 m: within a few metres every number type holds them and their differences exactly.
pub fn on_grid(x: [f64; 3]) -> [f64; 3] {
    x.map(|x| (x * 4096.0).round() / 4096.0)
}

pub fn components<S: Scalar, const D: usize>(r: &mut Random) -> Vec<Component<S, D>> {
    (0..r.random_range(1..=8))
        .map(|_| {
            let skew = spin::<S, D>(r, 2.0);
            let rate = r.random_range(0.5..3.0f64);
            Component {
                log_weight: S::from_f64(r.random_range(-1.0..1.0f64)),
                mean: vector(&within(r, 0.5)),
                whitening: Matrix::identity() * S::from_f64(r.random_range(3.0..30.0f64)),
                a: skew - Matrix::identity() * S::from_f64(rate),
            }
        })
        .collect()
}

pub fn settings<S: Scalar>(r: &mut Random) -> Settings<S> {
    let steering = if r.random_bool(0.7) {
        SteeringPolicy::WithFlow { beta: S::one() }
    } else {
        SteeringPolicy::fixed(S::from_f64(r.random_range(-3.0..3.0f64)))
    };
    let forever = S::from_f64(3600.0);
    let ageing = if r.random_bool(0.8) {
        Ageing { time_to_live: forever, growth: S::from_f64(0.02), hold: forever }
    } else {
        Ageing { time_to_live: S::from_f64(0.02), ..Ageing::default() }
    };
    let mut settings =
        Settings { steering, ageing, gain: S::from_f64(r.random_range(0.0..0.2f64)), ..Settings::default() };
    settings.limits.speed = S::from_f64(r.random_range(0.1..2.0f64));
    if r.random_bool(0.3) {
        settings.limits.acceleration = Some(S::from_f64(r.random_range(0.5..20.0f64)));
    }
    settings
}

/// The same with limits and guards of every kind.
fn pressed<S: Scalar>(r: &mut Random, mut settings: Settings<S>) -> Settings<S> {
    if r.random_bool(0.3) {
        settings.limits.speed = S::from_f64(10f64.powf(r.random_range(-4.0..0.3)));
    }
    if r.random_bool(0.5) {
        settings.guard = Some(Guard { approach: S::from_f64(10f64.powf(r.random_range(-2.5..0.0))) });
    }
    settings
}

pub struct World<S: Scalar, const D: usize> {
    pub controller: Controller<S, D, 40>,
    pub start: Vector<f64, D>,
}

/// A controller among obstacles, and a start outside of all cores if one was found.
pub fn world<S: Scalar, const D: usize>(seed: u64, kind: &Kind) -> Option<World<S, D>> {
    let r = &mut random(seed);
    let mut controller: Controller<S, D, 40> = Controller::new(motion(r), settings(r));
    if kind.walls && r.random_bool(0.25) {
        let walls = if kind.odd && r.random_bool(0.4) { r.random_range(2..=3) } else { 1 };
        for n in 0..walls {
            controller.upsert(1000 + n, wall(r, kind.odd), S::zero()).unwrap();
        }
    }
    for id in 0..r.random_range(1..=kind.obstacles) {
        if let Some(o) = obstacle(r, kind) {
            controller.upsert(id as u16, o, S::zero()).unwrap();
        }
    }
    if kind.scans && r.random_bool(0.25) {
        let (from, to) = (within(r, 0.6), within(r, 0.6));
        let n = r.random_range(1..100);
        let at = |i: usize, t: f64| from[i] + (to[i] - from[i]) * t;
        let points: Vec<Vector<S, D>> =
            (0..n).map(|i| Vector::from_fn(|j, _| S::from_f64(at(j, f64::from(i) / f64::from(n))))).collect();
        controller.set_scan(Scan::new(&points, S::from_f64(0.02)).unwrap(), S::zero());
    }
    if kind.odd {
        controller.set_settings(pressed(r, *controller.settings()));
    }
    (0..200).find_map(|_| {
        let mut start = Vector::<f64, D>::from_fn(|_, _| r.random_range(-0.7..0.7f64));
        if kind.odd && controller.table().iter().next().is_some() && r.random_bool(0.3) {
            // Hard by a surface, within its skin too.
            let of = controller.table().iter().nth(r.random_range(0..controller.table().len()))?.obstacle();
            let way = numbers(&(of.surface(&start.map(S::from_f64)) - of.spec().center));
            let beyond = 1.0 + 10f64.powf(r.random_range(-7.0..-3.0));
            start = numbers(&of.spec().center) + way * if of.spec().wall { 1.0 / beyond } else { beyond };
        }
        let state = RobotState::new(start.map(S::from_f64))?;
        (gamma(&controller, state.position()) >= S::one()).then_some(())?;
        let start = numbers(state.position());
        Some(World { controller: controller.clone(), start })
    })
}

/// The least Gamma of all that is in the table now.
pub fn gamma<S: Scalar, const D: usize, const CAP: usize>(controller: &Controller<S, D, CAP>, x: &Vector<S, D>) -> S {
    let table = controller.table();
    table.iter().map(|e| e.obstacle().gamma(x)).fold(table.scan().gamma(x), |m, g| if g < m { g } else { m })
}
