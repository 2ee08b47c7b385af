//! What a tick takes.

use core::hint::black_box;

use crate::{Digest, Kind, Number, Plan, Random, TICK_UNITS, scene, stream};
use pliant_core::{Command, Controller, Obstacle, RobotState, Settings};

/// Something that counts up: instructions on an emulated board, nanoseconds on a desk.
pub trait Clock {
    /// Begins to count.
    fn start(&mut self);
    /// What was counted since, by the measure that is reported, the cost of reading the clock not counted; `None` if it is more than the clock can count.
    fn stop(&mut self) -> Option<u32>;
}

/// The clock cannot count that far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overflow;

/// A tick to be measured: the shape of the problem. The dimension and number type are the function's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Case {
    /// Obstacles.
    pub obstacles: u16,
    /// Components of the skill.
    pub components: usize,
    /// Points of a scan.
    pub points: usize,
    /// What obstacles are like.
    pub kind: Kind,
    /// Ticks that are measured.
    pub ticks: u32,
}

/// Ticks in one scene, before the next.
const SCENE: u32 = 500;

/// What was measured, in the clock's measure a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Figures {
    /// Half of the ticks took no more.
    pub median: u32,
    /// 99 % of the ticks took no more.
    pub p99: u32,
    /// No tick took more.
    pub worst: u32,
    /// Which tick that was.
    pub worst_at: u32,
    /// Of all commands.
    pub digest: u64,
}

/// A part of a tick that can be run by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All of it.
    Tick,
    /// f(x), relative to the attractor.
    Nominal,
    /// The modulated velocity: f(x), the surroundings without soft layers, the modulation.
    Modulated,
    /// Everything that depends on the position alone: f(x), surroundings, modulation, soft layers.
    Stages,
    /// A tick without the guard.
    Unguarded,
    /// The passage of time.
    Wait,
}

impl Part {
    /// Every part.
    pub const ALL: [Self; 6] = [Self::Tick, Self::Nominal, Self::Modulated, Self::Stages, Self::Unguarded, Self::Wait];

    /// What reports call it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tick => "tick",
            Self::Nominal => "nominal",
            Self::Modulated => "modulated",
            Self::Stages => "stages",
            Self::Unguarded => "unguarded",
            Self::Wait => "wait",
        }
    }
}

/// Measures the ticks of a case; `counts` has room for all of them, and gets each one's count, sorted.
///
/// # Errors
/// A tick took longer than the clock can count.
pub fn measure<S: Number, const D: usize, const CAP: usize>(
    case: Case,
    part: Part,
    clock: &mut impl Clock,
    counts: &mut [u32],
) -> Result<Figures, Overflow> {
    let mut figures = Figures::default();
    let mut overflow = false;
    let mut digest = Digest::default();
    let mut room = counts.iter_mut();
    let mut done = 0;
    for scene in 0..case.ticks.div_ceil(SCENE) {
        let Case { obstacles, components, points, kind, .. } = case;
        let plan = Plan { seed: 1000 + scene, obstacles, components, points, kind };
        stream::run::<S, D, CAP>(plan, SCENE.min(case.ticks - done), |controller, state| {
            let (count, command) = timed(part, controller, state, clock);
            overflow |= count.is_none();
            let count = count.unwrap_or_default();
            if count > figures.worst {
                (figures.worst, figures.worst_at) = (count, done);
            }
            if let Some(place) = room.next() {
                *place = count;
            }
            done += 1;
            digest.command(&command);
            command
        });
    }
    let left = room.len();
    let filled = counts.len() - left;
    figures.rank(counts.get_mut(..filled).unwrap_or_default());
    figures.digest = digest.value();
    if overflow { Err(Overflow) } else { Ok(figures) }
}

impl Figures {
    /// Takes median and percentile from these counts.
    fn rank(&mut self, counts: &mut [u32]) {
        counts.sort_unstable();
        let at = |thousandths: usize| counts.get(counts.len() * thousandths / 1000).copied().unwrap_or(self.worst);
        (self.median, self.p99) = (at(500), at(990));
    }
}

/// What upserts took, and the longest of the pieces in which a device does them: no tick waits longer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UpsertFigures {
    /// Whole upserts.
    pub whole: Figures,
    /// Pieces.
    pub longest_piece: u32,
}

