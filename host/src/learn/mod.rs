//! Learning a skill from demonstrations.
//!
//! Files are read and checked ([`read`]), brought to one attractor, and normalised. For each number of components a
//! Gaussian mixture is fitted, then P and A_k under the certificate; the number that follows the demonstrations
//! best for its size is kept ([`learn`]). The result is a [`ModelFile`], rounded to f32 so that every machine runs the
//! same numbers, with its certificate checked on them.

mod cone;
pub mod csv;
pub mod demonstration;
mod error;
pub mod evaluate;
mod field;
pub mod fit;
pub mod gmm;
pub mod lasa;
pub mod mat;
#[cfg(test)]
mod mat_writer;
pub mod quality;
mod reference;
mod refine;
mod smoothing;

pub use demonstration::{Demonstration, Demonstrations, Unit};
pub use error::LearnError;
pub use quality::Quality;

use crate::model::{ComponentFile, FORMAT, ModelFile};
use evaluate::Motion;
use gmm::{MAX_COMPONENTS, Mixture, Samples};
use nalgebra::{SMatrix, SVector};
use std::fs;
use std::path::{Path, PathBuf};

/// Most components tried when their number is not given.
const MOST_TRIED: usize = 8;
/// Samples used for fitting; more add time and little else.
const FIT_SAMPLES: usize = 1000;

/// How to learn.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Name of the skill in the model file.
    pub name: String,
    /// Unit of lengths in the files. Without it: centimetres for .mat (LASA handwriting at ten times its size),
    /// metres for .csv.
    pub unit: Option<Unit>,
    /// Number of components, 1 to 16; chosen from 1 to 8 where not given.
    pub components: Option<usize>,
    /// Seed of all random choices.
    pub seed: u64,
    /// Guaranteed rate of convergence, 1/s.
    pub sigma: f64,
    /// Weight of the direction of motion against position (in extents) when samples are grouped.
    pub direction_weight: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { name: "skill".into(), unit: None, components: None, seed: 1, sigma: 0.1, direction_weight: 1.0 }
    }
}

/// A learnt skill.
#[derive(Debug, Clone)]
pub struct Learnt {
    /// The model, certified in f32 and f64.
    pub model: ModelFile,
    /// How well it follows the demonstrations.
    pub quality: Quality,
    /// Quality for each number of components tried.
    pub tried: Vec<(usize, Quality)>,
    /// What it was learnt from, in metres and ending at the attractor.
    pub demonstrations: Demonstrations,
}

/// Reads the demonstrations of one skill from files and folders of them, in metres.
pub fn read(paths: &[PathBuf], unit: Option<Unit>) -> Result<Demonstrations, LearnError> {
    let mut items = Vec::new();
    for path in paths {
        let file = path.display().to_string();
        if !path.exists() {
            return Err(LearnError::Unreadable { file, source: std::io::ErrorKind::NotFound.into() });
        }
        if path.is_dir() {
            let unreadable = |source| LearnError::Unreadable { file: file.clone(), source };
            let mut inside = Vec::new();
            for entry in fs::read_dir(path).map_err(unreadable)? {
                let entry = entry.map_err(unreadable)?.path();
                if matches!(extension(&entry).as_str(), "mat" | "csv") {
                    inside.push(entry);
                }
            }
            if inside.is_empty() {
                return Err(LearnError::NoDemonstrations { file });
            }
            inside.sort();
            for entry in inside {
                items.extend(read_file(&entry, unit)?);
            }
        } else {
            items.extend(read_file(path, unit)?);
        }
    }
    Demonstrations::new(items)
}

fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase()
}

fn read_file(path: &Path, unit: Option<Unit>) -> Result<Vec<Demonstration>, LearnError> {
    type Reader = fn(&str, &[u8]) -> Result<Vec<Demonstration>, LearnError>;
    let file = path.display().to_string();
    let (reader, default): (Reader, Unit) = match extension(path).as_str() {
        "mat" => (lasa::read, Unit::Cm),
        "csv" => (csv::read, Unit::M),
        _ => return Err(LearnError::UnknownFormat { file }),
    };
    let bytes = fs::read(path).map_err(|source| LearnError::Unreadable { file: file.clone(), source })?;
    let factor = unit.unwrap_or(default).metres();
    Ok(reader(&file, &bytes)?.into_iter().map(|d| d.scaled(factor)).collect())
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
    fn of(demonstrations: &Demonstrations, all: &Samples<D>) -> Self {
        let squares: f64 = all.v.iter().map(|v| v.norm_squared()).sum();
        let speed = (squares / all.v.len().max(1) as f64).sqrt();
        let attractor = SVector::from_column_slice(demonstrations.attractor().as_slice());
        // A recording with velocities of zero throughout still has a scale.
        Self { attractor, length: demonstrations.extent(), speed: if speed > 0.0 { speed } else { 1.0 } }
    }

    fn normalise(&self, samples: &Samples<D>) -> Samples<D> {
        Samples {
            x: samples.x.iter().map(|x| (x - self.attractor) / self.length).collect(),
            v: samples.v.iter().map(|v| v / self.speed).collect(),
        }
    }
}

