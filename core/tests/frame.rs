//! The frame does not matter: a world that is turned and moved as a whole has the same velocities, turned.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod world;

use pliant_core::scalar::Fixed;
use pliant_core::shape::{Polygon, Shape};
use pliant_core::{
    Component, Controller, LpvDs, Matrix, Motion, Obstacle, ObstacleSpec, RobotState, Scalar, Scan, Settings,
    SteeringPolicy, Vector,
};
use rand::Rng;
use world::scene::{MOVING, PLACES, controller, place, some};
use world::{Random, components, is_long, numbers, on_grid, random, share, turn, vector, wall, within};

/// Everything that makes a world, in numbers that both frames are made from.
struct Parts<const D: usize> {
    attractor: Vector<f64, D>,
    components: Vec<Component<f64, D>>,
    obstacles: Vec<ObstacleSpec<f64, D>>,
    scan: Vec<Vector<f64, D>>,
}

/// x -> q x + t, and after it every number changed by up to `jitter` (times one metre, one radian, ... whatever its unit).
struct Frame<'a, const D: usize> {
    q: Matrix<f64, D>,
    t: Vector<f64, D>,
    jitter: f64,
    random: &'a mut Random,
}

impl<const D: usize> Frame<'_, D> {
    fn number<S: Scalar>(&mut self, x: f64) -> S {
        let by = if self.jitter > 0.0 { self.random.random_range(-self.jitter..self.jitter) } else { 0.0 };
        S::from_f64(x + by * x.abs().max(1.0))
    }
    fn vector<S: Scalar>(&mut self, v: &Vector<f64, D>) -> Vector<S, D> {
        Vector::from_fn(|i, _| self.number(v[i]))
    }
    fn matrix<S: Scalar>(&mut self, m: &Matrix<f64, D>) -> Matrix<S, D> {
        Matrix::from_fn(|i, j| self.number(m[(i, j)]))
    }
    fn point<S: Scalar>(&mut self, x: &Vector<f64, D>) -> Vector<S, D> {
        let x = self.q * x + self.t;
        self.vector(&x)
    }

    fn shape<S: Scalar>(&mut self, shape: &Shape<f64, D>) -> Shape<S, D> {
        match shape {
            Shape::Ellipsoid { axes, curvature } => Shape::Ellipsoid { axes: self.vector(axes), curvature: *curvature },
            Shape::Box { half, rounding } => Shape::Box { half: self.vector(half), rounding: self.number(*rounding) },
            Shape::Cylinder { radius, half_length, rounding } => Shape::Cylinder {
                radius: self.number(*radius),
                half_length: self.number(*half_length),
                rounding: self.number(*rounding),
            },
            Shape::Capsule { radius, half_length } => {
                Shape::Capsule { radius: self.number(*radius), half_length: self.number(*half_length) }
            }
            Shape::Polygon(polygon) => {
                let corners: Vec<[S; 2]> = polygon.vertices().iter().map(|v| v.map(|x| self.number(x))).collect();
                Shape::Polygon(Polygon::new(&corners).unwrap())
            }
        }
    }

    /// None where what was changed is no obstacle any more.
    fn obstacle<S: Scalar>(&mut self, o: &ObstacleSpec<f64, D>) -> Option<Obstacle<S, D>> {
        let (q, spin) = (self.q, self.q * o.spin * self.q.transpose());
        // Factors are not measured: they stay as they are.
        Obstacle::new(ObstacleSpec {
            center: self.point(&o.center),
            rotation: self.matrix(&(q * o.rotation)),
            shape: self.shape(&o.shape),
            wall: o.wall,
            soft_ratio: o.soft_ratio.map(S::from_f64),
            margin: o.margin.map(S::from_f64),
            reference: o.reference.map(S::from_f64),
            velocity: self.vector(&(q * o.velocity)),
            // Skew to the bit.
            spin: Matrix::from_fn(|i, j| S::from_f64((spin[(i, j)] - spin[(j, i)]) * 0.5)),
            growth: self.number(o.growth),
        })
        .ok()
    }

    fn motion<S: Scalar>(&mut self, parts: &Parts<D>) -> Motion<S, D> {
        let attractor = self.point(&parts.attractor);
        if parts.components.is_empty() {
            return Motion::linear(attractor, S::one()).unwrap();
        }
        let q = self.q;
        let turned: Vec<Component<S, D>> = parts
            .components
            .iter()
            .map(|c| Component {
                log_weight: S::from_f64(c.log_weight),
                mean: self.point(&c.mean),
                whitening: self.matrix(&(c.whitening * q.transpose())),
                a: self.matrix(&(q * c.a * q.transpose())),
            })
            .collect();
        Motion::Lpv(LpvDs::new(attractor, Matrix::identity(), &turned).unwrap().certify().unwrap())
    }

    /// None where an obstacle is none any more.
    fn controller<S: Scalar>(&mut self, parts: &Parts<D>) -> Option<Controller<S, D, 16>> {
        let steering = SteeringPolicy::WithFlow { beta: S::one() };
        let settings = Settings { steering, gain: S::from_f64(0.1), ..Settings::default() };
        let obstacles: Option<Vec<_>> = parts.obstacles.iter().map(|o| self.obstacle(o)).collect();
        let mut controller = controller(self.motion(parts), settings, obstacles?);
        let points: Vec<_> = parts.scan.iter().map(|p| self.point(p)).collect();
        controller.set_scan(Scan::new(&points, S::from_f64(0.02)).unwrap(), S::zero());
        Some(controller)
    }
}

