//! Lengths, angles, rotations and tangents in two and three dimensions.

use nalgebra::{DMatrix, DVector};

use super::error::OracleError;
use super::scene::OracleRotation;

/// A finite vector of the right dimension.
pub(super) fn vector(values: &[f64], dimension: usize, what: &'static str) -> Result<DVector<f64>, OracleError> {
    if values.len() != dimension {
        return Err(OracleError::Shape(what));
    }
    if values.iter().any(|value| !value.is_finite()) {
        return Err(OracleError::Value(what));
    }
    Ok(DVector::from_column_slice(values))
}

/// A finite square matrix from its rows.
pub(super) fn matrix(rows: &[Vec<f64>], dimension: usize, what: &'static str) -> Result<DMatrix<f64>, OracleError> {
    if rows.len() != dimension || rows.iter().any(|row| row.len() != dimension) {
        return Err(OracleError::Shape(what));
    }
    if rows.iter().flatten().any(|value| !value.is_finite()) {
        return Err(OracleError::Value(what));
    }
    Ok(DMatrix::from_fn(dimension, dimension, |i, j| rows[i][j]))
}

/// Euclidean length; scaled first, because the gradient of a high power can be too small to square.
pub(super) fn length(v: &DVector<f64>) -> f64 {
    let largest = v.amax();
    if largest == 0.0 {
        return 0.0;
    }
    largest * v.iter().map(|c| (c / largest).powi(2)).sum::<f64>().sqrt()
}

/// The unit vector along v, or nothing for zero.
pub(super) fn unit(v: &DVector<f64>) -> Option<DVector<f64>> {
    let largest = v.amax();
    if largest == 0.0 {
        return None;
    }
    let scaled = v / largest;
    let norm = length(&scaled);
    Some(scaled / norm)
}

/// A plane vector turned by +90 degrees.
pub(super) fn turned_left(v: &DVector<f64>) -> DVector<f64> {
    DVector::from_column_slice(&[-v[1], v[0]])
}

