//! How many components a skill has: as many as foretell best what a demonstrator does who was not learnt from (cross-validation, Stone 1974).
//!
//! ```text
//! K = the least K with E(K) <= min E + ENOUGH,   E(K) = mean over demonstrations d of  mean over d's samples of  c(v) |f_K^(-d)(x) - v|^2
//! ```
//!
//! f_K^(-d) is learnt from the others: its samples grouped by how far along they are, and A_k by the convex programme, neither of which takes random
//! choices or rollouts; c(v) is that programme's own weight, more for slow samples. P is that of all demonstrations: it is one for every K.
//! Of many demonstrations more than one are kept out at a time.
//!
//! No more components are tried than the demonstrations can speak for, and than a device has time for in every tick.

use super::fit::Gram;
use super::gmm::{self, Samples};
use super::taught::Taught;
use nalgebra::SMatrix;

/// What is tried.
const TRIED: [usize; 5] = [1, 2, 4, 8, MOST];
/// A device evaluates every component in every tick; beyond these what is held out gains little.
const MOST: usize = 12;
/// Demonstrations are held out in this many groups, or each by itself where they are no more.
const FOLDS: usize = 7;
/// A difference of squared velocity errors that means nothing: a hundredth of the speed.
const ENOUGH: f64 = 1e-4;

/// Components that this many demonstrations can speak for: a stroke has about twenty numbers to give, a component takes ten; and no more than
/// there are samples.
pub fn most(demonstrations: usize, samples: usize) -> usize {
    (2 + 2 * demonstrations).min(samples).clamp(1, MOST)
}

/// How many of `most` components, or less, foretell best what is held out. With one demonstration there is nothing to hold out, and it is `most`.
pub fn foretelling_best<const D: usize>(
    taught: &[Taught<D>],
    p: &SMatrix<f64, D, D>,
    sigma: f64,
    most: usize,
) -> usize {
    if taught.len() < 2 {
        return most;
    }
    let tried = TRIED.iter().copied().filter(|k| *k < most).chain([most]);
    let errors: Vec<_> = tried.filter_map(|k| Some((k, held_out(taught, p, sigma, k)?))).collect();
    let least = errors.iter().map(|e| e.1).fold(f64::INFINITY, f64::min);
    errors.iter().find(|e| e.1 <= least + ENOUGH).map_or(most, |e| e.0)
}

/// E(K); `None` where the others of a demonstration do not make a model.
fn held_out<const D: usize>(
    taught: &[Taught<D>],
    p: &SMatrix<f64, D, D>,
    sigma: f64,
    components: usize,
) -> Option<f64> {
    let folds = taught.len().min(FOLDS);
    let mut sum = 0.0;
    for fold in 0..folds {
        let (mut shown, mut piece) = (Samples { x: vec![], v: vec![] }, vec![]);
        for (_, one) in taught.iter().enumerate().filter(|(i, _)| i % folds != fold) {
            shown.x.extend(&one.samples.x);
            shown.v.extend(&one.samples.v);
            piece.extend(one.pieces(components));
        }
        let mixture = gmm::labelled(&shown.x, &piece, components)?;
        let fit = Gram::new(&shown, &mixture).solve_for(p, sigma, 2).ok()?;
        sum += taught
            .iter()
            .skip(fold)
            .step_by(folds)
            .map(|out| Gram::new(&out.samples, &mixture).error(&fit.a))
            .sum::<f64>();
    }
    let mean = sum / taught.len() as f64;
    mean.is_finite().then_some(mean)
}
