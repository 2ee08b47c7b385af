//! How well a skill does what it has not been shown: one demonstration is kept from learning, and the skill is measured on that.

use super::quality::{self, Quality};
use super::{Demonstrations, LearnError, Options, learn_from, motion_of, recordings};

/// Learns from all demonstrations but one, and measures on that one. All end at the goal of all, which a skill may know.
///
/// ```
/// use pliant::learn::{Demonstration, Demonstrations, Options, held_out};
/// use nalgebra::DVector;
/// # fn main() -> Result<(), pliant::learn::LearnError> {
/// let line = |y: f64| {
///     let t: Vec<f64> = (0..100).map(|i| f64::from(i) / 50.0).collect();
///     let x = t.iter().map(|t| DVector::from_row_slice(&[1.0 - 0.5 * t, y * (2.0 - t)])).collect();
///     Demonstration::new(format!("line at {y}"), t, x, None)
/// };
/// let all = Demonstrations::new(vec![line(0.0)?, line(0.02)?, line(0.04)?])?;
/// let quality = held_out(&all, 1, &Options::default())?;
/// assert_eq!((quality.rollouts, quality.converged), (1, 1));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// There is no demonstration of that number (from 0), no other one, or no skill is found for the others.
pub fn held_out(demonstrations: &Demonstrations, which: usize, options: &Options) -> Result<Quality, LearnError> {
    let items = demonstrations.items();
    if items.len() < 2 || which >= items.len() {
        return Err(LearnError::Option {
            option: "held out",
            value: format!("{} of {}", which.saturating_add(1), items.len()),
            allowed: "one of two demonstrations or more",
        });
    }
    let others = items.iter().enumerate().filter(|(i, _)| *i != which).map(|(_, d)| d.clone()).collect();
    let learnt = learn_from(Demonstrations::new(others)?, options, &|_| {})?;
    match demonstrations.dimension() {
        2 => measured::<2>(&learnt.model, demonstrations, which),
        _ => measured::<3>(&learnt.model, demonstrations, which),
    }
    .ok_or_else(|| LearnError::Fit { reason: "the model is of another dimension".into() })
}

fn measured<const D: usize>(
    model: &crate::model::ModelFile,
    demonstrations: &Demonstrations,
    which: usize,
) -> Option<Quality> {
    let all = recordings::<D>(demonstrations);
    Some(quality::measure(&motion_of::<D>(model)?, all.get(which..=which)?, demonstrations.extent()))
}
