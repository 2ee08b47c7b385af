//! A scene: one motion, its settings, where it starts, and the obstacles in its way.
//!
//! ```toml
//! [ds]                                 # one of the two:
//! model = "../models/sbend.toml"       #   a learnt skill, relative to this file
//! # linear = { attractor = [0.0, 0.0], gain = 1.0 }
//!
//! [modulation]                         # may be left out, as may each key; these are the defaults
//! method = "deformable"                # or "original": soft layers are ignored
//! c = 0.03                             # m/s
//! steering = "with-flow"               # or { fixed = 0.785 } (rad)
//! beta = 1.0                           # only with "with-flow"
//!
//! [limits]                             # likewise
//! speed = 0.5                          # m/s
//! # acceleration = 5.0                 # m/s^2; free if left out
//! deceleration = 2.0                   # m/s^2
//!
//! [ageing]                             # likewise; a scene's obstacles are sent again at 30 Hz
//! time_to_live = 0.2                   # s
//! growth = 0.02                        # m/s
//! hold = 1.0                           # s
//!
//! [goal]                               # likewise
//! tolerance = 0.01                     # m
//! timeout = 30.0                       # s
//!
//! [guard]                              # likewise
//! approach = 0.02                      # share of the way to a core that a tick may use up; or enabled = false
//!
//! [attractor]                          # may be left out: then the goal stays where the motion has it
//! velocity = [0.0, 0.0]                # m/s
//! # path = [[0.0, 0.0, 0.0], [4.0, 0.1, 0.0]] # t, x, y: where it is over time, instead of a velocity
//!
//! [scan]                               # may be left out
//! points = [[0.1, 0.6], [0.1, 0.62]]   # m, up to 128
//! radius = 0.02                        # m, what each is kept away from by
//!
//! [[start]]                            # at least one
//! position = [0.37, 0.41]              # m
//!
//! [[obstacle]]                         # up to 64
//! name = "foam cylinder"
//! shape = { ellipsoid = [0.04, 0.04] } # hard semi-axes, m; or one of
//! #       { box = [0.1, 0.05], rounding = 0.01 }            half sides
//! #       { polygon = [[0.1, 0.0], [-0.1, 0.1], [-0.1, -0.1]] }  2-D: corners, in the obstacle's frame
//! #       { cylinder = [0.05, 0.2], rounding = 0.01 }       3-D: radius and half length, along z
//! #       { capsule = [0.05, 0.2] }                         3-D: likewise, plus a radius at both ends
//! wall = false                         # true: the shape is the free space
//! center = [0.20, 0.21]                # m
//! angle = 0.0                          # rad; in 3-D: rotation = [w, x, y, z]
//! stiffness = 1.6487                   # or soft = [0.06, 0.06], or layer = 0.02; none of them: rigid
//! curvature = 1                        # of an ellipsoid: 1 to 8 (nearly a box)
//! margin = [1.0, 1.0]                  # safety factors
//! velocity = [0.0, 0.0]                # m/s
//! angular_velocity = 0.0               # rad/s; in 3-D [x, y, z]
//! growth = 0.0                         # m/s on each half extent; below zero it shrinks
//! reference = [0.0, 0.0]               # m, in the obstacle's frame
//! # path = [[0.0, 0.2, 0.21], [4.0, 0.3, 0.2]] # t, x, y: the centre over time, instead of a velocity
//! ```
//!
//! A [`Scene`] can only be had by reading one, and what was read has been checked: it converts to the core's types in `f32` and
//! `f64` at every time up to its timeout.

mod check;
mod convert;
mod error;
mod fields;
mod file;
mod motion;
mod obstacle;
mod scan;
mod shape;
mod syntax;
#[cfg(test)]
mod tests;
mod track;

use std::io;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use pliant_core::{Ageing, Guard, Limits};

pub use convert::ConvertError;
pub use error::{SceneError, SceneErrorKind};
pub use motion::MotionSource;
pub use obstacle::{Pose, PosedObstacle, SceneObstacle};
pub use scan::SceneScan;
pub use shape::Shape;

use track::Track;

/// Most obstacles a scene may have.
pub const MAX_OBSTACLES: usize = 64;

/// Whether soft layers are soft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// They are.
    Deformable,
    /// They are not there (k = 1).
    Original,
}

/// Which way the push in a soft layer points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Steering {
    /// Along the flow, at most `beta` times the nominal speed.
    WithFlow {
        /// Largest push over nominal speed.
        beta: f64,
    },
    /// Turned by a fixed angle, as in the paper.
    Fixed {
        /// theta_2, rad.
        angle: f64,
    },
}

/// How obstacles bend the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modulation {
    /// Are soft layers soft?
    pub method: Method,
    /// Gain of the push in soft layers, m/s.
    pub c: f64,
    /// Which way the push points.
    pub steering: Steering,
}