/// The z part of the product of two plane vectors.
pub(super) fn plane_cross(a: &DVector<f64>, b: &DVector<f64>) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The product of two vectors in space.
pub(super) fn cross(a: &DVector<f64>, b: &DVector<f64>) -> DVector<f64> {
    DVector::from_column_slice(&[a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
}

/// The angle between two vectors, accurate near 0 and near pi, where an arc cosine is not.
pub(super) fn angle_between(a: &DVector<f64>, b: &DVector<f64>) -> f64 {
    let (Some(a), Some(b)) = (unit(a), unit(b)) else {
        return 0.0;
    };
    2.0 * length(&(&a - &b)).atan2(length(&(&a + &b)))
}

/// An orthonormal basis of the plane across a unit normal.
pub(super) fn tangents(normal: &DVector<f64>) -> Vec<DVector<f64>> {
    if normal.len() == 2 {
        return vec![turned_left(normal)];
    }
    let mut axis = DVector::zeros(3);
    axis[normal.iamin()] = 1.0;
    let across = cross(normal, &axis);
    let first = unit(&across).unwrap_or(axis);
    let second = cross(normal, &first);
    vec![first, second]
}

/// The part of v in the plane across a unit normal, summed over a basis of that plane.
pub(super) fn in_tangent_plane(v: &DVector<f64>, normal: &DVector<f64>) -> DVector<f64> {
    tangents(normal).iter().fold(DVector::zeros(v.len()), |sum, tangent| sum + tangent * tangent.dot(v))
}

/// A vector turned about z, in the plane or in space.
pub(super) fn turned_about_z(v: &DVector<f64>, angle: f64) -> DVector<f64> {
    let (sin, cos) = angle.sin_cos();
    let mut turned = v.clone();
    turned[0] = cos * v[0] - sin * v[1];
    turned[1] = sin * v[0] + cos * v[1];
    turned
}

/// A vector in space turned about `axis_angle` by its length (Rodrigues).
pub(super) fn turned_about(v: &DVector<f64>, axis_angle: &DVector<f64>) -> DVector<f64> {
    let Some(axis) = unit(axis_angle) else {
        return v.clone();
    };
    let (sin, cos) = length(axis_angle).sin_cos();
    v * cos + cross(&axis, v) * sin + &axis * (axis.dot(v) * (1.0 - cos))
}

/// The rotation matrix, column by column: the images of the coordinate axes.
pub(super) fn rotation_matrix(rotation: OracleRotation, dimension: usize) -> Result<DMatrix<f64>, OracleError> {
    let columns: Vec<DVector<f64>> = match rotation {
        OracleRotation::Angle(angle) => {
            if !angle.is_finite() {
                return Err(OracleError::Value("rotation"));
            }
            (0..dimension).map(|i| turned_about_z(&basis(i, dimension), angle)).collect()
        }
        OracleRotation::Quaternion(q) => {
            if dimension != 3 {
                return Err(OracleError::Shape("rotation"));
            }
            let q = unit(&vector(&q, 4, "rotation")?).ok_or(OracleError::Value("rotation"))?;
            let w = q[0];
            let imaginary = DVector::from_column_slice(&[q[1], q[2], q[3]]);
            (0..3)
                .map(|i| {
                    let axis = basis(i, 3);
                    let once = cross(&imaginary, &axis);
                    let twice = cross(&imaginary, &once);
                    axis + once * (2.0 * w) + twice * 2.0
                })
                .collect()
        }
    };
    Ok(DMatrix::from_columns(&columns))
}

fn basis(i: usize, dimension: usize) -> DVector<f64> {
    let mut axis = DVector::zeros(dimension);
    axis[i] = 1.0;
    axis
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI};

    fn v(values: &[f64]) -> DVector<f64> {
        DVector::from_column_slice(values)
    }

    #[test]
    fn angles_are_accurate_at_both_ends() {
        for tiny in [1e-4, 1e-9, 1e-14] {
            let turned = turned_about_z(&v(&[1.0, 0.0]), tiny);
            assert!((angle_between(&v(&[2.0, 0.0]), &turned) - tiny).abs() < 1e-12 * tiny + 1e-17);
            let back = angle_between(&v(&[-2.0, 0.0]), &turned);
            assert!((back - (PI - tiny)).abs() < 1e-15);
        }
        assert!((angle_between(&v(&[0.0, 3.0, 0.0]), &v(&[0.0, 0.0, 2.0])) - FRAC_PI_2).abs() < 1e-15);
    }

    #[test]
    fn tangents_are_orthonormal_and_across() {
        for normal in [v(&[0.6, -0.8]), v(&[0.0, 0.0, 1.0]), v(&[1.0, 2.0, -2.0]) / 3.0] {
            let basis = tangents(&normal);
            assert_eq!(basis.len(), normal.len() - 1);
            for (i, a) in basis.iter().enumerate() {
                assert!(a.dot(&normal).abs() < 1e-15);
                for (j, b) in basis.iter().enumerate() {
                    let expected = if i == j { 1.0 } else { 0.0 };
                    assert!((a.dot(b) - expected).abs() < 1e-15);
                }
            }
        }
    }

    #[test]
    fn a_quaternion_is_w_first_and_counter_clockwise() {
        // Half of the angle: 90 degrees about x takes y to z.
        let q = OracleRotation::Quaternion([FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0, 0.0]);
        let image = rotation_matrix(q, 3).unwrap() * v(&[0.0, 1.0, 0.0]);
        assert!((image - v(&[0.0, 0.0, 1.0])).amax() < 1e-15);
        let angle = 0.7_f64;
        let about_z = OracleRotation::Quaternion([(angle / 2.0).cos(), 0.0, 0.0, (angle / 2.0).sin()]);
        let difference =
            rotation_matrix(about_z, 3).unwrap() - rotation_matrix(OracleRotation::Angle(angle), 3).unwrap();
        assert!(difference.amax() < 1e-15);
    }

    #[test]
    fn rodrigues_turns_as_the_plane_does() {
        let v3 = v(&[0.3, -0.4, 0.9]);
        let turned = turned_about(&v3, &v(&[0.0, 0.0, 1.1]));
        assert!((turned - turned_about_z(&v3, 1.1)).amax() < 1e-15);
    }

    #[test]
    fn the_length_of_a_tiny_vector_is_not_lost() {
        assert!((length(&v(&[3e-200, 4e-200])) / 5e-200 - 1.0).abs() < 1e-14);
        assert_eq!(length(&v(&[0.0, 0.0])), 0.0);
        assert!(unit(&v(&[0.0, 0.0, 0.0])).is_none());
    }
}
