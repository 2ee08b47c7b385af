//! The half that faces the clock: modes, watchdogs and the tick.

use pliant_core::Settings;
use pliant_protocol::message::{self, DeviceError, Field, Mode, StopReason, TickMode, ToHost};

use crate::space::{AnyMotion, AnyObstacle, AnyScan, AnyState, AnyTarget, Flat, OtherDimension, Space};
use crate::{TICK, TICK_HZ};

/// Ticks (ms) without a fresh robot state after which the command ramps to zero.
pub const LATE_TICKS: u32 = 20;
/// Ticks (ms) without a frame from the host after which the device stops, until it is armed again.
pub const LOST_TICKS: u32 = 200;
/// The same in a stepped run, where a host may think long between two states.
pub const LOST_STEPPED_TICKS: u32 = 10_000;
/// Most ticks that obstacles are carried on by at once, after the clock had no chance to run.
const CATCH_UP_TICKS: u32 = 100;

/// The mode, the skill, the obstacles and the newest state.
///
/// Everything that gets here was checked by the [`Desk`](crate::Desk), so every method is short and none fails halfway. What takes long, the search for
/// overlapping cores, is left to [`Control::settle`].
#[derive(Debug)]
pub struct Control {
    space: Option<Space>,
    settings: Settings<f32>,
    mode: Mode,
    tick_mode: TickMode,
    /// Ticks that were due since the start, computed or not: the device's time, in ms. In a stepped run, the states that came.
    tick: u32,
    /// Ticks due since the last one that was computed.
    due: u32,
    computed: u32,
    missed: u32,
    late: u32,
    latest: Option<Latest>,
    /// What the host's clock showed at which tick.
    clock: Option<Reading>,
    /// Periods of the device's own clock since the last frame from the host.
    silence: u32,
    report: Option<ToHost>,
}

/// The newest robot state.
#[derive(Clone, Debug)]
struct Latest {
    state: AnyState,
    sequence: u16,
    tick: u32,
}

