//! Whatever finite input, a finite output within the limits: at centres, on boundaries, at reference points, far away, with f = 0, with twins.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod world;

use pliant_core::scalar::Fixed;
use pliant_core::{
    Component, Controller, Limits, LpvDs, Matrix, Motion, Obstacle, ObstacleSpec, RobotState, Scalar, Scan, Settings,
    Shape, Status, SteeringPolicy, Vector, rotation,
};
use rand::Rng;
use world::{Random, is_long, random, share, vector};

/// A length between the smallest and the largest there are.
fn length<S: Scalar>(r: &mut Random) -> f64 {
    10f64.powf(r.random_range(-4.0..3.0)).max(S::MIN_AXIS.to_f64() * 1.001)
}

fn coordinate(r: &mut Random) -> f64 {
    match r.random_range(0..4u8) {
        0 => 0.0,
        1 => r.random_range(-1.0..1.0),
        2 => r.random_range(-999.0..999.0),
        _ => 10f64.powf(r.random_range(-30.0..3.0)),
    }
}

fn anywhere(r: &mut Random) -> [f64; 3] {
    [coordinate(r), coordinate(r), coordinate(r)]
}

fn shape<S: Scalar, const D: usize>(r: &mut Random) -> Shape<S, D> {
    let sides = [length::<S>(r), length::<S>(r), length::<S>(r)];
    let least = sides[..D].iter().fold(f64::MAX, |m, x| m.min(*x));
    match r.random_range(0..5u8) {
        0 => world::shape(r, sides[0] * 4.0, true),
        1 => world::room::narrow(r),
        2 => Shape::Box { half: vector(&sides), rounding: S::from_f64(least) },
        _ => Shape::Ellipsoid { axes: vector(&sides), curvature: r.random_range(1..=8) },
    }
}

fn obstacle<S: Scalar, const D: usize>(r: &mut Random) -> Option<Obstacle<S, D>> {
    let shape = shape::<S, D>(r);
    let ratio = |r: &mut Random| [1.0, r.random_range(1.0..3.0), 100.0][r.random_range(0..3usize)];
    let speed =
        |r: &mut Random| [0.0, r.random_range(-2.0..2.0), r.random_range(-100.0..100.0)][r.random_range(0..3usize)];
    let half = r.random_range(-3.0..3.0f64);
    let turn = rotation::spatial([half.cos(), 0.0, 0.0, half.sin()]).unwrap();
    let spin = rotation::spatial_spin(&nalgebra::Vector3::new(0.0, 0.0, speed(r)));
    let (mut soft, mut margin) = ([ratio(r), ratio(r), ratio(r)], [ratio(r), ratio(r), ratio(r)]);
    if let Shape::Polygon(_) = shape {
        (soft, margin) = ([soft[0]; 3], [margin[0]; 3]);
    }
    let reference = shape.extent().map(|a| a * S::from_f64(r.random_range(-0.5..0.5)));
    Obstacle::new(ObstacleSpec {
        center: vector(&anywhere(r)),
        rotation: Matrix::from_fn(|i, j| S::from_f64(turn[(i, j)])),
        shape,
        wall: r.random_bool(0.1),
        soft_ratio: vector(&soft),
        margin: vector(&margin),
        reference,
        velocity: vector(&[speed(r), speed(r), speed(r)]),
        spin: Matrix::from_fn(|i, j| S::from_f64(spin[(i, j)])),
        growth: S::from_f64(speed(r) * if r.random_bool(0.3) { 1.0 } else { 0.0 }),
    })
    .ok()
}

/// Somewhere, or at a telling place of the first obstacle.
fn place<S: Scalar, const D: usize>(r: &mut Random, o: &Obstacle<S, D>) -> Vector<S, D> {
    let way = Vector::from_fn(|_, _| S::from_f64(r.random_range(-1.0..1.0)));
    match r.random_range(0..9u8) {
        0 => o.spec().center,
        1 => o.reference(),
        2 => o.surface(&way),
        3 => o.soft_surface(&way),
        4 => o.spec().center + (o.surface(&way) - o.spec().center) * S::from_f64(1.000_001),
        5 => o.spec().center + (o.surface(&way) - o.spec().center) * S::from_f64(0.999),
        _ => vector(&anywhere(r)),
    }
}

