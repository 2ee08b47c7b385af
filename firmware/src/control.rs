//! The half that faces the clock: modes, watchdogs and the tick.

use pliant_core::Settings;
use pliant_protocol::message::{self, DeviceError, Mode, StopReason, TickMode, ToHost};

use crate::TICK_HZ;
use crate::space::{AnyMotion, AnyObstacle, AnyState, Flat, OtherDimension, Space};

/// Ticks without a fresh robot state after which the command ramps to zero.
pub const LATE_TICKS: u32 = 20;
/// Ticks without any frame after which the device stops, until it is armed again.
pub const LOST_TICKS: u32 = 200;

/// The mode, the skill, the obstacles and the newest state.
///
/// Everything that gets here was checked by the [`Desk`](crate::Desk), so every method is short and none fails halfway.
#[derive(Debug)]
pub struct Control {
    space: Option<Space>,
    settings: Settings<f32>,
    mode: Mode,
    tick_mode: TickMode,
    /// Ticks computed since the start.
    tick: u32,
    missed: u32,
    late: u32,
    latest: Option<Latest>,
    /// The tick at which the last frame came.
    heard: u32,
    report: Option<ToHost>,
}

/// The newest robot state.
#[derive(Clone, Debug)]
struct Latest {
    state: AnyState,
    sequence: u16,
    /// Host's clock, us.
    stamp: u64,
    /// Device's clock.
    tick: u32,
}

impl Default for Control {
    fn default() -> Self {
        Self::new()
    }
}

impl Control {
    /// Idle, without a skill.
    pub fn new() -> Self {
        Self {
            space: None,
            settings: Settings::default(),
            mode: Mode::Idle,
            tick_mode: TickMode::Timed,
            tick: 0,
            missed: 0,
            late: 0,
            latest: None,
            heard: 0,
            report: None,
        }
    }

    /// The device's own clock has come to a tick. `overdue` counts the ticks before it that were due and had no chance to run.
    /// What is to be said about it is in [`Control::take_report`].
    pub fn tick(&mut self, overdue: u32) {
        if self.tick_mode == TickMode::Stepped {
            return;
        }
        self.missed = self.missed.saturating_add(overdue);
        self.watch();
        self.step();
    }

    /// The command of the last tick, once.
    pub fn take_report(&mut self) -> Option<ToHost> {
        self.report.take()
    }

    /// Something is broken: zero velocity from now on.
    pub fn fault(&mut self) {
        self.stop(StopReason::Fault);
    }

    /// What the device is doing.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Ticks computed since the start.
    pub fn ticks(&self) -> u32 {
        self.tick
    }

    /// Changes of the obstacle table so far.
    pub fn revision(&self) -> u32 {
        self.space.as_ref().map_or(0, Space::revision)
    }

    pub(crate) fn counters(&self) -> message::Statistics {
        let (ticks, missed, late) = (self.tick, self.missed, self.late);
        message::Statistics { ticks, missed, late, ..message::Statistics::default() }
    }

    /// A frame came, whatever was in it.
    pub(crate) fn heard(&mut self) {
        self.heard = self.tick;
    }

    pub(crate) fn arm(&mut self, tick_mode: TickMode) -> Result<(), DeviceError> {
        let space = self.space.as_mut().ok_or(DeviceError::NoModel)?;
        space.rest();
        (self.tick_mode, self.mode, self.latest) = (tick_mode, Mode::Armed, None);
        Ok(())
    }

    pub(crate) fn stop(&mut self, reason: StopReason) {
        if let Some(space) = &mut self.space {
            space.rest();
        }
        self.mode = Mode::Stopped(reason);
    }

    pub(crate) fn configure(&mut self, settings: Settings<f32>) {
        self.settings = settings;
        if let Some(space) = &mut self.space {
            space.set_settings(settings);
        }
    }

    /// A new skill. One of the same dimension may come while the robot runs; another dimension is another workspace.
    pub(crate) fn set_motion(&mut self, motion: AnyMotion) -> Result<(), DeviceError> {
        match &mut self.space {
            Some(space) if space.dimension() == motion.dimension() => {
                space.set_motion(motion).map_err(|OtherDimension| DeviceError::Dimension)
            }
            Some(_) if matches!(self.mode, Mode::Armed | Mode::Running | Mode::Degraded) => {
                Err(DeviceError::Mode(self.mode))
            }
            _ => {
                self.space = Some(Space::new(motion, self.settings));
                self.latest = None;
                Ok(())
            }
        }
    }

