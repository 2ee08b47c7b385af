//! `pliant check`

use std::path::PathBuf;

use pliant_core::Scalar;
use serde_json::json;

use super::{Finished, print_json};
use crate::error::{Error, Outcome};
use crate::model::{ModelFile, Skill};

/// Options of `pliant check`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// Model file.
    model: PathBuf,
}

/// What the certificate says in one precision.
struct Found {
    precision: &'static str,
    rate: f64,
    slowest: usize,
}

pub(super) fn main(args: &Args, json: bool) -> Finished {
    let model = ModelFile::read(&args.model)?;
    let found = [certificate::<f32>("f32", &model)?, certificate::<f64>("f64", &model)?];
    let components = model.component.len();
    if json {
        let each: Vec<_> = found
            .iter()
            .map(|f| json!({ "precision": f.precision, "rate_per_s": f.rate, "slowest_component": f.slowest + 1 }))
            .collect();
        print_json(&json!({
            "model": model.name, "dimension": model.dimension, "components": components, "certified": true, "certificate": each,
        }));
    } else {
        say!("{}: {} dimensions, {components} components", model.name, model.dimension);
        for f in found {
            say!(
                "  {}: certified; the distance to the goal shrinks at {:.3} 1/s or faster everywhere (component {} is the slowest)",
                f.precision,
                f.rate,
                f.slowest + 1
            );
        }
    }
    Ok(Outcome::Success)
}

fn certificate<S: Scalar>(precision: &'static str, model: &ModelFile) -> Result<Found, Error> {
    let certificate = match model.skill::<S>()? {
        Skill::Planar(ds) => ds.certificate(),
        Skill::Spatial(ds) => ds.certificate(),
    };
    Ok(Found { precision, rate: certificate.rate.to_f64(), slowest: certificate.slowest })
}
