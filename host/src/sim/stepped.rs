//! Lock-step: the device ticks when the robot has moved. As fast as the machine, and the same every time.

use std::time::Instant;

use nalgebra::Vector3;
use pliant_protocol::ToDevice;
use pliant_protocol::message::{Region, TickMode};

use super::run::{Log, PERCEPTION_TICKS, RunOptions, TICK, messages};
use super::{Camera, PointRobot};
use crate::bridge::{BridgeError, Session, wire};
use crate::scene::Scene;

/// From a start to the goal or the end of patience. `clock` is the host's, us, and goes on from run to run.
pub(super) fn drive(
    session: &mut Session,
    scene: &Scene,
    options: &RunOptions,
    clock: &mut u64,
    log: &mut Log<'_>,
    watch: &mut dyn FnMut(f64, f64),
) -> Result<(), BridgeError> {
    let mut robot = PointRobot::at(log.start());
    let patience = options.duration.unwrap_or(scene.goal().timeout);
    let mut region = Region::Free;
    let (mut camera, begin) = (Camera::new(scene, options.perception), *clock);
    session.request("clear", &ToDevice::Clear)?;
    session.request("arm", &ToDevice::Arm { tick: TickMode::Stepped })?;
    for tick in 0.. {
        let time = tick as f64 * TICK;
        if log.moved(time, robot.position, robot.velocity, region) || time >= patience {
            break;
        }
        if let Some(sight) = camera.at(tick) {
            for (what, message) in messages(scene, &sight, begin + sight.tick * 1000)? {
                session.request(what, &message)?;
            }
        }
        if u64::is_multiple_of(tick, PERCEPTION_TICKS) {
            watch(time, log.distance(time, &robot.position));
        }
        let sent = Instant::now();
        let command = session.step(*clock, wire::vector(&robot.position))?;
        log.command(session.device(), &command, Some(sent.elapsed().as_secs_f64() * 1e6))?;
        region = command.region;
        robot.step(&Vector3::from(command.velocity.map(f64::from)), TICK);
        *clock += 1000;
    }
    session.request("stop", &ToDevice::Stop)
}
