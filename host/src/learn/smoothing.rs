//! Velocities from positions: a Savitzky-Golay filter for samples at any times.

use nalgebra::{DVector, Matrix3, Vector3};

/// Slope at every sample of the quadratic fitted to its neighbours (least squares).
///
/// The window holds `half` samples on either side, fewer at the ends. Two samples give their difference.
pub fn velocities(t: &[f64], x: &[DVector<f64>], half: usize) -> Vec<DVector<f64>> {
    let n = t.len().min(x.len());
    (0..n)
        .map(|i| {
            let first = i.saturating_sub(half);
            let last = (i + half).min(n - 1);
            slope(&t[first..=last], &x[first..=last], t[i]).unwrap_or_else(|| difference(t, x, i))
        })
        .collect()
}

/// Half width that smooths hand tremor and leaves the strokes: a twentieth of the motion in all, whatever the rate.
pub fn half_width(samples: usize) -> usize {
    (samples / 40).max(1)
}

fn slope(t: &[f64], x: &[DVector<f64>], at: f64) -> Option<DVector<f64>> {
    if t.len() < 3 {
        return None;
    }
    let span = t.last()? - t.first()?;
    let mut normal = Matrix3::zeros();
    for &ti in t {
        let s = (ti - at) / span;
        let row = Vector3::new(1.0, s, s * s);
        normal += row * row.transpose();
    }
    let inverse = normal.try_inverse()?;
    let mut sum = DVector::zeros(x.first()?.len());
    for (&ti, xi) in t.iter().zip(x) {
        let s = (ti - at) / span;
        let weight = (inverse * Vector3::new(1.0, s, s * s))[1];
        sum += xi * (weight / span);
    }
    sum.iter().all(|v| v.is_finite()).then_some(sum)
}

fn difference(t: &[f64], x: &[DVector<f64>], i: usize) -> DVector<f64> {
    let (a, b) = (i.saturating_sub(1), (i + 1).min(t.len() - 1));
    let dt = t[b] - t[a];
    if dt > 0.0 { (&x[b] - &x[a]) / dt } else { DVector::zeros(x[i].len()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_for_a_parabola_at_uneven_times() {
        let t = [0.0, 0.1, 0.15, 0.3, 0.5, 0.55, 0.8];
        let x: Vec<_> = t.iter().map(|t| DVector::from_vec(vec![1.0 + 2.0 * t - 3.0 * t * t, 5.0])).collect();
        for (i, v) in velocities(&t, &x, 2).iter().enumerate() {
            assert!((v[0] - (2.0 - 6.0 * t[i])).abs() < 1e-9, "{i}: {v}");
            assert!(v[1].abs() < 1e-9);
        }
    }

    #[test]
    fn two_samples_give_their_difference() {
        let x = [DVector::from_vec(vec![0.0]), DVector::from_vec(vec![1.0])];
        let v = velocities(&[0.0, 0.5], &x, 3);
        assert_eq!(v[0][0], 2.0);
        assert_eq!(v[1][0], 2.0);
    }
}
