//! Controllers full of obstacles.

use crate::number::ONE;
use crate::{Number, Random};
use pliant_core::ds::{Component, LpvDs, MAX_COMPONENTS};
use pliant_core::scan::MAX_POINTS;
use pliant_core::shape::{MAX_VERTICES, Polygon};
use pliant_core::{
    Ageing, Controller, Guard, Limits, Matrix, Motion, Obstacle, ObstacleSpec, Scan, Settings, Shape, SteeringPolicy,
    Vector,
};

/// What obstacles are like, and how they lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Ellipsoids in soft layers, spread over the workspace, half of them moving, all seen just now: the common case.
    Ellipsoids,
    /// Every shape and motion, walls, overlaps, some old.
    Mixed,
    /// Every shape and motion, and all surfaces pass through one point, or nearly.
    Crowd,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Self; 3] = [Self::Ellipsoids, Self::Mixed, Self::Crowd];

    /// What reports call it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ellipsoids => "ellipsoids",
            Self::Mixed => "mixed",
            Self::Crowd => "crowd",
        }
    }
}

/// What to make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// Another one, another scene.
    pub seed: u32,
    /// Obstacles, at most the controller's room.
    pub obstacles: u16,
    /// Components of the skill, 1 to 16.
    pub components: usize,
    /// Points of a scan, at most 128.
    pub points: usize,
    /// What obstacles are like.
    pub kind: Kind,
}

/// Half of the workspace, in thousandths of a metre.
const WORKSPACE: i32 = 1000;

/// A controller with a skill, obstacles and perhaps a scan, guarded.
///
/// ```
/// use pliant_bench::{Kind, Plan, Random, scene};
/// let plan = Plan { seed: 1, obstacles: 8, components: 4, points: 0, kind: Kind::Mixed };
/// let controller = scene::controller::<f32, 2, 8>(&plan, &mut Random::new(plan.seed));
/// assert_eq!(controller.table().len(), 8);
/// ```
pub fn controller<S: Number, const D: usize, const CAP: usize>(
    plan: &Plan,
    random: &mut Random,
) -> Controller<S, D, CAP> {
    let mut controller = Controller::new(motion(plan.components, random), settings(plan.kind, random));
    if plan.kind == Kind::Mixed && plan.obstacles > 4 && random.one_in(2) {
        // It is one of the obstacles, and the others lie inside of it.
        let _ = controller.upsert(0, wall(random), S::zero());
    }
    for id in controller.table().len() as u16..plan.obstacles {
        let obstacle = obstacle(plan.kind, random);
        let age = age(plan.kind, random);
        let _ = controller.upsert(id, obstacle, age);
    }
    controller.set_scan(scan(plan.points, random), S::zero());
    controller
}

#[allow(clippy::expect_used, reason = "a skill that is refused is a mistake in here")]
/// A skill that is stable because each A is minus something positive definite and a skew part, and P is one.
pub fn motion<S: Number, const D: usize>(components: usize, random: &mut Random) -> Motion<S, D> {
    let mut parts: heapless::Vec<Component<S, D>, MAX_COMPONENTS> = heapless::Vec::new();
    for _ in 0..components.clamp(1, MAX_COMPONENTS) {
        let mut whitening = Matrix::zeros();
        for i in 0..D {
            for j in 0..i {
                whitening[(i, j)] = random.between(-1000, 1000);
            }
            whitening[(i, i)] = random.between(2000, 8000);
        }
        let rates: Vector<S, D> = random.vector(500, 2000);
        let part = Component {
            log_weight: random.between(-1000, 1000),
            mean: random.vector(-WORKSPACE, WORKSPACE),
            whitening,
            a: random.skew(1500) - Matrix::from_diagonal(&rates),
        };
        let _ = parts.push(part);
    }
    let attractor: Vector<S, D> = random.vector(-300, 300);
    let model = LpvDs::new(attractor, Matrix::identity(), &parts).expect("all numbers are within range");
    Motion::Lpv(model.certify().expect("stable by construction"))
}

