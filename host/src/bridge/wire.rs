//! A scene as messages.

use nalgebra::Vector3;
use pliant_core::LpvDs;
use pliant_protocol::ToDevice;
use pliant_protocol::message::{self, PIECE_MAX};
use pliant_protocol::model::{Model, Motion};

use crate::model::ModelFileError;
use crate::scene::{ConvertError, MotionSource, PosedObstacle, Scene};

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
///
/// # Errors
/// None for an obstacle of a checked scene.
pub fn obstacle(posed: &PosedObstacle<'_>, dimension: usize) -> Result<message::Obstacle, ConvertError> {
    Ok(match dimension {
        2 => message::Obstacle::from(&posed.spec::<f64, 2>()?),
        _ => message::Obstacle::from(&posed.spec::<f64, 3>()?),
    })
}

/// The scan in the pieces it is sent in; nothing if the scene has none. `stamp` is the host's clock, us.
pub fn scan(scene: &Scene, stamp: u64) -> impl Iterator<Item = ToDevice> + '_ {
    let scan = scene.scan();
    // A scene's scan has at most 128 points.
    let total = scan.map_or(0, |s| s.points().len() as u16);
    let pieces = scan.into_iter().flat_map(|s| s.points().chunks(PIECE_MAX).map(move |points| (s.radius(), points)));
    pieces.enumerate().map(move |(i, (radius, points))| ToDevice::Scan {
        stamp,
        start: (i * PIECE_MAX) as u16,
        total,
        radius: radius as f32,
        points: points.iter().map(vector).collect(),
    })
}

/// Where the attractor is at scene time `t`, s; nothing if it stays where the motion has it. `stamp` is the host's clock then, us.
pub fn aim(scene: &Scene, t: f64, stamp: u64) -> Option<ToDevice> {
    let (position, velocity) = scene.attractor_at(t);
    let aim = ToDevice::Aim { stamp, position: vector(&position), velocity: vector(&velocity) };
    scene.attractor_moves().then_some(aim)
}

/// A point as it goes over the wire.
pub fn vector(v: &Vector3<f64>) -> [f32; 3] {
    [v.x, v.y, v.z].map(|x| x as f32)
}
