//! How many components a skill has: as many as foretell best what a demonstrator does who was not learnt from (cross-validation, Stone 1974).
//!
//! ```text
//! K = the least K with E(K) <= 1.02 min E + 0.001,   E(K) = mean over all samples (x, v) of |f_K^(-d)(x) - v|, d the sample's demonstration
//! ```
//!
//! f_K^(-d) is learnt from the others: its samples grouped by how far along they are, and A_k by the convex programme, neither of which takes random
//! choices or rollouts: it takes milliseconds. P is that of all demonstrations, one for every K. In normalised units: speeds are shares of the mean.
//!
//! P, the attractor and the units are those of all demonstrations, held out or not; v is what is learnt along them, which V must be able to follow.
//!
//! No more components are tried than the demonstrations can speak for, and than a device holds. Of four demonstrations or less each may be the only one in its
//! part of the plane, and the others do not foretell it: there K is as many as they can speak for, and six are refined beside it.

use super::candidate::FEW;
use super::evaluate::Motion;
use super::fit::Gram;
use super::gmm::{self, MAX_COMPONENTS, Samples};
use super::taught::Taught;
use nalgebra::{SMatrix, SVector};

/// What is tried: what is held out does not tell apart numbers that are closer. The next one would be more than a device holds.
const TRIED: [usize; 4] = [1, 3, 6, MOST];
const MOST: usize = 12;
const _: () = assert!(MOST <= MAX_COMPONENTS && 2 * MOST > MAX_COMPONENTS);
/// Demonstrations are held out in this many groups, or each by itself where they are no more.
const FOLDS: usize = 7;
/// Errors that differ by less than this share tell nothing, nor do differences of a thousandth of the mean speed.
const ALIKE: f64 = 0.02;
const NOTHING: f64 = 1e-3;

/// Components that this many demonstrations can speak for: a stroke has about twenty numbers to give, a component takes ten; and no more than
/// there are samples.
pub fn most(demonstrations: usize, samples: usize) -> usize {
    (2 + 2 * demonstrations).min(samples).clamp(1, MOST)
}

/// How many of `most` components, or less, foretell best what is held out. With few demonstrations it is `most`.
pub fn foretelling_best<const D: usize>(
    taught: &[Taught<D>],
    p: &SMatrix<f64, D, D>,
    sigma: f64,
    most: usize,
) -> usize {
    if taught.len() <= FEW {
        return most;
    }
    let tried = TRIED.iter().copied().filter(|k| *k < most).chain([most]);
    let errors: Vec<_> = tried.filter_map(|k| Some((k, held_out(taught, p, sigma, k)?))).collect();
    let least = errors.iter().map(|e| e.1).fold(f64::INFINITY, f64::min);
    errors.iter().find(|e| e.1 <= least * (1.0 + ALIKE) + NOTHING).map_or(most, |e| e.0)
}