/// Settings: the usual ones, or others within their ranges; always guarded.
fn settings<S: Number>(kind: Kind, random: &mut Random) -> Settings<S> {
    let minute = S::units(60 * ONE);
    let common = Settings {
        guard: Some(Guard::default()),
        ageing: Ageing { time_to_live: minute, hold: minute, ..Ageing::default() },
        ..Settings::default()
    };
    if kind == Kind::Ellipsoids {
        return common;
    }
    let steering = if random.one_in(2) {
        SteeringPolicy::WithFlow { beta: random.between(200, 2000) }
    } else {
        SteeringPolicy::fixed(random.between(-3000, 3000))
    };
    let acceleration = if random.one_in(2) { Some(random.between(500, 20_000)) } else { None };
    Settings {
        gain: random.between(10, 100),
        steering,
        limits: Limits { speed: random.between(200, 2000), acceleration, ..Limits::default() },
        ageing: Ageing::default(),
        guard: Some(Guard { approach: random.between(200, 1000) }),
        ..common
    }
}

/// An obstacle somewhere in the workspace.
pub fn obstacle<S: Number, const D: usize>(kind: Kind, random: &mut Random) -> Obstacle<S, D> {
    let mut spec = ObstacleSpec { rotation: random.rotation(), ..ObstacleSpec::default() };
    if kind == Kind::Ellipsoids {
        spec.center = random.vector(-WORKSPACE, WORKSPACE);
        spec.shape = Shape::ellipsoid(random.vector(30, 90));
        spec.soft_ratio = Vector::from_element(random.between(1200, 1700));
        if random.one_in(2) {
            spec.velocity = random.vector(-200, 200);
        }
        return checked(spec);
    }
    spec.shape = shape(random);
    // Of a polygon all axes are enlarged alike.
    let alike = matches!(spec.shape, Shape::Polygon(_));
    let mut ratios = |low: i32, high: i32| {
        let each = random.vector(low, high);
        if alike || random.one_in(2) { Vector::from_element(each[0]) } else { each }
    };
    let (soft_ratio, margin) = (ratios(1000, 2200), ratios(1000, 1300));
    if !random.one_in(3) {
        spec.soft_ratio = soft_ratio;
    }
    if random.one_in(4) {
        spec.margin = margin;
    }
    if random.one_in(3) {
        let least = spec.shape.extent().iter().fold(S::MAX, |m, x| m.min(*x));
        spec.reference = random.vector::<S, D>(-300, 300) * least;
    }
    if random.one_in(2) {
        spec.velocity = random.vector(-500, 500);
    }
    if random.one_in(3) {
        spec.spin = random.skew(3000);
    }
    if random.one_in(4) {
        spec.growth = random.between(-50, 50);
    }
    spec.center = if kind == Kind::Crowd {
        // From the point where all meet, back along this obstacle's own way to its surface; some by a little more or less.
        let slip = random.vector::<S, D>(-2, 2) * S::units(random.below(ONE as u32) as i32);
        meeting::<S, D>() + slip - checked(spec.clone()).surface(&random.direction())
    } else if random.one_in(3) {
        // Close together: overlapping cores and soft layers.
        random.vector(-250, 250)
    } else {
        random.vector(-WORKSPACE, WORKSPACE)
    };
    checked(spec)
}

/// A full table that is hard to change: a [`visitor`] as obstacle 0, and all others ellipsoids in groups of eight that overlap.
pub fn groups<S: Number, const D: usize, const CAP: usize>(random: &mut Random) -> Controller<S, D, CAP> {
    let mut controller = Controller::new(motion(1, random), Settings::default());
    let _ = controller.upsert(0, visitor(false), S::zero());
    for id in 1..CAP as u16 {
        // A grid of places half a metre apart.
        let group = i32::from((id - 1) / 8);
        let place = [group % 3 - 1, group / 3 - 1, 0];
        let center = Vector::from_fn(|i, _| S::units(place.get(i).copied().unwrap_or_default() * ONE / 2));
        let spec = ObstacleSpec {
            center: center + random.vector::<S, D>(-20, 20),
            rotation: random.rotation(),
            shape: Shape::ellipsoid(random.vector(60, 90)),
            ..ObstacleSpec::default()
        };
        let _ = controller.upsert(id, checked(spec), S::zero());
    }
    controller
}

