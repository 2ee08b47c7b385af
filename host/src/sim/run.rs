//! A scene from every one of its starts.

use nalgebra::Vector3;
use pliant_core::Status;
use pliant_protocol::message::{Mode, Region, Statistics};
use pliant_protocol::{ToDevice, checksum};

use super::{Latency, Perception, Sight, stepped, timed};
use crate::bridge::session::Received;
use crate::bridge::{BridgeError, Session, wire};
use crate::scene::{Scene, SceneScan};

/// How often obstacles are reported, in ticks: a camera's 30 Hz.
pub(super) const PERCEPTION_TICKS: u64 = 33;
/// Ticks between the points of a path that are kept.
const KEPT_TICKS: u64 = 10;
/// A tick, s.
pub const TICK: f64 = 1e-3;

/// How to run.
#[derive(Clone, Copy, Debug, Default)]
pub struct RunOptions {
    /// One tick a state, as fast as it goes, instead of the device's clock.
    pub stepped: bool,
    /// Give up after this long, s; the scene's own timeout if not given.
    pub duration: Option<f64>,
    /// The link cannot carry a state a millisecond: send every tenth.
    pub slow_link: bool,
    /// How well obstacles are seen.
    pub perception: Perception,
}

/// Where the robot was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// s from the start
    pub time: f64,
    /// m
    pub position: Vector3<f64>,
    /// m/s
    pub velocity: Vector3<f64>,
    /// By the device.
    pub region: Region,
}

/// One start to its end.
#[derive(Clone, Debug)]
pub struct Run {
    /// m
    pub start: Vector3<f64>,
    /// Did it come within the goal's tolerance in time?
    pub reached: bool,
    /// Commands of the device that were used.
    pub ticks: u64,
    /// Ticks the device was due and did not compute.
    pub missed: u64,
    /// All that the commands' status said.
    pub status: Status,
    /// Commands of which it said [`Status::INFEASIBLE`].
    pub infeasible: u64,
    /// Those of them that came before the robot had been in any core or its safety factor.
    pub before_entry: u64,
    /// Milliseconds in which this host came too late to send a state in time.
    pub host_late: u64,
    /// What came nearest, by the scene's true geometry in f64: hard cores as they are, without their safety factors.
    pub nearest: Nearest,
    /// The same of cores with their safety factors, which the device keeps the robot out of.
    pub nearest_margin: Nearest,
    /// s; none if the goal was not reached.
    pub time_to_goal: Option<f64>,
    /// Where it went, every 10 ms.
    pub path: Vec<PathPoint>,
    /// The bits of every velocity, in order: two devices that agree have the same checksum.
    pub checksum: u32,
    pub(super) round_trips: Vec<f64>,
}

/// The least Gamma at any time of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Nearest {
    /// Infinite without obstacles and scan.
    pub gamma: f64,
    /// Whose it is: an obstacle's name, or [`SceneScan::NAME`].
    pub of: Option<String>,
}

impl Nearest {
    const NOTHING: Self = Self { gamma: f64::INFINITY, of: None };

    fn seen(&mut self, gamma: f64, name: &str) {
        if gamma < self.gamma {
            (self.gamma, self.of) = (gamma, Some(name.into()));
        }
    }

    /// Was it touched?
    pub fn touched(&self) -> bool {
        self.gamma <= 1.0
    }
}

/// All starts of a scene.
#[derive(Clone, Debug)]
pub struct Runs {
    /// In the scene's order.
    pub runs: Vec<Run>,
    /// From a state sent to its command received, us.
    pub rtt_us: Latency,
    /// What the device counted since it started.
    pub statistics: Statistics,
}

impl Runs {
    /// Did every run reach the goal?
    pub fn reached(&self) -> bool {
        self.runs.iter().all(|r| r.reached)
    }
    /// Did no run touch a hard core? (Its margin may have been entered.)
    pub fn untouched(&self) -> bool {
        !self.runs.iter().any(|r| r.nearest.touched())
    }
    /// The least Gamma of all runs, of cores without their safety factors.
    pub fn min_gamma(&self) -> f64 {
        self.runs.iter().map(|r| r.nearest.gamma).fold(f64::INFINITY, f64::min)
    }
    /// The same of cores with their safety factors.
    pub fn min_gamma_with_margin(&self) -> f64 {
        self.runs.iter().map(|r| r.nearest_margin.gamma).fold(f64::INFINITY, f64::min)
    }
    /// The longest time to the goal; none if one run did not reach it.
    pub fn time_to_goal(&self) -> Option<f64> {
        self.runs.iter().map(|r| r.time_to_goal).try_fold(0.0, |longest, t| t.map(|t| t.max(longest)))
    }
}

/// Uploads a scene and drives a point robot from every start. `watch` is told where the robot is: start, time (s), distance to go (m).
///
/// # Errors
/// The device refuses something, or does not answer.
pub fn run_scene(
    session: &mut Session,
    scene: &Scene,
    options: &RunOptions,
    watch: &mut dyn FnMut(usize, f64, f64),
) -> Result<Runs, BridgeError> {
    prepare(session, scene)?;
    let runs = drive(session, scene, options, watch);
    if runs.is_err() {
        // Whatever went wrong, the device is not to go on.
        let _ = session.send(&ToDevice::Stop);
    }
    runs
}

