//! The tick: position in, velocity out.

use crate::adaptive::adapt;
use crate::ds::Moving;
use crate::surroundings::Surroundings;
use crate::{
    Ageing, Guard, Limits, Motion, Obstacle, Region, Scalar, Scan, Status, SteeringPolicy, Table, TableFull, Vector,
    in_range, norm,
};

/// How obstacles bend the motion, and what the robot may be asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<S> {
    /// Are soft layers soft? If not, this is the original method (k = 1).
    pub deformable: bool,
    /// c of eqs. 15 and 27, m/s.
    pub gain: S,
    /// Which way the push in a soft layer points.
    pub steering: SteeringPolicy<S>,
    /// Speed and acceleration.
    pub limits: Limits<S>,
    /// What becomes of obstacles that are not updated.
    pub ageing: Ageing<S>,
    /// Keeps every sample out of every hard core; `None` leaves it to the modulation, as the papers do.
    pub guard: Option<Guard<S>>,
}

impl<S: Scalar> Default for Settings<S> {
    /// Deformable, c = 0.03 m/s, with the flow at most as fast again, guarded, and the defaults of [`Limits`], [`Ageing`] and [`Guard`].
    fn default() -> Self {
        Self {
            deformable: true,
            gain: S::from_f64(0.03),
            steering: SteeringPolicy::WithFlow { beta: S::one() },
            limits: Limits::default(),
            ageing: Ageing::default(),
            guard: Some(Guard::default()),
        }
    }
}

/// The setting that is out of its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingsError {
    /// c: 0 to 10 m/s.
    Gain,
    /// theta_2 finite, or beta 0 to 10.
    Steering,
    /// Above 0, at most 100 m/s.
    Speed,
    /// Above 0, at most 10^4 m/s^2.
    Acceleration,
    /// Above 0, at most 10^4 m/s^2.
    Deceleration,
    /// Times 0 to 3600 s with hold no less than time to live, growth 0 to 10 m/s.
    Ageing,
    /// Above 0, at most 1.
    Guard,
}

impl<S: Scalar> Settings<S> {
    /// Checks every range.
    ///
    /// # Errors
    /// The first setting out of its range, as [`SettingsError`] states it.
    pub fn check(&self) -> Result<(), SettingsError> {
        let from_zero = |x: S, high: f64| x >= S::zero() && x <= S::from_f64(high);
        let above_zero = |x: S, high: f64| x > S::zero() && x <= S::from_f64(high);
        let steering = match self.steering {
            SteeringPolicy::Fixed { cos, sin } => (cos * cos + sin * sin - S::one()).abs() <= S::from_f64(1e-3),
            SteeringPolicy::WithFlow { beta } => from_zero(beta, 10.0),
        };
        let Ageing { time_to_live, growth, hold } = self.ageing;
        let ageing = from_zero(time_to_live, 3600.0)
            && from_zero(growth, 10.0)
            && from_zero(hold, 3600.0)
            && hold >= time_to_live;
        let check = |ok: bool, error: SettingsError| if ok { Ok(()) } else { Err(error) };
        check(from_zero(self.gain, 10.0), SettingsError::Gain)?;
        check(steering, SettingsError::Steering)?;
        check(above_zero(self.limits.speed, 100.0), SettingsError::Speed)?;
        check(self.limits.acceleration.is_none_or(|a| above_zero(a, 1e4)), SettingsError::Acceleration)?;
        check(above_zero(self.limits.deceleration, 1e4), SettingsError::Deceleration)?;
        check(ageing, SettingsError::Ageing)?;
        check(self.guard.is_none_or(|guard| above_zero(guard.approach, 1.0)), SettingsError::Guard)
    }
}

/// Where the robot is: finite and within range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotState<S: Scalar, const D: usize> {
    position: Vector<S, D>,
}

impl<S: Scalar, const D: usize> RobotState<S, D> {
    /// A state at `position`, m; `None` if a coordinate is not finite or beyond +-1000 m.
    pub fn new(position: Vector<S, D>) -> Option<Self> {
        in_range(&position).then_some(Self { position })
    }
    /// m
    pub fn position(&self) -> &Vector<S, D> {
        &self.position
    }
}

