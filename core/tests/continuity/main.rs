//! Along random lines the velocity has no jump, at shells, overlaps or anywhere else outside of cores; and what jumps is found.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod bounds;
mod turning;
#[path = "../world/mod.rs"]
mod world;

use pliant_core::scalar::Fixed;
use pliant_core::{
    Controller, Obstacle, ObstacleSpec, RobotState, Scalar, Scan, Settings, Status, SteeringPolicy, Vector,
};
use rand::Rng;
use world::scene::{MOVING, STILL, controller, place, some};
use world::{Kind, Random, is_long, motion, numbers, random, share, vector, within};

/// c, m/s: how far the paper's steering jumps at a shell.
const GAIN: f64 = 1.0;
/// Samples on a line.
const POINTS: u32 = 200;
/// Between them, m.
const STEP: f64 = 1e-3;
/// Closer to a core than this Gamma the weights of overlapping cores become as steep as one likes: 1/(Gamma - 1).
const NEAREST: f64 = 1.05;

struct Line<'a, S: Scalar, const D: usize> {
    controller: &'a Controller<S, D, 16>,
    from: Vector<f64, D>,
    way: Vector<f64, D>,
}

impl<S: Scalar, const D: usize> Line<'_, S, D> {
    /// As modulated, and as adapted, m/s.
    fn velocity(&self, along: f64) -> Option<[Vector<f64, D>; 2]> {
        let stages = self.controller.evaluate(&RobotState::new((self.from + self.way * along).map(S::from_f64))?);
        // Where g.r vanishes, as beside a polygon whose shared reference point does not see all of it, the method has a pole: ten times as fast as f is
        // near it, and the status says where it is.
        let (f, u) = (numbers(&stages.nominal).norm(), numbers(&stages.modulated).norm());
        let pole = stages.status.contains(Status::REFERENCE) || u > 10.0 * (f + 1.0);
        (stages.gamma.to_f64() > NEAREST && !pole).then(|| [numbers(&stages.modulated), numbers(&stages.adapted)])
    }

    /// Halves an interval again and again, each time taking the half in which one of the two changes more: what change is left, of a continuous velocity
    /// nothing, of a jump all of it; over the bound on that. And the largest bound on the slope on the way into `steepest`.
    fn jump(&self, of: usize, mut low: f64, mut high: f64, steepest: &mut f64) -> Option<Jump> {
        let (mut at_low, mut at_high) = (self.velocity(low)?, self.velocity(high)?);
        loop {
            let changes = [0, 1].map(|i| (at_high[i] - at_low[i]).norm());
            let slope = self.slope([low, high], changes[0] / (high - low))[of];
            *steepest = steepest.max(slope);
            if high - low <= closest::<S>() {
                return Some(Jump { change: changes[of], of_bound: changes[of] / (slope * interval::<S>()) });
            }
            let middle = (low + high) * 0.5;
            let at_middle = self.velocity(middle)?;
            if (at_middle[of] - at_low[of]).norm() > (at_high[of] - at_middle[of]).norm() {
                (high, at_high) = (middle, at_middle);
            } else {
                (low, at_low) = (middle, at_middle);
            }
        }
    }
}

/// What is left of a change, m/s, and over its bound.
#[derive(Default)]
struct Jump {
    change: f64,
    of_bound: f64,
}

#[derive(Default, Debug)]
struct Found {
    tried: u64,
    /// Lines aimed at where two are near.
    aimed: u64,
    /// m/s
    jump: f64,
    jump_of_bound: f64,
    /// The steepest slope between samples.
    slope_of_bound: f64,
    /// Steps across a shell, into an overlap of two.
    shells: u64,
    overlaps: u64,
}

