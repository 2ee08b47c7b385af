use super::*;
use crate::{Obstacle, ObstacleSpec};
use proptest::prelude::*;

fn sample<const D: usize>(spec: ObstacleSpec<f64, D>, x: &Vector<f64, D>) -> Sample<f64, D> {
    Obstacle::new(spec).unwrap().sample(x)
}

fn past<const D: usize>(f: &Vector<f64, D>, all: &[Sample<f64, D>]) -> (Vector<f64, D>, bool) {
    let mut modulation: Modulation<f64, D, 4> = Modulation::new(f);
    all.iter().for_each(|o| modulation.push(o));
    modulation.finish(all.iter().fold(f64::MAX, |least, o| least.min(o.gamma)), None)
}

proptest! {
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
        let mut mean = DirectionalMean::new(&f.into(), 1.0);
        for (gamma, v) in [(2.0, other), (3.0, Vector::<f64, 3>::new(0.3, 0.1, 0.4))] {
            let zero = Vector::zeros();
            let group = Group::new(&Sample { gamma, outward: zero, arm: zero, surface_velocity: zero });
            let velocity = from_fn(|d| Lanes::new(&from_fn(|lane| if lane == 0 { v[d] } else { 0.0 })));
            mean.add(&group, <f64 as Scalar>::Lanes::mask(true), &velocity);
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
