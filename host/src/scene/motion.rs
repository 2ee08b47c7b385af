//! Where a scene's motion comes from.

use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use pliant_core::{Motion, Scalar};

use super::convert::{ConvertError, vector};
use crate::model::ModelFile;

/// A straight line to the attractor, or a learnt skill.
#[derive(Clone, Debug)]
pub enum MotionSource {
    /// f(x) = -gain (x - attractor)
    Linear {
        /// m
        attractor: Vector3<f64>,
        /// 1/s
        gain: f64,
    },
    /// A learnt skill, certified in `f32` and in `f64`.
    Model {
        /// The file it was read from.
        path: PathBuf,
        /// What the file says.
        model: Box<ModelFile>,
    },
}

impl MotionSource {
    /// Where the motion ends, m.
    pub fn attractor(&self) -> Vector3<f64> {
        match self {
            Self::Linear { attractor, .. } => *attractor,
            Self::Model { model, .. } => point(&model.attractor),
        }
    }

    /// The file of a learnt skill.
    pub fn model_path(&self) -> Option<&Path> {
        match self {
            Self::Linear { .. } => None,
            Self::Model { path, .. } => Some(path),
        }
    }

    pub(super) fn to_core<S: Scalar, const D: usize>(&self) -> Result<Motion<S, D>, ConvertError> {
        match self {
            Self::Linear { attractor, gain } => Motion::linear(vector(attractor), S::from_f64(*gain))
                .map_err(|e| ConvertError::Motion(format!("{:?} is out of range", e.field))),
            Self::Model { model, .. } => {
                model.certify().map(Motion::Lpv).map_err(|e| ConvertError::Motion(e.to_string()))
            }
        }
    }
}

/// Up to three coordinates; those left out are zero.
pub(super) fn point(coordinates: &[f64]) -> Vector3<f64> {
    Vector3::from_fn(|i, _| coordinates.get(i).copied().unwrap_or_default())
}