/// Measures obstacles that are put into a full table of `CAP`, each in the place of another; which cores overlap is found then.
///
/// In a scene of a kind; or, without one, groups of eight overlapping ellipsoids, the largest whose common point is searched for, and one obstacle that
/// comes to overlap them all and goes again, whereby all are looked at anew.
///
/// # Errors
/// A piece took longer than the clock can count.
pub fn measure_upserts<S: Number, const D: usize, const CAP: usize>(
    kind: Option<Kind>,
    upserts: u32,
    clock: &mut impl Clock,
    counts: &mut [u32],
) -> Result<UpsertFigures, Overflow> {
    let mut random = Random::new(2000);
    let obstacles = CAP as u16;
    let mut controller: Controller<S, D, CAP> = match kind {
        Some(kind) => scene::controller(&Plan { seed: 2000, obstacles, components: 1, points: 0, kind }, &mut random),
        None => scene::groups(&mut random),
    };
    let UpsertFigures { mut whole, mut longest_piece } = UpsertFigures::default();
    let counts = counts.get_mut(..upserts as usize).unwrap_or_default();
    for (done, place) in counts.iter_mut().enumerate() {
        let (id, obstacle) = match kind {
            Some(kind) => (random.below(u32::from(obstacles)) as u16, scene::obstacle(kind, &mut random)),
            None => (0, scene::visitor(done % 2 == 0)),
        };
        clock.start();
        put(&mut controller, id, obstacle);
        let mut piece = clock.stop().ok_or(Overflow)?;
        let mut count = piece;
        let mut more = true;
        while more {
            longest_piece = longest_piece.max(piece);
            clock.start();
            more = settle(&mut controller);
            piece = clock.stop().ok_or(Overflow)?;
            count = count.checked_add(piece).ok_or(Overflow)?;
        }
        *place = count;
        if count > whole.worst {
            (whole.worst, whole.worst_at) = (count, done as u32);
        }
    }
    whole.rank(counts);
    Ok(UpsertFigures { whole, longest_piece })
}

/// What the part takes, and the command of a whole tick.
fn timed<S: Number, const D: usize, const CAP: usize>(
    part: Part,
    controller: &mut Controller<S, D, CAP>,
    state: &RobotState<S, D>,
    clock: &mut impl Clock,
) -> (Option<u32>, Command<S, D>) {
    let state = black_box(state);
    let mut copy = None;
    if matches!(part, Part::Unguarded | Part::Wait) {
        let copy = copy.insert(controller.clone());
        copy.set_settings(Settings { guard: None, ..*controller.settings() });
    }
    clock.start();
    let mut command = None;
    match (part, &mut copy) {
        (Part::Nominal, _) => nominal(controller, state),
        (Part::Modulated, _) => modulated(controller, state),
        (Part::Stages, _) => stages(controller, state),
        (Part::Unguarded, Some(copy)) => drop(black_box(tick(copy, state))),
        (Part::Wait, Some(copy)) => wait(copy),
        _ => command = Some(tick(controller, state)),
    }
    let count = clock.stop();
    (count, command.unwrap_or_else(|| tick(controller, state)))
}

// None of these is inlined: what is counted is one function, whoever calls it.

#[inline(never)]
fn tick<S: Number, const D: usize, const CAP: usize>(
    controller: &mut Controller<S, D, CAP>,
    state: &RobotState<S, D>,
) -> Command<S, D> {
    controller.tick(state, S::units(TICK_UNITS))
}

#[inline(never)]
fn put<S: Number, const D: usize, const CAP: usize>(
    controller: &mut Controller<S, D, CAP>,
    id: u16,
    obstacle: Obstacle<S, D>,
) {
    let _ = controller.put(id, obstacle, S::zero());
}

#[inline(never)]
fn settle<S: Number, const D: usize, const CAP: usize>(controller: &mut Controller<S, D, CAP>) -> bool {
    controller.table_mut().settle()
}

#[inline(never)]
fn nominal<S: Number, const D: usize, const CAP: usize>(controller: &Controller<S, D, CAP>, state: &RobotState<S, D>) {
    black_box(controller.motion().relative(state.position()));
}

#[inline(never)]
fn modulated<S: Number, const D: usize, const CAP: usize>(
    controller: &Controller<S, D, CAP>,
    state: &RobotState<S, D>,
) {
    black_box(controller.modulated(state));
}

#[inline(never)]
fn stages<S: Number, const D: usize, const CAP: usize>(controller: &Controller<S, D, CAP>, state: &RobotState<S, D>) {
    black_box(controller.evaluate(state));
}

#[inline(never)]
fn wait<S: Number, const D: usize, const CAP: usize>(controller: &mut Controller<S, D, CAP>) {
    controller.wait(S::units(TICK_UNITS));
}
