//! Learning a skill from demonstrations.
//!
//! Files are read and checked ([`read()`]), brought to one attractor, and normalised. P is found, then how many components foretell best what is
//! held out; Gaussian mixtures of that many and A_k under the certificate are refined, and the best is kept ([`learn`]). The result is a [`ModelFile`], rounded to f32 so that every machine runs the
//! same numbers, with its certificate checked on them.

mod beside;
mod between;
mod candidate;
mod cleaning;
mod components;
mod cone;
pub mod demonstration;
mod error;
pub mod evaluate;
mod field;
pub mod fit;
pub mod gmm;
mod held_out;
pub mod memory;
mod outlier;
pub mod quality;
pub mod read;
mod reference;
mod refine;
mod smoothing;
mod taught;
mod warning;

pub use demonstration::{Demonstration, Demonstrations, Unit};
pub use error::LearnError;
pub use held_out::held_out;
pub use quality::Quality;
pub use read::read;
pub use warning::Warning;

use crate::model::{ComponentFile, FORMAT, ModelFile, Provenance, rounded};
use candidate::{Attempt, Candidate, Effort, FEW, Grouping, Lesson};
use evaluate::Motion;
use gmm::{MAX_COMPONENTS, Mixture};
use nalgebra::{SMatrix, SVector};
use pliant_core::Fixed;
use std::path::PathBuf;
use taught::Taught;

/// Samples of a demonstration used for fitting; more add time and little else.
const TRACK_SAMPLES: usize = 200;

/// How to learn.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Name of the skill in the model file.
    pub name: String,
    /// Unit of lengths in the files. Without it: centimetres for .mat (LASA handwriting at ten times its size),
    /// metres for .csv.
    pub unit: Option<Unit>,
    /// Number of components, 1 to 16; chosen where not given.
    pub components: Option<usize>,
    /// Seed of all random choices.
    pub seed: u64,
    /// Guaranteed rate of convergence, 1/s.
    pub sigma: f64,
    /// Weight of the direction of motion against position (in extents) when samples are grouped.
    pub direction_weight: f64,
    /// Weight of being on time on the path, against being on it, 0 to 10.
    pub pace: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            name: "skill".into(),
            unit: None,
            components: None,
            seed: 1,
            sigma: 0.01,
            direction_weight: 1.0,
            pace: 0.1,
        }
    }
}

/// A learnt skill.
#[derive(Debug, Clone)]
pub struct Learnt {
    /// The model, certified in f32 and f64.
    pub model: ModelFile,
    /// How well it follows the demonstrations.
    pub quality: Quality,
    /// How far the demonstrations had to give way so that V falls along them, m, the mean over samples: no skill with a certificate of this
    /// kind follows them closer.
    pub gives_way: f64,
    /// What it was learnt from, in metres and ending at the attractor.
    pub demonstrations: Demonstrations,
}

impl Learnt {
    /// The demonstrations from whose starts the motion does not arrive in ten times their duration, by name. The certificate says that it arrives
    /// some day; nobody waits for that.
    pub fn stranded(&self) -> Vec<&str> {
        match self.model.dimension {
            2 => self.stranded_in::<2>(),
            _ => self.stranded_in::<3>(),
        }
    }

    /// The rate sigma, 1/s, at which no demonstration's start can be stranded: the certificate of that rate keeps |x - x*| below
    /// sqrt(cond P) e^(-sigma t) of what it was, and cond P is bounded.
    pub fn arriving_rate(&self) -> f64 {
        let shortest = self.demonstrations.items().iter().map(Demonstration::duration).fold(f64::INFINITY, f64::min);
        (fit::MAX_CONDITION.sqrt() / quality::NEAR).ln() / (quality::LIMIT * shortest)
    }

    fn stranded_in<const D: usize>(&self) -> Vec<&str> {
        let Some(motion) = motion_of::<D>(&self.model) else { return vec![] };
        let (items, extent) = (self.demonstrations.items(), self.demonstrations.extent());
        let paths = recordings::<D>(&self.demonstrations);
        let lost = items.iter().zip(&paths).filter(|(_, path)| !quality::rollout(&motion, path, extent).1);
        lost.map(|(item, _)| item.name.as_str()).collect()
    }
}

