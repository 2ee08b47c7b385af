//! Planar or spatial: a device runs either, as its skill has it.

use pliant_core::{Command, Controller, Motion, Obstacle, RobotState, Scan, Settings, TableFull};
use pliant_protocol::convert::Target;

use crate::OBSTACLES;

/// Something that exists in the plane or in space.
#[derive(Clone, Debug)]
pub enum InSpace<P, S> {
    /// In two dimensions.
    Planar(P),
    /// In three.
    Spatial(S),
}

/// A controller in the plane or in space.
pub type Space = InSpace<Controller<f32, 2, OBSTACLES>, Controller<f32, 3, OBSTACLES>>;
pub(crate) type AnyMotion = InSpace<Motion<f32, 2>, Motion<f32, 3>>;
pub(crate) type AnyObstacle = InSpace<Obstacle<f32, 2>, Obstacle<f32, 3>>;
pub(crate) type AnyScan = InSpace<Scan<f32, 2>, Scan<f32, 3>>;
pub(crate) type AnyTarget = InSpace<Target<2>, Target<3>>;
pub(crate) type AnyState = InSpace<RobotState<f32, 2>, RobotState<f32, 3>>;

/// What was given is of the other dimension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OtherDimension;

/// A command whatever the dimension: z is zero in the plane.
pub(crate) type Flat = Command<f32, 3>;

impl<P, S> InSpace<P, S> {
    pub(crate) fn dimension(&self) -> u8 {
        match self {
            Self::Planar(_) => 2,
            Self::Spatial(_) => 3,
        }
    }
}

impl Space {
    /// Puts a controller with this motion, and nothing else yet, where `room` is.
    pub(crate) fn place(room: &mut Option<Self>, motion: AnyMotion, settings: Settings<f32>) {
        match motion {
            InSpace::Planar(m) => place_planar(room, m, settings),
            InSpace::Spatial(m) => place_spatial(room, m, settings),
        }
    }

    /// Changes the motion, if it is of the same dimension.
    pub(crate) fn set_motion(&mut self, motion: AnyMotion) -> Result<(), OtherDimension> {
        match (self, motion) {
            (Self::Planar(c), InSpace::Planar(m)) => c.set_motion(m),
            (Self::Spatial(c), InSpace::Spatial(m)) => c.set_motion(m),
            _ => return Err(OtherDimension),
        }
        Ok(())
    }

    pub(crate) fn set_settings(&mut self, settings: Settings<f32>) {
        match self {
            Self::Planar(c) => c.set_settings(settings),
            Self::Spatial(c) => c.set_settings(settings),
        }
    }

    pub(crate) fn rest(&mut self) {
        match self {
            Self::Planar(c) => c.rest(),
            Self::Spatial(c) => c.rest(),
        }
    }

    pub(crate) fn upsert(
        &mut self,
        id: u16,
        obstacle: AnyObstacle,
        age: f32,
    ) -> Result<Result<(), TableFull>, OtherDimension> {
        match (self, obstacle) {
            (Self::Planar(c), InSpace::Planar(o)) => Ok(c.upsert(id, o, age)),
            (Self::Spatial(c), InSpace::Spatial(o)) => Ok(c.upsert(id, o, age)),
            _ => Err(OtherDimension),
        }
    }

    pub(crate) fn set_scan(&mut self, scan: AnyScan, age: f32) -> Result<(), OtherDimension> {
        match (self, scan) {
            (Self::Planar(c), InSpace::Planar(s)) => c.set_scan(s, age),
            (Self::Spatial(c), InSpace::Spatial(s)) => c.set_scan(s, age),
            _ => return Err(OtherDimension),
        }
        Ok(())
    }

    /// Moves the attractor to where it is `age` seconds later; is that in range?
    pub(crate) fn aim(&mut self, target: &AnyTarget, age: f32) -> Result<bool, OtherDimension> {
        match (self, target) {
            (Self::Planar(c), InSpace::Planar(t)) => Ok(c.aim(&t.after(age), t.velocity())),
            (Self::Spatial(c), InSpace::Spatial(t)) => Ok(c.aim(&t.after(age), t.velocity())),
            _ => Err(OtherDimension),
        }
    }

    pub(crate) fn remove(&mut self, id: u16) -> bool {
        match self {
            Self::Planar(c) => c.table_mut().remove(id),
            Self::Spatial(c) => c.table_mut().remove(id),
        }
    }

    pub(crate) fn clear(&mut self) {
        match self {
            Self::Planar(c) => c.table_mut().clear(),
            Self::Spatial(c) => c.table_mut().clear(),
        }
    }

    pub(crate) fn revision(&self) -> u32 {
        match self {
            Self::Planar(c) => c.table().revision(),
            Self::Spatial(c) => c.table().revision(),
        }
    }

    /// Time passes without a command.
    pub(crate) fn wait(&mut self, dt: f32) {
        match self {
            Self::Planar(c) => c.wait(dt),
            Self::Spatial(c) => c.wait(dt),
        }
    }

    /// One tick of `dt` seconds, with a fresh state or (`fresh` false) ramping down from the last command.
    pub(crate) fn tick(&mut self, state: &AnyState, fresh: bool, dt: f32) -> Result<Flat, OtherDimension> {
        match (self, state) {
            (Self::Planar(c), InSpace::Planar(s)) => {
                let command = if fresh { c.tick(s, dt) } else { c.tick_late(s, dt) };
                Ok(Command {
                    velocity: command.velocity.push(0.0),
                    gamma: command.gamma,
                    nearest: command.nearest,
                    region: command.region,
                    status: command.status,
                })
            }
            (Self::Spatial(c), InSpace::Spatial(s)) => Ok(if fresh { c.tick(s, dt) } else { c.tick_late(s, dt) }),
            _ => Err(OtherDimension),
        }
    }
}

// A controller is tens of kilobytes, and is on the stack once before it is where it belongs. In one function there would be stack for one
// of each dimension at the same time; and a room that is emptied first needs no stack for what was there.

#[inline(never)]
fn place_planar(room: &mut Option<Space>, motion: Motion<f32, 2>, settings: Settings<f32>) {
    *room = None;
    room.get_or_insert_with(|| Space::Planar(Controller::new(motion, settings)));
}

#[inline(never)]
fn place_spatial(room: &mut Option<Space>, motion: Motion<f32, 3>, settings: Settings<f32>) {
    *room = None;
    room.get_or_insert_with(|| Space::Spatial(Controller::new(motion, settings)));
}
