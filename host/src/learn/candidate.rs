//! One attempt at a model: grouped, fitted by a convex programme, refined.

use super::beside;
use super::evaluate::Motion;
use super::field::Field;
use super::fit::Gram;
use super::gmm::{self, Mixture, Samples};
use super::quality::{self, Quality, Recording};
use super::reference::{INSIDE, Track, admissible};
use super::refine::{Path, Task, Weights, refine};
use super::taught::Taught;
use nalgebra::{SMatrix, SVector};

/// Errors of the same weight, as parts of the extent, of the mean speed, and of one.
const SAME_PATH: f64 = 0.02;
const SAME_SPEED: f64 = 0.14;
const SAME_DIRECTION: f64 = 0.034;
/// What a rollout from beside the demonstrations costs that does not arrive in time.
const LATE: f64 = 0.3;
/// Up to this many demonstrations have companions to be followed as well; the starts of more are spread by themselves.
pub const FEW: usize = 4;
/// What the companions count in the path's error, against one for the demonstrations.
const COMPANY: f64 = 3.0;
/// Steps of a rollout beside a companion, and how many times its duration it has.
const STEPS: f64 = 100.0;
const PATIENCE: f64 = 2.0;

/// How samples are grouped to start from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grouping {
    /// By a mixture over position and direction.
    Mixture,
    /// By how far along its demonstration a sample is, in length, turning and time.
    Segments,
}

/// How long a start is refined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// Until most motions gain little.
    Usual,
    /// Longer along what was shown, for those that are still poor.
    More,
}

impl Effort {
    /// Rounds of refinement: of velocities alone, with rollouts along the reference paths, with rollouts along what was shown.
    fn rounds(self) -> [usize; 3] {
        match self {
            Self::Usual => [20, 15, 10],
            Self::More => [20, 10, 25],
        }
    }
}

/// What is tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Attempt {
    /// Number of components.
    pub components: usize,
    /// Of samples, to start from.
    pub grouping: Grouping,
    /// Of refinement.
    pub effort: Effort,
    /// Zero for the first of its kind, another number for other random choices.
    pub again: u64,
}

/// What every attempt at one skill shares, in normalised units.
pub struct Lesson<'a, const D: usize> {
    /// As demonstrated.
    pub shown: &'a [Track<D>],
    /// What is learnt along each.
    pub taught: &'a [Taught<D>],
    /// Of V.
    pub p: SMatrix<f64, D, D>,
    /// Rate of the certificate.
    pub sigma: f64,
    /// Weight of direction against position where a mixture groups.
    pub direction: f64,
    /// Share of being on time on the path.
    pub pace: f64,
    /// Of random choices.
    pub seed: u64,
}

/// A refined model and what it is worth: less is better, about three for a good one.
pub struct Candidate<const D: usize> {
    /// The model.
    pub field: Field<D>,
    /// Its mixture.
    pub mixture: Mixture<D>,
    /// Its errors, in multiples of a good model's.
    pub score: f64,
    /// The part of it that is the path's.
    pub path: f64,
}