/// Learns a skill from files and folders. `progress` is told the part that is done, 0 to 1.
pub fn learn(paths: &[PathBuf], options: &Options, progress: &dyn Fn(f64)) -> Result<Learnt, LearnError> {
    learn_from(read(paths, options.unit)?, options, progress)
}

/// Learns a skill from demonstrations.
pub fn learn_from(
    demonstrations: Demonstrations,
    options: &Options,
    progress: &dyn Fn(f64),
) -> Result<Learnt, LearnError> {
    let refuse = |option, value: String, allowed| Err(LearnError::Option { option, value, allowed });
    if let Some(k) = options.components
        && !(1..=MAX_COMPONENTS).contains(&k)
    {
        return refuse("components", k.to_string(), "1 to 16");
    }
    if !(0.0..=10.0).contains(&options.sigma) {
        return refuse("sigma", options.sigma.to_string(), "0 to 10 1/s");
    }
    if !(0.0..=10.0).contains(&options.direction_weight) {
        return refuse("direction_weight", options.direction_weight.to_string(), "0 to 10");
    }
    if !(0.0..=10.0).contains(&options.pace) {
        return refuse("pace", options.pace.to_string(), "0 to 10");
    }
    match demonstrations.dimension() {
        2 => learn_in::<2>(demonstrations, options, progress),
        _ => learn_in::<3>(demonstrations, options, progress),
    }
}

/// The units in which fitting is well conditioned: the extent is one, and so is the root-mean-square speed.
struct Scale<const D: usize> {
    attractor: SVector<f64, D>,
    length: f64,
    speed: f64,
}

impl<const D: usize> Scale<D> {
    fn of(demonstrations: &Demonstrations, recordings: &[quality::Recording<D>]) -> Self {
        let squares: f64 = recordings.iter().flat_map(|r| &r.v).map(|v| v.norm_squared()).sum();
        let speed = (squares / demonstrations.samples().max(1) as f64).sqrt();
        let attractor = SVector::from_column_slice(demonstrations.attractor().as_slice());
        // A recording with velocities of zero throughout still has a scale.
        Self { attractor, length: demonstrations.extent(), speed: if speed > 0.0 { speed } else { 1.0 } }
    }
}

fn fixed<const D: usize>(all: &[nalgebra::DVector<f64>]) -> Vec<SVector<f64, D>> {
    all.iter().map(|p| SVector::from_column_slice(p.as_slice())).collect()
}

/// From few demonstrations a bad start is not made up for by the others: where the path's error, in multiples of a good one's, is beyond this, more
/// starts are tried, this many times both groupings.
const AMISS: f64 = 0.75;
const AGAIN: u64 = 3;
/// A score that leaves something to wish for.
const POOR: f64 = 6.0;
/// How much more than otherwise the path counts among those that are poor: velocities they cannot have, so what is left to choose is where they go.
const FOLLOW: f64 = 2.0;
/// What a component has to gain: a device evaluates every one in every tick.
const PRICE: f64 = 0.01;

/// Where demonstrations are too few to choose by, so many are tried as well.
const SIX: usize = 6;

/// All that may be tried with this many components: both groupings, and from few demonstrations again; where the number was chosen and all before
/// are poor, longer as well.
fn attempts(components: usize, chosen: bool, demonstrations: usize) -> Vec<Attempt> {
    let both = |effort, again| {
        [Grouping::Mixture, Grouping::Segments].map(|grouping| Attempt { components, grouping, effort, again })
    };
    let mut all = vec![];
    if chosen && demonstrations <= FEW && components > SIX {
        all.push(Attempt { components: SIX, grouping: Grouping::Segments, effort: Effort::Usual, again: 0 });
    }
    all.extend(both(Effort::Usual, 0));
    if chosen {
        all.extend(both(Effort::More, 0));
    }
    if demonstrations <= FEW {
        all.extend((1..=AGAIN).flat_map(|again| both(Effort::Usual, again)));
    }
    all
}