impl Found {
    /// Looks closer at the step that ends here, over which one of the two velocities changes by so much.
    fn look<S: Scalar, const D: usize>(&mut self, line: &Line<'_, S, D>, of: usize, along: f64, change: f64) {
        if change > 0.0 {
            let mut steepest = 0.0;
            let jump = line.jump(of, along - STEP, along, &mut steepest).unwrap_or_default();
            self.jump = self.jump.max(jump.change);
            self.jump_of_bound = self.jump_of_bound.max(jump.of_bound);
            self.slope_of_bound = self.slope_of_bound.max(change / STEP / steepest);
        }
    }
}

/// Intervals no shorter than this are looked at: with 64 units of rounding of a metre, the rounding of a position is a part of it.
fn closest<S: Scalar>() -> f64 {
    (64.0 * S::EPSILON.to_f64()).max(1e-10)
}

fn along_lines<S: Scalar, const D: usize>(seed: u64, kind: &Kind, steering: SteeringPolicy<S>) -> Found {
    let r = &mut random(seed);
    let mut found = Found::default();
    while found.tried < share(4) {
        // Range points by themselves, for what is between them and cores at any distance has no bound as simple.
        let points = if r.random_bool(0.1) { points(r) } else { Vec::new() };
        let mut obstacles: Vec<Obstacle<S, D>> = if points.is_empty() { some(r, kind) } else { Vec::new() };
        if r.random_bool(0.5) {
            obstacles.iter_mut().for_each(|o| *o = closer(o));
        }
        let settings = Settings { gain: S::from_f64(GAIN), steering, ..Settings::default() };
        let mut controller = controller(motion(r), settings, obstacles.iter().cloned());
        controller.set_scan(Scan::new(&points, S::from_f64(0.05)).unwrap(), S::zero());
        for _ in 0..5 {
            let line = line(r, &controller, &obstacles, &mut found);
            let (mut last, mut layers) = (None, 0);
            let mut steepest = [(0.0, 0.0); 2];
            for i in 0..POINTS {
                let along = STEP * f64::from(i);
                let here = line.velocity(along);
                found.tried += 1;
                let x = (line.from + line.way * along).map(S::from_f64);
                let now = obstacles.iter().filter(|o| o.gamma_soft(&x) <= S::one()).count();
                if let (Some(last), Some(here)) = (last, here) {
                    let changes: [f64; 2] = [0, 1].map(|of| (here[of] - (last as [Vector<f64, D>; 2])[of]).norm());
                    for of in [0, 1] {
                        if changes[of] > steepest[of].0 {
                            steepest[of] = (changes[of], along);
                        }
                    }
                    if now != layers {
                        found.shells += 1;
                        found.overlaps += u64::from(now.max(layers) > 1);
                        found.look(&line, 1, along, changes[1]);
                    }
                }
                (last, layers) = (here, now);
            }
            for (of, (change, along)) in steepest.into_iter().enumerate() {
                found.look(&line, of, along, change);
            }
        }
    }
    println!("{D}-D {:e} m: {found:?}", closest::<S>());
    found
}

/// The same nearer to the middle, where it meets others.
fn closer<S: Scalar, const D: usize>(o: &Obstacle<S, D>) -> Obstacle<S, D> {
    let center = o.spec().center * S::from_f64(0.4);
    Obstacle::new(ObstacleSpec { center, ..o.spec().clone() }).unwrap()
}

/// Anywhere in the robot's workspace, some of them close together.
fn points<S: Scalar, const D: usize>(r: &mut Random) -> Vec<Vector<S, D>> {
    let spread = r.random_range(0.1..0.6);
    (0..r.random_range(2..30)).map(|_| vector(&within(r, spread))).collect()
}

/// A line through such a place, both ways from there, half of them through one where two layers, cores or range points are near.
fn line<'a, S: Scalar, const D: usize>(
    r: &mut Random,
    controller: &'a Controller<S, D, 16>,
    obstacles: &[Obstacle<S, D>],
    found: &mut Found,
) -> Line<'a, S, D> {
    let aimed = r.random_bool(0.5);
    let from = if aimed { between(r, controller, obstacles) } else { None };
    found.aimed += u64::from(from.is_some());
    let from = numbers(&from.unwrap_or_else(|| place(r, obstacles)));
    let way = Vector::<f64, D>::from_fn(|_, _| r.random_range(-1.0..1.0));
    let way = way / way.norm().max(1e-3);
    Line { controller, from: from - way * (0.5 * STEP * f64::from(POINTS)), way }
}

