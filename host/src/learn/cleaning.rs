//! From samples as they were recorded to samples that a motion can be learnt from: repeats, rests, noise, rates.
//!
//! Everything is relative to the recording's own size and duration, so that units and speed change nothing.

use nalgebra::DVector;

/// Samples a demonstration keeps: more add time and little else.
pub const MOST_SAMPLES: usize = 2000;
/// What counts as standing still, as a part of the size of the motion (noise comes on top).
const STILL: f64 = 0.002;
/// And never more than this.
const STILL_AT_MOST: f64 = 0.01;
/// Standing still for this part of the duration is a rest and not the turn of a stroke.
const REST: f64 = 0.08;
/// At its end a motion does come to rest: only what would outweigh the motion is left out.
const REST_AT_END: f64 = 0.25;

/// Times, positions and, where they are known, velocities: one each a sample.
#[derive(Debug, Clone, Default)]
pub struct Samples {
    pub t: Vec<f64>,
    pub x: Vec<DVector<f64>>,
    pub v: Option<Vec<DVector<f64>>>,
}

/// A time in which nothing moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    pub from: f64,
    pub to: f64,
}

impl Samples {
    pub fn len(&self) -> usize {
        self.t.len()
    }

    pub fn duration(&self) -> f64 {
        self.t.last().copied().unwrap_or(0.0) - self.t.first().copied().unwrap_or(0.0)
    }

    /// Keeps the samples for which `keep` holds, by index.
    pub fn retain(&mut self, keep: impl Fn(usize) -> bool) {
        fn only<T>(all: &mut Vec<T>, keep: &impl Fn(usize) -> bool) {
            let mut i = 0;
            all.retain(|_| {
                i += 1;
                keep(i - 1)
            });
        }
        only(&mut self.t, &keep);
        only(&mut self.x, &keep);
        if let Some(v) = &mut self.v {
            only(v, &keep);
        }
    }

    /// Diagonal of the box around the positions.
    pub fn size(&self) -> f64 {
        let Some(first) = self.x.first() else { return 0.0 };
        let (mut low, mut high) = (first.clone(), first.clone());
        for p in &self.x {
            low.zip_apply(p, |l, c| *l = l.min(c));
            high.zip_apply(p, |h, c| *h = h.max(c));
        }
        (high - low).norm()
    }

