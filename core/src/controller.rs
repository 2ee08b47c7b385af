//! The tick: position in, velocity out.
//!
//! [`Controller::tick`] has the order of its stages. A controller owns a [`Motion`], the [`Table`] of obstacles and
//! the [`Settings`]; it has no clock (the time step is given), no I/O, allocates nothing and does not panic. Units
//! are SI: m, m/s, m/s^2, s, rad. Vectors have D = 2 or 3 entries in the world's frame, in the one number type S
//! throughout.

use crate::adaptive::adapt;
use crate::ds::Moving;
use crate::surroundings::Surroundings;
use crate::{Motion, Obstacle, Region, Scalar, Scan, Settings, Status, Table, TableFull, Vector, in_range, norm};

/// Where the robot is, x: D coordinates, m, finite and within +-1000 m ([`RANGE`](crate::RANGE)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotState<S: Scalar, const D: usize> {
    position: Vector<S, D>,
}

impl<S: Scalar, const D: usize> RobotState<S, D> {
    /// A state at `position`, m; `None` if a coordinate is not finite or beyond +-1000 m.
    pub fn new(position: Vector<S, D>) -> Option<Self> {
        in_range(&position).then_some(Self { position })
    }
    /// x, m.
    pub fn position(&self) -> &Vector<S, D> {
        &self.position
    }
}

/// What a tick asks of the robot, and what it saw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command<S: Scalar, const D: usize> {
    /// The velocity to drive with until the next tick, m/s: at most [`Limits::speed`](crate::Limits::speed) long.
    pub velocity: Vector<S, D>,
    /// The least Gamma of all obstacles and points at x, as they are at this sample, dimensionless: above 1 outside
    /// every hard core; [`Scalar::MAX`] without obstacles.
    pub gamma: S,
    /// The identifier of the obstacle it belongs to; `None` if there is none, or it is a point of the scan.
    pub nearest: Option<u16>,
    /// Where x is, as far as cores and layers go.
    pub region: Region,
    /// Conditions the command was computed under; [`Controller::tick`] says which stage sets which.
    pub status: Status,
}

/// The velocity after each stage of a tick that depends on nothing but the position, m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stages<S: Scalar, const D: usize> {
    /// f(x), the attractor's own velocity included; see [`ds`](crate::ds).
    pub nominal: Vector<S, D>,
    /// Bent round the hard cores; see [`modulation`](crate::modulation).
    pub modulated: Vector<S, D>,
    /// The same, faster or slower in soft layers; see [`adaptive`](crate::adaptive).
    pub adapted: Vector<S, D>,
    /// The least Gamma of all obstacles and points, as in [`Command::gamma`].
    pub gamma: S,
    /// Whose it is, as in [`Command::nearest`].
    pub nearest: Option<u16>,
    /// Where the point is.
    pub region: Region,
    /// [`Status::REFERENCE`] or nothing.
    pub status: Status,
}

/// One motion among at most `CAP` (1 to 64; more does not compile) obstacles and one scan. See the crate's front page
/// for an example.
///
/// What it remembers between ticks: the last command (for the acceleration limit), where attractor and obstacles are
/// by now, and how old these are.
#[derive(Clone, Debug)]
pub struct Controller<S: Scalar, const D: usize, const CAP: usize> {
    motion: Moving<S, D>,
    settings: Settings<S>,
    table: Table<S, D, CAP>,
    previous: Vector<S, D>,
}

impl<S: Scalar, const D: usize, const CAP: usize> Controller<S, D, CAP> {
    /// A controller at rest, without obstacles, its attractor where the motion has it. Of `settings`, what
    /// is out of its range counts as [`Settings::within_ranges`] says.
    // A controller is tens of kilobytes: built where it will be, it is on a small stack once.
    #[inline(always)]
    pub fn new(motion: Motion<S, D>, settings: Settings<S>) -> Self {
        let settings = settings.within_ranges();
        Self { motion: Moving::new(motion), settings, table: Table::new(), previous: Vector::zeros() }
    }