/// E(K); `None` where the others of a demonstration do not make a model.
fn held_out<const D: usize>(
    taught: &[Taught<D>],
    p: &SMatrix<f64, D, D>,
    sigma: f64,
    components: usize,
) -> Option<f64> {
    let folds = taught.len().min(FOLDS);
    let (mut sum, mut count) = (0.0, 0);
    for fold in 0..folds {
        let (mut shown, mut piece) = (Samples { x: vec![], v: vec![] }, vec![]);
        for (_, one) in taught.iter().enumerate().filter(|(i, _)| i % folds != fold) {
            shown.x.extend(&one.samples.x);
            shown.v.extend(&one.samples.v);
            piece.extend(one.pieces(components));
        }
        let mixture = gmm::labelled(&shown.x, &piece, components)?;
        let fit = Gram::new(&shown, &mixture).solve_for(p, sigma, 2).ok()?;
        let foretold = Motion { attractor: SVector::zeros(), mixture, a: fit.a };
        for Samples { x, v } in taught.iter().skip(fold).step_by(folds).map(|out| &out.samples) {
            sum += x.iter().zip(v).map(|(x, v)| (foretold.velocity(x) - v).norm()).sum::<f64>();
            count += x.len();
        }
    }
    let mean = sum / count.max(1) as f64;
    mean.is_finite().then_some(mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learn::reference::{INSIDE, Track, search};
    use nalgebra::{Matrix2, Rotation2, Vector2};
    use proptest::prelude::*;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    const SIGMA: f64 = 0.01;

    /// What is learnt along tracks whose velocities are disturbed by up to `noise` of the mean speed, and its P.
    fn taught(mut tracks: Vec<Track<2>>, noise: f64, seed: u64) -> (Vec<Taught<2>>, Matrix2<f64>) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let all: Vec<f64> = tracks.iter().flat_map(|t| &t.v).map(Vector2::norm_squared).collect();
        let speed = (all.iter().sum::<f64>() / all.len() as f64).sqrt();
        for track in &mut tracks {
            track.t.iter_mut().for_each(|t| *t *= speed);
            let mut off = || noise * (2.0 * rng.random::<f64>() - 1.0);
            track.v.iter_mut().for_each(|v| *v = *v / speed + Vector2::new(off(), off()));
        }
        let p = search(&tracks, SIGMA);
        (tracks.iter().map(|t| Taught::new(t, &p, SIGMA * INSIDE)).collect(), p)
    }

    /// The motion of one matrix A from `count` starts until it is slow: a single component.
    fn linear(a: &Matrix2<f64>, count: usize) -> Vec<Track<2>> {
        let dt = 0.02;
        let one = |start: usize| {
            let mut track = Track { x: vec![], v: vec![], t: vec![], shift: 0.0 };
            let mut x = Rotation2::new(0.2 * start as f64) * Vector2::new(0.7, 0.1);
            while x.norm() > 0.2 {
                track.t.push(dt * track.t.len() as f64);
                track.x.push(x);
                track.v.push(a * x);
                x += a * (x + a * x * (dt / 2.0)) * dt;
            }
            track
        };
        (0..count).map(one).collect()
    }

    /// Along a line to the origin, swinging across it `swings` times: some components a swing.
    fn swinging(swings: f64, count: usize) -> Vec<Track<2>> {
        let one = |which: usize| {
            let (high, turn) = (0.12 + 0.005 * which as f64, std::f64::consts::TAU * swings);
            let at = |s: f64| Vector2::new(1.0 - s, high * (turn * (1.0 - s)).sin());
            let slope = |s: f64| Vector2::new(-1.0, -high * turn * (turn * (1.0 - s)).cos());
            let t: Vec<f64> = (0..=120).map(|i| f64::from(i) / 120.0).collect();
            Track { x: t.iter().map(|&s| at(s)).collect(), v: t.iter().map(|&s| slope(s)).collect(), t, shift: 0.0 }
        };
        (0..count).map(one).collect()
    }

    fn chosen(tracks: Vec<Track<2>>, noise: f64, seed: u64) -> usize {
        let (taught, p) = taught(tracks, noise, seed);
        foretelling_best(&taught, &p, SIGMA, MOST)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        /// More components would follow noise that nobody repeats.
        #[test]
        fn what_one_component_does_gets_few(
            decay in 0.5..1.5f64, lean in -0.4..0.4f64, spin in -1.0..1.0f64, noise in 0.0..0.5f64, count in 5usize..9, seed: u64,
        ) {
            let a = Matrix2::new(-decay, spin + lean, lean - spin, -1.0);
            let k = chosen(linear(&a, count), noise, seed);
            prop_assert!(k <= 3, "{k}");
        }

        /// The same noise does not hide what takes many.
        #[test]
        fn a_motion_with_many_swings_gets_many(noise in 0.0..0.5f64, count in 5usize..9, seed: u64) {
            let k = chosen(swinging(3.0, count), noise, seed);
            prop_assert!(k == MOST, "{k}");
        }
    }

    #[test]
    fn few_demonstrations_get_what_they_can_speak_for() {
        let (few, p) = taught(linear(&Matrix2::new(-1.0, 0.5, -0.5, -1.0), 4), 0.0, 0);
        assert_eq!(foretelling_best(&few, &p, SIGMA, most(4, 120)), 10);
        assert_eq!([most(1, 2), most(2, 1000), most(5, 1000), most(100, 100_000)], [2, 6, MOST, MOST]);
    }
}
