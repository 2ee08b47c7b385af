//! Planar or spatial: a device runs either, as its skill has it.

use pliant_core::{Command, Controller, Motion, Obstacle, RobotState, Settings, TableFull};

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
    pub(crate) fn new(motion: AnyMotion, settings: Settings<f32>) -> Self {
        match motion {
            InSpace::Planar(m) => Self::Planar(Controller::new(m, settings)),
            InSpace::Spatial(m) => Self::Spatial(Controller::new(m, settings)),
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