fn learn_in<const D: usize>(
    demonstrations: Demonstrations,
    options: &Options,
    progress: &dyn Fn(f64),
) -> Result<Learnt, LearnError> {
    let recordings = recordings::<D>(&demonstrations);
    let scale = Scale::of(&demonstrations, &recordings);
    let tracks = tracks(&recordings, demonstrations.shifts(), &scale);
    progress(0.0);
    let sigma = options.sigma * scale.length / scale.speed;
    let p = reference::search(&tracks, sigma);
    let taught: Vec<_> = tracks.iter().map(|track| Taught::new(track, &p, sigma * reference::INSIDE)).collect();
    let components = options.components.unwrap_or_else(|| {
        components::foretelling_best(&taught, &p, sigma, components::most(tracks.len(), demonstrations.samples()))
    });
    let attempts = attempts(components, options.components.is_none(), tracks.len());
    let lesson = Lesson {
        shown: &tracks,
        taught: &taught,
        p,
        sigma,
        direction: options.direction_weight,
        pace: options.pace,
        seed: options.seed,
    };
    let mut best: Option<(f64, f64, ModelFile)> = None;
    let mut failure = String::from("no mixture fits the samples");
    for (i, attempt) in attempts.iter().enumerate() {
        let good = best.as_ref().is_some_and(|b| match attempt {
            Attempt { again: 1.., .. } => b.1 < AMISS,
            Attempt { effort: Effort::More, .. } => b.0 < POOR,
            _ => false,
        });
        if good {
            continue;
        }
        let follow = if attempt.effort == Effort::More { FOLLOW } else { 0.0 };
        if let Some(candidate) = lesson.attempt(*attempt) {
            let price = 1.0 + PRICE * candidate.mixture.len() as f64;
            let (score, path) = (candidate.score * price, candidate.path * price);
            if best.as_ref().is_none_or(|b| score + follow * path < b.0 + follow * b.1) {
                match model_of(candidate, sigma, &scale, options) {
                    Ok(model) => best = Some((score, path, model)),
                    Err(reason) => failure = reason,
                }
            }
        }
        progress((i + 1) as f64 / (attempts.len() + 1) as f64);
    }
    let Some((.., mut model)) = best else { return Err(LearnError::Fit { reason: failure }) };
    let Some(motion) = motion_of::<D>(&model) else { return Err(LearnError::Fit { reason: failure }) };
    let quality = quality::measure(&motion, &recordings, demonstrations.extent());
    // The proof of what will run, free of rounding itself.
    model.proof::<f32>().and_then(|_| model.proof::<f64>()).map_err(|e| LearnError::Fit { reason: e.to_string() })?;
    model.learnt = Some(provenance(options, &demonstrations, &quality));
    model.validate()?;
    progress(1.0);
    let away: Vec<f64> = tracks.iter().flat_map(|t| reference::follow(t, &lesson.p, sigma).1).collect();
    let gives_way = scale.length * away.iter().sum::<f64>() / away.len().max(1) as f64;
    Ok(Learnt { model, quality, gives_way, demonstrations })
}

/// Rounds to f32 and checks the certificate on the rounded numbers.
fn model_of<const D: usize>(
    candidate: Candidate<D>,
    sigma: f64,
    scale: &Scale<D>,
    options: &Options,
) -> Result<ModelFile, String> {
    let Candidate { field, mixture, .. } = candidate;
    let mut fit = fit::Stable { p: field.p, a: field.parts.iter().map(|c| c.a).collect(), error: 0.0 };
    let mut strictness = sigma;
    let mut floating = None;
    for _ in 0..6 {
        fit::repair(&mut fit, strictness).ok_or("the inequality cannot be met")?;
        let model = denormalise(&fit, &mixture, scale, options);
        if model.certified::<f32>() && model.certified::<f64>() {
            if model.certified::<Fixed>() {
                return Ok(model);
            }
            floating = floating.or(Some(model));
        }
        // Rounding used up the margin: ask for more.
        strictness += 0.02;
    }
    // Very slow or very large, a skill may have no room in fixed point; in f32 it must hold.
    floating.ok_or("the certificate does not survive rounding to f32".into())
}

/// The demonstrations in the form that motions of the dimension D are compared with.
pub fn recordings<const D: usize>(demonstrations: &Demonstrations) -> Vec<quality::Recording<D>> {
    let one = |d: &Demonstration| quality::Recording { t: d.t.clone(), x: fixed(&d.x), v: fixed(&d.v) };
    demonstrations.items().iter().map(one).collect()
}