/// When a run has arrived, and when it has failed to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Distance to the attractor, where it then is, that counts as there, m.
    pub tolerance: f64,
    /// Time after which a run is given up, s.
    pub timeout: f64,
}

/// A checked scene; see the [module](self) for the file it is read from.
///
/// Points and directions have three entries; in a scene of two dimensions the third is zero.
#[derive(Clone, Debug)]
pub struct Scene {
    name: String,
    dimension: usize,
    motion: MotionSource,
    modulation: Modulation,
    limits: Limits<f64>,
    ageing: Ageing<f64>,
    guard: Option<Guard<f64>>,
    goal: Goal,
    target: Track,
    starts: Vec<Vector3<f64>>,
    obstacles: Vec<SceneObstacle>,
    scan: Option<SceneScan>,
}

impl Scene {
    /// Reads a scene file and the model it names.
    ///
    /// # Errors
    /// The first thing that is wrong, with its line, its field and what is allowed there.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|e| SceneError::unreadable(&name, &e))?;
        Self::parse(&name, &text, path.parent().unwrap_or(Path::new("")))
    }

    /// Reads a scene from a text. `name` is what errors call it; a model's path is relative to `base_dir`.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn parse(name: &str, text: &str, base_dir: &Path) -> Result<Self, SceneError> {
        check::scene(name, text, &|relative| {
            let path = base_dir.join(relative);
            std::fs::read_to_string(&path).map(|text| (path, text))
        })
    }

    /// Reads a scene from a text with a model that is at hand: `model` is the text of the file that `ds.model` names.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn parse_with_model(name: &str, text: &str, model: &str) -> Result<Self, SceneError> {
        check::scene(name, text, &|relative| Ok((relative.to_owned(), model.to_owned())))
    }

    /// The scene that is compiled in: `scenes/sbend-foam.toml`.
    ///
    /// # Errors
    /// None, as a test sees to; the type is there because this reads the file like any other.
    pub fn builtin() -> Result<Self, SceneError> {
        const SCENE: &str = include_str!("../../../scenes/sbend-foam.toml");
        const MODEL: &str = include_str!("../../../models/sbend.toml");
        check::scene("scenes/sbend-foam.toml", SCENE, &|relative| {
            if relative == Path::new("../models/sbend.toml") {
                Ok((PathBuf::from("models/sbend.toml"), MODEL.to_owned()))
            } else {
                Err(io::ErrorKind::NotFound.into())
            }
        })
    }

    /// The name of the file, without its folders and its ending.
    pub fn name(&self) -> &str {
        &self.name
    }
    /// 2 or 3.
    pub fn dimension(&self) -> usize {
        self.dimension
    }
    /// Where the motion comes from.
    pub fn motion_source(&self) -> &MotionSource {
        &self.motion
    }
    /// Where the motion ends at time 0, m.
    pub fn attractor(&self) -> Vector3<f64> {
        self.attractor_at(0.0).0
    }
    /// Where the motion ends at scene time `t` (s), m, and how fast that moves, m/s.
    pub fn attractor_at(&self, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        self.target.at(t)
    }
    /// Is the attractor ever elsewhere than where the motion has it?
    pub fn attractor_moves(&self) -> bool {
        self.target.moves() || self.attractor() != self.motion.attractor()
    }
    /// How obstacles bend the motion.
    pub fn modulation(&self) -> &Modulation {
        &self.modulation
    }
    /// Speed and acceleration.
    pub fn limits(&self) -> &Limits<f64> {
        &self.limits
    }
    /// What becomes of obstacles that are not updated.
    pub fn ageing(&self) -> &Ageing<f64> {
        &self.ageing
    }
    /// What keeps the robot out of hard cores whatever the flow says; none if it is off.
    pub fn guard(&self) -> Option<&Guard<f64>> {
        self.guard.as_ref()
    }
    /// When a run has arrived.
    pub fn goal(&self) -> &Goal {
        &self.goal
    }
    /// Where runs start, m; at least one.
    pub fn starts(&self) -> &[Vector3<f64>] {
        &self.starts
    }
    /// The obstacles in the order of the file; the place in it is an obstacle's id.
    pub fn obstacles(&self) -> &[SceneObstacle] {
        &self.obstacles
    }
    /// Range points that are in the way as well.
    pub fn scan(&self) -> Option<&SceneScan> {
        self.scan.as_ref()
    }
    /// The obstacles as they are at scene time `t`, s.
    pub fn obstacles_at(&self, t: f64) -> impl ExactSizeIterator<Item = PosedObstacle<'_>> {
        self.obstacles.iter().map(move |o| o.at(t))
    }
}
