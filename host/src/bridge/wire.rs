//! A scene as messages.

use nalgebra::Vector3;
use pliant_core::LpvDs;
use pliant_protocol::message;
use pliant_protocol::model::{Model, Motion};

use crate::model::ModelFileError;
use crate::scene::{MotionSource, PosedObstacle, Scene};

/// The skill of a scene, rounded to f32.
///
/// # Errors
/// The model is not one; a checked scene's always is.
pub fn model(scene: &Scene) -> Result<Model, ModelFileError> {
    match (scene.motion_source(), scene.dimension()) {
        (MotionSource::Linear { attractor, gain }, d) => {
            let motion = Motion::Linear { attractor: vector(attractor), gain: *gain as f32 };
            Ok(Model { dimension: d as u8, motion })
        }
        (MotionSource::Model { model, .. }, 2) => Ok(Model::from(&model.lpv_ds::<f32, 2>()?)),
        (MotionSource::Model { model, .. }, _) => {
            let ds: LpvDs<f32, 3> = model.lpv_ds()?;
            Ok(Model::from(&ds))
        }
    }
}

/// How a scene modulates, and its limits.
pub fn settings(scene: &Scene) -> message::Settings {
    message::Settings::from(&scene.settings::<f64>())
}

/// An obstacle where it is, in a scene of so many dimensions.
pub fn obstacle(posed: &PosedObstacle<'_>, dimension: usize) -> message::Obstacle {
    match dimension {
        2 => message::Obstacle::from(&posed.spec::<f64, 2>()),
        _ => message::Obstacle::from(&posed.spec::<f64, 3>()),
    }
}

/// A point as it goes over the wire.
pub fn vector(v: &Vector3<f64>) -> [f32; 3] {
    [v.x, v.y, v.z].map(|x| x as f32)
}