/// What a tick asks of the robot, and what it saw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command<S: Scalar, const D: usize> {
    /// m/s
    pub velocity: Vector<S, D>,
    /// The least Gamma of all obstacles, above 1 outside every hard core; the largest number there is without obstacles.
    pub gamma: S,
    /// The obstacle it belongs to.
    pub nearest: Option<u16>,
    /// Where the robot is.
    pub region: Region,
    /// Conditions the command was computed under.
    pub status: Status,
}

/// The velocity after each stage of a tick that depends on nothing but the position, m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stages<S: Scalar, const D: usize> {
    /// f(x)
    pub nominal: Vector<S, D>,
    /// Round the hard cores.
    pub modulated: Vector<S, D>,
    /// Faster or slower in soft layers.
    pub adapted: Vector<S, D>,
    /// The least Gamma of all obstacles.
    pub gamma: S,
    /// The obstacle it belongs to.
    pub nearest: Option<u16>,
    /// Where the point is.
    pub region: Region,
    /// What was out of the ordinary.
    pub status: Status,
}

/// One motion among at most `CAP` obstacles. See the crate's front page for an example.
#[derive(Clone, Debug)]
pub struct Controller<S: Scalar, const D: usize, const CAP: usize> {
    motion: Moving<S, D>,
    settings: Settings<S>,
    table: Table<S, D, CAP>,
    previous: Vector<S, D>,
}

impl<S: Scalar, const D: usize, const CAP: usize> Controller<S, D, CAP> {
    /// A controller at rest, without obstacles. `settings` are taken as they are: [`Settings::check`] those that come from outside.
    pub fn new(motion: Motion<S, D>, settings: Settings<S>) -> Self {
        Self { motion: Moving::new(motion), settings, table: Table::new(), previous: Vector::zeros() }
    }

    /// One step of `dt` seconds (not negative): the velocity to drive with from now on, and time passes for obstacles and attractor.
    pub fn tick(&mut self, state: &RobotState<S, D>, dt: S) -> Command<S, D> {
        let x = state.position();
        let (dt, valid) = time_step(dt);
        let guard = self.settings.guard.filter(|_| dt > S::zero());
        let reach = guard.map(|guard| (guard.reach(x, self.settings.limits.speed, dt), dt));
        let (relative, nominal) = self.nominal(x);
        let mut around = Surroundings::new(&nominal);
        self.table.look(x, self.settings.deformable, reach, &mut around);
        let stages = self.stages(&relative, nominal, &around);
        let (mut velocity, limited) = self.settings.limits.apply(stages.adapted, &self.previous, dt);
        let mut status = stages.status | limited | self.pass(dt);
        if !(valid && velocity.iter().all(|v| v.is_finite())) {
            velocity = Vector::zeros();
            status |= Status::NOT_FINITE;
        }
        if let Some(guard) = guard {
            let guarded = guard.apply(x, &velocity, self.settings.limits.speed, dt, &self.table, &around);
            velocity = guarded.velocity;
            status.set(Status::GUARDED, guarded.changed);
            status.set(Status::INFEASIBLE, !guarded.feasible);
        }
        self.previous = velocity;
        Command { velocity, gamma: stages.gamma, nearest: stages.nearest, region: stages.region, status }
    }

    /// One step without a fresh state: from the last command towards rest, within the deceleration limit. `last` is where the robot was
    /// last known to be. Nobody knows where it is now, so there is nothing to guard.
    pub fn tick_late(&mut self, last: &RobotState<S, D>, dt: S) -> Command<S, D> {
        let mut around = Surroundings::new(&Vector::zeros());
        self.table.look(last.position(), self.settings.deformable, None, &mut around);
        let (dt, valid) = time_step(dt);
        let velocity = self.settings.limits.ramp_down(&self.previous, dt);
        let mut status = Status::LATE | self.pass(dt);
        status.set(Status::NOT_FINITE, !valid);
        self.previous = velocity;
        Command { velocity, gamma: around.gamma, nearest: around.nearest, region: region(&around), status }
    }

    /// Time passes without a command: obstacles and attractor move on and age.
    pub fn wait(&mut self, dt: S) {
        self.pass(time_step(dt).0);
        self.previous = Vector::zeros();
    }

    /// Puts an obstacle into the table; see [`Table::upsert`].
    ///
    /// # Errors
    /// [`TableFull`]; then nothing has changed.
    pub fn upsert(&mut self, id: u16, obstacle: Obstacle<S, D>, age: S) -> Result<(), TableFull> {
        self.table.upsert(id, obstacle, age, &self.settings.ageing)
    }