    /// One step: the velocity to drive with for the next `dt` seconds, and these seconds pass for obstacles and
    /// attractor.
    ///
    /// ```text
    ///    stage      formula                                             sets
    /// 1  nominal    f(x, t) = f0(x - d) + v      d, v: of the attractor
    /// 2  modulated  speed sum_n w_n |xdot_n|, direction by angles       REFERENCE
    /// 3  adapted    (1 - slower) u + faster      in soft layers
    /// 4  limited    |u| <= speed, |u - u_previous| <= acceleration dt   SPEED_LIMITED, ACCELERATION_LIMITED
    /// 5  time       c += v dt, Q turns, sizes grow, ages += dt          EXTRAPOLATED, HELD, CLUSTER
    /// 6  finite     u = 0 unless every entry is a number                NOT_FINITE
    /// 7  guard      nearest u, n.u >= -alpha room/dt, |u| <= speed      GUARDED, INFEASIBLE
    /// ```
    ///
    /// The formulas in full, with their sources, are on the pages of [`ds`](crate::ds),
    /// [`modulation`](crate::modulation), [`adaptive`](crate::adaptive), [`limits`](crate::limits),
    /// [`table`](crate::table) and [`guard`](crate::guard); [`Status`] says what each flag means. Stages 1 to 4 see
    /// attractor and obstacles as they are at this sample, the guard as they will be at the next one. gamma, nearest
    /// and region are those of x at this sample; EXTRAPOLATED and HELD speak of ages before the step.
    ///
    /// `dt` is in s, not negative. With less than 1e-9 no time passes, nothing is guarded, and a set acceleration leaves the
    /// command as it was. A `dt` that is negative or not finite counts as 0, and the command is zero with
    /// [`Status::NOT_FINITE`].
    ///
    /// ```
    /// use pliant_core::nalgebra::Vector2;
    /// use pliant_core::{Controller, Motion, RobotState, Settings, Status};
    /// let motion = Motion::linear(Vector2::zeros(), 1.0).unwrap();
    /// let mut controller: Controller<f32, 2, 4> = Controller::new(motion, Settings::default());
    /// let state = RobotState::new(Vector2::new(0.2, 0.0)).unwrap();
    /// assert_eq!(controller.tick(&state, 0.001).velocity, Vector2::new(-0.2, 0.0));
    /// let far = RobotState::new(Vector2::new(2.0, 0.0)).unwrap();
    /// let command = controller.tick(&far, 0.001);
    /// assert!(command.velocity.norm() <= 0.5 && command.status == Status::SPEED_LIMITED);
    /// assert!(controller.tick(&far, f32::NAN).status.contains(Status::NOT_FINITE));
    /// ```
    pub fn tick(&mut self, state: &RobotState<S, D>, dt: S) -> Command<S, D> {
        let x = state.position();
        let (dt, valid) = time_step(dt);
        let guard = self.settings.guard.filter(|_| dt > S::zero());
        let stride = guard.map(|guard| guard.stride(x, self.settings.limits.speed, dt));
        let (relative, nominal) = self.nominal(x);
        let mut around = Surroundings::new(&nominal);
        self.table.look(x, self.settings.deformable, stride.as_ref(), &mut around);
        let stages = self.stages(&relative, nominal, &around);
        let (mut velocity, limited) = self.settings.limits.apply(stages.adapted, &self.previous, dt);
        let mut status = stages.status | limited | self.pass(dt);
        if !(valid && velocity.iter().all(|v| v.is_finite())) {
            velocity = Vector::zeros();
            status |= Status::NOT_FINITE;
        }
        if let (Some(guard), Some(stride)) = (guard, stride) {
            let guarded = guard.apply(x, &velocity, &stride, &self.table, &around);
            velocity = guarded.velocity;
            status.set(Status::GUARDED, guarded.changed);
            status.set(Status::INFEASIBLE, !guarded.feasible);
        }
        self.previous = velocity;
        Command { velocity, gamma: stages.gamma, nearest: stages.nearest, region: stages.region, status }
    }

    /// One step of `dt` seconds (as in [`Controller::tick`]) without a fresh state: from the last command towards
    /// rest, by [`Limits::ramp_down`](crate::Limits::ramp_down). `last` is where the robot was last known to be, of which gamma, nearest and
    /// region speak. Nobody knows where it is now, so there is nothing to guard. The status has [`Status::LATE`], and
    /// what stage 5 sets.
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

    /// `dt` seconds pass without a command: obstacles and attractor move on and age (stage 5), and the robot counts
    /// as at rest.
    pub fn wait(&mut self, dt: S) {
        self.pass(time_step(dt).0);
        self.previous = Vector::zeros();
    }

    /// Puts an obstacle into the table under its identifier, seen `age` seconds ago; see [`Table::upsert`].
    ///
    /// # Errors
    /// [`TableFull`]; then nothing has changed.
    pub fn upsert(&mut self, id: u16, obstacle: Obstacle<S, D>, age: S) -> Result<(), TableFull> {
        self.table.upsert(id, obstacle, age, &self.settings.ageing)
    }

    /// Puts a scan, taken `age` seconds ago, in the place of the one before; see [`Table::set_scan`].
    pub fn set_scan(&mut self, scan: Scan<S, D>, age: S) {
        self.table.set_scan(scan, age, &self.settings.ageing);
    }

    /// Puts the attractor at `position` (m), moving at `velocity` (m/s): from now on f(x, t) = f0(x - d(t)) +
    /// velocity, with d how far it is from where the motion was learnt. False, and nothing changed, if a coordinate
    /// is not finite, beyond +-1000 m, or faster than [`MAX_SPEED`](crate::obstacle::MAX_SPEED).
    pub fn aim(&mut self, position: &Vector<S, D>, velocity: &Vector<S, D>) -> bool {
        self.motion.aim(position, velocity)
    }

    /// Stages 1 to 3 of [`Controller::tick`], which depend on the position alone; nothing changes.
    pub fn evaluate(&self, state: &RobotState<S, D>) -> Stages<S, D> {
        let x = state.position();
        let (relative, nominal) = self.nominal(x);
        let mut around: Surroundings<S, D, CAP> = Surroundings::new(&nominal);
        self.table.look(x, self.settings.deformable, None, &mut around);
        self.stages(&relative, nominal, &around)
    }

    /// Stage 2, the velocity bent round every hard core, m/s, without what soft layers and limits do to it. Nothing
    /// changes.
    pub fn modulated(&self, state: &RobotState<S, D>) -> Vector<S, D> {
        let x = state.position();
        let (_, nominal) = self.nominal(x);
        let mut around: Surroundings<S, D, CAP> = Surroundings::new(&nominal);
        self.table.look(x, false, None, &mut around);
        around.velocity
    }

    /// Forgets the last command: u_previous = 0, the robot stands still.
    pub fn rest(&mut self) {
        self.previous = Vector::zeros();
    }

    /// Changes the motion, with its attractor at rest where it was learnt; obstacles stay, and so does the last command, from which the
    /// acceleration limit goes on ([`Controller::rest`] forgets it).
    pub fn set_motion(&mut self, motion: Motion<S, D>) {
        self.motion = Moving::new(motion);
    }

    /// Changes the settings; what is out of its range counts as [`Settings::within_ranges`] says.
    pub fn set_settings(&mut self, settings: Settings<S>) {
        self.settings = settings.within_ranges();
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
    (if valid && dt >= S::from_f64(1e-9) { dt } else { S::zero() }, valid)
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
