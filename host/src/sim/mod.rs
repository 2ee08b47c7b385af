//! Driving a simulated robot through a scene with the velocities of a device.

mod camera;
mod latency;
mod robot;
mod run;
mod stepped;
mod timed;

pub use camera::{Camera, Perception, Sight};
pub use latency::Latency;
pub use robot::PointRobot;
pub use run::{Nearest, PathPoint, Run, RunOptions, Runs, TICK, prepare, run_scene};
