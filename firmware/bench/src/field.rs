//! One modulated velocity among so many ellipsoids: the measure that papers state.

use crate::{Number, Random};
use pliant_core::{Controller, Motion, Obstacle, ObstacleSpec, RobotState, Settings, Shape, Vector};

/// Obstacles that a [`Field`] has room for.
pub const ROOM: usize = 64;
/// Numbers of obstacles that are measured.
pub const COUNTS: [u16; 6] = [1, 2, 5, 10, 20, 50];
/// Positions of a [`Field`].
const POSITIONS: usize = 256;

/// A linear motion among ellipsoids (p = 1) at rest, and positions all over, outside every core.
#[derive(Clone, Debug)]
pub struct Field<S: Number, const D: usize> {
    /// With the obstacles in it.
    pub controller: Controller<S, D, ROOM>,
    /// At least one.
    pub states: heapless::Vec<RobotState<S, D>, POSITIONS>,
}

impl<S: Number, const D: usize> Field<S, D> {
    /// With so many obstacles, at most [`ROOM`]; always the same ones.
    ///
    /// ```
    /// let field = pliant_bench::field::Field::<f64, 3>::new(10);
    /// assert_eq!(field.controller.table().len(), 10);
    /// assert_eq!(field.states.len(), 256);
    /// assert!(field.states.iter().all(|s| field.controller.evaluate(s).gamma > 1.0));
    /// ```
    #[allow(clippy::expect_used, reason = "numbers that are refused are a mistake in here")]
    pub fn new(obstacles: u16) -> Self {
        let mut random = Random::new(u32::from(obstacles));
        let motion = Motion::linear(random.vector(-100, 100), S::one()).expect("within range");
        let mut controller = Controller::new(motion, Settings::default());
        for id in 0..obstacles {
            let shape = Shape::ellipsoid(random.vector(20, 80));
            let center = random.vector(-1000, 1000);
            let spec = ObstacleSpec { center, rotation: random.rotation(), shape, ..ObstacleSpec::default() };
            controller.upsert(id, Obstacle::new(spec).expect("within range"), S::zero()).expect("there is room");
        }
        let mut states = heapless::Vec::new();
        while !states.is_full() {
            let position: Vector<S, D> = random.vector(-1000, 1000);
            let state = RobotState::new(position).expect("within range");
            if controller.evaluate(&state).gamma > S::one() {
                let _ = states.push(state);
            }
        }
        Self { controller, states }
    }

    /// The modulated velocity at one of the positions.
    #[inline(never)]
    pub fn velocity(&self, state: &RobotState<S, D>) -> Vector<S, D> {
        self.controller.modulated(state)
    }
}
