//! One experiment run once, and what is measured of it.

use serde_json::{Value, json};

use super::cases::Case;
use crate::error::Error;
use crate::scene::Scene;
use crate::study::column::Column;
use crate::study::drive::{Drive, Driving, Robot, Step, drive};
use crate::study::measure;

/// How robots follow in experiments.
const ROBOT: Robot = Robot::Lagging;

/// A run of an experiment.
#[derive(Clone, Debug)]
pub struct Outcome<'a> {
    /// Which experiment.
    pub case: &'a Case<'a>,
    /// Computed how.
    pub column: Column,
    /// What was driven through.
    pub scene: Scene,
    /// Where the robot went.
    pub drive: Drive,
}

/// In exactly one soft layer, or where one would be if the method knew of it.
pub fn soft(step: &Step) -> bool {
    step.layers == 1 && step.gamma > 1.0
}

/// Where soft layers overlap.
pub fn intersection(step: &Step) -> bool {
    step.layers > 1 && step.gamma > 1.0
}

impl<'a> Outcome<'a> {
    /// Runs it with a robot that follows with a lag.
    ///
    /// # Errors
    /// None for the experiments as they are.
    pub fn of(case: &'a Case<'a>, column: Column) -> Result<Self, Error> {
        let scene = case.world.scene(case.id, column)?;
        let driving = Driving { perception: case.perception, ..Driving::of(ROBOT) };
        let drive = drive(&scene, &case.world.skill.start, &driving, None)?;
        Ok(Self { case, column, scene, drive })
    }

    /// Mean speed in exactly one soft layer, m/s.
    pub fn soft_speed(&self) -> Option<f64> {
        measure::mean_speed(&self.drive, soft)
    }

    /// Mean speed where soft layers overlap, m/s.
    pub fn intersection_speed(&self) -> Option<f64> {
        measure::mean_speed(&self.drive, intersection)
    }

    /// Mean and largest distance from the path without obstacles, m.
    pub fn deviation(&self) -> (f64, f64) {
        measure::deviation(&self.drive, self.case.world.skill)
    }

    /// Did it arrive without touching a core?
    pub fn is_well(&self) -> bool {
        self.drive.reached && !self.drive.touched()
    }

    /// For programs.
    pub fn json(&self) -> Value {
        let (mean, most) = self.deviation();
        json!({
            "column": self.column.key(),
            "reached": self.drive.reached,
            "time_s": self.drive.time(),
            "min_gamma": self.drive.min_gamma(),
            "touched": self.drive.touched(),
            "mean_speed": measure::mean_speed(&self.drive, |_| true),
            "mean_speed_soft": self.soft_speed(),
            "mean_speed_intersection": self.intersection_speed(),
            "mean_deviation_m": mean,
            "max_deviation_m": most,
            "rms_jerk": measure::jerk(&self.drive, ROBOT.ramp()),
            "largest_velocity_jump": measure::largest_jump(&self.drive, ROBOT.ramp()),
            "guarded_share": measure::guarded(&self.drive),
        })
    }
}
