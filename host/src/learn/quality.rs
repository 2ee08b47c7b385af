//! How well a motion follows the demonstrations.

use super::beside;
use super::evaluate::Motion;
use nalgebra::SVector;

/// Points that paths are resampled to before they are compared.
const POINTS: usize = 200;
/// Points that the alignment may run ahead or behind.
const WINDOW: usize = 20;
/// A rollout has arrived within this part of the extent.
pub const NEAR: f64 = 0.01;
/// In this many times the demonstration's time, which is long enough for what is slow.
pub const LIMIT: f64 = 10.0;
/// From beside the demonstrations this is near enough, in this many times their duration: the last of the way may be slow.
const THERE: f64 = 0.05;
const PATIENCE: f64 = 2.0;
/// Rollouts start at this sample of a recording of a thousand: before it the hand hardly moves.
const START: usize = 20;
/// Samples a demonstration is judged at: every fifth of a thousand.
const JUDGED: usize = 200;

/// Figures of merit, all in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// Velocity error, m/s: the mean over samples of the root of the mean over axes of its square.
    pub rmse: f64,
    /// Mean of 1 - cos of the angle between demonstrated and learnt velocity.
    pub e_dot: f64,
    /// Dynamic time warping distance, m: the sum of point distances along the best alignment of a demonstration and the
    /// rollout from its start, each as 200 points at equal steps of length; the mean over demonstrations.
    pub dtwd: f64,
    /// The same alignment, as the mean distance of aligned points, m.
    pub path_error: f64,
    /// The rollouts' time over the demonstrations' to come within a tenth of the way of the attractor; the mean over demonstrations.
    pub pace: f64,
    /// Rollouts that came within one percent of the extent of the attractor.
    pub converged: usize,
    /// All rollouts: one a demonstration.
    pub rollouts: usize,
    /// Rollouts from beside the demonstrations that are within a twentieth of the extent of the attractor after twice the demonstrators' time.
    pub robust: usize,
    /// All such rollouts: from the mean start, and from places up to a tenth of the extent beside the starts and the paths.
    pub beside: usize,
    /// The farthest that one of them, or a rollout from a demonstration's start, leaves the box about the demonstrations and that rollout's start, m.
    pub excursion: f64,
    /// Where that rollout starts, m, entries beyond the dimension 0; of one skill that leaves it. Places have no mean and no median.
    pub excursion_from: Option<[f64; 3]>,
}

/// One demonstration.
#[derive(Debug, Clone)]
pub struct Recording<const D: usize> {
    /// Times, s.
    pub t: Vec<f64>,
    /// Positions, m.
    pub x: Vec<SVector<f64, D>>,
    /// Velocities, m/s.
    pub v: Vec<SVector<f64, D>>,
}

impl<const D: usize> Recording<D> {
    /// Every n-th sample is judged, so that there are about 200.
    pub fn stride(&self) -> usize {
        self.x.len().div_ceil(JUDGED).max(1)
    }

    /// Index of the sample where rollouts start: the 20th of a thousand, as far in shorter recordings.
    pub fn start(&self) -> usize {
        ((START - 1) * self.x.len() / 1000).min(START - 1)
    }

    /// Seconds from where rollouts start to the end.
    pub fn duration(&self) -> f64 {
        self.t[self.t.len() - 1] - self.t[self.start()]
    }

    /// Seconds between two points of a rollout.
    fn step(&self) -> f64 {
        self.duration() / 400.0
    }
}

/// What a demonstration is compared with: the path from where it starts, until it arrives or [`LIMIT`] times the demonstration's time have
/// passed; and whether it arrived.
pub fn rollout<const D: usize>(
    motion: &Motion<D>,
    recording: &Recording<D>,
    extent: f64,
) -> (Vec<SVector<f64, D>>, bool) {
    let start = &recording.x[recording.start()];
    motion.rollout(start, recording.step(), LIMIT * recording.duration(), NEAR * extent)
}

