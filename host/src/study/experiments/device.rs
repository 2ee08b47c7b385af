//! The same experiments on a device: the same bits on every one of them, and the same path as in this process but for rounding.

use nalgebra::Vector2;

use super::cases::Case;
use crate::bridge::Device;
use crate::error::Error;
use crate::scene::Scene;
use crate::sim::{Run, RunOptions, run_scene};
use crate::study::column::Column;
use crate::study::drive::Drive;

/// The experiments that are run on devices.
pub const ON_DEVICES: [&str; 3] = ["A1", "B1", "D1"];

/// An experiment on two devices.
#[derive(Clone, Debug)]
pub struct Compared {
    /// Which experiment.
    pub id: &'static str,
    /// The device's name and its board.
    pub device: String,
    /// Ticks.
    pub ticks: u64,
    /// CRC-32C of the bits of all its velocities.
    pub checksum: u32,
    /// Has the virtual device the same bits?
    pub identical: bool,
    /// Did it reach the goal?
    pub reached: bool,
    /// The least Gamma.
    pub min_gamma: f64,
    /// The largest distance at one time between its path and the one computed here in f64, m.
    pub apart: f64,
}

/// Runs an experiment on a device and on the virtual one, step by step.
///
/// # Errors
/// A device cannot be used, or refuses something.
pub fn compare(case: &Case<'_>, device: &Device, here: &Drive) -> Result<Compared, Error> {
    let scene = case.world.scene(case.id, Column::Pliant)?;
    let (reference, _) = run(case, &scene, &Device::Virtual)?;
    let (run, board) = run(case, &scene, device)?;
    let at = |i: usize| here.steps.get(i).map(|s| s.position);
    let apart = run.path.iter().filter_map(|p| {
        let there: Vector2<f64> = p.position.xy();
        Some((there - at((p.time / crate::sim::TICK).round() as usize)?).norm())
    });
    Ok(Compared {
        id: case.id,
        device: format!("{device} ({board})"),
        ticks: run.ticks,
        checksum: run.checksum,
        identical: (run.checksum, run.ticks) == (reference.checksum, reference.ticks),
        reached: run.reached,
        min_gamma: run.nearest.gamma,
        apart: apart.fold(0.0, f64::max),
    })
}

fn run(case: &Case<'_>, scene: &Scene, device: &Device) -> Result<(Run, String), Error> {
    let mut session = device.open()?;
    let options = RunOptions { stepped: true, perception: case.perception, ..RunOptions::default() };
    let runs = run_scene(&mut session, scene, &options, &mut |_, _, _| {})?;
    let board = session.info().board.clone();
    let run = runs.runs.into_iter().next().ok_or_else(|| Error::failed("the scene has no start"))?;
    Ok((run, board))
}
