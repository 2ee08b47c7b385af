//! Was there really no velocity? Section 7 of docs/method.md once more, in f64 and from what is public: what every core of the next sample asks of
//! the velocity, as far as there is no choice in it.

use super::{gamma, numbers};
use pliant_core::{Controller, Obstacle, RobotState, Scalar, Shape, Vector};

/// n.u >= offset, m/s.
struct Side<const D: usize> {
    normal: Vector<f64, D>,
    offset: f64,
}

/// All that is asked of one velocity.
pub struct Asked<S: Scalar, const D: usize> {
    sides: Vec<Side<D>>,
    /// Those whose free space is convex.
    walls: Vec<Obstacle<S, D>>,
    x: Vector<f64, D>,
    speed: f64,
    dt: f64,
    /// From a wall, m.
    clearance: f64,
    /// Is the robot outside of every core there will be where it is?
    pub may_stand: bool,
    /// And farther from each than the guard keeps it?
    pub undisturbed: bool,
    /// Is a polygon, or one as a wall, so near that it may ask for something? Then there is more to fulfil than `sides`.
    pub more: bool,
}

/// What rounding may do to the guard's own distances and velocities.
struct Rounding {
    /// m
    distance: f64,
    /// Of a unit normal, and so of a velocity over the speed.
    normal: f64,
}

impl<S: Scalar, const D: usize> Asked<S, D> {
    /// By `controller` after its tick at `state`: then its obstacles are those of the next sample. Every demand is made a little stronger than the
    /// guard's, by what rounding may have done to that.
    pub fn new<const CAP: usize>(controller: &Controller<S, D, CAP>, state: &RobotState<S, D>, dt: f64) -> Self {
        let x = numbers(state.position());
        let settings = controller.settings();
        let speed = settings.limits.speed.to_f64();
        let eps = S::EPSILON.to_f64();
        let size = x.iter().fold(1.0, |m: f64, x| x.abs().max(m));
        let skin = (16.0 * eps * size).max(1.0 / 65536.0);
        let rounding = Rounding { distance: 4.0 * eps, normal: 64.0 * eps };
        let may_stand = gamma(controller, state.position()) >= S::one();
        let (sides, walls) = (Vec::new(), Vec::new());
        let mut asked =
            Self { sides, walls, x, speed, dt, clearance: 2.0 * skin, may_stand, undisturbed: true, more: false };
        let mut side = |normal: Vector<f64, D>, gap: f64| {
            let gap = gap - rounding.distance;
            // What a step cannot reach asks for nothing.
            if gap <= speed * dt {
                let offset = -(gap - 4.0 * eps * size) / dt + rounding.normal * speed;
                asked.sides.push(Side { normal, offset });
            }
            gap >= skin
        };
        let step = speed * dt;
        let (mut undisturbed, mut more) = (true, false);
        for entry in controller.table().iter() {
            let o = entry.obstacle();
            match &o.spec().shape {
                shape if o.spec().wall && !matches!(shape, Shape::Polygon(_)) => {
                    // The curve of the wall within a step takes at most 1.2 p (2p - 1) L^2 of 1 - gamma, with p = 3 and L = 2 mm/0.7 m 1.5e-4, and of a
                    // box whose corners have a radius of 0.2 m 2e-5 m: nothing where the gauge is below 0.98. Its rate of approach asks for more.
                    undisturbed &= o.gamma(state.position()).to_f64() > 1.0 / (0.98 * 0.98);
                    asked.walls.push(o.clone());
                }
                Shape::Polygon(polygon) => {
                    // One of its pieces' sides, that with most room for what is wanted. A point at a distance d from a piece is at least d sin(a/2) beyond
                    // one of its sides, where a is the sharpest of its corners, and the chosen one has as much but for two steps.
                    let corners = corners(o, polygon.vertices());
                    let d = distance(&corners, &x);
                    let share = (0.5 * sharpest(&corners, &numbers(&o.spec().center))).sin();
                    let inside = o.gamma(state.position()) <= S::one();
                    let size = corners.iter().map(|c| (c - numbers(&o.spec().center)).norm()).fold(0.0, f64::max);
                    let unit = if S::FLOATS { 2.0 } else { size.max(2.0) };
                    let skin = skin + (8.0 * eps * size * unit - 1.0 / 65536.0).max(0.0);
                    undisturbed &= !inside && share * d > 2.0 * step + skin + rounding.distance;
                    more |= inside || share * d - 2.0 * step - skin < step;
                }
                _ => match supporting(o, state.position()) {
                    Some((normal, gap)) => {
                        // The coordinates of what is larger than a metre are as coarse, and it is kept off by as much more.
                        let size = numbers(&o.spec().shape.extent()).amax();
                        let coarse = if size > 1.0 { 24.0 * eps * size } else { 0.0 };
                        undisturbed &= side(normal, gap - coarse);
                    }
                    // How far it is cannot be told; if it is no nearer than all of it, a step does not reach it.
                    None => {
                        let outer = numbers(&o.spec().shape.extent().component_mul(&o.spec().margin)).norm() * 2.0;
                        more |= (x - numbers(&o.spec().center)).norm() < outer + 2.0 * step;
                    }
                },
            }
        }
        for p in controller.table().scan().points() {
            let away = x - numbers(p);
            if away.norm() > 1e-6 {
                undisturbed &= side(away.normalize(), away.norm() - controller.table().scan().radius().to_f64());
            } else {
                (undisturbed, more) = (false, true);
            }
        }
        (asked.undisturbed, asked.more) = (undisturbed, more);
        asked
    }