fn fixed<const D: usize>(all: &[nalgebra::DVector<f64>]) -> Vec<SVector<f64, D>> {
    all.iter().map(|p| SVector::from_column_slice(p.as_slice())).collect()
}

/// Every demonstration's samples, thinned to about `limit` in all.
fn samples<const D: usize>(demonstrations: &Demonstrations, limit: usize) -> Samples<D> {
    let stride = demonstrations.samples().div_ceil(limit).max(1);
    let mut out = Samples { x: vec![], v: vec![] };
    for item in demonstrations.items() {
        out.x.extend(fixed::<D>(&item.x).into_iter().step_by(stride));
        out.v.extend(fixed::<D>(&item.v).into_iter().step_by(stride));
    }
    out
}

fn learn_in<const D: usize>(
    demonstrations: Demonstrations,
    options: &Options,
    progress: &dyn Fn(f64),
) -> Result<Learnt, LearnError> {
    let all = samples::<D>(&demonstrations, usize::MAX);
    let paths = recordings::<D>(&demonstrations);
    let scale = Scale::of(&demonstrations, &all);
    let normal = scale.normalise(&samples(&demonstrations, 300));
    let tracks = tracks(&paths, &scale);

    let candidates = match options.components {
        Some(k) => k..=k,
        None => 1..=MOST_TRIED.min(normal.x.len() / (D + 1)).max(1),
    };
    let count = candidates.clone().count() as f64;
    let mut tried = Vec::new();
    let mut best: Option<(f64, ModelFile, Quality)> = None;
    let mut failure = String::from("no mixture fits the samples");
    for (i, k) in candidates.enumerate() {
        progress(i as f64 / count);
        let Some(mixture) = gmm::fit(&normal, k, options.direction_weight, options.seed) else { continue };
        let model = match model_of(&normal, &mixture, &tracks, &scale, options) {
            Ok(model) => model,
            Err(reason) => {
                failure = reason;
                continue;
            }
        };
        let Some(motion) = motion_of::<D>(&model) else { continue };
        let quality = quality::measure(&motion, &paths, demonstrations.extent());
        tried.push((mixture.len(), quality));
        let score = score(&quality, mixture.len(), demonstrations.extent(), scale.speed);
        if best.as_ref().is_none_or(|b| score < b.0) {
            best = Some((score, model, quality));
        }
    }
    let Some((_, mut model, quality)) = best else { return Err(LearnError::Fit { reason: failure }) };
    model.learnt = Some(provenance(options, &demonstrations, &quality));
    model.validate()?;
    progress(1.0);
    Ok(Learnt { model, quality, tried, demonstrations })
}

/// What a number of components is judged by: errors relative to the skill, with a price a component, and a rollout that
/// does not arrive counts more than any error.
fn score(quality: &Quality, components: usize, extent: f64, speed: f64) -> f64 {
    let stranded = (quality.rollouts - quality.converged) as f64;
    let error = quality.rmse / speed + 5.0 * quality.path_error / extent;
    10.0 * stranded + error * (1.0 + 0.03 * components as f64)
}

