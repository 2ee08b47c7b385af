//! One sample that cannot be meant: a place far off the path, or a velocity that is none of its positions'.

use super::cleaning::Samples;
use nalgebra::DVector;

/// A place is far off where it lies this part of the size of the motion beside its neighbours,
const OFF: f64 = 0.03;
/// as many times what neighbours are apart in the middle,
const STEPS: f64 = 6.0;
/// and as many times what its own two neighbours are apart.
const APART: f64 = 2.0;
/// A velocity is absurd where it differs from its positions' by as many times the fastest of these.
const FASTEST: f64 = 5.0;
/// Of fewer samples each may be meant.
const FEW: usize = 8;

/// The sample that lies farthest off the line between its neighbours, if that is far: its index and how far, in the positions' unit.
pub fn place(samples: &Samples) -> Option<(usize, f64)> {
    let (n, size) = (samples.len(), samples.size());
    if n < FEW {
        return None;
    }
    let mut steps: Vec<f64> = samples.x.windows(2).map(|w| (&w[1] - &w[0]).norm()).collect();
    steps.sort_by(f64::total_cmp);
    let usual = steps[steps.len() / 2];
    let off = |i: usize| {
        let (a, b) = (&samples.x[i - 1], &samples.x[i + 1]);
        let part = (samples.t[i] - samples.t[i - 1]) / (samples.t[i + 1] - samples.t[i - 1]);
        let off = (&samples.x[i] - a.lerp(b, part)).norm();
        (off > OFF * size && off > STEPS * usual && off > APART * (b - a).norm()).then_some((i, off))
    };
    (1..n - 1).filter_map(off).max_by(|a, b| a.1.total_cmp(&b.1))
}

/// The given velocity that is farthest from its positions', if that is far: its index, its size, and the fastest of the positions', in their
/// units. A factor that all of them have in common, such as another unit's, is left out of it.
pub fn velocity(samples: &Samples) -> Option<(usize, f64, f64)> {
    let (given, n) = (samples.v.as_ref()?, samples.len());
    if n < FEW {
        return None;
    }
    let slope = |i: usize| {
        let (a, b) = (i.saturating_sub(1), (i + 1).min(n - 1));
        (&samples.x[b] - &samples.x[a]) / (samples.t[b] - samples.t[a])
    };
    let slopes: Vec<DVector<f64>> = (0..n).map(slope).collect();
    let fastest = slopes.iter().map(|v| v.norm()).fold(0.0, f64::max);
    let factor = middle(given) / middle(&slopes);
    if !(factor > 0.0 && factor.is_finite()) {
        return None;
    }
    let (i, off) = given
        .iter()
        .zip(&slopes)
        .map(|(v, slope)| (v - slope * factor).norm())
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    (off > FASTEST * factor * fastest).then(|| (i, given[i].norm(), fastest))
}

/// The median size.
fn middle(all: &[DVector<f64>]) -> f64 {
    let mut sizes: Vec<f64> = all.iter().map(|v| v.norm()).collect();
    sizes.sort_by(f64::total_cmp);
    sizes[sizes.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    /// A motion of 4 s at `count` samples, and its velocities.
    fn samples(count: usize, at: impl Fn(f64) -> [f64; 2]) -> Samples {
        let s = |i: usize| i as f64 / (count - 1) as f64;
        let x = |s: f64| DVector::from_row_slice(&at(s));
        let v = |s: f64| (x(s + 1e-6) - x(s - 1e-6)) / (2e-6 * 4.0);
        Samples {
            t: (0..count).map(|i| 4.0 * s(i)).collect(),
            x: (0..count).map(|i| x(s(i))).collect(),
            v: Some((0..count).map(|i| v(s(i))).collect()),
        }
    }

    /// A wave, a stroke that turns right back, a corner, and from rest to rest.
    const MOTIONS: [fn(f64) -> [f64; 2]; 4] = [
        |s| [0.5 * (1.0 - s), 0.1 * (TAU * s).sin()],
        |s| [0.3 * (1.0 - 2.0 * (s - 0.4).abs()), 0.01 * s],
        |s| if s < 0.5 { [1.0 - 2.0 * s, 0.0] } else { [0.0, 2.0 * s - 1.0] },
        |s| [0.4 * (PI * s).cos(), 0.05 * s * s],
    ];

    #[test]
    fn a_motion_as_it_is_has_no_outlier_at_any_rate() {
        for at in MOTIONS {
            for count in [8, 20, 57, 400, 3000] {
                let all = samples(count, at);
                assert_eq!((place(&all), velocity(&all)), (None, None), "{count}");
                let slower = all.v.iter().flatten().map(|v| v * 1e-3).collect();
                assert_eq!(velocity(&Samples { v: Some(slower), ..all }), None, "another unit, {count}");
            }
        }
    }

    #[test]
    fn one_place_off_the_path_is_found_wherever_it_is_and_whichever_way() {
        for at in MOTIONS {
            for (i, far) in [(1, 0.3), (30, -0.2), (30, 1000.0), (98, 0.15)] {
                let mut all = samples(100, at);
                all.x[i] += DVector::from_row_slice(&[0.6 * far, 0.8 * far]);
                let (found, off) = place(&all).expect("an outlier");
                assert!(found == i && (off - far.abs()).abs() < 0.02, "{found} {off}");
            }
        }
    }

    #[test]
    fn one_absurd_velocity_is_found_and_says_how_fast_the_positions_are() {
        for at in MOTIONS {
            for (i, factor) in [(0, 1.0), (40, 1.0), (99, 1e-3)] {
                let mut all = samples(100, at);
                all.v.iter_mut().flatten().for_each(|v| *v *= factor);
                all.v.as_mut().expect("given")[i] = DVector::from_row_slice(&[0.0, -40.0 * factor]);
                let (found, speed, fastest) = velocity(&all).expect("absurd");
                assert!(
                    found == i && (speed - 40.0 * factor).abs() < 1e-9 && fastest < 1.0,
                    "{found} {speed} {fastest}"
                );
            }
        }
    }
}
