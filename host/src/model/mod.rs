//! Model files: a learnt skill as text that people can read and change. Metres and seconds.
//!
//! # Into firmware of one's own
//!
//! A device that speaks `pliant-protocol` is sent its skill. Firmware that has only the core takes it along, as the bytes that an upload
//! would carry: something on the host writes them, and the firmware, which needs no allocation for it, makes the motion of them. The
//! certificate is checked there once more, in the numbers that run (`f32`).
//!
//! ```
//! use pliant::model::ModelFile;
//! use pliant_core::{Controller, Motion, Settings};
//! use pliant_protocol::message::{DeviceError, UploadError};
//! use pliant_protocol::{convert, model::{MODEL_MAX, Model}};
//!
//! // On the host, in a build script or a tool:
//! fn bytes(path: &str) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
//!     let file = ModelFile::read(path.as_ref())?;
//!     file.is_certified()?;
//!     let mut room = [0; MODEL_MAX];
//!     Ok(Model::from(&file.lpv_ds::<f32, 2>()?).to_bytes(&mut room)?.to_vec())
//! }
//!
//! // In the firmware, with `static SKILL: &[u8] = include_bytes!("sbend.model");`
//! fn controller(skill: &[u8]) -> Result<Controller<f32, 2, 16>, DeviceError> {
//!     let model = Model::from_bytes(skill).map_err(|_| DeviceError::Upload(UploadError::Malformed))?;
//!     let motion: Motion<f32, 2> = convert::motion(&model)?;
//!     Ok(Controller::new(motion, Settings::default()))
//! }
//!
//! let skill = bytes("../models/sbend.toml")?; // std::fs::write("sbend.model", skill)
//! assert!(matches!(controller(&skill), Ok(c) if matches!(c.motion().motion(), Motion::Lpv(_))));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod convert;
mod error;
mod locate;
mod provenance;
mod text;
mod transform;

pub use convert::Skill;
pub use error::{FieldError, ModelFileError};
pub use provenance::{Provenance, SourceFile};
pub use text::Text;
pub use transform::{Similarity, SimilarityError};

use crate::error::counted;
use crate::output;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The version of the format that is read and written.
pub const FORMAT: u32 = 1;

const COMMENT: &str =
    "# A learnt skill: dx/dt = sum_k gamma_k(x) a_k (x - attractor), gamma_k from the Gaussian mixture.
# Metres and seconds. V = (x - attractor)' lyapunov (x - attractor) decreases along every motion.
";

/// A skill, as it is in its file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelFile {
    /// Version of the format: 1.
    pub format: u32,
    /// Name of the skill.
    pub name: String,
    /// 2 or 3.
    pub dimension: usize,
    /// Where the motion ends, m.
    pub attractor: Vec<f64>,
    /// P of V = (x - attractor)' P (x - attractor), row by row.
    pub lyapunov: Vec<Vec<f64>>,
    /// 1 to 16 linear systems and where they rule.
    pub component: Vec<ComponentFile>,
    /// How it was learnt; it does not change what the skill does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub learnt: Option<Provenance>,
}

/// One linear system and the Gaussian that says where it rules.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ComponentFile {
    /// Weight of the Gaussian, positive; only ratios matter.
    pub prior: f64,
    /// Its mean, m.
    pub mean: Vec<f64>,
    /// Its covariance, m^2, row by row.
    pub covariance: Vec<Vec<f64>>,
    /// The linear system, 1/s, row by row.
    pub a: Vec<Vec<f64>>,
}

impl ModelFile {
    /// Reads and checks a file. The certificate is not part of this check.
    pub fn read(path: &Path) -> Result<Self, ModelFileError> {
        Text::read(path)?.model()
    }

    /// Reads and checks text; `file` is named in errors.
    pub fn parse(file: &str, text: &str) -> Result<Self, ModelFileError> {
        let model: Self = toml::from_str(text).map_err(|e| {
            let span = e.span().unwrap_or(0..0);
            let located = || ModelFileError::located(file, text, span, e.message().to_owned());
            locate::scene(file, text).unwrap_or_else(located)
        })?;
        match model.validate() {
            Ok(()) => Ok(model),
            Err(fault) => Err(locate::fault(file, text, fault.component, fault.name, fault.to_string())),
        }
    }