/// Fits P and A_k, rounds to f32 and checks the certificate on the rounded numbers.
fn model_of<const D: usize>(
    normal: &Samples<D>,
    mixture: &Mixture<D>,
    tracks: &[reference::Track<D>],
    scale: &Scale<D>,
    options: &Options,
) -> Result<ModelFile, String> {
    let sigma = tune("SIGMA", options.sigma) * scale.length / scale.speed;
    let mut strictness = sigma;
    let t0 = cpu();
    let _ = mixture;
    let mut p = reference::search(tracks, sigma);
    let t1 = cpu();
    let margin = tune("MARGINS", 1.3);
    let (tune_dir, tune_slow) = (tune("DIR", 0.1), tune("SLOW", 0.2).powi(2));
    let mut best: Option<(field::Field<D>, f64)> = None;
    let mut log = String::new();
    for start in 0..tune("STARTS", 2.0) as u64 {
        let moved: Vec<_> = tracks.iter().map(|t| reference::follow(t, &p, sigma * margin)).collect();
        let (mut x, mut v) = (vec![], vec![]);
        let mut label = vec![];
        let kk = tune("K", mixture.len() as f64);
        for (track, (m, away)) in tracks.iter().zip(&moved) {
            let n = track.x.len();
            let mut cumulative = vec![0.0];
            let step = |i: usize| (m.x[i] - m.x[i - 1]).norm();
            let turn = |i: usize| { let (a, b) = (m.v[i], m.v[i - 1]); let s = a.norm() * b.norm(); if s > 0.0 { (a.dot(&b) / s).clamp(-1.0, 1.0).acos() } else { 0.0 } };
            let length: f64 = (1..n).map(step).sum();
            let turns: f64 = (1..n).map(turn).sum::<f64>() + 0.3;
            for i in 1..n {
                cumulative.push(cumulative[i - 1] + tune("SEGL", 1.0) * step(i) / length + tune("SEGA", 1.0) * turn(i) / turns + tune("SEGT", 1.0) / n as f64);
            }
            let total = cumulative[n - 1];
            for i in 0..track.x.len() {
                let l = ((cumulative[i] / total * kk) as usize).min(kk as usize - 1);
                label.push(l);
                if away[i] > 3e-3 { label.push(l); }
                x.push(track.x[i]);
                v.push(reference::admissible(&track.x[i], &track.v[i], &p, sigma * margin));
                if away[i] > 3e-3 {
                    x.push(m.x[i]);
                    v.push(m.v[i]);
                }
            }
        }
        let targets = Samples { x, v };
        let thin = Samples { x: targets.x.iter().copied().step_by(4).collect(), v: targets.v.iter().copied().step_by(4).collect() };
        let t2 = cpu();
        let segments = tune("SEG", 2.0) > 1.5 && start % 2 == 1 || tune("SEG", 2.0) == 1.0;
        let Some(mixture) = (if segments { gmm::labelled(&targets.x, &label, kk as usize) } else { gmm::fit(&thin, tune("K", mixture.len() as f64) as usize, tune("CDIR", options.direction_weight), options.seed + start) }) else { continue };
        let t3 = cpu();
        let Ok(fit) = fit::Gram::new(&targets, &mixture, |v| 1.0 + tune_dir / (v.norm_squared() + tune_slow)).solve_for(&p, sigma, 2) else { continue };
        let t4 = cpu();
        let Some(field) = field::Field::new(&mixture, &fit.p, &fit.a, sigma) else { continue };
        let followed: Vec<_> = moved.iter().map(|m| &m.0).map(as_path).collect();
        let shown: Vec<_> = tracks.iter().map(as_path).collect();
        let weights = refine::Weights { direction: tune("DIR", 0.1), slow: tune("SLOW", 0.2), path: 0.0, pace: tune("PACE", 0.1), anchor: 0.0, snap: tune("SNAP", 8.0), window: tune("WINDOW", 0.1), leash: tune("LEASH", 0.06) };
        let mut task = refine::Task { x: &targets.x, v: &targets.v, tracks: &followed, weights };
        let run = |field, task: &refine::Task<D>, rounds: f64| if D == 2 { refine::refine::<D, 10>(field, task, rounds as usize) } else { refine::refine::<D, 19>(field, task, rounds as usize) };
        let (field, c1) = run(field, &task, tune("R1", 20.0));
        let t5 = cpu();
        task.weights.path = tune("PATH", 100.0);
        let (field, c2) = run(field, &task, tune("R2", 15.0));
        let t6 = cpu();
        let mut last = refine::Task { tracks: if tune("TRUE", 0.0) > 0.0 { &shown } else { &followed }, ..task };
        last.weights.leash = tune("LEASH3", 0.2);
        last.weights.path = tune("PATH3", 100.0);
        let (field, c3) = run(field, &last, tune("R3", 10.0));
        let t7 = cpu();
        log += &format!("start: P {:.4} cluster {:.4} socp {:.4} ({:.4}) refine {c1:.4} ({:.4}) roll {c2:.4} ({:.4}) true {c3:.4} ({:.4})\n", t1 - t0, t3 - t2, fit.error, t4 - t3, t5 - t4, t6 - t5, t7 - t6);
        p = p * 1.0;
        let Some(mixture) = field.mixture() else { continue };
        let motion = Motion { attractor: SVector::zeros(), mixture, a: field.parts.iter().map(|c| c.a).collect() };
        let recs: Vec<_> = tracks.iter().map(|t| quality::Recording { t: t.t.clone(), x: t.x.clone(), v: t.v.clone() }).collect();
        let q = quality::measure(&motion, &recs, 1.0);
        let c4 = q.dtwd / 200.0 / 0.02 + q.rmse / 0.14 + q.e_dot / 0.034 + 100.0 * (q.rollouts - q.converged) as f64;
        let refs: f64 = tracks.iter().zip(&moved).map(|(t, m)| quality::warping_distance(&quality::resample(&t.x), &quality::resample(&m.0.x)).0).sum::<f64>() / tracks.len() as f64;
        let recs: Vec<_> = moved.iter().map(|t| quality::Recording { t: t.0.t.clone(), x: t.0.x.clone(), v: t.0.v.clone() }).collect();
        log += &format!("   refs are {:.0} from shown, rollouts {:.0} from refs", refs * scale.length * 1e3, quality::measure(&motion, &recs, 1.0).dtwd * scale.length * 1e3);
        log += &format!("   score {c4:.2} dtwd {:.0} time {:.4}\n", q.dtwd * scale.length * 1e3, cpu() - t7);
        if best.as_ref().is_none_or(|b| c4 < b.1) { best = Some((field, c4)); }
    }
    if tune("VERBOSE", 0.0) > 0.0 { eprint!("{log}"); }
    let (field, c2) = best.ok_or("no start")?;
    let mut fit;
    let mixture = &field.mixture().ok_or("mixture")?;
    fit = fit::Stable { p: field.p, a: field.parts.iter().map(|c| c.a).collect(), error: c2 };
    fit::repair(&mut fit, sigma).ok_or("the inequality cannot be met")?;
    for _ in 0..6 {
        let model = denormalise(&fit, mixture, scale, options);
        if model.certified::<f32>() && model.certified::<f64>() {
            return Ok(model);
        }
        // Rounding used up the margin: ask for more.
        strictness += 0.05;
        fit::repair(&mut fit, strictness).ok_or("the inequality cannot be met")?;
    }
    Err("the certificate does not survive rounding to f32".into())
}