    /// A velocity within the limit that does all that is asked, if the search finds one: each time the demand that is violated most is fulfilled,
    /// and the velocity cut to the limit, which comes closer to every velocity that is allowed (Agmon, Motzkin & Schoenberg).
    ///
    /// What is found is a proof that `INFEASIBLE` was wrong, for it is checked here. That nothing is found proves nothing by itself: where what is
    /// allowed is thinner than what 300 steps come near to, it is missed.
    pub fn search(&self) -> Option<Vector<f64, D>> {
        let mut u = Vector::<f64, D>::zeros();
        for _ in 0..300 {
            let sides = self.sides.iter().map(|s| (s.offset - s.normal.dot(&u), s.normal));
            let walls: Vec<_> = self.walls.iter().map(|wall| self.beyond(wall, &u)).collect::<Option<_>>()?;
            let (violation, normal) = sides.chain(walls).max_by(|a, b| a.0.total_cmp(&b.0))?;
            if violation <= 0.0 {
                return Some(u);
            }
            u += normal * (violation * 1.5);
            let length = u.norm();
            let most = self.speed * (1.0 - 1e-6);
            if length > most {
                u *= most / length;
            }
        }
        None
    }

    /// How far beyond a convex free space, less a clearance, a velocity leads, m/s, and the normal inwards there: the gauge of the free space is convex, so
    /// the tangent plane of its level has all of it on its other side.
    fn beyond(&self, wall: &Obstacle<S, D>, u: &Vector<f64, D>) -> Option<(f64, Vector<f64, D>)> {
        let p = power(wall);
        let at = (self.x + u * self.dt).map(S::from_f64);
        let gamma = wall.gamma(&at).to_f64();
        let gradient = numbers(&wall.gradient(&at));
        let lambda = gamma.powf(-0.5 / p);
        let slope = gradient.norm() * lambda / (2.0 * p * gamma);
        if slope > 0.0 && slope.is_finite() {
            return Some(((lambda - 1.0) / slope / self.dt + self.clearance / self.dt, gradient.normalize()));
        }
        // At its centre nothing is asked; far outside it cannot be told.
        (gamma > 1.0).then(|| (-f64::MAX, Vector::zeros()))
    }
}

/// A velocity within the limit whose next sample is outside of every core there will be, by more than rounding, if one is among 432 (in space 600): whatever
/// half-spaces say, `INFEASIBLE` was wrong then.
pub fn clear_velocity<S: Scalar, const D: usize, const CAP: usize>(
    controller: &Controller<S, D, CAP>,
    state: &RobotState<S, D>,
    dt: f64,
) -> Option<Vector<f64, D>> {
    let x = numbers(state.position());
    let speed = controller.settings().limits.speed.to_f64() * (1.0 - 1e-6);
    // What is large has coarse coordinates.
    let near = |o: &&Obstacle<S, D>| o.gamma(state.position()) < S::from_f64(4.0);
    let extent = |o: &Obstacle<S, D>| numbers(&o.spec().shape.extent()).amax();
    let largest = controller.table().iter().map(|e| e.obstacle()).filter(near).map(extent).fold(1.0, f64::max);
    let rounding = 16.0 * S::EPSILON.to_f64() * x.amax().max(largest);
    let outside = |y: Vector<f64, D>| gamma(controller, &y.map(S::from_f64)) >= S::one();
    let around = |y: &Vector<f64, D>| {
        (0..D).all(|i| {
            [rounding, -rounding].iter().all(|off| outside(y + Vector::from_fn(|j, _| if i == j { *off } else { 0.0 })))
        })
    };
    let (shells, ways) = if D == 2 { (12, 36) } else { (6, 100) };
    let velocities =
        (1..=shells).rev().flat_map(|shell| (0..ways).map(move |way| (f64::from(shell) / f64::from(shells), way)));
    let mut velocities = velocities.map(|(share, way)| direction::<D>(way, ways) * (speed * share));
    velocities.find(|u| {
        let y = x + u * dt;
        outside(y) && around(&y)
    })
}