    /// The largest step between neighbours: the index it leads to, and its length.
    pub fn largest_step(&self) -> Option<(usize, f64)> {
        let steps = self.x.windows(2).map(|w| (&w[1] - &w[0]).norm());
        steps.enumerate().map(|(i, s)| (i + 1, s)).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Samples whose position is that of the sample before.
    pub fn held(&self) -> usize {
        self.x.windows(2).filter(|w| w[0] == w[1]).count()
    }

    /// At most `limit` samples, or two: means of as many neighbours each; the first and the last stay as they are.
    pub fn thinned(&self, limit: usize) -> Self {
        let n = self.len();
        let stride = n.div_ceil(limit.max(2));
        if stride <= 1 {
            return self.clone();
        }
        // Blocks of equal weight between the two ends.
        let inside = 1..n - 1;
        let blocks = (inside.len() / stride).max(1);
        let edge = |b: usize| inside.start + inside.len() * b / blocks;
        let mean = |all: &[DVector<f64>]| {
            let mut out = vec![all[0].clone()];
            for b in 0..blocks {
                let block = &all[edge(b)..edge(b + 1)];
                if let Some((first, rest)) = block.split_first() {
                    out.push(rest.iter().fold(first.clone(), |sum, p| sum + p) / block.len() as f64);
                }
            }
            out.push(all[n - 1].clone());
            out
        };
        let times: Vec<_> = self.t.iter().map(|&t| DVector::from_element(1, t - self.t[0])).collect();
        Self {
            t: mean(&times).iter().map(|t| self.t[0] + t[0]).collect(),
            x: mean(&self.x),
            v: self.v.as_deref().map(mean),
        }
    }

    /// Standard deviation of what moves from sample to sample without being motion: the median second difference, which
    /// smooth motion leaves small.
    pub fn noise(&self) -> f64 {
        let d = self.x.first().map_or(0, DVector::len);
        let mut largest: f64 = 0.0;
        for axis in 0..d {
            let mut bends: Vec<f64> =
                self.x.windows(3).map(|w| (w[0][axis] - 2.0 * w[1][axis] + w[2][axis]).abs()).collect();
            if bends.len() < 20 {
                continue;
            }
            bends.sort_by(f64::total_cmp);
            // Of a normal deviate the median is 0.6745 standard deviations, and the difference has the variance 6.
            largest = largest.max(bends[bends.len() / 2] / (0.6745 * 6.0_f64.sqrt()));
        }
        largest
    }

    /// Times in which the positions stay in one place for long.
    pub fn rests(&self) -> Vec<Rest> {
        // A few blocks per rest are enough, and bound the time.
        let coarse = self.thinned(MOST_SAMPLES);
        let size = coarse.size();
        let radius = (STILL * size + 4.0 * coarse.noise()).min(STILL_AT_MOST * size);
        let n = coarse.len();
        let mut rests = Vec::new();
        let mut i = 0;
        while i < n {
            let end = (i + 1..n).find(|&j| (&coarse.x[j] - &coarse.x[i]).norm() > radius).unwrap_or(n) - 1;
            // Creeping towards the end counts as being there.
            let last = &coarse.x[n - 1];
            let at_end = coarse.x[i..].iter().all(|p| (p - last).norm() <= 2.0 * STILL_AT_MOST * size);
            let least = if at_end { REST_AT_END } else { REST };
            if end > i + 1 && coarse.t[end] - coarse.t[i] >= least * coarse.duration() {
                rests.push(Rest { from: coarse.t[i], to: coarse.t[end] });
                i = end;
            } else {
                i += 1;
            }
        }
        rests
    }

    /// Leaves out rests. What follows one in the middle comes earlier.
    pub fn without(mut self, rests: &[Rest]) -> Self {
        let (Some(&first), Some(&last)) = (self.t.first(), self.t.last()) else { return self };
        let step = self.duration() / (self.len().max(2) - 1) as f64;
        for rest in rests.iter().rev() {
            let t = self.t.clone();
            if rest.from <= first {
                self.retain(|i| t[i] >= rest.to);
            } else if rest.to >= last {
                // Where it comes to rest is known better than any one sample says.
                let still: Vec<_> = self.x.iter().zip(&t).filter(|(_, t)| **t >= rest.from).map(|(x, _)| x).collect();
                let mean = still.iter().skip(1).fold(still[0].clone(), |sum, x| sum + *x) / still.len() as f64;
                self.retain(|i| t[i] <= rest.from);
                if let Some(end) = self.x.last_mut() {
                    *end = mean;
                }
            } else {
                self.retain(|i| t[i] <= rest.from || t[i] >= rest.to);
                let later = (rest.to - rest.from - step).max(0.0);
                self.t.iter_mut().filter(|t| **t >= rest.to).for_each(|t| *t -= later);
            }
        }
        self
    }

    /// At a given number of samples, equally spaced in time, on the cubic through neighbouring positions and velocities.
    /// Needs velocities.
    pub fn interpolated(&self, samples: usize) -> Self {
        let Some(v) = &self.v else { return self.clone() };
        if samples < 2 || self.len() < 2 {
            return self.clone();
        }
        let mut out = Self { v: Some(vec![]), ..Self::default() };
        let mut i = 0;
        for k in 0..samples {
            let t = self.t[0] + self.duration() * k as f64 / (samples - 1) as f64;
            while i + 2 < self.len() && self.t[i + 1] <= t {
                i += 1;
            }
            let h = self.t[i + 1] - self.t[i];
            let s = ((t - self.t[i]) / h).clamp(0.0, 1.0);
            let (a, b) = (&self.x[i], &self.x[i + 1]);
            let (s2, s3) = (s * s, s * s * s);
            out.t.push(t);
            out.x.push(
                a * (2.0 * s3 - 3.0 * s2 + 1.0)
                    + &v[i] * (h * (s3 - 2.0 * s2 + s))
                    + b * (3.0 * s2 - 2.0 * s3)
                    + &v[i + 1] * (h * (s3 - s2)),
            );
            if let Some(all) = &mut out.v {
                all.push(
                    (b - a) * (6.0 * (s - s2) / h)
                        + &v[i] * (3.0 * s2 - 4.0 * s + 1.0)
                        + &v[i + 1] * (3.0 * s2 - 2.0 * s),
                );
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A stroke of a second, with rests of the given lengths before, in the middle and after; 100 samples a second.
    fn with_rests(rests: [f64; 3]) -> Samples {
        let mut out = Samples::default();
        let total = 1.0 + rests.iter().sum::<f64>();
        let mut push = |t: f64| {
            let s =
                if t < rests[0] + 0.5 { (t - rests[0]).max(0.0) } else { (t - rests[0] - rests[1]).clamp(0.5, 1.0) };
            out.t.push(t);
            out.x.push(DVector::from_vec(vec![(1.0 - s) * (2.0 * s).cos(), 0.5 * (1.0 - s)]));
        };
        (0..=(total * 100.0).round() as usize).for_each(|i| push(i as f64 / 100.0));
        out
    }

    #[test]
    fn rests_are_found_and_left_out() {
        let plain = with_rests([0.0; 3]);
        assert_eq!(plain.rests(), []);
        for rests in [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.8], [0.3, 0.4, 1.0]] {
            let samples = with_rests(rests);
            let found = samples.rests();
            let wanted = rests.iter().filter(|r| **r > 0.0).count();
            assert_eq!(found.len(), wanted, "{rests:?}: {found:?}");
            let clean = samples.without(&found);
            assert!((clean.duration() - 1.0).abs() < 0.05, "{rests:?}: {}", clean.duration());
            assert!((clean.x.last().expect("some") - plain.x.last().expect("some")).norm() < 0.01);
            assert!(clean.t.windows(2).all(|w| w[1] > w[0]));
            assert!(clean.largest_step().expect("some").1 < 0.05, "{rests:?}");
        }
    }

    #[test]
    fn a_short_stop_at_the_end_stays() {
        assert_eq!(with_rests([0.0, 0.0, 0.2]).rests(), []);
    }

    #[test]
    fn noise_is_measured() {
        let mut samples = with_rests([0.0; 3]);
        assert!(samples.noise() < 2e-4, "{}", samples.noise());
        // A normal deviate, near enough: the sum of twelve uniform ones.
        let mut state = 1_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        samples.x.iter_mut().for_each(|p| p.apply(|c| *c += 0.01 * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0)));
        assert!((samples.noise() / 0.01 - 1.0).abs() < 0.35, "{}", samples.noise());
    }

    proptest! {
        #[test]
        fn thinning_keeps_the_ends_and_the_order(n in 2usize..5000, limit in 0usize..400) {
            let samples = Samples {
                t: (0..n).map(|i| 5.0 + i as f64).collect(),
                x: (0..n).map(|i| DVector::from_element(2, i as f64)).collect(),
                v: Some(vec![DVector::from_element(2, 1.0); n]),
            };
            let few = samples.thinned(limit);
            prop_assert!(few.len() >= 2 && few.len() <= limit.max(2) + 2, "{}", few.len());
            prop_assert_eq!((few.t[0], few.t[few.len() - 1]), (5.0, 4.0 + n as f64));
            prop_assert!(few.t.windows(2).all(|w| w[1] > w[0]));
            // Position and time are averaged alike.
            prop_assert!(few.t.iter().zip(&few.x).all(|(t, x)| (t - 5.0 - x[0]).abs() < 1e-9 * n as f64));
            prop_assert!(few.v.expect("given").iter().all(|v| (v[0] - 1.0).abs() < 1e-12));
        }

        #[test]
        fn interpolation_is_exact_for_cubics(n in 3usize..40, count in 2usize..100) {
            let x = |t: f64| DVector::from_vec(vec![1.0 - 2.0 * t + t * t * t, t * t]);
            let v = |t: f64| DVector::from_vec(vec![-2.0 + 3.0 * t * t, 2.0 * t]);
            let t: Vec<f64> = (0..n).map(|i| 2.0 * i as f64 / (n - 1) as f64).collect();
            let samples = Samples { x: t.iter().map(|&t| x(t)).collect(), v: Some(t.iter().map(|&t| v(t)).collect()), t };
            let many = samples.interpolated(count);
            prop_assert_eq!(many.len(), count);
            let velocities = many.v.expect("given");
            for (i, &t) in many.t.iter().enumerate() {
                prop_assert!((&many.x[i] - x(t)).norm() < 1e-9 && (&velocities[i] - v(t)).norm() < 1e-9, "{t}");
            }
        }
    }
}
