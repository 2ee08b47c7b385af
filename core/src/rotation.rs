//! Rotations and angular velocities in two and three dimensions, as matrices, so that one formula serves both.
//!
//! A rotation Q is d x d, orthonormal and right-handed, and takes coordinates of an obstacle's frame to the world's:
//! x = c + Q q. An angular velocity is the skew d x d matrix W (rad/s) in the world's frame with W r = w x r; dQ/dt =
//! W Q. Angles are in rad, counter-clockwise.
//!
//! ```
//! use pliant_core::rotation::{planar, planar_spin, turned};
//! let quarter = core::f64::consts::FRAC_PI_2;
//! let mut q = planar(0.0);
//! for _ in 0..100 {
//!     q = turned(&q, &planar_spin(quarter), 0.01); // rad/s, s
//! }
//! assert!((q - planar(quarter)).norm() < 1e-9);
//! ```

use crate::{Matrix, Scalar, Vector};

/// The rotation by `angle` (rad) in the plane: [cos, -sin; sin, cos].
pub fn planar<S: Scalar>(angle: S) -> Matrix<S, 2> {
    let (sin, cos) = (angle.sin(), angle.cos());
    Matrix::<S, 2>::new(cos, -sin, sin, cos)
}

/// The rotation of a quaternion w + xi + yj + zk, q v q*/|q|^2, or `None` if its length is not one to 1e-3
/// (not-a-number is not).
pub fn spatial<S: Scalar>([w, x, y, z]: [S; 4]) -> Option<Matrix<S, 3>> {
    let squared = w * w + x * x + y * y + z * z;
    let tolerance = S::from_f64(2e-3);
    if !((squared - S::one()).abs() <= tolerance) {
        return None;
    }
    let two = S::from_f64(2.0) / squared;
    let one = S::one();
    Some(Matrix::<S, 3>::new(
        one - two * (y * y + z * z),
        two * (x * y - w * z),
        two * (x * z + w * y),
        two * (x * y + w * z),
        one - two * (x * x + z * z),
        two * (y * z - w * x),
        two * (x * z - w * y),
        two * (y * z + w * x),
        one - two * (x * x + y * y),
    ))
}

/// The angular velocity `rate` (rad/s) in the plane as the matrix [0, -rate; rate, 0] that maps an arm (m) to its
/// velocity (m/s).
pub fn planar_spin<S: Scalar>(rate: S) -> Matrix<S, 2> {
    Matrix::<S, 2>::new(S::zero(), -rate, rate, S::zero())
}

/// The angular velocity w (rad/s) as the skew matrix that maps an arm r (m) to its velocity w x r (m/s).
pub fn spatial_spin<S: Scalar>(w: &Vector<S, 3>) -> Matrix<S, 3> {
    let o = S::zero();
    Matrix::<S, 3>::new(o, -w[2], w[1], w[2], o, -w[0], -w[1], w[0], o)
}

/// The rotation after `dt` seconds at the angular velocity `spin` (skew, rad/s): exp(spin dt) Q, nearly.
///
/// Cayley's map I + 2 (a + a^2)/(1 + |a|^2) is a rotation by 2 atan(|a|) in 2 and 3 dimensions and needs no sine.
/// With h = spin dt/2 and a = h (1 + |h|^2/3 + 2|h|^4/15), the tangent's series, its angle is short of the true one
/// by 1e-18 rad for 5 rad/s and 1 ms: what is carried on for long is where the next sight finds it. One step of
/// Newton's iteration takes out what rounding would add up to. In fixed point no step turns farther than with a largest entry of h of one: beyond that
/// the series says nothing, and squares leave the range.
pub fn turned<S: Scalar, const D: usize>(rotation: &Matrix<S, D>, spin: &Matrix<S, D>, dt: S) -> Matrix<S, D> {
    if D == 2 {
        return turned_in_plane(rotation, spin, dt);
    }
    let half = S::from_f64(0.5);
    let h = spin * (dt * half);
    let most = if S::FLOATS { S::one() } else { h.iter().fold(S::one(), |m, x| m.max(x.abs())) };
    let h = if most > S::one() { h / most } else { h };
    // Every entry of a skew matrix is in there twice.
    let length_squared = |a: &Matrix<S, D>| a.iter().fold(S::zero(), |s, x| s + *x * *x) * half;
    let squared = length_squared(&h);
    let a = h * longer(squared);
    let squared = length_squared(&a);
    let scale = S::from_f64(2.0) / (S::one() + squared);
    let q = rotation + (a + a * a) * rotation * scale;
    q * (Matrix::<S, D>::identity() * S::from_f64(3.0) - q.transpose() * q) * half
}

