use super::*;
use crate::scalar::lanes::{LANES, Lanes};
use crate::shape::{Polygon, Shape};
use crate::{Fixed, Matrix, norm, rotation};
use proptest::prelude::*;

fn spec() -> ObstacleSpec<f64, 2> {
    ObstacleSpec {
        center: Vector::<f64, 2>::new(0.3, -0.2),
        rotation: rotation::planar(0.4),
        shape: Shape::Ellipsoid { axes: Vector::<f64, 2>::new(0.08, 0.04), curvature: 2 },
        soft_ratio: Vector::<f64, 2>::new(1.5, 1.5),
        margin: Vector::<f64, 2>::new(1.1, 1.3),
        ..ObstacleSpec::default()
    }
}

fn ellipse(a: f64, b: f64, curvature: u8) -> Shape<f64, 2> {
    Shape::Ellipsoid { axes: Vector::<f64, 2>::new(a, b), curvature }
}

fn polygon(vertices: &[[f64; 2]]) -> Shape<f64, 2> {
    Shape::Polygon(Polygon::new(vertices).unwrap())
}

fn shaped(shape: Shape<f64, 2>) -> ObstacleSpec<f64, 2> {
    ObstacleSpec { shape, ..spec() }
}

#[test]
fn each_bad_field_is_named() {
    let cases = [
        (ObstacleSpec { center: Vector::<f64, 2>::new(f64::NAN, 0.0), ..spec() }, ObstacleError::Center),
        (ObstacleSpec { center: Vector::<f64, 2>::new(1001.0, 0.0), ..spec() }, ObstacleError::Center),
        (ObstacleSpec { rotation: Matrix::zeros(), ..spec() }, ObstacleError::Rotation),
        (ObstacleSpec { rotation: Matrix::<f64, 2>::new(1.0, 0.0, 0.0, -1.0), ..spec() }, ObstacleError::Rotation),
        (shaped(ellipse(0.1, 0.0, 1)), ObstacleError::Axes),
        (shaped(ellipse(-0.1, 0.1, 1)), ObstacleError::Axes),
        (shaped(ellipse(0.1, 0.1, 0)), ObstacleError::Curvature),
        (shaped(ellipse(0.1, 0.1, 9)), ObstacleError::Curvature),
        (shaped(Shape::Box { half: Vector::<f64, 2>::new(0.1, 0.05), rounding: 0.06 }), ObstacleError::Rounding),
        (shaped(Shape::Box { half: Vector::<f64, 2>::new(0.1, 0.05), rounding: 0.0 }), ObstacleError::Rounding),
        (shaped(Shape::Capsule { radius: 0.1, half_length: 0.1 }), ObstacleError::Dimension),
        (shaped(polygon(&[[0.1, 0.0], [-0.1, -0.1], [-0.1, 0.1]])), ObstacleError::Vertices),
        (shaped(polygon(&[[0.1, 0.1], [0.2, 0.1], [0.2, 0.2]])), ObstacleError::Vertices),
        (ObstacleSpec { growth: f64::NAN, ..spec() }, ObstacleError::Growth),
        (ObstacleSpec { soft_ratio: Vector::<f64, 2>::new(1.0, 0.9), ..spec() }, ObstacleError::SoftRatio),
        (ObstacleSpec { margin: Vector::<f64, 2>::new(0.9, 1.0), ..spec() }, ObstacleError::Margin),
        (ObstacleSpec { reference: Vector::<f64, 2>::new(0.0, 0.05), ..spec() }, ObstacleError::Reference),
        (ObstacleSpec { velocity: Vector::<f64, 2>::new(f64::INFINITY, 0.0), ..spec() }, ObstacleError::Velocity),
        (ObstacleSpec { spin: Matrix::identity(), ..spec() }, ObstacleError::Spin),
    ];
    for (bad, error) in cases {
        assert_eq!(Obstacle::new(bad), Err(error));
    }
}

proptest! {
    #[test]
    fn gradient_is_the_slope_of_gamma(x in -0.3..0.9f64, y in -0.7..0.4f64, p in 1..4u8) {
        let o = Obstacle::new(shaped(ellipse(0.08, 0.04, p))).unwrap();
        let at = Vector::<f64, 2>::new(x, y);
        let gradient = o.gradient(&at);
        for i in 0..2 {
            let mut step = Vector::<f64, 2>::zeros();
            step[i] = 1e-7;
            let slope = (o.gamma(&(at + step)) - o.gamma(&(at - step))) / 2e-7;
            prop_assert!((slope - gradient[i]).abs() <= 1e-5 * (1.0 + gradient.norm()));
        }
    }

    #[test]
    fn the_inflated_surface_has_gamma_one(angle in 0.0..6.3f64) {
        let o = Obstacle::new(shaped(ellipse(0.08, 0.04, 1))).unwrap();
        let q = Vector::<f64, 2>::new(0.08 * 1.1 * angle.cos(), 0.04 * 1.3 * angle.sin());
        prop_assert!((o.gamma(&(o.spec().center + o.spec().rotation * q)) - 1.0).abs() < 1e-12);
    }
}