/// An obstacle that overlaps all [`groups`], or none of them.
pub fn visitor<S: Number, const D: usize>(there: bool) -> Obstacle<S, D> {
    let center = if there { Vector::zeros() } else { Vector::from_element(S::units(20 * ONE)) };
    checked(ObstacleSpec { center, shape: Shape::ellipsoid(Vector::from_element(S::one())), ..ObstacleSpec::default() })
}

/// Where all surfaces of a [`Kind::Crowd`] meet, m.
pub fn meeting<S: Number, const D: usize>() -> Vector<S, D> {
    Vector::from_fn(|i, _| S::units(ONE / 4 - ONE / 8 * i as i32))
}

/// How old an obstacle is when it is told of, s.
pub fn age<S: Number>(kind: Kind, random: &mut Random) -> S {
    if kind == Kind::Ellipsoids || random.one_in(2) { S::zero() } else { random.between(0, 1200) }
}

/// Range points in clumps.
pub fn scan<S: Number, const D: usize>(points: usize, random: &mut Random) -> Scan<S, D> {
    let mut all: heapless::Vec<Vector<S, D>, MAX_POINTS> = heapless::Vec::new();
    let mut around = Vector::zeros();
    for i in 0..points.min(MAX_POINTS) {
        if i % 16 == 0 {
            around = random.vector(-WORKSPACE, WORKSPACE);
        }
        let _ = all.push(around + random.vector::<S, D>(-100, 100));
    }
    Scan::new(&all, random.between(10, 60)).unwrap_or_default()
}

fn wall<S: Number, const D: usize>(random: &mut Random) -> Obstacle<S, D> {
    let half: Vector<S, D> = random.vector(1000, 1400);
    let shape = if random.one_in(2) {
        Shape::Box { half, rounding: random.between(20, 400) }
    } else if D == 2 && random.one_in(2) {
        polygon(900, 1400, random)
    } else {
        Shape::Ellipsoid { axes: half, curvature: 1 + random.below(3) as u8 }
    };
    checked(ObstacleSpec {
        shape,
        wall: true,
        rotation: random.rotation(),
        soft_ratio: Vector::from_element(random.between(1000, 1200)),
        spin: random.skew(100),
        ..ObstacleSpec::default()
    })
}

fn shape<S: Number, const D: usize>(random: &mut Random) -> Shape<S, D> {
    let axes: Vector<S, D> = random.vector(30, 150);
    match random.below(6) {
        0 => Shape::ellipsoid(Vector::from_element(random.between(20, 100))),
        1 => Shape::ellipsoid(axes),
        2 => Shape::Ellipsoid { axes, curvature: 2 + random.below(2) as u8 },
        3 => rounded_box(axes, random),
        4 if D == 3 => {
            let (radius, half_length) = (random.between(30, 100), random.between(30, 150));
            let share: S = random.between(100, 1000);
            Shape::Cylinder { radius, half_length, rounding: radius.min(half_length) * share }
        }
        _ if D == 3 => Shape::Capsule { radius: random.between(20, 80), half_length: random.between(0, 150) },
        4 => polygon(40, 150, random),
        _ => polygon(100, 120, random),
    }
}

fn rounded_box<S: Number, const D: usize>(half: Vector<S, D>, random: &mut Random) -> Shape<S, D> {
    let least = half.iter().fold(S::MAX, |m, x| m.min(*x));
    let share: S = if random.one_in(4) { S::one() } else { random.between(100, 900) };
    Shape::Box { half, rounding: least * share }
}

/// A star of 3 to 12 corners, each between these distances (thousandths of a metre) from its origin.
fn polygon<S: Number, const D: usize>(near: i32, far: i32, random: &mut Random) -> Shape<S, D> {
    let corners = 3 + random.below(MAX_VERTICES as u32 - 2) as i32;
    // A turn of 2 pi in as many steps, each corner up to a tenth of a step off.
    let step = 6283 / corners;
    let mut vertices: heapless::Vec<[S; 2], MAX_VERTICES> = heapless::Vec::new();
    for i in 0..corners {
        let angle: S = random.between(i * step - step / 10, i * step + step / 10);
        let (sin, cos) = angle.sin_cos();
        let distance: S = random.between(near, far);
        let _ = vertices.push([cos * distance, sin * distance]);
    }
    Polygon::new(&vertices).map_or_else(|_| Shape::ellipsoid(Vector::from_element(S::units(far))), Shape::Polygon)
}

