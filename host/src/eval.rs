//! The velocity at given points, here in f64 or on a device in f32.

use std::path::Path;

use nalgebra::Vector3;
use pliant_core::{Controller, RANGE, Region, RobotState, Scalar, Status, Vector};
use pliant_protocol::ToDevice;
use pliant_protocol::message::{self, TickMode};

use crate::bridge::{BridgeError, Session, wire};
use crate::error::Error;
use crate::scene::{ConvertError, MAX_OBSTACLES, Scene};
use crate::sim;

/// A tick, s: what the guard looks ahead by.
const TICK: f64 = 1e-3;

/// A stage of the tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// f(x)
    Nominal,
    /// Round the hard cores.
    Modulated,
    /// Faster or slower in soft layers.
    Adapted,
    /// Within the speed limit and guarded, from a steady state (the acceleration limit depends on the past).
    Final,
}

/// What is at one point.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// m
    pub position: Vector3<f64>,
    /// m/s
    pub velocity: Vector3<f64>,
    /// The least Gamma; none without obstacles near enough to matter.
    pub gamma: Option<f64>,
    /// free, soft, intersection or hard
    pub region: &'static str,
    /// `ok`, or the names of status flags joined by `+`.
    pub status: String,
}

/// Points of a scene's dimension, finite and within range.
#[derive(Clone, Debug, PartialEq)]
pub struct Points(Vec<Vector3<f64>>);

impl Points {
    /// Points that are known to be right.
    pub fn new(points: Vec<Vector3<f64>>) -> Self {
        Self(points)
    }

    /// Reads a CSV file with header `x,y` or `x,y,z`.
    ///
    /// # Errors
    /// The line and what is wrong with it.
    pub fn read(path: &Path, dimension: usize) -> Result<Self, Error> {
        let file = path.display();
        let bad = |line: Option<u64>, what: String| {
            Error::bad_input(line.map_or(format!("{file}: {what}"), |line| format!("{file}, line {line}: {what}")))
        };
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_path(path)
            .map_err(|e| bad(None, format!("cannot be read: {e}")))?;
        let axes = &["x", "y", "z"][..dimension];
        let header = reader.headers().map_err(|e| bad(Some(1), e.to_string()))?;
        if header.iter().ne(axes.iter().copied()) {
            let found = header.iter().collect::<Vec<_>>().join(",");
            return Err(bad(
                Some(1),
                format!("the header is `{found}`; a scene of {dimension} dimensions wants `{}`", axes.join(",")),
            ));
        }
        let mut points = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|e| bad(e.position().map(csv::Position::line), e.to_string()))?;
            let line = record.position().map(csv::Position::line);
            let mut point = Vector3::zeros();
            for ((entry, text), axis) in point.iter_mut().zip(&record).zip(axes) {
                *entry = text.parse().ok().filter(|x: &f64| x.abs() <= RANGE).ok_or_else(|| {
                    bad(line, format!("`{axis}` is `{text}`; allowed is a number between -{RANGE} and {RANGE} (m)"))
                })?;
            }
            points.push(point);
        }
        Ok(Self(points))
    }

    /// The points.
    pub fn as_slice(&self) -> &[Vector3<f64>] {
        &self.0
    }
}

/// Evaluates a scene at time 0, here, in f64.
///
/// # Errors
/// None for a checked scene.
pub fn evaluate(scene: &Scene, points: &Points, stage: Stage) -> Result<Vec<Evaluation>, ConvertError> {
    match scene.dimension() {
        2 => evaluate_in::<f64, 2>(scene, points, stage),
        _ => evaluate_in::<f64, 3>(scene, points, stage),
    }
}

fn evaluate_in<S: Scalar, const D: usize>(
    scene: &Scene,
    points: &Points,
    stage: Stage,
) -> Result<Vec<Evaluation>, ConvertError> {
    let controller: Controller<S, D, MAX_OBSTACLES> = scene.controller(0.0)?;
    // The acceleration limit depends on the past.
    let mut steady = controller.clone();
    let limits = pliant_core::Limits { acceleration: None, ..controller.settings().limits };
    steady.set_settings(pliant_core::Settings { limits, ..*controller.settings() });
    let rows = points.0.iter().filter_map(|point| {
        let state = RobotState::new(Vector::<S, D>::from_fn(|i, _| S::from_f64(point[i])))?;
        let stages = controller.evaluate(&state);
        let mut status = stages.status;
        let velocity = match stage {
            Stage::Nominal => stages.nominal,
            Stage::Modulated => stages.modulated,
            Stage::Adapted => stages.adapted,
            Stage::Final => {
                let command = steady.clone().tick(&state, S::from_f64(TICK));
                status = command.status;
                command.velocity
            }
        };
        Some(Evaluation {
            position: *point,
            velocity: Vector3::from_fn(|i, _| velocity.get(i).map_or(0.0, |v| v.to_f64())),
            gamma: (stages.gamma < S::MAX).then(|| stages.gamma.to_f64()),
            region: region_name(stages.region),
            status: status_names(status),
        })
    });
    Ok(rows.collect())
}

/// Evaluates a scene at time 0 on a device, in f32.
///
/// # Errors
/// The device refuses something, or does not answer.
pub fn evaluate_on(session: &mut Session, scene: &Scene, points: &Points) -> Result<Vec<Evaluation>, BridgeError> {
    sim::prepare(session, scene)?;
    // As in f64: neither the past nor the age of what is seen counts.
    let forever = 3600.0;
    let steady =
        message::Settings { acceleration: None, time_to_live: forever, hold: forever, ..wire::settings(scene) };
    session.request("the settings", &ToDevice::Configure(steady))?;
    session.request("clear", &ToDevice::Clear)?;
    session.request("arm", &ToDevice::Arm { tick: TickMode::Stepped })?;
    let mut rows = Vec::new();
    for (i, point) in points.0.iter().enumerate() {
        // A step takes a millisecond, in which obstacles move on and age: put them back.
        let stamp = i as u64 * 1000;
        for o in scene.obstacles_at(0.0).filter(|o| i % 100 == 0 || o.obstacle.is_moving()) {
            let obstacle = wire::obstacle(&o, scene.dimension())?;
            session.request("an obstacle", &ToDevice::Upsert { id: o.obstacle.id(), stamp, obstacle })?;
        }
        for piece in wire::scan(scene, stamp).filter(|_| i % 100 == 0) {
            session.request("the scan", &piece)?;
        }
        if let Some(aim) = wire::aim(scene, 0.0, stamp) {
            session.request("the attractor", &aim)?;
        }
        let command = session.step(stamp, wire::vector(point))?;
        rows.push(Evaluation {
            position: *point,
            velocity: Vector3::from(command.velocity.map(f64::from)),
            gamma: (command.gamma < f32::MAX).then(|| f64::from(command.gamma)),
            region: region_name(command.region.into()),
            status: status_names(Status::from_bits_truncate(command.status)),
        });
    }
    session.request("stop", &ToDevice::Stop)?;
    Ok(rows)
}

fn region_name(region: Region) -> &'static str {
    match region {
        Region::Free => "free",
        Region::Soft => "soft",
        Region::Intersection => "intersection",
        Region::Hard => "hard",
    }
}

fn status_names(status: Status) -> String {
    if status.is_empty() {
        return "ok".into();
    }
    status.iter_names().map(|(name, _)| name.to_lowercase()).collect::<Vec<_>>().join("+")
}