/// A place outside of every core where two layers overlap or two surfaces are so near that both count.
fn between<S: Scalar, const D: usize>(
    r: &mut Random,
    controller: &Controller<S, D, 16>,
    obstacles: &[Obstacle<S, D>],
) -> Option<Vector<S, D>> {
    let scan = controller.table().scan();
    let radius = scan.radius().to_f64();
    (0..200).find_map(|_| {
        let x = if scan.points().is_empty() {
            place(r, obstacles)
        } else {
            let [a, b] = [(); 2].map(|()| numbers(&scan.points()[r.random_range(0..scan.points().len())]));
            vector(&[0, 1, 2].map(|i| (a + (b - a) * 0.5).get(i).map_or(0.0, |x| x + r.random_range(-radius..radius))))
        };
        let cores = obstacles.iter().map(|o| o.gamma(&x).to_f64());
        let balls = scan.points().iter().map(|p| (numbers(&x) - numbers(p)).norm_squared() / (radius * radius));
        let gammas: Vec<f64> = cores.chain(balls).collect();
        let near = gammas.iter().filter(|g| **g < 2.0).count();
        let layers = obstacles.iter().filter(|o| o.gamma_soft(&x) <= S::one()).count();
        (near.max(layers) > 1 && gammas.iter().all(|g| *g > NEAREST)).then_some(x)
    })
}

/// The shortest interval, and what rounding does to both its ends, m: that acts as a displacement by some units. Times [`bounds::SLOPE`] it is
/// the least jump that is seen: 4e-7 m/s in f64, 0.06 in f32, 0.5 in fixed point.
fn interval<S: Scalar>() -> f64 {
    closest::<S>() + 64.0 * S::EPSILON.to_f64()
}

fn no_jump<S: Scalar, const D: usize>(seed: u64) {
    let (mut overlaps, mut aimed) = (0, 0);
    for (seed, kind) in [(seed, STILL), (seed + 100, MOVING)] {
        let found = along_lines::<S, D>(seed, &kind, SteeringPolicy::WithFlow { beta: S::one() });
        assert!(found.jump_of_bound < 1.0 && found.slope_of_bound < 1.0, "{found:?}");
        assert!(found.shells * 4000 > found.tried || !is_long(), "{found:?}");
        overlaps += found.overlaps;
        aimed += found.aimed;
    }
    assert!(
        overlaps * 5000 > share(2) && aimed * 10 * u64::from(POINTS) > share(2) || !is_long(),
        "{overlaps} {aimed}"
    );
}

macro_rules! campaigns {
    ($($name:ident: $scalar:ty, $d:literal, $seed:literal;)+) => {
        $(#[test] fn $name() { no_jump::<$scalar, $d>($seed); })+
    };
}
campaigns! {
    continuity_2d_f64: f64, 2, 41;
    continuity_3d_f64: f64, 3, 42;
    continuity_2d_f32: f32, 2, 43;
    continuity_3d_f32: f32, 3, 44;
    continuity_2d_fixed: Fixed, 2, 45;
    continuity_3d_fixed: Fixed, 3, 46;
}

/// The paper's own steering jumps by c at a shell, and the search finds it in every number type.
#[test]
fn what_jumps_is_found() {
    fn check<S: Scalar, const D: usize>(seed: u64) {
        let found = along_lines::<S, D>(seed, &STILL, SteeringPolicy::fixed(S::from_f64(0.7)));
        assert!(found.jump_of_bound > 1.0 && found.jump > 0.9 * GAIN || !is_long(), "{found:?}");
    }
    check::<f64, 2>(47);
    check::<f64, 3>(48);
    check::<f32, 2>(49);
    check::<Fixed, 2>(50);
    check::<Fixed, 3>(51);
}
