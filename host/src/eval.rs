//! The velocity at given points, here in f64 or on a device in f32.

use std::path::Path;

use nalgebra::Vector3;
use pliant_core::{Controller, RANGE, Region, RobotState, Scalar, Status, Vector};
use pliant_protocol::ToDevice;
use pliant_protocol::message::{self, TickMode};

use crate::bridge::{BridgeError, Session, wire};
use crate::error::{Error, counted};
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
        let file = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|e| Error::bad_input(format!("{file}: cannot be read: {e}")))?;
        Self::parse(&bytes, dimension)
            .map_err(|(line, what)| Error::bad_input(format!("{file}, line {line}: {what}")).at_line(&file, line))
    }

    /// The line at fault, from 1, and what is wrong with it.
    fn parse(bytes: &[u8], dimension: usize) -> Result<Self, (u64, String)> {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).flexible(true).from_reader(bytes);
        // Of a flexible reader in memory that is all that can go wrong.
        let broken = |e: csv::Error| {
            (
                e.position().map_or(1, csv::Position::line),
                "it is not UTF-8 text; allowed are comma-separated numbers".into(),
            )
        };
        let axes = &["x", "y", "z"][..dimension];
        let wanted = format!("a scene of {dimension} dimensions wants the header `{}`", axes.join(","));
        let header = reader.headers().map_err(broken)?;
        if header.iter().all(str::is_empty) {
            return Err((1, format!("the file is empty; {wanted}")));
        }
        if header.iter().ne(axes.iter().copied()) {
            let found: String = header.iter().collect::<Vec<_>>().join(",").chars().take(60).collect();
            return Err((1, format!("the header is `{found}`; {wanted}")));
        }
        let mut points = Vec::new();
        for record in reader.records() {
            let record = record.map_err(broken)?;
            let line = record.position().map_or(1, csv::Position::line);
            if record.len() != dimension {
                let found = counted(record.len(), "field");
                return Err((line, format!("it has {found}; allowed is one for each of `{}`", axes.join(","))));
            }
            let mut point = Vector3::zeros();
            for ((entry, text), axis) in point.iter_mut().zip(&record).zip(axes) {
                *entry = text.parse().ok().filter(|x: &f64| x.abs() <= RANGE).ok_or_else(|| {
                    (line, format!("`{axis}` is `{text}`; allowed is a number between -{RANGE} and {RANGE} (m)"))
                })?;
            }
            points.push(point);
        }
        if points.is_empty() {
            return Err((1, "there are no points below the header; allowed is one or more".into()));
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
    if status.is_empty() { "ok".into() } else { flag_names(status).join("+") }
}

/// The name of every flag of a status, as people read it.
pub(crate) fn flag_names(status: Status) -> Vec<String> {
    status.iter_names().map(|(name, _)| name.to_lowercase()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn refused(text: &[u8]) -> (u64, String) {
        Points::parse(text, 2).expect_err("must be refused")
    }

    #[test]
    fn points_are_read_or_the_line_is_named() {
        let read = Points::parse("\u{feff}x, y\r\n1,2\n\n-3,4e-1\n".as_bytes(), 2).expect("valid");
        assert_eq!(read.as_slice(), [Vector3::new(1.0, 2.0, 0.0), Vector3::new(-3.0, 0.4, 0.0)]);
        for (text, line, words) in [
            (&b""[..], 1, "the file is empty; a scene of 2 dimensions wants the header `x,y`"),
            (b"\n\n", 1, "the file is empty"),
            (b"a,b\n1,2\n", 1, "the header is `a,b`"),
            (b"x,y\n", 1, "no points"),
            (b"x,y\n1,2\n3\n", 3, "it has 1 field; allowed is one for each of `x,y`"),
            (b"x,y\n1,2,3\n", 2, "it has 3 fields"),
            (b"x,y\n1,one\n", 2, "`y` is `one`"),
            (b"x,y\n1,nan\n", 2, "`y` is `nan`"),
            (b"x,y\n1,1001\n", 2, "between -1000 and 1000"),
            (b"x,y\n\xff,1\n", 2, "not UTF-8"),
        ] {
            let (at, what) = refused(text);
            assert!(at == line && what.contains(words), "{at}: {what}");
        }
    }

    proptest! {
        #[test]
        fn never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..200), text in "[0-9.e,\n-]{0,60}") {
            let _ = Points::parse(&bytes, 2);
            if let Ok(points) = Points::parse(format!("x,y,z\n{text}").as_bytes(), 3) {
                prop_assert!(points.as_slice().iter().flatten().all(|c| c.abs() <= RANGE));
            }
        }
    }
}
