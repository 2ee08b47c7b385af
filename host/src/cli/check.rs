//! `pliant check`

use std::path::PathBuf;

use pliant_core::{Fixed, Scalar};
use serde_json::json;

use super::{Finished, print_json};
use crate::error::{Outcome, counted};
use crate::model::{ModelFile, ModelFileError, Skill, Text};

/// Options of `pliant check`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// Model file, as `learn` writes it; a scene is checked by `plot` and `run`.
    model: PathBuf,
}

/// What the certificate says in one precision.
struct Found {
    precision: &'static str,
    /// What the device finds, 1/s, its rounding included.
    rate: f64,
    /// What is proved of the same numbers without rounding, 1/s.
    margin: f64,
    slowest: usize,
}

pub(super) fn main(args: &Args, json: bool) -> Finished {
    let text = Text::read(&args.model)?;
    let model = text.model()?;
    let checked = |found: Result<Found, ModelFileError>| found.map_err(|e| text.locate(e));
    let mut found = vec![checked(certificate::<f32>("f32", &model))?, checked(certificate::<f64>("f64", &model))?];
    // A processor without floating point: not every skill has room in its numbers.
    let fixed = certificate::<Fixed>("fixed", &model);
    let without = fixed.as_ref().err().map(ToString::to_string);
    found.extend(fixed);
    let components = model.component.len();
    if json {
        let each: Vec<_> = found
            .iter()
            .map(|f| {
                json!({
                    "precision": f.precision, "margin_per_s": f.margin, "rate_per_s": f.rate, "slowest_component": f.slowest + 1,
                })
            })
            .collect();
        print_json(&json!({
            "model": model.name, "dimension": model.dimension, "components": components, "certified": true, "certificate": each,
            "not_in_fixed_point": without,
        }));
    } else {
        say!("{}: {} dimensions, {}", model.name, model.dimension, counted(components, "component"));
        for f in found {
            say!(
                "  {}: certified; the distance to the goal shrinks at {} or faster everywhere (component {} is the slowest)",
                f.precision,
                per_second(f.margin),
                f.slowest + 1
            );
        }
        if let Some(reason) = without {
            say!("  not in fixed point: {reason}");
        }
    }
    Ok(Outcome::Success)
}

/// Rounded down, so that what is printed is proved as well; to no fewer than two digits.
pub(super) fn per_second(margin: f64) -> String {
    let decimals = if margin > 0.0 { (1 - margin.log10().floor() as i32).clamp(3, 12) } else { 3 };
    let unit = 10f64.powi(decimals);
    format!("{:.*} 1/s", decimals as usize, (margin * unit).floor() / unit)
}

fn certificate<S: Scalar>(precision: &'static str, model: &ModelFile) -> Result<Found, ModelFileError> {
    let rate = match model.skill::<S>()? {
        Skill::Planar(ds) => ds.certificate().rate,
        Skill::Spatial(ds) => ds.certificate().rate,
    };
    let proof = model.proof::<S>()?;
    Ok(Found { precision, rate: rate.to_f64(), margin: proof.margin, slowest: proof.slowest })
}
