use super::*;
use crate::{Matrix, Obstacle, ObstacleSpec, Shape};
use proptest::prelude::*;

fn sample<const D: usize>(spec: ObstacleSpec<f64, D>, x: &Vector<f64, D>) -> Sample<f64, D> {
    Obstacle::new(spec).unwrap().sample(x)
}

fn past<const D: usize>(f: &Vector<f64, D>, all: &[Sample<f64, D>]) -> (Vector<f64, D>, bool) {
    let mut modulation = Modulation::new(f);
    all.iter().for_each(|o| modulation.push(o));
    modulation.finish()
}

/// E D E^-1 as the papers write it.
fn explicit<const D: usize>(f: &Vector<f64, D>, o: &Sample<f64, D>) -> Vector<f64, D> {
    let n = o.outward.normalize();
    let mut e = Matrix::<f64, D>::identity();
    let first = n.iamax();
    e.swap_columns(0, first);
    e.set_column(0, &n);
    for i in 1..D {
        let mut t = e.column(i).into_owned();
        for j in 0..i {
            let c = e.column(j).into_owned();
            t -= c * c.dot(&t);
        }
        e.set_column(i, &t.normalize());
    }
    e.set_column(0, &o.arm.normalize());
    let mut d = Matrix::<f64, D>::identity() * (1.0 + 1.0 / o.gamma);
    d[(0, 0)] = 1.0 - 1.0 / o.gamma;
    let mut inverse = e;
    assert!(nalgebra::linalg::try_invert_to(e, &mut inverse));
    e * d * inverse * (f - o.surface_velocity) + o.surface_velocity
}

proptest! {
    #[test]
    fn closed_form_is_e_d_e_inverse(
        p in 1..4u8, f in prop::array::uniform3(-1.0..1.0f64), x in prop::array::uniform3(0.06..0.4f64), r in prop::array::uniform3(-0.01..0.01f64),
    ) {
        let spec3 = ObstacleSpec { shape: Shape::Ellipsoid { axes: Vector::<f64, 3>::repeat(0.05), curvature: p }, reference: r.into(), velocity: Vector::<f64, 3>::new(0.1, 0.0, -0.2), ..ObstacleSpec::default() };
        let o = sample(spec3, &x.into());
        let error = past(&f.into(), core::slice::from_ref(&o)).0 - explicit(&f.into(), &o);
        prop_assert!(error.norm() < 1e-11, "{error}");
        let [fx, fy, _] = f;
        let [rx, ry, _] = r;
        let spec2 = ObstacleSpec { shape: Shape::Ellipsoid { axes: Vector::<f64, 2>::repeat(0.05), curvature: p }, reference: [rx, ry].into(), ..ObstacleSpec::default() };
        let o = sample(spec2, &[x[0], x[1]].into());
        let error = past(&[fx, fy].into(), core::slice::from_ref(&o)).0 - explicit(&[fx, fy].into(), &o);
        prop_assert!(error.norm() < 1e-11, "{error}");
    }

    #[test]
    fn nothing_flows_through_a_surface(angle in 0.0..6.2f64, f in prop::array::uniform2(-1.0..1.0f64)) {
        let x = Vector::<f64, 2>::new(angle.cos(), angle.sin()) * 0.05;
        let other = ObstacleSpec { center: Vector::<f64, 2>::new(0.3, 0.0), ..ObstacleSpec::default() };
        let around = [sample(ObstacleSpec::default(), &x), sample(other, &x)];
        let (v, _) = past(&f.into(), &around);
        prop_assert!(v.dot(&around[0].outward.normalize()).abs() < 1e-9);
    }
}

#[test]
fn at_the_centre_the_robot_keeps_still_and_says_so() {
    let o = sample(ObstacleSpec::default(), &Vector::<f64, 2>::zeros());
    let (v, unusable) = past(&Vector::<f64, 2>::new(1.0, 0.0), &[o]);
    assert!(unusable && v == Vector::<f64, 2>::zeros());
}

#[test]
fn there_is_no_jump_where_a_velocity_is_opposite_to_f_or_f_vanishes() {
    let mixed = |f: Vector<f64, 3>, other: Vector<f64, 3>| {
        let mut mean = DirectionalMean::new(&f);
        for (distance, v) in [(1.0, other), (2.0, Vector::<f64, 3>::new(0.3, 0.1, 0.4))] {
            let seen = mean.seen(&from_fn(|d| [v[d]; LANES]));
            mean.add(distance, &seen, 0);
        }
        mean.velocity()
    };
    let f = Vector::<f64, 3>::new(0.0, 0.0, 1.0);
    let tiny = 1e-9;
    let (x, y) = (Vector::<f64, 3>::x() * tiny, Vector::<f64, 3>::y() * tiny);
    for (one, other) in [(x, -x), (y, -y), (x, y), (x, Vector::<f64, 3>::zeros())] {
        assert!((mixed(f, -f + one) - mixed(f, -f + other)).norm() < 1e-6);
        assert!((mixed(one, f) - mixed(other, f)).norm() < 1e-6);
    }
}
