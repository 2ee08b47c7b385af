//! One obstacle on one side of the path, passed in every way, and what is measured of it.

use crate::error::Error;
use crate::study::column::{Column, Way};
use crate::study::drive::{Drive, Driving, Robot, Step, drive};
use crate::study::measure::{self, change_percent};
use crate::study::skill::Skill;
use crate::study::world::{Body, World};

/// Below this speed, m/s, farther than [`FAR`] from the goal a robot counts as stalled.
const STALLED: f64 = 0.005;
/// m
const FAR: f64 = 0.03;
/// A run is given up after this, s.
const TIMEOUT: f64 = 15.0;
const ROBOT: Robot = Robot::Exact;

/// How a run that ends at a core would have gone on, were the core no obstacle to the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum After {
    /// Through the core to the goal.
    Arrives,
    /// Not to the goal: it comes to rest on the way.
    Stalls,
    /// Neither, until it is given up.
    Wanders,
}

/// What is measured of a run.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    pub reached: bool,
    /// Was Gamma below 1? A robot that rests on a surface, at 1, stalls.
    pub entered: bool,
    pub stalled: bool,
    /// None where it did not end at a core.
    pub after: Option<After>,
    pub time: f64,
    pub min_gamma: f64,
    pub soft_speed: Option<f64>,
    pub jerk: f64,
    pub jump: f64,
    pub guarded: f64,
}

impl Measured {
    /// Did it end at a core without having stalled before, and would it have, had it gone on?
    pub fn would_stall(&self) -> bool {
        !self.stalled && self.after == Some(After::Stalls)
    }

    /// Drives until it arrives, touches a core, or is given up; and where it touches one, once more through it.
    fn of(world: &World<'_>, way: Way) -> Result<Self, Error> {
        let (scene, skill) = (world.scene("placement", way)?, world.skill);
        let run = |ends_at_contact| {
            let driving = Driving { ends_at_contact, ..Driving::of(ROBOT) };
            drive(&scene, &skill.start, &driving, None)
        };
        let drive = run(true)?;
        let after = drive.touched().then(|| Ok::<_, Error>(after(&run(false)?, skill))).transpose()?;
        Ok(Self {
            reached: drive.reached,
            entered: drive.min_gamma() < 1.0,
            stalled: stalls(&drive, skill),
            after,
            time: drive.time(),
            min_gamma: drive.min_gamma(),
            soft_speed: measure::mean_speed(&drive, |s| s.layers > 0 && s.gamma > 1.0),
            jerk: measure::jerk(&drive, ROBOT.ramp()),
            jump: measure::largest_jump(&drive, ROBOT.ramp()),
            guarded: measure::guarded(&drive),
        })
    }
}

/// Does it ever rest far from the goal?
fn stalls(drive: &Drive, skill: &Skill) -> bool {
    let goal = skill.goal();
    let still = |s: &Step| s.velocity.norm() < STALLED && (s.position - goal).norm() > FAR;
    // The first step stands: the robot has not been told anything yet.
    drive.steps.iter().skip(1).any(still)
}

fn after(whole: &Drive, skill: &Skill) -> After {
    match (whole.reached, stalls(whole, skill)) {
        (true, _) => After::Arrives,
        (false, true) => After::Stalls,
        (false, false) => After::Wanders,
    }
}

/// One obstacle on one side of the path, each way; the order is that of [`Column::ALL`].
#[derive(Clone, Copy, Debug)]
pub struct Passed {
    pub left: bool,
    /// As the columns are.
    pub runs: [Measured; 3],
    /// The same with the guard where a column has none, and without where it has one.
    pub others: [Measured; 3],
}

impl Passed {
    /// Passes a body that is on the left of the path, or on its right.
    pub fn of(skill: &Skill, left: bool, body: &Body) -> Result<Self, Error> {
        let world = World { timeout: TIMEOUT, ..World::new(skill, vec![body.clone()]) };
        let [letter, pliant, original] = Column::ALL.map(|column| Measured::of(&world, column.into()));
        let runs = [letter?, pliant?, original?];
        let [letter, pliant, original] = Column::ALL.map(|column| Measured::of(&world, Way::other(column)));
        Ok(Self { left, runs, others: [letter?, pliant?, original?] })
    }

    /// Change of mean speed in the soft layer against the original method, percent.
    pub fn speed_change(&self, ours: &Measured) -> Option<f64> {
        Some(change_percent(ours.soft_speed?, self.runs[2].soft_speed?))
    }

    /// Change of the time to the goal, likewise.
    pub fn time_change(&self, ours: &Measured) -> Option<f64> {
        let original = &self.runs[2];
        (ours.reached && original.reached).then(|| change_percent(ours.time, original.time))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::skill::Skills;
    use nalgebra::Vector2;

    #[test]
    fn a_run_that_ends_at_a_core_is_followed_through_it() {
        let skills = Skills::new(None, &|_| {}).unwrap();
        let skill = &skills.s;
        let run = |at: &[Vector2<f64>], reached| {
            let step = |i: usize| Step {
                position: at[i],
                velocity: if i == 0 { Vector2::zeros() } else { (at[i] - at[i - 1]) / crate::sim::TICK },
                gamma: 0.9,
                layers: 1,
                status: pliant_core::Status::empty(),
            };
            after(&Drive { steps: (0..at.len()).map(step).collect(), reached }, skill)
        };
        let (near, far) = (skill.goal(), skill.start);
        let aside = far + Vector2::new(0.01, 0.0);
        assert_eq!(run(&[far, aside, near], true), After::Arrives);
        assert_eq!(run(&[far, aside, aside], false), After::Stalls);
        assert_eq!(run(&[far, aside, far, aside], false), After::Wanders);
        // Resting at the goal is no stall, and what rests on the way but arrives does not stall for good.
        assert_eq!(run(&[far, near, near], false), After::Wanders);
        assert_eq!(run(&[far, far, near], true), After::Arrives);
    }
}
