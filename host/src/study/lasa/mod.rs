//! All motions of a folder learnt, such as those of the LASA handwriting set: how well, how fast, and beside other learners.
//!
//! Lengths are as recorded (a .mat in mm), figures of merit those of [`crate::learn::quality`], and seconds processor time of one core.

mod measured;
mod motions;
mod peers;
mod report;

use std::path::Path;

pub use measured::{Failed, HeldOut, Measured, learn_one};
pub use motions::{Source, sources};

use super::{Findings, parallel};
use crate::error::Error;
use crate::learn::{Options, Quality, Unit, held_out};
use crate::plot::contact_sheet;

/// What is learnt, and how.
#[derive(Clone, Debug)]
pub struct Task<'a> {
    /// A folder with a motion in each file, or in each folder in it.
    pub folder: &'a Path,
    /// Unit of lengths; mm for .mat and m for all else if not given.
    pub unit: Option<Unit>,
    /// Seed of all random choices.
    pub seed: u64,
    /// Also learn each motion without one of its demonstrations, for each of these, and measure on that one?
    pub held_out: bool,
}

/// What was found, and what could not be learnt.
#[derive(Clone, Debug)]
pub struct Found {
    /// Tables, the contact sheet, numbers.
    pub findings: Findings,
    /// Motions that were learnt, in order.
    pub measured: Vec<Measured>,
    /// What went wrong, in order; the other motions are learnt all the same.
    pub failed: Vec<Failed>,
    /// Are all motions by their names of the LASA handwriting set?
    pub lasa: bool,
}

impl Found {
    /// Is everything learnt and certified, and does every rollout arrive?
    pub fn is_well(&self) -> bool {
        let well = |m: &Measured| m.certified && m.quality.converged == m.quality.rollouts;
        self.failed.is_empty() && self.measured.iter().all(well)
    }
}

/// Told what is being done, how much of it is done, and how much there is.
pub type Progress<'a> = &'a (dyn Fn(&'static str, usize, usize) + Sync);

/// Learns every motion of a folder, on all cores.
///
/// # Errors
/// A folder that cannot be read or holds no motion, and one of which no motion can be learnt.
pub fn study(task: &Task<'_>, progress: Progress<'_>) -> Result<Found, Error> {
    let sources = sources(task.folder)?;
    let options = Options { seed: task.seed, ..Options::default() };
    let all = parallel::map(&sources, &|done| progress("learning", done, sources.len()), |source| {
        Ok(learn_one(source, task.unit, &options))
    })?;
    let (mut measured, mut failed) = (Vec::new(), Vec::new());
    for result in all {
        match result {
            Ok(one) => measured.push(one),
            Err(one) => failed.push(one),
        }
    }
    if let (true, Some(first)) = (measured.is_empty(), failed.first()) {
        let more =
            if failed.len() > 1 { format!(" (and {} other motions failed)", failed.len() - 1) } else { String::new() };
        return Err(Error::bad_input(format!("{}{more}", first.reason)));
    }
    if task.held_out {
        hold_out(&mut measured, &mut failed, &options, progress)?;
    }
    let lasa = peers::are_lasa(&measured);
    let mut findings = report::findings(&measured, &failed, task, lasa);
    let portraits: Vec<_> = measured.iter().filter_map(|m| m.portrait.clone()).collect();
    let columns = portraits.len().clamp(1, 5);
    let caption = "Demonstrations, the learnt motion from where each starts, and its flow; each motion at its own scale, with its DTWD";
    let width = (216 * columns).max(420) as f64;
    findings.figures.push(("lasa", caption.into(), contact_sheet(&portraits, columns, width)));
    Ok(Found { findings, measured, failed, lasa })
}

/// Learns each motion without one of its demonstrations, for each of them.
fn hold_out(
    measured: &mut [Measured],
    failed: &mut Vec<Failed>,
    options: &Options,
    progress: Progress<'_>,
) -> Result<(), Error> {
    let folds: Vec<(usize, usize)> = measured
        .iter()
        .enumerate()
        .filter(|(_, m)| m.shown.items().len() > 1)
        .flat_map(|(i, m)| (0..m.shown.items().len()).map(move |fold| (i, fold)))
        .collect();
    let done = |done| progress("held out", done, folds.len());
    let results = parallel::map(&folds, &done, |&(i, fold)| Ok(held_out(&measured[i].shown, fold, options)))?;
    let mut of: Vec<Vec<Quality>> = vec![Vec::new(); measured.len()];
    for (&(i, fold), result) in folds.iter().zip(results) {
        match result {
            Ok(quality) => of[i].push(quality),
            Err(e) => failed.push(Failed {
                name: measured[i].name.clone(),
                reason: format!("{}: without demonstration {}: {e}", measured[i].name, fold + 1),
            }),
        }
    }
    for (one, qualities) in measured.iter_mut().zip(of) {
        // A mean over the easier ones alone would flatter.
        if qualities.len() == one.shown.items().len() {
            one.held_out = HeldOut::of(&qualities);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