fn tracks<const D: usize>(
    recordings: &[quality::Recording<D>],
    shifts: &[f64],
    scale: &Scale<D>,
) -> Vec<reference::Track<D>> {
    recordings
        .iter()
        .zip(shifts)
        .map(|(r, shift)| {
            let stride = r.x.len().div_ceil(TRACK_SAMPLES).max(1);
            let x = r.x.iter().map(|x| (x - scale.attractor) / scale.length).step_by(stride).collect();
            let v = r.v.iter().map(|v| v / scale.speed).step_by(stride).collect();
            let t = r.t.iter().map(|t| (t - r.t[0]) * scale.speed / scale.length).step_by(stride).collect();
            between::filled(&reference::Track { x, v, t, shift: shift / scale.length })
        })
        .collect()
}

fn denormalise<const D: usize>(
    fit: &fit::Stable<D>,
    mixture: &Mixture<D>,
    scale: &Scale<D>,
    options: &Options,
) -> ModelFile {
    let rows = |m: &SMatrix<f64, D, D>| {
        (0..D).map(|r| (0..D).map(|c| rounded(m[(r, c)])).collect()).collect::<Vec<Vec<f64>>>()
    };
    let vector = |v: &SVector<f64, D>| v.iter().map(|&c| rounded(c)).collect::<Vec<f64>>();
    let component = mixture
        .components()
        .zip(&fit.a)
        .map(|((prior, mean, covariance), a)| ComponentFile {
            prior: rounded(prior),
            mean: vector(&(mean * scale.length + scale.attractor)),
            covariance: rows(&(covariance * scale.length.powi(2))),
            a: rows(&(a * (scale.speed / scale.length))),
        })
        .collect();
    ModelFile {
        format: FORMAT,
        name: options.name.clone(),
        dimension: D,
        attractor: vector(&scale.attractor),
        lyapunov: rows(&((fit.p + fit.p.transpose()) * 0.5)),
        component,
        learnt: None,
    }
}

/// The motion of a model in f64, for the dimension D; `None` where the model is of another dimension or not valid.
pub fn motion_of<const D: usize>(model: &ModelFile) -> Option<Motion<D>> {
    if model.dimension != D || model.validate().is_err() {
        return None;
    }
    let vector = |v: &[f64]| SVector::<f64, D>::from_column_slice(v);
    let matrix = |m: &[Vec<f64>]| SMatrix::<f64, D, D>::from_fn(|r, c| m[r][c]);
    let parts = &model.component;
    let mixture = Mixture::new(
        parts.iter().map(|c| c.prior).collect(),
        parts.iter().map(|c| vector(&c.mean)).collect(),
        parts.iter().map(|c| matrix(&c.covariance)).collect(),
    )?;
    let a = parts.iter().map(|c| matrix(&c.a)).collect();
    Some(Motion { attractor: vector(&model.attractor), mixture, a })
}

/// How well any model follows any demonstrations; `None` where their dimensions differ.
pub fn evaluate(model: &ModelFile, demonstrations: &Demonstrations) -> Option<Quality> {
    fn inside<const D: usize>(model: &ModelFile, demonstrations: &Demonstrations) -> Option<Quality> {
        let paths = recordings::<D>(demonstrations);
        Some(quality::measure(&motion_of::<D>(model)?, &paths, demonstrations.extent()))
    }
    match (model.dimension, demonstrations.dimension()) {
        (2, 2) => inside::<2>(model, demonstrations),
        (3, 3) => inside::<3>(model, demonstrations),
        _ => None,
    }
}

fn provenance(options: &Options, demonstrations: &Demonstrations, quality: &Quality) -> Provenance {
    let float = |x: f64| Some((x * 1e6).round() / 1e6);
    let count = |n: usize| u32::try_from(n).ok();
    Provenance {
        demonstrations: count(demonstrations.items().len()),
        samples: Some(demonstrations.samples() as u64),
        sigma: float(options.sigma),
        seed: Some(options.seed as i64),
        rmse: float(quality.rmse),
        e_dot: float(quality.e_dot),
        dtwd: float(quality.dtwd),
        pace: float(quality.pace),
        path_error: float(quality.path_error),
        converged: count(quality.converged),
        robust: count(quality.robust),
        ..Provenance::default()
    }
}

#[cfg(test)]
mod tests;
