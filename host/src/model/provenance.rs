//! How a model came about: numbers for people, and what is needed to add a demonstration to it or to move it.

use crate::learn::Unit;
use serde::{Deserialize, Serialize};

/// The table `learnt` of a model file. Nothing in it changes what the skill does.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Rollouts from the demonstrations' starts that arrive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub converged: Option<u32>,
    /// Number of demonstrations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub demonstrations: Option<u32>,
    /// Dynamic time warping distance of rollouts, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dtwd: Option<f64>,
    /// Mean direction error, 1 - cos.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub e_dot: Option<f64>,
    /// The file of another tool that it was imported from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imported: Option<String>,
    /// The model that it was moved from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moved: Option<String>,
    /// Its time over the demonstrators'.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pace: Option<f64>,
    /// Mean distance of rollouts from the demonstrations, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path_error: Option<f64>,
    /// Velocity error, m/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rmse: Option<f64>,
    /// Places beside the demonstrations from which it arrives in twice their time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robust: Option<u32>,
    /// Number of samples.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub samples: Option<u64>,
    /// The seed it was learnt with, as a signed number of the same bits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<i64>,
    /// The rate of convergence that was asked for, 1/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma: Option<f64>,
    /// What it was learnt from.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<SourceFile>,
    /// Where the demonstrations began, m.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub starts: Vec<Vec<f64>>,
}

/// A file or folder of demonstrations.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SourceFile {
    /// Where it is, from the model file.
    pub file: String,
    /// The unit that was declared for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<Unit>,
}
