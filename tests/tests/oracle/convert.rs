//! Scenes of the oracle in the words of the core.

use pliant_core::shape::Polygon;
use pliant_core::{
    Ageing, Component, Controller, Guard, Limits, LpvDs, Matrix, Motion, Obstacle, ObstacleSpec, Scan, Settings, Shape,
    SteeringPolicy, Vector, rotation,
};
use pliant_tests::oracle::random_scene::RandomAgeing;
use pliant_tests::oracle::{
    OracleMethod, OracleMotion, OracleObstacle, OracleRotation, OracleScene, OracleShape, OracleSpin, OracleSteering,
    lean, refer,
};

pub fn vector<const D: usize>(v: &[f64]) -> Vector<f64, D> {
    Vector::from_fn(|i, _| v[i])
}

fn matrix<const D: usize>(rows: &[Vec<f64>]) -> Matrix<f64, D> {
    Matrix::from_fn(|i, j| rows[i][j])
}

/// Cut a 3-D matrix to the dimension asked for.
fn cut<const D: usize>(m: nalgebra::Matrix3<f64>) -> Matrix<f64, D> {
    Matrix::from_fn(|i, j| m[(i, j)])
}

fn motion<const D: usize>(motion: &OracleMotion) -> Motion<f64, D> {
    match motion {
        OracleMotion::Linear { attractor, gain } => Motion::linear(vector(attractor), *gain).unwrap(),
        OracleMotion::Lpv { attractor, lyapunov, components } => {
            let components: Vec<_> = components
                .iter()
                .map(|c| {
                    let covariance: Matrix<f64, D> = matrix(&c.covariance);
                    let dynamic = nalgebra::DMatrix::from_fn(D, D, |i, j| covariance[(i, j)]);
                    let l = dynamic.cholesky().unwrap().l();
                    let inverse = l.clone().try_inverse().unwrap();
                    Component {
                        log_weight: c.prior.ln() - l.diagonal().iter().map(|x| x.ln()).sum::<f64>(),
                        mean: vector(&c.mean),
                        whitening: Matrix::from_fn(|i, j| inverse[(i, j)]),
                        a: matrix(&c.a),
                    }
                })
                .collect();
            Motion::Lpv(LpvDs::new(vector(attractor), matrix(lyapunov), &components).unwrap().certify().unwrap())
        }
    }
}

fn shape<const D: usize>(shape: &OracleShape) -> Shape<f64, D> {
    match shape {
        OracleShape::Ellipsoid { axes, curvature } => Shape::Ellipsoid { axes: vector(axes), curvature: *curvature },
        OracleShape::Box { half, rounding } => Shape::Box { half: vector(half), rounding: *rounding },
        OracleShape::Cylinder { radius, half_length, rounding } => {
            Shape::Cylinder { radius: *radius, half_length: *half_length, rounding: *rounding }
        }
        OracleShape::Capsule { radius, half_length } => Shape::Capsule { radius: *radius, half_length: *half_length },
        OracleShape::Polygon { vertices } => Shape::Polygon(Polygon::new(vertices).unwrap()),
    }
}

/// The obstacle as it was seen `age` ago, s.
fn obstacle<const D: usize>(o: &OracleObstacle, age: f64) -> Obstacle<f64, D> {
    let turn = match o.rotation {
        OracleRotation::Angle(a) => [(a / 2.0).cos(), 0.0, 0.0, (a / 2.0).sin()],
        OracleRotation::Quaternion(q) => q,
    };
    let spin = match o.spin {
        OracleSpin::Planar(rate) => [0.0, 0.0, rate],
        OracleSpin::Spatial(rate) => rate,
    };
    let velocity: Vector<f64, D> = vector(&o.velocity);
    Obstacle::new(ObstacleSpec {
        center: vector::<D>(&o.center) - velocity * age,
        rotation: cut(rotation::spatial(turn).unwrap()),
        shape: shape(&o.shape),
        wall: o.wall,
        soft_ratio: vector(&o.soft_ratio),
        margin: vector(&o.margin),
        reference: vector(&o.reference),
        velocity,
        spin: cut(rotation::spatial_spin(&spin.into())),
        growth: o.growth,
    })
    .unwrap()
}

pub fn controller<const D: usize>(scene: &OracleScene, ageing: &RandomAgeing) -> Controller<f64, D, 16> {
    let settings = Settings {
        deformable: scene.method == OracleMethod::Deformable,
        gain: scene.gain,
        steering: match scene.steering {
            OracleSteering::Fixed { angle } => SteeringPolicy::fixed(angle),
            OracleSteering::WithFlow { beta } => SteeringPolicy::WithFlow { beta },
        },
        limits: Limits { speed: scene.limits.speed, acceleration: scene.limits.acceleration, deceleration: 2.0 },
        ageing: Ageing { time_to_live: ageing.time_to_live, growth: ageing.rate, hold: 100.0 },
        guard: scene.guard.map(|approach| Guard { approach }),
    };
    let mut controller = Controller::new(motion(&scene.motion), settings);
    for (id, (o, age)) in scene.obstacles.iter().zip(&ageing.ages).enumerate() {
        controller.upsert(id as u16, obstacle(o, *age), *age).unwrap();
    }
    if let Some(scan) = &scene.scan {
        let points: Vec<Vector<f64, D>> = scan.points.iter().map(|p| vector(p)).collect();
        controller.set_scan(Scan::new(&points, scan.radius).unwrap(), 0.0);
    }
    if let Some(drift) = &scene.drift {
        let there = vector::<D>(scene.motion.attractor()) + vector::<D>(&drift.displacement);
        assert!(controller.aim(&there, &vector(&drift.velocity)));
    }
    controller
}

/// The scene with the reference points that the core uses, which differ where cores overlap.
pub fn as_used<const D: usize>(scene: &OracleScene, controller: &Controller<f64, D, 16>) -> OracleScene {
    let mut used = scene.clone();
    for entry in controller.table().iter() {
        refer(&mut used, usize::from(entry.id()), entry.obstacle().reference().as_slice()).unwrap();
        lean(&mut used, usize::from(entry.id()), entry.obstacle().hub().as_ref().map(|hub| hub.as_slice())).unwrap();
    }
    used
}