fn cpu() -> f64 { std::fs::read_to_string("/proc/thread-self/schedstat").ok().and_then(|s| s.split(' ').next().and_then(|n| n.parse::<f64>().ok())).unwrap_or(0.0) * 1e-9 }
fn tune(name: &str, default: f64) -> f64 {
    std::env::var(format!("T_{name}")).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}

fn recordings<const D: usize>(demonstrations: &Demonstrations) -> Vec<quality::Recording<D>> {
    let one = |d: &Demonstration| quality::Recording { t: d.t.clone(), x: fixed(&d.x), v: fixed(&d.v) };
    demonstrations.items().iter().map(one).collect()
}

fn tracks<const D: usize>(recordings: &[quality::Recording<D>], scale: &Scale<D>) -> Vec<reference::Track<D>> {
    recordings
        .iter()
        .map(|r| {
            let stride = r.x.len().div_ceil(tune("SAMPLES", 200.0) as usize).max(1);
            let x = r.x.iter().map(|x| (x - scale.attractor) / scale.length).step_by(stride).collect();
            let v = r.v.iter().map(|v| v / scale.speed).step_by(stride).collect();
            let t = r.t.iter().map(|t| (t - r.t[0]) * scale.speed / scale.length).step_by(stride).collect();
            reference::Track { x, v, t }
        })
        .collect()
}

fn as_path<const D: usize>(t: &reference::Track<D>) -> refine::Track<D> {
    let first = t.x.len() / 50;
    refine::Track { x: t.x[first..].to_vec(), duration: t.t[t.t.len() - 1] - t.t[first] }
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

/// The shortest decimal that is the nearest f32: short to read, and the same on every machine.
fn rounded(x: f64) -> f64 {
    let nearest = x as f32 + 0.0;
    format!("{nearest:e}").parse().unwrap_or(f64::from(nearest))
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

fn provenance(options: &Options, demonstrations: &Demonstrations, quality: &Quality) -> toml::Table {
    let float = |x: f64| toml::Value::Float((x * 1e6).round() / 1e6);
    let integer = |n: usize| toml::Value::Integer(n as i64);
    [
        ("demonstrations", integer(demonstrations.items().len())),
        ("samples", integer(demonstrations.samples())),
        ("sigma", float(options.sigma)),
        ("seed", toml::Value::Integer(options.seed as i64)),
        ("rmse", float(quality.rmse)),
        ("e_dot", float(quality.e_dot)),
        ("dtwd", float(quality.dtwd)),
        ("path_error", float(quality.path_error)),
        ("converged", integer(quality.converged)),
    ]
    .into_iter()
    .map(|(key, value)| (key.to_owned(), value))
    .collect()
}

#[cfg(test)]
mod tests;