/// What is computed side by side has the bits of what is computed one by one.
fn abreast_as_alone<S: Scalar, const D: usize>() {
    let vector = |x: [f64; 3]| Vector::<S, D>::from_fn(|i, _| S::from_f64(x[i]));
    let few: [Obstacle<S, D>; LANES] = core::array::from_fn(|i| {
        let k = i as f64;
        let shape = Shape::ellipsoid(vector([0.1 + 0.03 * k, 0.2, 0.31 - 0.05 * k]));
        let center = vector([0.3 * k, -0.7, 0.2]);
        let reference = vector([0.02, 0.03 * k, -0.01]);
        let mut rotation = Matrix::identity();
        let (sin, cos) = S::from_f64(0.4 * k).sin_cos();
        (rotation[(0, 0)], rotation[(0, 1)]) = (cos, -sin);
        (rotation[(1, 0)], rotation[(1, 1)]) = (sin, cos);
        Obstacle::new(ObstacleSpec { center, shape, reference, rotation, ..ObstacleSpec::default() }).unwrap()
    });
    let mut compared = 0;
    for i in 0..400 {
        let t = f64::from(i) * 0.11;
        let x = vector([t.sin() * 0.02 * t, t.cos() * 0.03 * t, 0.01 * t]);
        let Some(abreast) = Abreast::new(few.each_ref(), &x) else { continue };
        for (lane, one) in few.iter().enumerate() {
            let alone = one.sample(&x);
            assert_eq!(abreast.gamma.numbers()[lane], alone.gamma);
            assert_eq!(abreast.outward.map(|v| v.numbers()[lane]), alone.outward.data.0[0]);
            assert_eq!(abreast.arm.map(|v| v.numbers()[lane]), alone.arm.data.0[0]);
            assert!(alone.surface_velocity.iter().all(|v| *v == S::zero()));
            compared += 1;
        }
    }
    assert_eq!(compared > 0, Abreast::<S, D>::WORTH_IT);
    let moving = Obstacle::new(ObstacleSpec { velocity: vector([0.1, 0.0, 0.0]), ..few[0].spec().clone() }).unwrap();
    let mut some = few.each_ref();
    some[LANES - 1] = &moving;
    assert!(Abreast::new(some, &vector([0.5; 3])).is_none());
}

#[test]
fn abreast_as_alone_in_every_number() {
    abreast_as_alone::<f32, 2>();
    abreast_as_alone::<f32, 3>();
    abreast_as_alone::<f64, 2>();
    abreast_as_alone::<f64, 3>();
    abreast_as_alone::<Fixed, 2>();
    abreast_as_alone::<Fixed, 3>();
}

/// What is accepted as a rotation is one before anything moves: its first turn moves no surface by more than it turns.
#[test]
fn a_first_turn_is_no_jump() {
    let spin = rotation::planar_spin(1e-6);
    for off in [-1e-3, -1e-5, 1e-6, 9e-4] {
        let error = Matrix::<f64, 2>::from_fn(|i, j| off * [1.0, 0.0, 0.3, -0.5][2 * i + j]);
        let shape = ellipse(100.0, 50.0, 1);
        let rotation = rotation::planar(0.9) + error;
        let before = Obstacle::new(ObstacleSpec { shape, rotation, spin, ..ObstacleSpec::default() }).unwrap();
        let mut after = before.clone();
        after.advance(0.001);
        for i in 0..40 {
            let way = Vector::<f64, 2>::new(libm::cos(f64::from(i)), libm::sin(f64::from(i)));
            let moved = (after.surface(&way) - before.surface(&way)).norm();
            assert!(moved < 1e-6, "by {off}: {moved} m");
        }
    }
}

