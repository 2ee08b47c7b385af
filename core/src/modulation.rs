//! Bending the nominal motion round hard cores.
//!
//! One obstacle: Khansari-Zadeh & Billard (2012), eqs. 7-10 of Chen et al., in closed form. Several: Huber, Billard & Slotine (2019).

use crate::obstacle::Sample;
use crate::{Scalar, Vector, is_zero, norm};

/// The velocity past one obstacle:
///
/// ```text
/// xdot = s + M (f - s),   M u = (1 + 1/G) u - (2/G) ((n.u)/(n.r)) r,   G = max(Gamma, 1),   n = g/|g|
/// ```
///
/// which is E D E^-1 with E = [r/|r|, tangents of g] and D = diag(1 - 1/G, 1 + 1/G, ...): u minus its part along r (split by the tangent
/// plane) is tangential and stretched, the part along r is compressed. `None` where g.r is not positive.
fn past_one<S: Scalar, const D: usize>(f: &Vector<S, D>, o: &Sample<S, D>) -> Option<Vector<S, D>> {
    let along = o.normal.dot(&o.arm);
    if !(along > S::from_f64(1e-6) * norm(&o.arm)) {
        return None;
    }
    let u = f - o.surface_velocity;
    let inverse = S::one() / o.gamma.max(S::one());
    let radial = (inverse + inverse) * o.normal.dot(&u) / along;
    Some(o.surface_velocity + u * (S::one() + inverse) - o.arm * radial)
}

/// The velocity past all obstacles, and whether one of their reference points was unusable.
pub(crate) fn modulate<S: Scalar, const D: usize>(f: &Vector<S, D>, around: &[Sample<S, D>]) -> (Vector<S, D>, bool) {
    let mut unusable = false;
    let mut past = |o: &Sample<S, D>| {
        past_one(f, o).unwrap_or_else(|| {
            unusable = true;
            o.surface_velocity
        })
    };
    let velocity = match around {
        [] => *f,
        [only] => past(only),
        several => {
            let nearest = several.iter().fold(S::MAX, |m, o| m.min(o.gamma - S::one()));
            let mut mean = DirectionalMean::new(f);
            for o in several {
                mean.add(weight(o.gamma - S::one(), nearest), &past(o));
            }
            mean.velocity()
        }
    };
    (velocity, unusable)
}

/// A weight proportional to 1/(Gamma - 1), scaled so that the nearest obstacle's is one: no overflow, and on a surface that
/// obstacle alone counts.
fn weight<S: Scalar>(distance: S, nearest: S) -> S {
    if nearest > S::zero() {
        nearest / distance
    } else if distance <= S::zero() {
        S::one()
    } else {
        S::zero()
    }
}

/// Mean speed, and mean direction as a mean of angles to f: averaging velocities themselves could cancel to a standstill.
struct DirectionalMean<S: Scalar, const D: usize> {
    /// f/|f|; zero where f is.
    forward: Vector<S, D>,
    sum: S,
    speed: S,
    /// sum of w_n angle_n (unit vector across f towards xdot_n)
    kappa: Vector<S, D>,
    /// sum of w_n xdot_n, for where f = 0 and there is no direction to measure from.
    plain: Vector<S, D>,
}

impl<S: Scalar, const D: usize> DirectionalMean<S, D> {
    fn new(f: &Vector<S, D>) -> Self {
        let zero = Vector::zeros();
        Self { forward: unit(f), sum: S::zero(), speed: S::zero(), kappa: zero, plain: zero }
    }

    fn add(&mut self, weight: S, velocity: &Vector<S, D>) {
        self.sum += weight;
        self.plain += velocity * weight;
        let speed = norm(velocity);
        self.speed += weight * speed;
        if !(speed > S::zero()) {
            return;
        }
        let direction = velocity / speed;
        let cos = direction.dot(&self.forward);
        let across = direction - self.forward * cos;
        let sin = norm(&across);
        if sin > S::zero() {
            self.kappa += across * (weight * sin.atan2(cos) / sin);
        } else if cos < S::zero() {
            let pi = S::zero().atan2(-S::one());
            self.kappa += sideways(&self.forward) * (weight * pi);
        }
    }