    /// Puts a scan in the place of the one before; see [`Table::set_scan`].
    pub fn set_scan(&mut self, scan: Scan<S, D>, age: S) {
        self.table.set_scan(scan, age, &self.settings.ageing);
    }

    /// Puts the attractor at `position` (m), moving at `velocity` (m/s); false, and nothing changed, if one is out of range.
    pub fn aim(&mut self, position: &Vector<S, D>, velocity: &Vector<S, D>) -> bool {
        self.motion.aim(position, velocity)
    }

    /// All stages that depend on the position alone; nothing changes.
    pub fn evaluate(&self, state: &RobotState<S, D>) -> Stages<S, D> {
        let x = state.position();
        let (relative, nominal) = self.nominal(x);
        let mut around: Surroundings<S, D, CAP> = Surroundings::new(&nominal);
        self.table.look(x, self.settings.deformable, None, &mut around);
        self.stages(&relative, nominal, &around)
    }

    /// The velocity bent round every hard core, m/s, without what soft layers and limits do to it.
    pub fn modulated(&self, state: &RobotState<S, D>) -> Vector<S, D> {
        let x = state.position();
        let (_, nominal) = self.nominal(x);
        let mut around: Surroundings<S, D, CAP> = Surroundings::new(&nominal);
        self.table.look(x, false, None, &mut around);
        around.velocity
    }

    /// Forgets the last command: the robot stands still.
    pub fn rest(&mut self) {
        self.previous = Vector::zeros();
    }

    /// Changes the motion, with its attractor at rest where it was learnt; obstacles stay.
    pub fn set_motion(&mut self, motion: Motion<S, D>) {
        self.motion = Moving::new(motion);
    }

    /// Changes the settings; [`Settings::check`] those that come from outside.
    pub fn set_settings(&mut self, settings: Settings<S>) {
        self.settings = settings;
        self.table.rules_changed(&self.settings.ageing);
    }

    /// The nominal motion, and where its attractor is.
    pub fn motion(&self) -> &Moving<S, D> {
        &self.motion
    }

    /// The settings in force.
    pub fn settings(&self) -> &Settings<S> {
        &self.settings
    }

    /// The obstacles.
    pub fn table(&self) -> &Table<S, D, CAP> {
        &self.table
    }

    /// The obstacles, to be changed.
    pub fn table_mut(&mut self) -> &mut Table<S, D, CAP> {
        &mut self.table
    }

    /// f(x) relative to the attractor, and as it is, m/s.
    fn nominal(&self, x: &Vector<S, D>) -> (Vector<S, D>, Vector<S, D>) {
        let relative = self.motion.relative(x);
        (relative, relative + self.motion.drift())
    }

    #[inline]
    fn stages(&self, relative: &Vector<S, D>, nominal: Vector<S, D>, around: &Surroundings<S, D, CAP>) -> Stages<S, D> {
        let modulated = around.velocity;
        // Measured by the motion relative to the attractor, a push leaves a moving attractor alone too.
        let adapted = adapt(&self.settings.steering, self.settings.gain, norm(relative), modulated, &around.soft);
        Stages {
            nominal,
            modulated,
            adapted,
            gamma: around.gamma,
            nearest: around.nearest,
            region: region(around),
            status: if around.unusable { Status::REFERENCE } else { Status::empty() },
        }
    }

    /// Time passes; how old obstacles were before, as status flags.
    fn pass(&mut self, dt: S) -> Status {
        self.motion.advance(dt);
        self.table.advance(dt, &self.settings.ageing)
    }
}

/// The time step, and whether it is one; in the place of what is none, no time.
fn time_step<S: Scalar>(dt: S) -> (S, bool) {
    let valid = dt >= S::zero() && dt.is_finite();
    (if valid { dt } else { S::zero() }, valid)
}

fn region<S: Scalar, const D: usize, const CAP: usize>(around: &Surroundings<S, D, CAP>) -> Region {
    if around.gamma <= S::one() {
        return Region::Hard;
    }
    match around.soft.len() {
        0 => Region::Free,
        1 => Region::Soft,
        _ => Region::Intersection,
    }
}