    /// The text of the file: the same model gives the same text, and reading it gives the same model.
    pub fn to_toml(&self) -> Result<String, ModelFileError> {
        let body = toml::to_string(self)
            .map_err(|e| ModelFileError::Unwritable { file: self.name.clone(), problem: std::io::Error::other(e) })?;
        Ok(format!("{COMMENT}{body}"))
    }

    /// Writes the file, and the folder it is in if need be.
    pub fn write(&self, path: &Path) -> Result<(), ModelFileError> {
        output::write(path, self.to_toml()?)
            .map_err(|problem| ModelFileError::Unwritable { file: path.display().to_string(), problem })
    }

    /// Checks sizes and ranges: all that can be said about each field by itself.
    pub fn validate(&self) -> Result<(), FieldError> {
        let d = self.dimension;
        let fail = |name, problem: String, allowed| Err(FieldError { component: None, name, problem, allowed });
        if self.format != FORMAT {
            return fail("format", format!("is {}", self.format), "1");
        }
        if !(2..=3).contains(&d) {
            return fail("dimension", format!("is {d}"), "2 or 3");
        }
        check(None, "attractor", vector(&self.attractor, d))?;
        check(None, "lyapunov", definite(&self.lyapunov, d))?;
        let k = self.component.len();
        if !(1..=pliant_core::ds::MAX_COMPONENTS).contains(&k) {
            return fail("component", format!("occurs {k} times"), "1 to 16 components");
        }
        for (i, c) in self.component.iter().enumerate() {
            let at = Some(i);
            let prior = if c.prior > 0.0 && c.prior.is_finite() {
                Ok(())
            } else {
                Err((format!("is {}", c.prior), "a positive number"))
            };
            check(at, "prior", prior)?;
            check(at, "mean", vector(&c.mean, d))?;
            check(at, "covariance", definite(&c.covariance, d))?;
            check(at, "a", square(&c.a, d))?;
        }
        for start in self.learnt.iter().flat_map(|l| &l.starts) {
            check(None, "learnt.starts", vector(start, d))?;
        }
        Ok(())
    }
}

/// The shortest decimal that is the nearest f32: short to read, and the same on every machine.
pub fn rounded(x: f64) -> f64 {
    let nearest = x as f32 + 0.0;
    format!("{nearest:e}").parse().unwrap_or(f64::from(nearest))
}

type Check = Result<(), (String, &'static str)>;

fn check(component: Option<usize>, name: &'static str, result: Check) -> Result<(), FieldError> {
    result.map_err(|(problem, allowed)| FieldError { component, name, problem, allowed })
}

fn vector(v: &[f64], d: usize) -> Check {
    if v.len() != d {
        return Err((format!("has {} for dimension {d}", counted(v.len(), "number")), "one number a dimension"));
    }
    match v.iter().find(|c| !(c.abs() <= pliant_core::RANGE)) {
        Some(c) => Err((format!("holds {c}"), "-1000 to 1000 m")),
        None => Ok(()),
    }
}

fn square(m: &[Vec<f64>], d: usize) -> Check {
    if m.len() != d || m.iter().any(|row| row.len() != d) {
        return Err((format!("is not {d} x {d}"), "a square matrix of the model's dimension, row by row"));
    }
    match m.iter().flatten().find(|c| !c.is_finite()) {
        Some(c) => Err((format!("holds {c}"), "finite numbers")),
        None => Ok(()),
    }
}

fn definite(m: &[Vec<f64>], d: usize) -> Check {
    const ALLOWED: &str = "a symmetric positive definite matrix";
    square(m, d)?;
    if (0..d).any(|r| (0..r).any(|c| m[r][c] != m[c][r])) {
        return Err(("is not symmetric".into(), ALLOWED));
    }
    let pivots = nalgebra::DMatrix::from_fn(d, d, |r, c| m[r][c]).cholesky();
    if pivots.is_none() {
        return Err(("is not positive definite".into(), ALLOWED));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