/// Compares a motion with demonstrations.
pub fn measure<const D: usize>(motion: &Motion<D>, recordings: &[Recording<D>], extent: f64) -> Quality {
    let (mut error, mut turn, mut count, mut moving) = (0.0, 0.0, 0usize, 0usize);
    let (mut dtwd, mut path_error, mut pace, mut converged) = (0.0, 0.0, 0.0, 0);
    let area = Area::of(recordings.iter().flat_map(|r| &r.x));
    let mut farthest = (0.0_f64, SVector::zeros());
    let mut leaves = |path: &[SVector<f64, D>]| {
        let by = area.left_by(path);
        if by > farthest.0 {
            farthest = (by, path[0]);
        }
    };
    for r in recordings {
        for (x, v) in r.x.iter().zip(&r.v).step_by(r.stride()) {
            let f = motion.velocity(x);
            error += ((f - v).norm_squared() / D as f64).sqrt();
            count += 1;
            let size = f.norm() * v.norm();
            // Where one of them stands still there is no direction to compare.
            if size > 0.0 {
                turn += 1.0 - f.dot(v) / size;
                moving += 1;
            }
        }
        let path = &r.x[r.start()..];
        let dt = r.step();
        let (rollout, arrived) = rollout(motion, r, extent);
        converged += usize::from(arrived);
        leaves(&rollout);
        let (sum, mean) = warping_distance(&resample(path), &resample(&rollout));
        dtwd += sum;
        path_error += mean;
        let near = 0.1 * (path[0] - motion.attractor).norm();
        // The last time a demonstration is farther than that; a path may pass near its end on the way.
        let reached = path.iter().rposition(|x| (x - motion.attractor).norm() >= near).map_or(1, |i| i + 1);
        let taken = rollout.iter().rposition(|x| (x - motion.attractor).norm() >= near).map_or(1, |i| i + 1);
        let demonstrated = r.t[(r.start() + reached).min(r.t.len() - 1)] - r.t[r.start()];
        pace += if demonstrated > 0.0 { taken as f64 * dt / demonstrated } else { 1.0 };
    }
    let n = recordings.len().max(1) as f64;
    let paths: Vec<_> = recordings.iter().map(|r| r.x.as_slice()).collect();
    let longest = recordings.iter().map(Recording::duration).fold(0.0, f64::max);
    let places = beside::places(&paths, extent);
    let mut robust = 0;
    for place in &places {
        let (path, in_time) = from_beside(motion, place, longest, extent);
        robust += usize::from(in_time);
        leaves(&path);
    }
    Quality {
        rmse: error / count.max(1) as f64,
        e_dot: turn / moving.max(1) as f64,
        dtwd: dtwd / n,
        path_error: path_error / n,
        pace: pace / n,
        converged,
        rollouts: recordings.len(),
        robust,
        beside: places.len(),
        excursion: farthest.0,
        excursion_from: (farthest.0 > 0.0).then(|| std::array::from_fn(|i| farthest.1.get(i).copied().unwrap_or(0.0))),
    }
}

/// The motion from a place beside the demonstrations, and whether it is at the goal after `PATIENCE` times a demonstration's time.
fn from_beside<const D: usize>(
    motion: &Motion<D>,
    start: &SVector<f64, D>,
    duration: f64,
    extent: f64,
) -> (Vec<SVector<f64, D>>, bool) {
    let (path, arrived) = motion.rollout(start, duration / 100.0, PATIENCE * duration, NEAR * extent);
    let in_time = arrived || path.last().is_some_and(|x| (x - motion.attractor).norm() <= THERE * extent);
    (path, in_time)
}

/// The box about all demonstrations, along the axes.
struct Area<const D: usize> {
    low: SVector<f64, D>,
    high: SVector<f64, D>,
}

impl<const D: usize> Area<D> {
    fn of<'a>(points: impl Iterator<Item = &'a SVector<f64, D>>) -> Self {
        let empty = Self { low: SVector::repeat(f64::INFINITY), high: SVector::repeat(f64::NEG_INFINITY) };
        points.fold(empty, |area, x| area.with(x))
    }

    fn with(&self, x: &SVector<f64, D>) -> Self {
        Self { low: self.low.inf(x), high: self.high.sup(x) }
    }

    /// How far a path leaves it, once it holds the path's start.
    fn left_by(&self, path: &[SVector<f64, D>]) -> f64 {
        let Some(start) = path.first() else { return 0.0 };
        let area = self.with(start);
        let outside = |x: &SVector<f64, D>| (area.low - x).sup(&(x - area.high)).sup(&SVector::zeros()).norm();
        path.iter().map(outside).fold(0.0, f64::max)
    }
}