impl<const D: usize> Lesson<'_, D> {
    /// Learns so; `None` where no start works.
    pub fn attempt(&self, attempt: Attempt) -> Option<Candidate<D>> {
        let Attempt { components, grouping, effort, again } = attempt;
        let seed = self.seed.wrapping_add(again);
        let mut targets = Samples { x: vec![], v: vec![] };
        let (mut piece, mut belief) = (vec![], vec![]);
        for one in self.taught {
            targets.x.extend(&one.samples.x);
            targets.v.extend(&one.samples.v);
            belief.extend(&one.belief);
            piece.extend(one.pieces(components));
        }
        let mixture = match grouping {
            Grouping::Segments => gmm::labelled(&targets.x, &piece, components),
            Grouping::Mixture => {
                // A quarter of the samples says as well where they are.
                let stride = targets.x.len().div_ceil(350).max(1);
                let thin = |all: &[SVector<f64, D>]| all.iter().copied().step_by(stride).collect();
                let few = Samples { x: thin(&targets.x), v: thin(&targets.v) };
                gmm::fit(&few, components, self.direction, seed)
            }
        }?;
        let start = Gram::new(&targets, &mixture).solve_for(&self.p, self.sigma, 2).ok()?;
        let mut field = Field::new(&mixture, &start.p, &start.a, self.sigma)?;

        // A single component is linear: it lingers nowhere, and the samples alone say what it is.
        if components > 1 {
            let references: Vec<_> = self.taught.iter().map(|one| one.reference.clone()).collect();
            for (x, v) in beside::tube(&references, seed) {
                belief.push(1.0);
                targets.v.push(admissible(&x, &v, &self.p, self.sigma * INSIDE));
                targets.x.push(x);
            }
        }
        let mut followed: Vec<_> = self.taught.iter().map(|one| one.reference.after_start()).collect();
        let mut shown: Vec<_> = self.shown.iter().map(Track::after_start).collect();
        let mut company = vec![];
        if self.shown.len() <= FEW {
            followed.extend(self.taught.iter().flat_map(|one| beside::companions(&one.reference)));
            company.extend(self.shown.iter().flat_map(beside::companions));
            shown.extend(company.iter().cloned());
        }
        let [alone, along, to_the_end] = effort.rounds();
        let weights = Weights { path: 0.0, pace: self.pace, ..Weights::default() };
        let mut task = Task { x: &targets.x, v: &targets.v, belief: &belief, tracks: &followed, weights };
        field = improve(field, &task, alone);
        task.weights.path = Weights::default().path;
        field = improve(field, &task, along);
        // Near enough to follow through to the end, whatever happens on the way.
        task.weights.leash = f64::INFINITY;
        task.tracks = &shown;
        field = improve(field, &task, to_the_end);

        let mixture = field.mixture()?;
        let motion = Motion {
            attractor: SVector::zeros(),
            mixture: mixture.clone(),
            a: field.parts.iter().map(|c| c.a).collect(),
        };
        let recordings: Vec<_> =
            self.shown.iter().map(|t| Recording { t: t.t.clone(), x: t.x.clone(), v: t.v.clone() }).collect();
        let mut quality = quality::measure(&motion, &recordings, 1.0);
        if !company.is_empty() {
            quality.path_error = (quality.path_error + COMPANY * astray(&motion, &company)) / (1.0 + COMPANY);
        }
        let (score, path) = (score(&quality), quality.path_error / SAME_PATH);
        score.is_finite().then_some(Candidate { field, mixture, score, path })
    }
}

fn improve<const D: usize>(field: Field<D>, task: &Task<D>, rounds: usize) -> Field<D> {
    if D == 2 { refine::<D, 10>(field, task, rounds) } else { refine::<D, 19>(field, task, rounds) }
}

/// The mean distance of rollouts from the paths from whose starts they begin.
fn astray<const D: usize>(motion: &Motion<D>, paths: &[Path<D>]) -> f64 {
    let one = |path: &Path<D>| {
        let (rollout, _) = motion.rollout(&path.x[0], path.duration / STEPS, PATIENCE * path.duration, quality::NEAR);
        quality::warping_distance(&quality::resample(&path.x), &quality::resample(&rollout)).1
    };
    paths.iter().map(one).sum::<f64>() / paths.len().max(1) as f64
}

/// Errors in multiples of a good model's, and a rollout that does not arrive counts more than any error.
fn score(q: &Quality) -> f64 {
    let stranded = (q.rollouts - q.converged) as f64;
    let late = (q.beside - q.robust) as f64;
    q.path_error / SAME_PATH + q.rmse / SAME_SPEED + q.e_dot / SAME_DIRECTION + 100.0 * stranded + LATE * late
}