    pub(crate) fn upsert(&mut self, id: u16, obstacle: AnyObstacle, stamp: u64) -> Result<(), DeviceError> {
        let age = self.age(stamp);
        let space = self.space.as_mut().ok_or(DeviceError::NoModel)?;
        match space.upsert(id, obstacle, age) {
            Ok(Ok(())) => Ok(()),
            Ok(Err(pliant_core::TableFull)) => Err(DeviceError::TableFull),
            Err(OtherDimension) => Err(DeviceError::Dimension),
        }
    }

    pub(crate) fn remove(&mut self, id: u16) -> Result<(), DeviceError> {
        let space = self.space.as_mut().ok_or(DeviceError::NoModel)?;
        if space.remove(id) { Ok(()) } else { Err(DeviceError::UnknownObstacle) }
    }

    pub(crate) fn clear(&mut self) {
        if let Some(space) = &mut self.space {
            space.clear();
        }
    }

    /// A robot state. In a stepped run it makes the tick, and the answer is its command.
    pub(crate) fn state(&mut self, state: AnyState, sequence: u16, stamp: u64) -> Result<Option<ToHost>, DeviceError> {
        match self.mode {
            Mode::Idle => return Err(DeviceError::Mode(Mode::Idle)),
            // The stop is latched; the host still learns of it, by the command.
            Mode::Stopped(_) => {}
            Mode::Armed | Mode::Running | Mode::Degraded => self.mode = Mode::Running,
        }
        self.latest = Some(Latest { state, sequence, stamp, tick: self.tick });
        if self.tick_mode == TickMode::Timed {
            return Ok(None);
        }
        self.step();
        Ok(self.take_report())
    }

    /// Is the robot's state late, or the link lost?
    fn watch(&mut self) {
        if !matches!(self.mode, Mode::Armed | Mode::Running | Mode::Degraded) {
            return;
        }
        let fresh = |l: &Latest| self.tick.wrapping_sub(l.tick) < LATE_TICKS;
        if self.tick.wrapping_sub(self.heard) >= LOST_TICKS {
            self.stop(StopReason::LinkLost);
        } else if self.mode == Mode::Running && !self.latest.as_ref().is_some_and(fresh) {
            self.mode = Mode::Degraded;
        }
    }

    /// One tick: the command for the newest state, in the present mode.
    fn step(&mut self) {
        let (Some(space), Some(latest)) = (&mut self.space, &self.latest) else {
            self.tick = self.tick.wrapping_add(1);
            return;
        };
        let revision = space.revision();
        let command = match self.mode {
            Mode::Running => space.tick(&latest.state, true),
            Mode::Degraded => {
                self.late = self.late.saturating_add(1);
                space.tick(&latest.state, false)
            }
            // At rest: the ramp from zero is zero, and obstacles go on being watched.
            Mode::Idle | Mode::Armed | Mode::Stopped(_) => space.tick(&latest.state, false),
        };
        if let Ok(command) = command {
            self.report = Some(report(&command, self.tick, latest.sequence, revision, self.mode));
        }
        self.tick = self.tick.wrapping_add(1);
    }

    /// Seconds since `stamp`, host's clock, in us: by the newest state's stamp and the ticks since then.
    fn age(&self, stamp: u64) -> f32 {
        let Some(latest) = &self.latest else {
            return 0.0;
        };
        let since = u64::from(self.tick.wrapping_sub(latest.tick)) * (1_000_000 / u64::from(TICK_HZ));
        let age = latest.stamp.saturating_add(since).saturating_sub(stamp);
        // A microsecond count this small is exact in f32; older is as good as held.
        (age.min(10_000_000) as f32 * 1e-6).min(self.settings.ageing.hold)
    }
}

fn report(command: &Flat, tick: u32, state: u16, revision: u32, mode: Mode) -> ToHost {
    ToHost::Command {
        tick,
        state,
        revision,
        velocity: command.velocity.into(),
        gamma: command.gamma,
        nearest: command.nearest,
        region: command.region.into(),
        status: command.status.bits(),
        mode,
    }
}
