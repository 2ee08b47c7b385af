//! A motion, learnt and measured.

use std::path::Path;

use super::Source;
use crate::learn::{self, Demonstrations, LearnError, Learnt, Options, Quality, Unit, read};
use crate::plot::Portrait;
use crate::study::cpu;

/// A motion that was learnt.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Of its file or folder.
    pub name: String,
    /// Number of components.
    pub k: usize,
    /// On the demonstrations it was learnt from.
    pub quality: Quality,
    /// On demonstrations it was not learnt from.
    pub held_out: Option<HeldOut>,
    /// Processor time of learning, without reading and drawing, s.
    pub seconds: f64,
    /// Does its certificate hold in f32, rounding included?
    pub certified: bool,
    /// The rate that is proved in f32, 1/s.
    pub margin: f64,
    /// What it was learnt from.
    pub shown: Demonstrations,
    /// To be drawn.
    pub portrait: Option<Portrait>,
}

/// Each demonstration measured by what was learnt from all others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldOut {
    /// Over demonstrations; numbers of rollouts are sums.
    pub mean: Quality,
    /// The largest DTWD of one, m: a motion that leads elsewhere from a start it does not know is seen here.
    pub worst: f64,
}

/// A motion that was not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failed {
    /// Of its file or folder.
    pub name: String,
    /// A sentence that names it or its file.
    pub reason: String,
}

/// Lengths of a .mat are mm where nothing is said: LASA handwriting at its recorded size.
fn unit_of(file: &Path, declared: Option<Unit>) -> Option<Unit> {
    let is_mat = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("mat"));
    declared.or(is_mat.then_some(Unit::Mm))
}

/// Learns a motion and measures it.
///
/// # Errors
/// Its files are no demonstrations of one skill, or no skill is found.
pub fn learn_one(source: &Source, unit: Option<Unit>, options: &Options) -> Result<Measured, Failed> {
    let failed = |e: LearnError| {
        let (name, said) = (source.name.clone(), e.to_string());
        // Most sentences begin with the file.
        let named = source.files.iter().any(|f| said.contains(&*f.to_string_lossy()));
        Failed { reason: if named { said } else { format!("{name}: {said}") }, name }
    };
    let mut recordings = Vec::new();
    for file in &source.files {
        recordings.extend(read::recordings(std::slice::from_ref(file), unit_of(file, unit)).map_err(failed)?);
    }
    let shown = Demonstrations::new(recordings).map_err(failed)?;
    let options = Options { name: source.name.clone(), ..options.clone() };
    let (learnt, seconds) = cpu::timed(|| learn::learn_from(shown, &options, &|_| {}));
    let Learnt { model, quality, demonstrations: shown, .. } = learnt.map_err(failed)?;
    let proof = model.proof::<f32>();
    let note = format!("DTWD {:.0} mm", quality.dtwd * 1e3);
    Ok(Measured {
        name: source.name.clone(),
        k: model.component.len(),
        quality,
        held_out: None,
        seconds,
        certified: proof.is_ok() && model.certified::<f32>(),
        margin: proof.map_or(0.0, |p| p.margin),
        portrait: Portrait::new(source.name.clone(), note, &model, &shown, Unit::Mm),
        shown,
    })
}

impl HeldOut {
    /// Of what was measured on each; none of none.
    pub fn of(all: &[Quality]) -> Option<Self> {
        let mean = |of: fn(&Quality) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
        (!all.is_empty()).then(|| Self {
            mean: Quality {
                rmse: mean(|q| q.rmse),
                e_dot: mean(|q| q.e_dot),
                dtwd: mean(|q| q.dtwd),
                path_error: mean(|q| q.path_error),
                pace: mean(|q| q.pace),
                converged: all.iter().map(|q| q.converged).sum(),
                rollouts: all.iter().map(|q| q.rollouts).sum(),
                robust: all.iter().map(|q| q.robust).sum(),
                beside: all.iter().map(|q| q.beside).sum(),
                excursion: all.iter().map(|q| q.excursion).fold(0.0, f64::max),
                excursion_from: None,
            },
            worst: all.iter().map(|q| q.dtwd).fold(0.0, f64::max),
        })
    }
}