/// The obstacle; where its reference point does not fit, with its own; and where nothing does, a ball. All of it depends on the numbers alone.
#[allow(clippy::expect_used, reason = "a ball that is refused is a mistake in here")]
pub(crate) fn checked<S: Number, const D: usize>(spec: ObstacleSpec<S, D>) -> Obstacle<S, D> {
    let central = ObstacleSpec { reference: Vector::zeros(), ..spec.clone() };
    let ball = || Obstacle::new(ObstacleSpec::default()).expect("the default is an obstacle");
    Obstacle::new(spec).or_else(|_| Obstacle::new(central)).unwrap_or_else(|_| ball())
}

#[cfg(test)]
mod tests {
    use super::*;
    use pliant_core::scalar::Fixed;

    /// How many of a hundred obstacles are what was asked for, rather than the ball they are replaced by.
    fn made<S: Number, const D: usize>() -> (usize, usize) {
        let mut random = Random::new(5);
        let all: [Obstacle<S, D>; 400] = core::array::from_fn(|_| obstacle(Kind::Mixed, &mut random));
        let plain = ObstacleSpec::<S, D>::default().shape;
        let shapes = |f: fn(&Shape<S, D>) -> bool| all.iter().any(|o| f(&o.spec().shape));
        assert!(shapes(|s| matches!(s, Shape::Ellipsoid { curvature: 3, .. })));
        assert!(shapes(|s| matches!(s, Shape::Box { .. })));
        assert_eq!(shapes(|s| matches!(s, Shape::Cylinder { .. })), D == 3);
        assert_eq!(shapes(|s| matches!(s, Shape::Capsule { .. })), D == 3);
        assert_eq!(shapes(|s| matches!(s, Shape::Polygon(_))), D == 2);
        (all.iter().filter(|o| o.spec().shape != plain).count(), all.len())
    }

    #[test]
    fn every_shape_is_made_and_accepted() {
        for (made, of) in [made::<f32, 2>(), made::<f32, 3>(), made::<Fixed, 2>(), made::<Fixed, 3>()] {
            assert_eq!(made, of);
        }
    }

    #[test]
    fn skills_are_certified() {
        for seed in 0..50 {
            let mut random = Random::new(seed);
            assert!(matches!(motion::<f32, 2>(8, &mut random), Motion::Lpv(m) if m.components().len() == 8));
            assert!(matches!(motion::<Fixed, 3>(4, &mut random), Motion::Lpv(_)));
        }
    }

    #[test]
    fn a_visitor_makes_one_cluster_of_all_groups() {
        let mut controller = groups::<f32, 2, 64>(&mut Random::new(7));
        let references = |c: &Controller<f32, 2, 64>| {
            let mut all: heapless::Vec<Vector<f32, 2>, 64> = heapless::Vec::new();
            for entry in c.table().iter().filter(|e| e.id() > 0) {
                let reference = entry.obstacle().reference();
                if !all.iter().any(|other| (other - reference).norm() < 1e-4) {
                    all.push(reference).unwrap();
                }
            }
            all.len()
        };
        // One for each group of eight.
        assert_eq!(references(&controller), 8);
        controller.upsert(0, visitor(true), 0.0).unwrap();
        assert!(references(&controller) > 8);
        controller.upsert(0, visitor(false), 0.0).unwrap();
        assert_eq!(references(&controller), 8);
    }

    #[test]
    fn a_crowd_meets() {
        let plan = Plan { seed: 3, obstacles: 16, components: 2, points: 0, kind: Kind::Crowd };
        let crowd = controller::<f64, 2, 16>(&plan, &mut Random::new(3));
        let at = meeting::<f64, 2>();
        for entry in crowd.table().iter().filter(|e| e.age() == 0.0) {
            let o = entry.obstacle();
            let surface = o.surface(&(at - o.spec().center));
            assert!((surface - at).norm() < 0.005, "{:?}", o.spec());
        }
    }
}