fn drive(
    session: &mut Session,
    scene: &Scene,
    options: &RunOptions,
    watch: &mut dyn FnMut(usize, f64, f64),
) -> Result<Runs, BridgeError> {
    let mut runs = Vec::new();
    let mut clock = 0;
    for (i, start) in scene.starts().iter().enumerate() {
        let mut log = Log::new(scene, *start);
        let mut watch = |time: f64, distance: f64| watch(i, time, distance);
        if options.stepped {
            stepped::drive(session, scene, options, &mut clock, &mut log, &mut watch)?;
        } else {
            timed::drive(session, scene, options, &mut clock, &mut log, &mut watch)?;
        }
        runs.push(log.finish());
    }
    let mut times: Vec<f64> = runs.iter().flat_map(|r| r.round_trips.iter().copied()).collect();
    let statistics = session.statistics()?;
    Ok(Runs { runs, rtt_us: Latency::of(&mut times), statistics })
}

/// Uploads the skill and the settings of a scene, after checking that the device has room for it.
///
/// # Errors
/// It has not, refuses something, or does not answer.
pub fn prepare(session: &mut Session, scene: &Scene) -> Result<(), BridgeError> {
    let (room, wanted) = (usize::from(session.info().obstacles), scene.obstacles().len());
    if wanted > room {
        return Err(BridgeError::Capacity { device: session.device().into(), what: "obstacles", room, wanted });
    }
    let model =
        wire::model(scene).map_err(|e| BridgeError::Emulator(format!("the scene's model cannot be sent: {e}")))?;
    session.request("stop", &ToDevice::Stop)?;
    session.upload(&model)?;
    session.request("the settings", &ToDevice::Configure(wire::settings(scene)))
}

/// What was seen of the scene, as messages: every obstacle, the scan, and the attractor if it moves, stamped with what the host's clock was at
/// the time, us.
///
/// # Errors
/// An obstacle cannot be sent; one of a checked scene always can.
pub(super) fn messages(
    scene: &Scene,
    sight: &Sight<'_>,
    stamp: u64,
) -> Result<Vec<(&'static str, ToDevice)>, BridgeError> {
    let mut seen = Vec::with_capacity(sight.obstacles.len() + 1);
    for o in &sight.obstacles {
        let obstacle = wire::obstacle(o, scene.dimension())?;
        seen.push(("an obstacle", ToDevice::Upsert { id: o.obstacle.id(), stamp, obstacle }));
    }
    seen.extend(wire::scan(scene, stamp).map(|piece| ("the scan", piece)));
    seen.extend(wire::aim(scene, sight.time(), stamp).map(|aim| ("the attractor", aim)));
    Ok(seen)
}

/// A run as it goes on.
pub(super) struct Log<'a> {
    scene: &'a Scene,
    run: Run,
    seen: u64,
    bits: Vec<u8>,
}

impl<'a> Log<'a> {
    fn new(scene: &'a Scene, start: Vector3<f64>) -> Self {
        let run = Run {
            start,
            reached: false,
            ticks: 0,
            missed: 0,
            status: Status::empty(),
            infeasible: 0,
            before_entry: 0,
            host_late: 0,
            nearest: Nearest::NOTHING,
            nearest_margin: Nearest::NOTHING,
            time_to_goal: None,
            path: Vec::new(),
            checksum: 0,
            round_trips: Vec::new(),
        };
        Self { scene, run, seen: 0, bits: Vec::new() }
    }

    pub(super) fn start(&self) -> Vector3<f64> {
        self.run.start
    }

    /// A command came, `rtt` us after its state went.
    ///
    /// # Errors
    /// It says that the device has stopped.
    pub(super) fn command(&mut self, device: &str, command: &Received, rtt: Option<f64>) -> Result<(), BridgeError> {
        if let Mode::Stopped(_) = command.mode {
            return Err(BridgeError::Stopped { device: device.into(), mode: command.mode });
        }
        self.run.ticks += 1;
        let status = Status::from_bits_truncate(command.status);
        self.run.status |= status;
        let infeasible = status.contains(Status::INFEASIBLE);
        self.run.infeasible += u64::from(infeasible);
        self.run.before_entry += u64::from(infeasible && !self.run.nearest_margin.touched());
        self.bits.extend(command.velocity.iter().flat_map(|v| v.to_bits().to_le_bytes()));
        self.run.round_trips.extend(rtt);
        Ok(())
    }

    /// The robot is here; true once it has arrived.
    pub(super) fn moved(&mut self, time: f64, position: Vector3<f64>, velocity: Vector3<f64>, region: Region) -> bool {
        for o in self.scene.obstacles_at(time) {
            let (gamma, name) = (o.gamma(&position), o.obstacle.name());
            self.run.nearest_margin.seen(gamma, name);
            let bare = if o.obstacle.has_margin() { o.without_margin().gamma(&position) } else { gamma };
            self.run.nearest.seen(bare, name);
        }
        if let Some(gamma) = self.scene.scan().map(|s| s.gamma(&position)) {
            self.run.nearest_margin.seen(gamma, SceneScan::NAME);
            self.run.nearest.seen(gamma, SceneScan::NAME);
        }
        let arrived = self.distance(time, &position) <= self.scene.goal().tolerance;
        if self.seen.is_multiple_of(KEPT_TICKS) || arrived {
            self.run.path.push(PathPoint { time, position, velocity, region });
        }
        self.seen += 1;
        if arrived {
            (self.run.reached, self.run.time_to_goal) = (true, Some(time));
        }
        arrived
    }

    /// How far it is at this time from where the attractor then is, m.
    pub(super) fn distance(&self, time: f64, position: &Vector3<f64>) -> f64 {
        (position - self.scene.attractor_at(time).0).norm()
    }

    pub(super) fn missed(&mut self, ticks: u64) {
        self.run.missed += ticks;
    }

    pub(super) fn host_late(&mut self) {
        self.run.host_late += 1;
    }

    fn finish(mut self) -> Run {
        self.run.checksum = checksum(&self.bits);
        self.run
    }
}