/// The same where a rotation is a complex number x + iy, and a = i a: times 1 - 2 a^2/(1 + a^2) + 2 i a/(1 + a^2).
fn turned_in_plane<S: Scalar, const D: usize>(rotation: &Matrix<S, D>, spin: &Matrix<S, D>, dt: S) -> Matrix<S, D> {
    let half = S::from_f64(0.5);
    let h = spin[(1, 0)] * (dt * half);
    let h = if S::FLOATS { h } else { h.max(-S::one()).min(S::one()) };
    let a = h * longer(h * h);
    let scale = S::from_f64(2.0) / (S::one() + a * a);
    let (sine, versine) = (a * scale, a * a * scale);
    let (x, y) = (rotation[(0, 0)], rotation[(1, 0)]);
    let (x, y) = (x - S::dot(&[sine, versine], &[y, x]), y + S::dot(&[sine, -versine], &[x, y]));
    let newton = (S::from_f64(3.0) - S::dot(&[x, y], &[x, y])) * half;
    let (x, y) = (x * newton, y * newton);
    Matrix::from_fn(|i, j| match (i, j) {
        (1, 0) => y,
        (0, 1) => -y,
        _ => x,
    })
}

/// tan(h)/h, from h^2.
fn longer<S: Scalar>(squared: S) -> S {
    S::one() + squared * (S::from_f64(1.0 / 3.0) + squared * S::from_f64(2.0 / 15.0))
}

/// Is this a rotation: orthonormal to 1e-3 and right-handed?
pub(crate) fn is_rotation<S: Scalar, const D: usize>(q: &Matrix<S, D>) -> bool {
    let error = q.transpose() * q - Matrix::<S, D>::identity();
    error.iter().all(|x| x.abs() <= S::from_f64(2e-3)) && determinant(q) > S::zero()
}

/// The rotation that one with an error is meant for: Newton's steps towards Q (Q'Q)^(-1/2), as after every turn. One without keeps its bits.
pub(crate) fn righted<S: Scalar, const D: usize>(q: &Matrix<S, D>) -> Matrix<S, D> {
    let (mut q, three) = (*q, Matrix::<S, D>::identity() * S::from_f64(3.0));
    // Each squares what is left of 1e-3.
    for _ in 0..3 {
        let squares = q.transpose() * q;
        let error = (squares - Matrix::<S, D>::identity()).iter().fold(S::zero(), |m, x| m.max(x.abs()));
        if error <= S::rounding(S::one()) * S::from_f64(8.0) {
            break;
        }
        q = q * (three - squares) * S::from_f64(0.5);
    }
    q
}

/// Is this an angular velocity: skew-symmetric and within `limit` rad/s?
pub(crate) fn is_spin<S: Scalar, const D: usize>(spin: &Matrix<S, D>, limit: S) -> bool {
    (spin + spin.transpose()).iter().all(|x| *x == S::zero()) && spin.iter().all(|x| x.abs() <= limit)
}

fn determinant<S: Scalar, const D: usize>(m: &Matrix<S, D>) -> S {
    let at = |i, j| m[(i, j)];
    let minor = |r: usize, c: usize| at(0, r) * at(1, c) - at(0, c) * at(1, r);
    match D {
        2 => minor(0, 1),
        _ => minor(0, 1) * at(2, 2) - minor(0, 2) * at(2, 1) + minor(1, 2) * at(2, 0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_of_ticks_turns_by_the_rate() {
        let spin = spatial_spin(&Vector::<f64, 3>::new(0.0, 0.0, 5.0));
        let mut q = Matrix::<f64, 3>::identity();
        for _ in 0..1000 {
            q = turned(&q, &spin, 0.001);
        }
        let expected = planar(5.0_f64);
        assert!((q[(0, 0)] - expected[(0, 0)]).abs() < 1e-12 && (q[(1, 0)] - expected[(1, 0)]).abs() < 1e-12);
        assert!(is_rotation(&q));
    }

    #[test]
    fn rounding_does_not_wear_a_rotation_out() {
        let spin = planar_spin(3.0_f32);
        let mut q = planar(0.3_f32);
        for _ in 0..1_000_000 {
            q = turned(&q, &spin, 0.001);
        }
        assert!(((q.transpose() * q) - Matrix::<f32, 2>::identity()).amax() < 1e-5);
    }

    #[test]
    fn plane_and_space_turn_alike() {
        let (mut p, mut q) = (planar(0.4_f64), Matrix::<f64, 3>::identity());
        q.fixed_view_mut::<2, 2>(0, 0).copy_from(&p);
        for rate in [5.0, -3.0, 0.01, 0.0, 40.0] {
            p = turned(&p, &planar_spin(rate), 0.01);
            q = turned(&q, &spatial_spin(&Vector::<f64, 3>::new(0.0, 0.0, rate)), 0.01);
            assert!((q.fixed_view::<2, 2>(0, 0) - p).amax() < 1e-15);
        }
    }

    #[test]
    fn quaternion_and_angle_agree() {
        let half = 0.35_f64;
        let q = spatial([half.cos(), 0.0, 0.0, half.sin()]).unwrap();
        let p = planar(0.7_f64);
        assert!((q.fixed_view::<2, 2>(0, 0) - p).amax() < 1e-15);
        assert!(spatial([1.0_f64, 0.1, 0.0, 0.0]).is_none() && spatial([f64::NAN, 0.0, 0.0, 0.0]).is_none());
    }
}
