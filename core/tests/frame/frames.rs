//! The same world in two frames, made from the same numbers.

use crate::world::scene::{MOVING, controller, some};
use crate::world::{Random, components, numbers, on_grid, vector, wall, within};
use pliant_core::shape::{Polygon, Shape};
use pliant_core::{
    Component, Controller, LpvDs, Matrix, Motion, Obstacle, ObstacleSpec, Scalar, Scan, Settings, SteeringPolicy,
    Vector,
};
use rand::Rng;

/// Everything that makes a world, in numbers that both frames are made from.
pub struct Parts<const D: usize> {
    pub attractor: Vector<f64, D>,
    pub components: Vec<Component<f64, D>>,
    pub obstacles: Vec<ObstacleSpec<f64, D>>,
    pub scan: Vec<Vector<f64, D>>,
}

/// x -> q x + t, and after it every number changed by up to `jitter` (times one metre, one radian, ... whatever its unit).
pub struct Frame<'a, const D: usize> {
    pub q: Matrix<f64, D>,
    pub t: Vector<f64, D>,
    pub jitter: f64,
    pub random: &'a mut Random,
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
    pub fn obstacle<S: Scalar>(&mut self, o: &ObstacleSpec<f64, D>) -> Option<Obstacle<S, D>> {
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
    pub fn controller<S: Scalar>(&mut self, parts: &Parts<D>) -> Option<Controller<S, D, 16>> {
        let steering = SteeringPolicy::WithFlow { beta: S::one() };
        let settings = Settings { steering, gain: S::from_f64(0.1), ..Settings::default() };
        let obstacles: Option<Vec<_>> = parts.obstacles.iter().map(|o| self.obstacle(o)).collect();
        let mut controller = controller(self.motion(parts), settings, obstacles?);
        let points: Vec<_> = parts.scan.iter().map(|p| self.point(p)).collect();
        controller.set_scan(Scan::new(&points, S::from_f64(0.02)).unwrap(), S::zero());
        Some(controller)
    }
}

pub fn parts<const D: usize>(r: &mut Random) -> Parts<D> {
    let mut obstacles: Vec<_> = some::<f64, D>(r, &MOVING).iter().map(|o| o.spec().clone()).collect();
    if r.random_bool(0.2) {
        obstacles.push(wall::<f64, D>(r, true).spec().clone());
    }
    let scan = if r.random_bool(0.2) { (0..10).map(|_| vector(&within(r, 0.6))).collect() } else { Vec::new() };
    let components = if r.random_bool(0.5) { components(r) } else { Vec::new() };
    Parts { attractor: vector(&on_grid(within(r, 0.4))), components, obstacles, scan }
}

/// The farthest that reference points of the same obstacle lie apart, of one world taken to the other.
pub fn farthest<S: Scalar, T: Scalar, const D: usize>(
    one: &Controller<S, D, 16>,
    other: &Controller<T, D, 16>,
    to: impl Fn(&Vector<f64, D>) -> Vector<f64, D>,
) -> f64 {
    let pairs = one.table().iter().zip(other.table().iter());
    pairs
        .map(|(a, b)| (to(&numbers(&a.obstacle().reference())) - numbers(&b.obstacle().reference())).norm())
        .fold(0.0, f64::max)
}