/// The host's clock, us, as it was at one of the device's ticks.
#[derive(Clone, Copy, Debug)]
struct Reading {
    stamp: u64,
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
            due: 0,
            computed: 0,
            missed: 0,
            late: 0,
            latest: None,
            clock: None,
            silence: 0,
            report: None,
        }
    }

    /// The device's own clock has come to a tick. `overdue` counts the ticks before it that were due and had no chance to run.
    /// What is to be said about it is in [`Control::take_report`].
    ///
    /// A tick that comes late computes nothing: if the computation is what takes too long, the links still get their turn, and with them
    /// a stop.
    pub fn tick(&mut self, overdue: u32) {
        let periods = overdue.saturating_add(1);
        self.silence = self.silence.saturating_add(periods);
        self.watch_link();
        if self.tick_mode == TickMode::Stepped {
            return;
        }
        self.tick = self.tick.wrapping_add(periods);
        self.due = self.due.saturating_add(periods);
        if overdue > 0 {
            self.missed = self.missed.saturating_add(periods);
            return;
        }
        self.watch_state();
        self.step();
    }

    /// One bounded piece of what changes of the obstacles have left to find out: which cores overlap now, and their reference points. False when nothing
    /// is left. To be called again and again by whoever has the least urgent work, with the control half locked for one piece at a time: that is as long as
    /// a tick may have to wait.
    pub fn settle(&mut self) -> bool {
        self.space.as_mut().is_some_and(Space::settle)
    }

    /// The command of the last tick, once.
    pub fn take_report(&mut self) -> Option<ToHost> {
        self.report.take()
    }

    /// What the device is doing.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// The number of the tick that comes next.
    pub fn ticks(&self) -> u32 {
        self.tick
    }

    /// Changes of the obstacle table so far.
    pub fn revision(&self) -> u32 {
        self.space.as_ref().map_or(0, Space::revision)
    }

    pub(crate) fn counters(&self) -> message::Statistics {
        let (ticks, missed, late) = (self.computed, self.missed, self.late);
        message::Statistics { ticks, missed, late, ..message::Statistics::default() }
    }

    /// A frame came from the host, whatever was in it.
    pub(crate) fn heard(&mut self) {
        self.silence = 0;
    }

    /// Another host, with another clock.
    pub(crate) fn greeted(&mut self) {
        (self.clock, self.silence) = (None, 0);
    }

    /// Is it the host's turn to be disturbed by nobody?
    pub(crate) fn is_busy(&self) -> bool {
        matches!(self.mode, Mode::Armed | Mode::Running | Mode::Degraded)
    }

    pub(crate) fn arm(&mut self, tick_mode: TickMode) -> Result<(), DeviceError> {
        let space = self.space.as_mut().ok_or(DeviceError::NoModel)?;
        space.rest();
        (self.tick_mode, self.mode, self.latest, self.report) = (tick_mode, Mode::Armed, None, None);
        Ok(())
    }

    pub(crate) fn stop(&mut self, reason: StopReason) {
        if let Some(space) = &mut self.space {
            space.rest();
        }
        self.mode = Mode::Stopped(reason);
        // A command that was computed and not yet sent must not follow the answer to the stop.
        self.report = None;
    }

    pub(crate) fn configure(&mut self, settings: Settings<f32>) {
        self.settings = settings;
        if let Some(space) = &mut self.space {
            space.set_settings(settings);
        }
    }

    /// A new skill. One of the same dimension may come while the robot runs; another dimension is another workspace.
    pub(crate) fn set_motion(&mut self, motion: AnyMotion) -> Result<(), DeviceError> {
        let busy = self.is_busy();
        match &mut self.space {
            Some(space) if space.dimension() == motion.dimension() => {
                space.set_motion(motion).map_err(|OtherDimension| DeviceError::Dimension)
            }
            Some(_) if busy => Err(DeviceError::Mode(self.mode)),
            _ => {
                Space::place(&mut self.space, motion, self.settings);
                self.latest = None;
                Ok(())
            }
        }
    }

    pub(crate) fn upsert(&mut self, id: u16, obstacle: AnyObstacle, stamp: u64) -> Result<(), DeviceError> {
        let age = self.age(stamp);
        let space = self.space.as_mut().ok_or(DeviceError::NoModel)?;
        match space.put(id, obstacle, age) {
            Ok(Ok(())) => Ok(()),
            Ok(Err(pliant_core::TableFull)) => Err(DeviceError::TableFull),
            Err(OtherDimension) => Err(DeviceError::Dimension),
        }
    }

    /// Puts a scan in the place of the one before.
    pub(crate) fn set_scan(&mut self, scan: AnyScan, stamp: u64) -> Result<(), DeviceError> {
        let age = self.age(stamp);
        let space = self.space.as_mut().ok_or(DeviceError::NoModel)?;
        space.set_scan(scan, age).map_err(|OtherDimension| DeviceError::Dimension)
    }

    /// Moves the attractor; refused where it has left the range since it was seen.
    pub(crate) fn aim(&mut self, target: &AnyTarget, stamp: u64) -> Result<(), DeviceError> {
        let age = self.age(stamp);
        let space = self.space.as_mut().ok_or(DeviceError::NoModel)?;
        match space.aim(target, age) {
            Ok(true) => Ok(()),
            Ok(false) => Err(DeviceError::OutOfRange(Field::Attractor)),
            Err(OtherDimension) => Err(DeviceError::Dimension),
        }
    }

    pub(crate) fn remove(&mut self, id: u16) -> Result<(), DeviceError> {
        let space = self.space.as_mut().ok_or(DeviceError::NoModel)?;
        if space.take(id) { Ok(()) } else { Err(DeviceError::UnknownObstacle) }
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
        self.latest = Some(Latest { state, sequence, tick: self.tick });
        self.clock = Some(Reading { stamp, tick: self.tick });
        if self.tick_mode == TickMode::Timed {
            return Ok(None);
        }
        // Nothing is urgent here, and commands must not depend on how fast the device is.
        while self.settle() {}
        self.due = 1;
        self.step();
        self.tick = self.tick.wrapping_add(1);
        Ok(self.take_report())
    }

    /// Is the link lost?
    fn watch_link(&mut self) {
        let limit = if self.tick_mode == TickMode::Timed { LOST_TICKS } else { LOST_STEPPED_TICKS };
        if self.is_busy() && self.silence > limit {
            self.stop(StopReason::LinkLost);
        }
    }

    /// Is the robot's state late?
    fn watch_state(&mut self) {
        let fresh = |l: &Latest| self.tick.wrapping_sub(l.tick) <= LATE_TICKS;
        if self.mode == Mode::Running && !self.latest.as_ref().is_some_and(fresh) {
            self.mode = Mode::Degraded;
        }
    }

    /// One tick: the command for the newest state, in the present mode. Obstacles are carried on by all the time that was due.
    fn step(&mut self) {
        let dt = TICK * core::mem::take(&mut self.due).min(CATCH_UP_TICKS) as f32;
        self.computed = self.computed.wrapping_add(1);
        let Some(space) = &mut self.space else { return };
        let Some(latest) = &self.latest else {
            space.wait(dt);
            return;
        };
        let revision = space.revision();
        let command = match self.mode {
            Mode::Running => space.tick(&latest.state, true, dt),
            Mode::Degraded => {
                self.late = self.late.saturating_add(1);
                space.tick(&latest.state, false, dt)
            }
            // At rest: the ramp from zero is zero, and obstacles go on being watched.
            Mode::Idle | Mode::Armed | Mode::Stopped(_) => space.tick(&latest.state, false, dt),
        };
        if let Ok(command) = command {
            self.report = Some(report(&command, self.tick, latest.sequence, revision, self.mode));
        }
    }

    /// Seconds since `stamp`, host's clock, in us: by the newest reading of it and the ticks since then. Where there is none, this is the
    /// first.
    fn age(&mut self, stamp: u64) -> f32 {
        let clock = self.clock.get_or_insert(Reading { stamp, tick: self.tick });
        let since = u64::from(self.tick.wrapping_sub(clock.tick)) * (1_000_000 / u64::from(TICK_HZ));
        let age = clock.stamp.saturating_add(since).saturating_sub(stamp);
        // A microsecond count this small is exact in f32; the table knows what to do with what is older than its hold time.
        age.min(10_000_000) as f32 * 1e-6
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