    fn velocity(self) -> Vector<S, D> {
        let inverse = S::one() / self.sum;
        if is_zero(&self.forward) {
            return self.plain * inverse;
        }
        let kappa = self.kappa * inverse;
        let angle = norm(&kappa);
        let direction =
            if angle > S::zero() { self.forward * angle.cos() + kappa * (angle.sin() / angle) } else { self.forward };
        direction * (self.speed * inverse)
    }
}

fn unit<S: Scalar, const D: usize>(v: &Vector<S, D>) -> Vector<S, D> {
    let length = norm(v);
    if length > S::zero() { v / length } else { Vector::zeros() }
}

/// A fixed side of a direction: turned by +90 degrees in 2-D; in 3-D along z x v, or y x v where v is along z.
fn sideways<S: Scalar, const D: usize>(v: &Vector<S, D>) -> Vector<S, D> {
    let mut side = Vector::<S, D>::zeros();
    (side[0], side[1]) = (-v[1], v[0]);
    if D == 3 && is_zero(&side) {
        (side[0], side[2]) = (v[2], -v[0]);
    }
    unit(&side)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Matrix, Obstacle, ObstacleSpec};
    use proptest::prelude::*;

    fn sample<const D: usize>(spec: ObstacleSpec<f64, D>, x: &Vector<f64, D>) -> Sample<f64, D> {
        Obstacle::new(spec).unwrap().sample(x).1.unwrap()
    }

    /// E D E^-1 as the papers write it.
    fn explicit<const D: usize>(f: &Vector<f64, D>, o: &Sample<f64, D>) -> Vector<f64, D> {
        let n = o.normal;
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
            let spec3 = ObstacleSpec { curvature: p, reference: r.into(), velocity: Vector::<f64, 3>::new(0.1, 0.0, -0.2), ..ObstacleSpec::default() };
            let o = sample(spec3, &x.into());
            let error = past_one(&f.into(), &o).unwrap() - explicit(&f.into(), &o);
            prop_assert!(error.norm() < 1e-11, "{error}");
            let [fx, fy, _] = f;
            let [rx, ry, _] = r;
            let spec2 = ObstacleSpec { curvature: p, reference: [rx, ry].into(), ..ObstacleSpec::default() };
            let o = sample(spec2, &[x[0], x[1]].into());
            let error = past_one(&[fx, fy].into(), &o).unwrap() - explicit(&[fx, fy].into(), &o);
            prop_assert!(error.norm() < 1e-11, "{error}");
        }

        #[test]
        fn nothing_flows_through_a_surface(angle in 0.0..6.2f64, f in prop::array::uniform2(-1.0..1.0f64)) {
            let x = Vector::<f64, 2>::new(angle.cos(), angle.sin()) * 0.05;
            let other = ObstacleSpec { center: Vector::<f64, 2>::new(0.3, 0.0), ..ObstacleSpec::default() };
            let around = [sample(ObstacleSpec::default(), &x), sample(other, &x)];
            let (v, _) = modulate(&f.into(), &around);
            prop_assert!(v.dot(&around[0].normal).abs() < 1e-9);
        }
    }

    #[test]
    fn at_the_centre_the_robot_keeps_still_and_says_so() {
        let o = sample(ObstacleSpec::default(), &Vector::<f64, 2>::zeros());
        let (v, unusable) = modulate(&Vector::<f64, 2>::new(1.0, 0.0), &[o]);
        assert!(unusable && v == Vector::<f64, 2>::zeros());
    }

    #[test]
    fn exactly_opposite_turns_to_a_fixed_side() {
        let f = Vector::<f64, 3>::new(0.0, 0.0, 1.0);
        let mut mean = DirectionalMean::new(&f);
        mean.add(1.0, &-f);
        mean.add(1.0, &f);
        let v = mean.velocity();
        assert!((v - Vector::<f64, 3>::new(1.0, 0.0, 0.0)).norm() < 1e-12, "{v}");
    }
}