fn motion<S: Scalar, const D: usize>(r: &mut Random, x: &Vector<S, D>) -> Motion<S, D> {
    let attractor = if r.random_bool(0.2) { *x } else { vector(&anywhere(r)) };
    if r.random_bool(0.5) {
        return Motion::linear(attractor, S::from_f64(10f64.powf(r.random_range(-3.0..2.9)))).unwrap();
    }
    let parts: Vec<Component<S, D>> = (0..r.random_range(1..=16))
        .map(|_| Component {
            log_weight: S::from_f64(r.random_range(-1000.0..1000.0)),
            mean: vector(&anywhere(r)),
            whitening: Matrix::identity() * S::from_f64(10f64.powf(r.random_range(-2.0..3.0))),
            a: -Matrix::identity() * S::from_f64(r.random_range(0.01..1000.0)),
        })
        .collect();
    Motion::Lpv(LpvDs::new(attractor, Matrix::identity(), &parts).unwrap().certify().unwrap())
}

/// How often each degenerate input was really there.
#[derive(Default, Debug)]
struct Tally {
    ticks: u64,
    at_center: u64,
    at_reference: u64,
    /// Gamma or Gamma_k is one but for 64 units of rounding.
    on_boundary: u64,
    on_soft_boundary: u64,
    /// f = 0
    at_rest: u64,
    twins: u64,
    /// Gamma is infinite or at the end of the range, or beyond what is looked at.
    overflow: u64,
    far: u64,
    /// A soft layer that lies inside its own safety factor.
    swallowed: u64,
}

impl Tally {
    fn count<S: Scalar, const D: usize>(&mut self, c: &Controller<S, D, 8>, x: &Vector<S, D>) {
        let one = |gamma: S| (gamma - S::one()).abs() <= S::EPSILON * S::from_f64(64.0);
        let entries: Vec<&Obstacle<S, D>> = c.table().iter().map(|e| e.obstacle()).collect();
        let any = |is: &dyn Fn(&Obstacle<S, D>) -> bool| u64::from(entries.iter().any(|o| is(o)));
        self.ticks += 1;
        self.at_center += any(&|o| o.spec().center == *x);
        self.at_reference += any(&|o| o.reference() == *x && o.spec().center != *x);
        self.on_boundary += any(&|o| one(o.gamma(x)));
        self.on_soft_boundary += any(&|o| one(o.gamma_soft(x)) && o.gamma(x) > S::one());
        self.overflow += any(&|o| !(o.gamma(x) < S::MAX));
        self.far += any(&|o| !(o.gamma(x) < S::FAR));
        let swallows = |o: &Obstacle<S, D>| (0..D).all(|i| o.spec().margin[i] >= o.spec().soft_ratio[i]);
        self.swallowed += any(&|o| swallows(o) && o.spec().soft_ratio.iter().any(|rho| *rho > S::one()));
        let same = |i: usize| entries.iter().skip(i + 1).any(|o| o.spec() == entries[i].spec());
        self.twins += u64::from((0..entries.len()).any(same));
        let still = c.motion().relative(x) + c.motion().drift();
        self.at_rest += u64::from(still.iter().all(|f| *f == S::zero()));
    }

    fn check(&self, huge_fits: bool) {
        println!("{self:?}");
        let often =
            |n: u64, share: u64| assert!(n * share >= self.ticks || !is_long(), "not tried often enough: {self:?}");
        for n in [self.at_center, self.at_reference, self.on_boundary, self.on_soft_boundary, self.at_rest] {
            often(n, 100);
        }
        for n in [self.twins, self.far, self.swallowed] {
            often(n, 20);
        }
        // Of f64 no Gamma there may be reaches the end: (2000 m / 0.1 mm)^16.
        assert!(huge_fits || self.overflow * 1000 >= self.ticks || !is_long(), "{self:?}");
    }
}

fn limits<S: Scalar>(r: &mut Random) -> Limits<S> {
    let speed = if r.random_bool(0.5) { 0.5 } else { 10f64.powf(r.random_range(-4.0..2.0)) };
    let acceleration = r.random_bool(0.3).then(|| S::from_f64(10f64.powf(r.random_range(-1.0..3.0))));
    Limits { speed: S::from_f64(speed), acceleration, ..Limits::default() }
}

