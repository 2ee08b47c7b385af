//! What is between samples that are far apart: the motion is learnt along paths, and a few samples are no path.
//!
//! Between neighbours x_0, x_1 a time T apart, with velocities v_0 and v_1, the cubic (Hermite)
//!
//! ```text
//! x(s) = (1 + 2s)(1 - s)^2 x_0 + s(1 - s)^2 T v_0 + s^2 (3 - 2s) x_1 - s^2 (1 - s) T v_1      0 <= s <= 1
//! ```
//!
//! goes through both samples as fast as they do. A velocity longer than three times a neighbouring chord's would swing the cubic back and forth
//! (Fritsch and Carlson 1980), so it is taken as that long, for the cubics on both sides and for the sample itself: the path is as fast as it says.

use super::reference::Track;
use nalgebra::SVector;

/// Fewer steps than these are no path: rollouts are compared with it as often.
const STEPS: usize = 100;
/// A velocity is taken up to this many times a neighbouring chord's.
const CHORDS: f64 = 3.0;

/// The same track with the cubic's samples between its own, where these are few; recorded places stay as they are, and velocities that cubics can
/// have.
pub fn filled<const D: usize>(track: &Track<D>) -> Track<D> {
    let pieces = STEPS.div_ceil(track.x.len().saturating_sub(1).max(1));
    if pieces < 2 {
        return track.clone();
    }
    let speed = |i: usize| Some((track.x.get(i + 1)? - track.x[i]).norm() / (track.t[i + 1] - track.t[i]));
    let taken = |(i, v): (usize, &SVector<f64, D>)| {
        let slower = i.checked_sub(1).and_then(speed).into_iter().chain(speed(i)).fold(f64::INFINITY, f64::min);
        v.cap_magnitude(CHORDS * slower)
    };
    let v: Vec<_> = track.v.iter().enumerate().map(taken).collect();
    let mut dense = Track { x: vec![], v: vec![], t: vec![], shift: track.shift };
    for i in 0..track.x.len() {
        let (t, x) = (track.t[i], track.x[i]);
        dense.t.push(t);
        dense.x.push(x);
        dense.v.push(v[i]);
        let Some(next) = track.x.get(i + 1) else { break };
        let duration = track.t[i + 1] - t;
        let chord = next - x;
        let (leave, arrive) = (v[i] * duration, v[i + 1] * duration);
        for j in 1..pieces {
            let s = j as f64 / pieces as f64;
            let rest = 1.0 - s;
            dense.t.push(t + s * duration);
            dense.x.push(x + chord * (s * s * (3.0 - 2.0 * s)) + leave * (s * rest * rest) - arrive * (s * s * rest));
            let slope = chord * (6.0 * s * rest) + leave * (rest * (1.0 - 3.0 * s)) + arrive * (s * (3.0 * s - 2.0));
            dense.v.push(slope / duration);
        }
    }
    dense
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    fn track(t: &[f64], at: impl Fn(f64) -> (Vector2<f64>, Vector2<f64>)) -> Track<2> {
        let (x, v) = t.iter().map(|&t| at(t)).unzip();
        Track { x, v, t: t.to_vec(), shift: 0.0 }
    }

    #[test]
    fn a_cubic_motion_is_found_again_between_uneven_samples() {
        let at = |t: f64| (Vector2::new(t * t * t - t, 2.0 - t * t), Vector2::new(3.0 * t * t - 1.0, -2.0 * t));
        let dense = filled(&track(&[0.0, 0.3, 1.1, 1.5], at));
        assert!(dense.t.is_sorted_by(|a, b| a < b) && dense.x.len() > STEPS);
        for (t, (x, v)) in dense.t.iter().zip(dense.x.iter().zip(&dense.v)) {
            assert!((x - at(*t).0).norm() < 1e-12 && (v - at(*t).1).norm() < 1e-12, "{t}: {x} {v}");
        }
    }

    #[test]
    fn what_is_dense_stays_and_so_do_recorded_samples() {
        let line = |t: f64| (Vector2::new(1.0 - t, 0.0), Vector2::new(-1.0, 0.0));
        let times: Vec<f64> = (0..=STEPS).map(|i| i as f64 / STEPS as f64).collect();
        let dense = track(&times, line);
        assert_eq!(filled(&dense).t, dense.t);
        let few = track(&[0.0, 0.25, 1.0], line);
        let all = filled(&few);
        assert!(few.t.iter().all(|t| all.t.contains(t)));
    }

    /// A long step before a short one, at a velocity that only the long one bears: what the samples say is what the path does, on both sides.
    #[test]
    fn velocities_are_those_of_the_path_everywhere() {
        let x = [0.0, 0.6, 0.61, 0.61, 1.0].map(|x| Vector2::new(1.0 - x, 0.3 * x * x));
        let v = [0.5, 4.0, 2.0, 1.0, 3.0].map(|v| Vector2::new(-v, 0.2));
        let track = Track { x: x.to_vec(), v: v.to_vec(), t: vec![0.0, 0.5, 0.8, 1.0, 1.2], shift: 0.0 };
        let dense = filled(&track);
        let pieces = (dense.x.len() - 1) / (x.len() - 1);
        for i in 1..dense.x.len() - 1 {
            // Slopes at the sample of parabolas through it and the next two, and the two before: exact but for the cubic's third derivative.
            let slope = |a: usize, b: usize| (dense.x[b] - dense.x[a]) / (dense.t[b] - dense.t[a]);
            let ahead = (i + 2 < dense.x.len() && (i % pieces) + 2 <= pieces)
                .then(|| slope(i, i + 1) * 1.5 - slope(i + 1, i + 2) * 0.5);
            let behind = (i >= 2 && (i - 1) % pieces >= 1).then(|| slope(i - 1, i) * 1.5 - slope(i - 2, i - 1) * 0.5);
            for measured in [ahead, behind].into_iter().flatten() {
                assert!((measured - dense.v[i]).norm() < 0.02, "{i}: {measured} {}", dense.v[i]);
            }
        }
        // What no cubic has to give way for stays.
        assert_eq!((dense.v[0], dense.v[dense.v.len() - 1].norm() > 3.0), (v[0], true));
    }

    /// Velocities in mm/s beside positions in m: the path stays near its samples.
    #[test]
    fn a_velocity_that_cannot_be_meant_does_not_throw_the_path() {
        let dense = filled(&track(&[0.0, 1.0], |t| (Vector2::new(1.0 - t, 0.0), Vector2::new(0.0, 1000.0))));
        assert!(dense.x.iter().all(|x| x.norm() < 1.5), "{:?}", dense.x);
    }
}
