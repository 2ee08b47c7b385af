//! Real time: the device ticks by its own clock, the robot moves by the host's.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use nalgebra::Vector3;
use pliant_protocol::ToDevice;
use pliant_protocol::message::{DeviceError, Region, TickMode};

use super::run::{Log, PERCEPTION_TICKS, RunOptions, TICK, messages};
use super::{Camera, PointRobot};
use crate::bridge::session::Event;
use crate::bridge::{BridgeError, Session, wire};
use crate::scene::Scene;

/// Ticks between two states on a link that cannot carry more.
const SLOW_TICKS: u64 = 10;
/// Most messages taken in one tick; a device sends one command a tick and answers what it is sent.
const EVENTS: usize = 100;
/// Without a command for this long, the robot stands.
const QUIET: Duration = Duration::from_millis(100);
/// Without one for this long, the run is over.
const GIVE_UP: Duration = Duration::from_secs(3);
/// States under way whose command has not come; older ones are given up.
const UNDER_WAY: usize = 256;

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
    let state_ticks = if options.slow_link { SLOW_TICKS } else { 1 };
    session.request("clear", &ToDevice::Clear)?;
    let (mut camera, first) = (Camera::new(scene, options.perception), *clock);
    for (what, message) in camera.at(0).map_or(Ok(Vec::new()), |sight| messages(scene, &sight, first))? {
        session.request(what, &message)?;
    }
    session.request("arm", &ToDevice::Arm { tick: TickMode::Timed })?;
    let missed = session.statistics()?.missed;
    let mut wanted = Vector3::zeros();
    let mut region = Region::Free;
    let mut under_way: VecDeque<(u16, Instant)> = VecDeque::new();
    let begin = Instant::now();
    let mut heard = begin;
    for tick in 0.. {
        let time = tick as f64 * TICK;
        if log.moved(time, robot.position, robot.velocity, region) || time >= patience {
            break;
        }
        if let Some(sight) = (tick > 0).then(|| camera.at(tick)).flatten() {
            for (_, message) in messages(scene, &sight, first + sight.tick * 1000)? {
                session.send(&message)?;
            }
        }
        if u64::is_multiple_of(tick, PERCEPTION_TICKS) {
            watch(time, log.distance(time, &robot.position));
        }
        if u64::is_multiple_of(tick, state_ticks) {
            let state = ToDevice::State { stamp: *clock, position: wire::vector(&robot.position) };
            if under_way.len() == UNDER_WAY {
                under_way.pop_front();
            }
            under_way.push_back((session.send(&state)?, Instant::now()));
        }
        let end = begin + Duration::from_secs_f64((tick + 1) as f64 * TICK);
        let late = Instant::now().saturating_duration_since(end).as_millis() as u64;
        if late > 0 {
            log.host_late();
        }
        let silence = heard.elapsed();
        if silence > QUIET {
            wanted = Vector3::zeros();
        }
        if silence > GIVE_UP {
            return Err(BridgeError::Silent { device: session.device().into(), seconds: GIVE_UP.as_secs_f64() });
        }
        // Bounded, so that a host that is late and a device that talks without pause still get to the next tick.
        for _ in 0..EVENTS {
            let left = end.saturating_duration_since(Instant::now());
            match session.event(left)? {
                Some(Event::Command(command)) => {
                    let of = under_way.iter().position(|(sequence, _)| *sequence == command.state);
                    let rtt = of.map(|i| {
                        let (_, sent) = under_way[i];
                        under_way.drain(..=i);
                        sent.elapsed().as_secs_f64() * 1e6
                    });
                    log.command(session.device(), &command, rtt)?;
                    heard = Instant::now();
                    wanted = Vector3::from(command.velocity.map(f64::from));
                    region = command.region;
                }
                // A piece was lost on the way: the scan before it stays, and the next one comes soon.
                Some(Event::Refused(DeviceError::Scan(_))) => {}
                Some(Event::Refused(error)) => {
                    let device = session.device().into();
                    return Err(BridgeError::Refused { device, what: "the run".into(), error });
                }
                None => break,
            }
        }
        robot.step(&wanted, TICK);
        *clock += 1000;
    }
    session.request("stop", &ToDevice::Stop)?;
    log.missed(u64::from(session.statistics()?.missed.saturating_sub(missed)));
    Ok(())
}
