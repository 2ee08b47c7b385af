//! No core is ever entered while the guard says that it need not be, and it never says that it must where it need not.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

#[path = "../world/mod.rs"]
mod world;

use pliant_core::scalar::Fixed;
use pliant_core::{RobotState, Scalar, Status};
use rand::Rng;
use world::judge::{Asked, clear_velocity};
use world::{Kind, World, balls, gamma, is_long, random, room, share, world};

/// Ticks of one world.
const TICKS: u64 = 250;
/// So many of them after the first that was infeasible: what comes then is mostly the same.
const AFTERWARDS: u64 = 20;

/// Where the robot is.
#[derive(Clone, Copy, Debug)]
enum Place {
    /// In the open or a hall.
    Among(Kind),
    /// In a room with little space, that moves and shrinks up to so fast, m/s.
    Room(f64),
    /// Among ellipsoids alone that close in.
    Balls,
    /// The same as among, with another time step in each world: from a fifth of a millisecond to five.
    AtAnyStep(Kind),
}

impl Place {
    fn world<S: Scalar, const D: usize>(&self, seed: u64) -> Option<World<S, D>> {
        match self {
            Place::Among(kind) | Place::AtAnyStep(kind) => world(seed, kind),
            Place::Room(speed) => room::world(seed, *speed),
            Place::Balls => balls::world(seed),
        }
    }

    fn moves(&self) -> bool {
        !matches!(self, Place::Among(Kind { speed: 0.0, .. }))
    }

    /// May a way out be missed? Where a step can end beyond a body, there are some to which no side of it leads that is seen on the way.
    fn may_miss(&self) -> bool {
        matches!(self, Place::AtAnyStep(_))
    }

    /// And is it in not too many?
    fn rarely_misses(&self, tally: &Tally) -> bool {
        match self {
            Place::AtAnyStep(_) => tally.missed <= 2 + tally.ticks / 200_000,
            _ => tally.missed == 0,
        }
    }

    /// The time step, s.
    fn step(&self, seed: u64) -> f64 {
        match self {
            // A multiple of 2^-20 s: every number type has it.
            Place::AtAnyStep(_) => (200.0 * 25f64.powf(random(!seed).random_range(0.0..1.0))).round() / 1_048_576.0,
            _ => 1e-3,
        }
    }
}

#[derive(Default, Debug)]
struct Tally {
    ticks: u64,
    guarded: u64,
    infeasible: u64,
    entered: u64,
    /// Ticks where standing still was allowed, and how many of those were guarded.
    may_stand: u64,
    may_stand_guarded: u64,
    /// Infeasible ticks where all that is near asks for one half-space each: those are judged by a search.
    judged: u64,
    /// Infeasible ticks with a way left that was not found.
    missed: u64,
}

/// One world, from tick to tick.
fn drive<S: Scalar, const D: usize>(place: Place, seed: u64, tally: &mut Tally) {
    let tick = place.step(seed);
    let dt = S::from_f64(tick);
    let Some(World { mut controller, start: mut x }) = place.world::<S, D>(seed) else { return };
    let speed = controller.settings().limits.speed.to_f64();
    let mut afterwards = 0;
    for n in 0..TICKS {
        let Some(state) = RobotState::new(x.map(S::from_f64)) else { break };
        let before = gamma(&controller, state.position());
        let command = controller.tick(&state, dt);
        let u = command.velocity.map(|v| v.to_f64());
        assert!(u.norm() <= speed * (1.0 + 1e-5) + 1e-5, "seed {seed} tick {n}: {u} over {speed}");
        x += u * tick;
        tally.ticks += 1;
        tally.guarded += u64::from(command.status.contains(Status::GUARDED));
        let infeasible = command.status.contains(Status::INFEASIBLE);
        tally.infeasible += u64::from(infeasible);
        afterwards += u64::from(infeasible || afterwards > 0);
        let after = gamma(&controller, &x.map(S::from_f64));
        if after < S::one() {
            tally.entered += 1;
            assert!(infeasible, "seed {seed} tick {n}: Gamma {before} then {after} at {x}, {command:?}");
        }
        // Far from everything there is nothing to count.
        if infeasible || command.gamma < S::from_f64(100.0) {
            let asked = Asked::new(&controller, &state, tick);
            let guarded = command.status.contains(Status::GUARDED);
            tally.may_stand += u64::from(asked.may_stand);
            tally.may_stand_guarded += u64::from(asked.may_stand && guarded);
            assert!(!(infeasible && asked.may_stand), "seed {seed} tick {n}: infeasible, and standing still is not");
            if infeasible {
                let mut way = clear_velocity(&controller, &state, tick);
                if !asked.more {
                    tally.judged += 1;
                    way = way.or_else(|| asked.search());
                }
                tally.missed += u64::from(way.is_some());
                let from = state.position();
                assert!(
                    way.is_none() || place.may_miss(),
                    "seed {seed} tick {n}: {way:?} leads out from {from:?}, {command:?}"
                );
            }
        }
        if !place.moves() && command.status & (Status::EXTRAPOLATED | Status::HELD) == Status::empty() {
            assert!(!infeasible, "seed {seed} tick {n}: infeasible at rest, Gamma {before} at {x}");
        }
        if afterwards > AFTERWARDS {
            break;
        }
    }
}