fn parts<const D: usize>(r: &mut Random) -> Parts<D> {
    let mut obstacles: Vec<_> = some::<f64, D>(r, &MOVING).iter().map(|o| o.spec().clone()).collect();
    if r.random_bool(0.2) {
        obstacles.push(wall::<f64, D>(r, true).spec().clone());
    }
    let scan = if r.random_bool(0.2) { (0..10).map(|_| vector(&within(r, 0.6))).collect() } else { Vec::new() };
    let components = if r.random_bool(0.5) { components(r) } else { Vec::new() };
    Parts { attractor: vector(&on_grid(within(r, 0.4))), components, obstacles, scan }
}

/// How far x is from the line across g through the reference point, m.
fn across<const D: usize>(o: &Obstacle<f64, D>, x: &Vector<f64, D>) -> f64 {
    let g = o.gradient(x);
    (g.dot(&(x - o.reference())) / g.norm()).abs()
}

/// How many neighbouring worlds the conditioning is taken from.
const NEIGHBOURS: usize = 3;
/// What is done to a number on its way is no worse than this many units of rounding of what it is made from.
const UNITS: f64 = 64.0;

/// Both frames are made from the same numbers, rounded once to `S`, so what the two differ by is rounding, magnified by how fast the velocity
/// changes from world to world. That is measured, in f64: by how much it changes where every number of the world is changed at random by one
/// unit of rounding of `S`. `UNITS` of those are allowed (a position goes through some ten operations before it is a velocity, and three random
/// neighbours see at least a part of the steepest direction), and as many of the velocity itself.
fn frame<S: Scalar, const D: usize>(seed: u64) {
    let r = &mut random(seed);
    let (mut compared, mut pushed, mut flipped, mut worst) = (0u64, 0u64, 0u64, 0.0f64);
    let (mut worlds, mut elsewhere, mut refused) = (0u64, 0u64, 0u64);
    let eps = S::EPSILON.to_f64();
    while compared < share(2) {
        let q = turn::<f64, D>(r);
        let t: Vector<f64, D> = vector(&within(r, 0.8));
        let mut parts = parts::<D>(r);
        let (one, none) = (Matrix::identity(), Vector::zeros());
        // What is too small for the number type is no obstacle in it.
        parts.obstacles.retain(|o| Frame { q: one, t: none, jitter: 0.0, random: r }.obstacle::<S>(o).is_some());
        let here: Controller<S, D, 16> = Frame { q: one, t: none, jitter: 0.0, random: r }.controller(&parts).unwrap();
        let there: Controller<S, D, 16> = Frame { q, t, jitter: 0.0, random: r }.controller(&parts).unwrap();
        let exact: Controller<f64, D, 16> =
            Frame { q: one, t: none, jitter: 0.0, random: r }.controller(&parts).unwrap();
        let near: Option<Vec<Controller<f64, D, 16>>> =
            (0..NEIGHBOURS).map(|_| Frame { q: one, t: none, jitter: eps, random: r }.controller(&parts)).collect();
        // A polygon with corners so close that a change of so little makes it none has no neighbours to compare with.
        worlds += 1;
        let Some(near) = near else {
            refused += 1;
            continue;
        };
        let obstacles: Vec<_> = exact.table().iter().map(|e| e.obstacle().clone()).collect();
        // Whatever the common point of a cluster is that its search ends at, it will do; but which it is depends on comparisons on the way, and so it
        // magnifies rounding more than any bound that three neighbours show. Where it did, the flows are two, each as good: nothing to compare.
        let apart = farthest(&here, &there, |x| q * x + t);
        // The conditioning is that of the world in f64, so the references must be its own.
        let apart = apart.max(farthest(&here, &exact, |x| *x));
        let near_apart = near.iter().map(|c| farthest(&exact, c, |x| *x)).fold(0.0, f64::max);
        if apart.max(near_apart) > UNITS * eps {
            elsewhere += 1;
            continue;
        }
        // How far the references moved is known. Where that is much more than in the neighbours, the flow changes by as much more, and in their few
        // random directions the neighbours see at least an eighth of the steepest.
        let units = UNITS.max(8.0 * apart / near_apart.max(0.25 * eps));
        for _ in 0..PLACES {
            let x = numbers(&place(r, &obstacles).map(S::from_f64));
            let at = |x: Vector<f64, D>| RobotState::new(x.map(S::from_f64)).unwrap();
            let (a, b) = (here.evaluate(&at(x)), there.evaluate(&at(q * x + t)));
            let truth = exact.evaluate(&RobotState::new(x).unwrap());
            // At a surface the velocity jumps into the core: rounding must not decide on which side x is.
            let sides = |c: &Controller<S, D, 16>, x: Vector<f64, D>| {
                let x = x.map(S::from_f64);
                c.table().iter().map(|e| e.obstacle().gamma(&x) <= S::one()).collect::<Vec<_>>()
            };
            let true_sides: Vec<bool> = obstacles.iter().map(|o| o.gamma(&x) <= 1.0).collect();
            if sides(&here, x) != true_sides || sides(&there, q * x + t) != true_sides {
                flipped += 1;
                continue;
            }
            // In a core r may lie across g: the flow has a pole there, and where the reference may have moved across it rounding says on which side x is.
            let moved = apart + UNITS * eps;
            if obstacles.iter().zip(&true_sides).any(|(o, inside)| *inside && across(o, &x) <= 8.0 * moved) {
                flipped += 1;
                continue;
            }
            let sensitivity =
                near.iter().map(|c| (c.evaluate(&RobotState::new(x).unwrap()).adapted - truth.adapted).norm());
            let sensitivity = sensitivity.fold(0.0, f64::max);
            let error = (q * numbers(&a.adapted) - numbers(&b.adapted)).norm();
            // Where numbers have a fixed point what is small has few digits: Gamma below one, and on the way to a normal the radius of an edge, which
            // is 0.15 of a side that is 0.3 of the longest.
            let digits = eps + S::rounding(S::zero()).to_f64() / (0.045 * truth.gamma.min(1.0));
            let bound = units * sensitivity + UNITS * digits * (1.0 + truth.adapted.norm());
            worst = worst.max(error / bound);
            assert!(
                error <= bound,
                "{error:e} over {bound:e}, references {apart:e} and {near_apart:e} apart: {a:?} {b:?} {truth:?} at {x} of {here:?}"
            );
            compared += 1;
            pushed += u64::from(a.adapted != a.modulated);
        }
    }
    println!(
        "{D}-D: {compared}, {pushed} with a push, {flipped} flipped, {elsewhere} and {refused} of {worlds} worlds, worst {worst}"
    );
    assert!(
        !is_long()
            || 40 * pushed > compared && 50 * flipped < compared && 2 * elsewhere < worlds && 20 * refused < worlds
    );
}

/// The farthest that reference points of the same obstacle lie apart, of one world taken to the other.
fn farthest<S: Scalar, T: Scalar, const D: usize>(
    one: &Controller<S, D, 16>,
    other: &Controller<T, D, 16>,
    to: impl Fn(&Vector<f64, D>) -> Vector<f64, D>,
) -> f64 {
    let pairs = one.table().iter().zip(other.table().iter());
    pairs
        .map(|(a, b)| (to(&numbers(&a.obstacle().reference())) - numbers(&b.obstacle().reference())).norm())
        .fold(0.0, f64::max)
}

macro_rules! campaigns {
    ($($name:ident: $scalar:ty, $d:literal, $seed:literal;)+) => {
        $(#[test] fn $name() { frame::<$scalar, $d>($seed); })+
    };
}
campaigns! {
    frame_2d_f64: f64, 2, 31;
    frame_3d_f64: f64, 3, 32;
    frame_2d_f32: f32, 2, 33;
    frame_3d_f32: f32, 3, 34;
    frame_2d_fixed: Fixed, 2, 35;
    frame_3d_fixed: Fixed, 3, 36;
}