/// Where products of scaled coordinates leave the numbers' range, a polygon is still as far away.
#[test]
fn a_polygon_far_away_is_far_away_in_fixed_point_too() {
    // One edge passes near the centre, so its normal is long; and the body shrinks.
    let corners = [[0.0774765, 0.070869], [0.07723, 0.071137], [-0.101133, 0.028231], [-0.02882, -0.100967]];
    let fixed = corners.map(|v: [f64; 2]| v.map(Fixed::from_f64));
    for step in 0..2000 {
        let turn = f64::from(step) * 0.00314;
        let spec = ObstacleSpec {
            center: Vector::<Fixed, 2>::zeros(),
            rotation: rotation::planar(turn).map(Fixed::from_f64),
            shape: Shape::Polygon(Polygon::new(&fixed).unwrap()),
            growth: Fixed::from_f64(-0.1),
            ..ObstacleSpec::default()
        };
        let mut obstacle = Obstacle::new(spec).unwrap();
        obstacle.carry(Fixed::from_f64(0.1 + 0.15 * f64::from(step % 7) / 6.0));
        for far in [3.0, 10.0, 31.6, 60.0] {
            let gamma = obstacle.gamma(&Vector::<f64, 2>::new(-0.95 * far, 0.31 * far).map(Fixed::from_f64));
            // No corner is farther from the centre than 0.11 m.
            let least = (far / 0.11 * (far / 0.11)).min(1000.0);
            assert!(gamma.to_f64() >= 0.9 * least, "{gamma} at {far} m, turned by {turn}");
        }
    }
}

/// Displacements said to end in the core do, and a surface said to be out of reach is. How many of those tried were said to end in it.
fn engulfed<S: Scalar>(rounding: f64) -> (u32, u32) {
    use rand::{Rng, SeedableRng};
    let r = &mut rand_chacha::ChaCha8Rng::seed_from_u64(5);
    let (mut tried, mut held) = (0, 0);
    for _ in 0..20_000 {
        let size = 10f64.powf(r.random_range(-3.0..-0.5));
        let axes = Vector::<f64, 2>::new(size, size * 10f64.powf(r.random_range(-1.0..0.0)));
        let spec = ObstacleSpec {
            center: Vector::<f64, 2>::new(r.random_range(-1.0..1.0), r.random_range(-1.0..1.0)).map(S::from_f64),
            rotation: rotation::planar(r.random_range(0.0..6.3)).map(S::from_f64),
            shape: Shape::Ellipsoid { axes: axes.map(S::from_f64), curvature: r.random_range(1..3) },
            ..ObstacleSpec::default()
        };
        let Ok(o) = Obstacle::new(spec) else { continue };
        let step = 10f64.powf(r.random_range(-4.0..-2.0));
        let way = Vector::<f64, 2>::new(r.random_range(-1.0..1.0), r.random_range(-1.0..1.0)).map(S::from_f64);
        let surface = o.surface(&way);
        let off = (surface - o.spec().center) / norm(&(surface - o.spec().center));
        let off = off * S::from_f64(step * r.random_range(-3.0..2.0));
        let x = if r.random_bool(0.02) { o.spec().center } else { surface + off };
        let seen = o.engulfs(&x, S::from_f64(step), S::zero());
        for _ in 0..20 {
            let (angle, share): (f64, f64) = (r.random_range(0.0..6.3), r.random_range(0.0f64..1.0).sqrt());
            let delta = Vector::<f64, 2>::new(angle.cos(), angle.sin()) * (step * share);
            let to = x + delta.map(S::from_f64);
            let (before, after) = (o.gamma(&x).to_f64(), o.gamma(&to).to_f64());
            tried += 1;
            // The steepest there is: what rounding of a place may do to the gauge.
            let slack = rounding * o.steepest().to_f64();
            let ends_inside = match &seen {
                None => {
                    let stays = (before - 1.0).signum() == (after - 1.0).signum();
                    assert!(stays || (after - 1.0).abs() < slack, "{o:?} {x} {delta}: {before}, {after}");
                    false
                }
                Some(Engulfed::Everything) => true,
                Some(Engulfed::HalfSpace { normal, depth }) => {
                    *depth > S::from_f64(step) || normal.dot(&delta.map(S::from_f64)) < *depth
                }
                Some(Engulfed::Nothing) => false,
            };
            if ends_inside {
                held += 1;
                assert!(after < 1.0 + slack, "{o:?} {x} {delta}: {after}");
            }
        }
    }
    (tried, held)
}

#[test]
fn what_is_said_to_end_in_a_core_does() {
    for (tried, held) in [engulfed::<f64>(1e-12), engulfed::<f32>(1e-5), engulfed::<Fixed>(3e-5)] {
        assert!(held * 4 > tried && tried > 200_000, "{held} of {tried}");
    }
}