/// Points at equal steps along a path.
pub fn resample<const D: usize>(path: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
    let mut length = vec![0.0];
    for pair in path.windows(2) {
        length.push(length[length.len() - 1] + (pair[1] - pair[0]).norm());
    }
    let total = length[length.len() - 1];
    let mut i = 0;
    (0..POINTS)
        .map(|j| {
            let at = total * j as f64 / (POINTS - 1) as f64;
            while i + 2 < path.len() && length[i + 1] < at {
                i += 1;
            }
            let Some(next) = path.get(i + 1) else { return path[i] };
            let step = length[i + 1] - length[i];
            let part = if step > 0.0 { ((at - length[i]) / step).clamp(0.0, 1.0) } else { 0.0 };
            path[i] + (next - path[i]) * part
        })
        .collect()
}

/// Sum and mean of distances along the best alignment within the window.
pub fn warping_distance<const D: usize>(a: &[SVector<f64, D>], b: &[SVector<f64, D>]) -> (f64, f64) {
    let mut row = vec![(f64::INFINITY, 0usize); b.len()];
    for (i, p) in a.iter().enumerate() {
        let before = row.clone();
        row.fill((f64::INFINITY, 0));
        for j in i.saturating_sub(WINDOW)..(i + WINDOW + 1).min(b.len()) {
            let mut best = if i == 0 && j == 0 { (0.0, 0) } else { (f64::INFINITY, 0) };
            let mut offer = |o: (f64, usize)| {
                if o.0 < best.0 {
                    best = o;
                }
            };
            if j > 0 {
                offer(before[j - 1]);
                offer(row[j - 1]);
            }
            if i > 0 {
                offer(before[j]);
            }
            row[j] = (best.0 + (p - b[j]).norm(), best.1 + 1);
        }
    }
    let (sum, pairs) = row[b.len() - 1];
    (sum, sum / pairs.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    #[test]
    fn resampling_keeps_the_ends_and_equal_steps() {
        let path = [Vector2::new(0.0, 0.0), Vector2::new(0.1, 0.0), Vector2::new(1.0, 0.0), Vector2::new(1.0, 1.0)];
        let even = resample(&path);
        assert_eq!(even.len(), POINTS);
        assert_eq!((even[0], even[POINTS - 1]), (path[0], path[3]));
        let step = 2.0 / (POINTS - 1) as f64;
        assert!(even.windows(2).all(|w| (w[1] - w[0]).norm() < step + 1e-12));
    }

    #[test]
    fn an_excursion_is_counted_from_the_box_and_the_start() {
        let area = Area::of([Vector2::new(0.0, 0.0), Vector2::new(1.0, 2.0)].iter());
        assert_eq!(area.left_by(&[Vector2::new(0.5, 1.0), Vector2::new(1.0, 0.5)]), 0.0);
        // From outside straight in: no excursion; on outwards: as far as from the start.
        assert_eq!(area.left_by(&[Vector2::new(1.5, 1.0), Vector2::new(1.0, 0.5)]), 0.0);
        assert_eq!(area.left_by(&[Vector2::new(1.5, 1.0), Vector2::new(1.75, 0.5)]), 0.25);
        assert_eq!(area.left_by(&[Vector2::new(0.5, 1.0), Vector2::new(-3.0, 6.0)]), 5.0);
    }

    #[test]
    fn parallel_lines_are_their_distance_apart() {
        let line = |y: f64| resample(&[Vector2::new(0.0, y), Vector2::new(1.0, y)]);
        let (sum, mean) = warping_distance(&line(0.0), &line(0.03));
        assert!((mean - 0.03).abs() < 1e-3 && (sum - 0.03 * POINTS as f64).abs() < 0.1, "{sum} {mean}");
        assert_eq!(warping_distance(&line(0.0), &line(0.0)).0, 0.0);
    }
}