fn controller<S: Scalar, const D: usize>(
    r: &mut Random,
    obstacles: Vec<Obstacle<S, D>>,
    x: &Vector<S, D>,
) -> Controller<S, D, 8> {
    let steering = if r.random_bool(0.5) {
        SteeringPolicy::fixed(S::from_f64(r.random_range(-4.0..4.0)))
    } else {
        SteeringPolicy::WithFlow { beta: S::one() }
    };
    let gain = S::from_f64(r.random_range(0.0..10.0));
    let mut settings = Settings { steering, gain, limits: limits(r), ..Settings::default() };
    if r.random_bool(0.3) {
        settings.guard = None;
    }
    let mut controller = Controller::new(motion(r, x), settings);
    for (id, o) in obstacles.into_iter().enumerate() {
        controller.upsert(id as u16, o, S::from_f64(r.random_range(0.0..2.0))).unwrap();
    }
    if r.random_bool(0.2) {
        let points = [*x, vector(&anywhere(r)), vector(&anywhere(r))];
        controller.set_scan(Scan::new(&points, S::from_f64(length::<S>(r).min(99.0))).unwrap(), S::zero());
    }
    if r.random_bool(0.1) {
        controller.aim(&vector(&anywhere(r)), &vector(&[1.0, -1.0, 0.5]));
    }
    controller
}

fn campaign<S: Scalar, const D: usize>(seed: u64) {
    let r = &mut random(seed);
    let mut tally = Tally::default();
    while tally.ticks < share(2) {
        let mut obstacles: Vec<Obstacle<S, D>> = (0..r.random_range(1..7)).filter_map(|_| obstacle(r)).collect();
        let Some(first) = obstacles.first().cloned() else { continue };
        if r.random_bool(0.3) {
            obstacles.push(first.clone());
        }
        let x = place(r, &first);
        // A place of an obstacle may be out of range itself.
        let Some(state) = RobotState::new(x) else { continue };
        let mut controller = controller(r, obstacles, &x);
        let Limits { speed, acceleration, .. } = controller.settings().limits;
        let (speed, eps) = (speed.to_f64(), S::EPSILON.to_f64());
        let step = S::rounding(S::zero()).to_f64();
        let fastest = speed * (1.0 + 1e-5) + 8.0 * eps.min(speed) + 8.0 * step;
        let mut here = Some(state);
        let mut previous = Vector::<f64, D>::zeros();
        let usual = [0.001, 0.001, 0.1].into_iter().cycle().take(12);
        for dt in usual.chain([0.0, 1e-9, 0.5, 30.0, S::MAX.to_f64()]) {
            let state = here.unwrap_or(state);
            tally.count(&controller, state.position());
            let before = controller.clone();
            let command = controller.tick(&state, S::from_f64(dt));
            let u = command.velocity.map(|v| v.to_f64());
            let what = || format!("{command:?}\nat {state:?}\nof {:?}\n{before:?}", before.evaluate(&state));
            assert!(command.velocity.iter().all(|v| v.is_finite()), "{}", what());
            assert!(u.norm() <= fastest, "{} over {speed}: {}", u.norm(), what());
            assert!(command.gamma.is_finite() && !command.status.contains(Status::NOT_FINITE), "{}", what());
            // The guard may change it by more.
            if let Some(acceleration) = acceleration
                && !command.status.contains(Status::GUARDED)
            {
                let most = (acceleration * S::from_f64(dt)).to_f64();
                let rounding = 8.0 * (eps * speed + step);
                assert!(
                    (u - previous).norm() <= most * (1.0 + 1e-5) + rounding,
                    "{} over {most} from {previous}{}",
                    (u - previous).norm(),
                    what()
                );
            }
            previous = u;
            let somewhere = controller.table().iter().next().map(|e| place(r, e.obstacle()));
            // Or where the motion ends.
            let somewhere = if r.random_bool(0.1) { Some(controller.motion().attractor()) } else { somewhere };
            here = somewhere.and_then(RobotState::new);
        }
    }
    tally.check(S::from_f64(1e300).to_f64() == 1e300);
}

macro_rules! campaigns {
    ($($name:ident: $scalar:ty, $d:literal, $seed:literal;)+) => {
        $(#[test] fn $name() { campaign::<$scalar, $d>($seed); })+
    };
}
campaigns! {
    finite_2d_f32: f32, 2, 1;
    finite_3d_f32: f32, 3, 2;
    finite_2d_f64: f64, 2, 3;
    finite_3d_f64: f64, 3, 4;
    finite_2d_fixed: Fixed, 2, 5;
    finite_3d_fixed: Fixed, 3, 6;
}
