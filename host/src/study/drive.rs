//! A robot driven through a scene by the core itself, in this process: much faster than by a device, and in f64.

use nalgebra::{Vector2, Vector3};
use pliant_core::{Controller, RobotState, Status, Vector};

use crate::error::Error;
use crate::plot::{Trajectory, TrajectoryPoint};
use crate::scene::{PosedObstacle, Scene};
use crate::sim::{Camera, Perception, PointRobot, TICK};

/// Most obstacles of a study's scene.
const CAPACITY: usize = 8;

/// How a robot follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Robot {
    /// Exactly: what the method itself does.
    Exact,
    /// With the lag of a well-tuned arm, as in `pliant run`.
    Lagging,
}

impl Robot {
    /// Ticks until it is up to speed from rest: one, or ten times its lag, when e^-10 of the way there is left. What is before tells of the start alone.
    pub fn ramp(self) -> usize {
        match self {
            Self::Exact => 1,
            Self::Lagging => (10.0 * PointRobot::LAG / TICK).round() as usize,
        }
    }
}

/// A millisecond of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// m
    pub position: Vector2<f64>,
    /// The robot's, m/s.
    pub velocity: Vector2<f64>,
    /// The least Gamma, by what is really there; infinite without obstacles.
    pub gamma: f64,
    /// In how many soft layers the robot is, by what is really there.
    pub layers: u8,
    /// What the command was computed under.
    pub status: Status,
}

/// A run from a start to its end, a step a millisecond.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// The steps, by time from 0.
    pub steps: Vec<Step>,
    /// Did it come to the goal in time?
    pub reached: bool,
}

impl Drive {
    /// s
    pub fn time(&self) -> f64 {
        self.steps.len().saturating_sub(1) as f64 * TICK
    }
    /// The least Gamma of all.
    pub fn min_gamma(&self) -> f64 {
        self.steps.iter().map(|s| s.gamma).fold(f64::INFINITY, f64::min)
    }
    /// Was a core touched?
    pub fn touched(&self) -> bool {
        !(self.min_gamma() > 1.0)
    }
    /// For a figure: every tenth step, and the last.
    pub fn trajectory(&self) -> Trajectory {
        let last = self.steps.len().saturating_sub(1);
        let kept = self.steps.iter().enumerate().filter(|(i, _)| i % 10 == 0 || *i == last);
        let point = |(i, s): (usize, &Step)| TrajectoryPoint {
            time: i as f64 * TICK,
            position: s.position.push(0.0),
            speed: s.velocity.norm(),
        };
        Trajectory { points: kept.map(point).collect() }
    }
}

/// How to drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driving {
    /// How the robot follows.
    pub robot: Robot,
    /// How well it sees.
    pub perception: Perception,
    /// End where a core is touched?
    pub ends_at_contact: bool,
}

impl Driving {
    /// A robot that sees all exactly, to the end.
    pub fn of(robot: Robot) -> Self {
        Self { robot, perception: Perception::default(), ends_at_contact: false }
    }
}

/// Drives from a place to the goal of the scene, or as near as `target` says (centre and radius, m).
///
/// # Errors
/// None for a planar scene of few obstacles.
pub fn drive(
    scene: &Scene,
    start: &Vector2<f64>,
    driving: &Driving,
    target: Option<(Vector2<f64>, f64)>,
) -> Result<Drive, Error> {
    let mut controller: Controller<f64, 2, CAPACITY> = scene.controller(0.0)?;
    let mut camera = Camera::new(scene, driving.perception);
    let mut robot = PointRobot::at(start.push(0.0));
    let (goal, tolerance) = target.unwrap_or((flat(&scene.attractor()), scene.goal().tolerance));
    let moves = scene.obstacles().iter().any(|o| o.is_moving());
    let mut true_ones: Vec<PosedObstacle<'_>> = scene.obstacles_at(0.0).collect();
    let mut steps = Vec::new();
    let mut status = Status::empty();
    for tick in 0_u64.. {
        let time = tick as f64 * TICK;
        if moves {
            true_ones = scene.obstacles_at(time).collect();
        }
        let step = look(&true_ones, &robot, status);
        steps.push(step);
        let reached = (step.position - goal).norm() <= tolerance;
        if reached || time >= scene.goal().timeout || (driving.ends_at_contact && !(step.gamma > 1.0)) {
            return Ok(Drive { steps, reached });
        }
        if let Some(sight) = camera.at(tick) {
            let age = (tick - sight.tick) as f64 * TICK;
            for o in &sight.obstacles {
                // There is room: the controller was made with all of them.
                let _ = controller.upsert(o.obstacle.id(), o.to_core()?, age);
            }
        }
        let Some(state) = RobotState::new(Vector::from(step.position)) else { break };
        let command = controller.tick(&state, TICK);
        status = command.status;
        match driving.robot {
            Robot::Lagging => robot.step(&command.velocity.push(0.0), TICK),
            Robot::Exact => {
                robot.velocity = command.velocity.push(0.0);
                robot.position += robot.velocity * TICK;
            }
        }
    }
    Ok(Drive { steps, reached: false })
}

fn look(all: &[PosedObstacle<'_>], robot: &PointRobot, status: Status) -> Step {
    let x = &robot.position;
    let (mut gamma, mut layers) = (f64::INFINITY, 0);
    for o in all {
        gamma = gamma.min(o.gamma(x));
        layers += u8::from(o.gamma_soft(x) <= 1.0);
    }
    Step { position: flat(x), velocity: flat(&robot.velocity), gamma, layers, status }
}

fn flat(v: &Vector3<f64>) -> Vector2<f64> {
    v.xy()
}