/// One of so many unit vectors evenly about: on a circle, or on a spiral from pole to pole.
fn direction<const D: usize>(way: u32, ways: u32) -> Vector<f64, D> {
    let share = (f64::from(way) + 0.5) / f64::from(ways);
    if D == 2 {
        let (sin, cos) = (std::f64::consts::TAU * share).sin_cos();
        return Vector::from_fn(|i, _| [cos, sin][i]);
    }
    let height = 1.0 - 2.0 * share;
    let (sin, cos) = (2.399_963 * f64::from(way)).sin_cos();
    let across = (1.0 - height * height).sqrt();
    Vector::from_fn(|i, _| [across * cos, across * sin, height][i])
}

/// p: Gamma is the gauge to the power of 2p.
fn power<S: Scalar, const D: usize>(o: &Obstacle<S, D>) -> f64 {
    if let Shape::Ellipsoid { curvature, .. } = o.spec().shape { f64::from(curvature) } else { 1.0 }
}

/// The supporting half-space of a convex core and how far x is from it, m: with the gauge lambda = Gamma^(1/2p) the normal is along its gradient, and
/// the distance (lambda - 1)/|grad lambda|. Nothing where Gamma is all that can be told; no one side at the very centre.
fn supporting<S: Scalar, const D: usize>(o: &Obstacle<S, D>, x: &Vector<S, D>) -> Option<(Vector<f64, D>, f64)> {
    let p = power(o);
    let gamma = o.gamma(x).to_f64();
    let lambda = gamma.powf(0.5 / p);
    // What is farther is all the same in fixed point.
    if gamma >= S::FAR.to_f64() {
        return None;
    }
    let gradient = numbers(&o.gradient(x));
    let slope = gradient.norm() * lambda / (2.0 * p * gamma);
    // At the centre any side is as good: none that a velocity could fulfil.
    let none = || (Vector::<f64, D>::zeros(), -1.0);
    Some(if slope > 0.0 && slope.is_finite() { (gradient.normalize(), (lambda - 1.0) / slope) } else { none() })
}

/// A polygon's corners in the world, m.
pub fn corners<S: Scalar, const D: usize>(o: &Obstacle<S, D>, vertices: &[[S; 2]]) -> Vec<Vector<f64, D>> {
    let corner = |v: &[S; 2]| {
        let way = o.spec().rotation * Vector::<S, D>::from_fn(|i, _| v[i.min(1)]);
        numbers(&o.surface(&way))
    };
    vertices.iter().map(corner).collect()
}

fn edges<const D: usize>(corners: &[Vector<f64, D>]) -> impl Iterator<Item = (&Vector<f64, D>, &Vector<f64, D>)> {
    corners.iter().zip(corners.iter().skip(1).chain(corners.first()))
}

/// From the nearest of its edges, m.
fn distance<const D: usize>(corners: &[Vector<f64, D>], x: &Vector<f64, D>) -> f64 {
    let from = |(a, b): (&Vector<f64, D>, &Vector<f64, D>)| {
        let along = b - a;
        let t = ((x - a).dot(&along) / along.dot(&along)).clamp(0.0, 1.0);
        (x - (a + along * t)).norm()
    };
    edges(corners).map(from).fold(f64::MAX, f64::min)
}

/// The sharpest angle of a triangle of the centre and an edge, or of what is beyond the edge in its sector, rad: no convex piece has a sharper one.
fn sharpest<const D: usize>(corners: &[Vector<f64, D>], center: &Vector<f64, D>) -> f64 {
    let angle = |a: Vector<f64, D>, b: Vector<f64, D>| (a.dot(&b) / (a.norm() * b.norm())).clamp(-1.0, 1.0).acos();
    let least = |(a, b): (&Vector<f64, D>, &Vector<f64, D>)| {
        let inner = [angle(center - a, b - a), angle(center - b, a - b), angle(a - center, b - center)];
        inner.into_iter().flat_map(|a| [a, std::f64::consts::PI - a]).fold(f64::MAX, f64::min)
    };
    edges(corners).map(least).fold(f64::MAX, f64::min)
}