fn campaign<S: Scalar, const D: usize>(place: Place, seed: u64) {
    let mut tally = Tally::default();
    let mut seed = seed << 32;
    let wanted = share(10);
    while tally.ticks < wanted {
        seed += 1;
        drive::<S, D>(place, seed, &mut tally);
    }
    println!("{D}-D {place:?}: {tally:?}");
    if is_long() {
        assert!(tally.guarded > 0 && tally.may_stand_guarded * 500 > tally.ticks, "nothing was tried: {tally:?}");
        assert!(place.rarely_misses(&tally), "too often missed: {tally:?}");
        assert!(!place.moves() || tally.judged * 5000 > tally.ticks, "nothing was tried: {tally:?}");
    }
}

const STILL: Place = Place::Among(Kind { obstacles: 30, speed: 0.0, walls: true, scans: true, odd: true, thin: false });
const MOVING: Place =
    Place::Among(Kind { obstacles: 30, speed: 2.0, walls: true, scans: true, odd: true, thin: false });
const ROOM: Place = Place::Room(2.0);
const THIN: Place =
    Place::AtAnyStep(Kind { obstacles: 30, speed: 2.0, walls: true, scans: true, odd: true, thin: true });

macro_rules! campaigns {
    ($($name:ident: $scalar:ty, $d:literal, $place:expr, $seed:literal;)+) => {
        $(#[test] fn $name() { campaign::<$scalar, $d>($place, $seed); })+
    };
}
campaigns! {
    still_2d_f64: f64, 2, STILL, 1;
    still_3d_f64: f64, 3, STILL, 2;
    still_2d_f32: f32, 2, STILL, 3;
    still_3d_f32: f32, 3, STILL, 4;
    still_2d_fixed: Fixed, 2, STILL, 5;
    still_3d_fixed: Fixed, 3, STILL, 6;
    moving_2d_f64: f64, 2, MOVING, 7;
    moving_3d_f64: f64, 3, MOVING, 8;
    moving_2d_f32: f32, 2, MOVING, 9;
    moving_3d_f32: f32, 3, MOVING, 10;
    moving_2d_fixed: Fixed, 2, MOVING, 11;
    moving_3d_fixed: Fixed, 3, MOVING, 12;
    room_2d_f64: f64, 2, ROOM, 13;
    room_3d_f64: f64, 3, ROOM, 14;
    room_2d_f32: f32, 2, ROOM, 15;
    room_3d_f32: f32, 3, ROOM, 16;
    room_2d_fixed: Fixed, 2, ROOM, 17;
    room_3d_fixed: Fixed, 3, ROOM, 18;
    balls_2d_f64: f64, 2, Place::Balls, 25;
    balls_3d_f64: f64, 3, Place::Balls, 26;
    balls_2d_f32: f32, 2, Place::Balls, 27;
    balls_3d_f32: f32, 3, Place::Balls, 28;
    balls_2d_fixed: Fixed, 2, Place::Balls, 29;
    balls_3d_fixed: Fixed, 3, Place::Balls, 30;
    thin_2d_f64: f64, 2, THIN, 19;
    thin_3d_f64: f64, 3, THIN, 20;
    thin_2d_f32: f32, 2, THIN, 21;
    thin_3d_f32: f32, 3, THIN, 22;
    thin_2d_fixed: Fixed, 2, THIN, 23;
    thin_3d_fixed: Fixed, 3, THIN, 24;
}

/// Worlds in which a velocity is found by one part of the search alone: from an end of the step, by room rather than by no violation, by tangents of the places
/// before, by the fourth place and later. And some in which no search but one of other places finds it.
#[test]
fn each_part_of_the_search_is_needed() {
    let mut tally = Tally::default();
    for seed in [900_011_489, 900_017_142, 900_019_379, 900_004_097, 900_005_002, 900_005_306, 900_010_046] {
        drive::<f64, 2>(MOVING, seed, &mut tally);
    }
    for seed in [900_000_017, 900_000_161, 900_000_524, 900_009_810, 900_018_864, 900_002_896, 900_003_009] {
        drive::<f64, 2>(ROOM, seed, &mut tally);
    }
    for seed in [900_000_051, 900_000_483, 900_013_053] {
        drive::<f64, 3>(ROOM, seed, &mut tally);
    }
    // Where fixed point had no digits left.
    drive::<Fixed, 2>(ROOM, 73_014_446_955, &mut tally);
    drive::<Fixed, 3>(ROOM, 77_309_416_077, &mut tally);
    drive::<Fixed, 3>(ROOM, 77_309_427_608, &mut tally);
    drive::<Fixed, 2>(ROOM, 73_014_473_984, &mut tally);
    drive::<Fixed, 3>(ROOM, 77_309_442_427, &mut tally);
    // A box that drives the robot along no more slowly than that can go: the way out leads by hardly more than rounding.
    drive::<Fixed, 2>(MOVING, 47_244_654_036, &mut tally);
    // A room whose gauge is steeper than fixed point can say.
    drive::<Fixed, 2>(ROOM, 73_014_484_898, &mut tally);
    assert!(tally.infeasible > 0);
}
