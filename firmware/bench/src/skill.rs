//! A learnt motion by itself: what one nominal velocity f(x) costs.

use crate::{Number, Random};
use pliant_core::{Component, Matrix, Motion, Vector, ds::LpvDs};

/// Numbers of components that are measured.
pub const COUNTS: [u16; 3] = [1, 8, 16];
/// Positions of a [`Skill`].
const POSITIONS: usize = 256;

/// A certified mixture of linear systems, so wide that each counts at every one of the positions: nothing is left out, it is the slowest there is.
#[derive(Clone, Debug)]
pub struct Skill<S: Number, const D: usize> {
    /// An LPV-DS.
    pub motion: Motion<S, D>,
    /// At least one.
    pub positions: heapless::Vec<Vector<S, D>, POSITIONS>,
}

impl<S: Number, const D: usize> Skill<S, D> {
    /// With so many components, 1 to 16; always the same ones.
    ///
    /// ```
    /// use pliant_core::{Motion, Vector};
    /// let skill = pliant_bench::skill::Skill::<f64, 2>::new(8);
    /// let Motion::Lpv(ds) = &skill.motion else { panic!() };
    /// assert_eq!((ds.components().len(), skill.positions.len()), (8, 256));
    /// // Nowhere do they differ by that much: no exponent lies 40 below another, so all are computed.
    /// let deep = |k: usize, x: &Vector<f64, 2>| (ds.components()[k].whitening * (x - ds.components()[k].mean)).norm_squared() / 2.0;
    /// assert!(skill.positions.iter().all(|x| (0..8).all(|k| deep(k, x) < 38.0)));
    /// ```
    #[allow(clippy::expect_used, reason = "numbers that are refused are a mistake in here")]
    pub fn new(components: u16) -> Self {
        let mut random = Random::new(u32::from(components));
        let parts: heapless::Vec<Component<S, D>, 16> = (0..components)
            .map(|_| {
                let rates: Vector<S, D> = random.vector(500, 2000);
                Component {
                    log_weight: random.between(-1000, 1000),
                    mean: random.vector(-500, 500),
                    whitening: random.skew::<S, D>(1000).lower_triangle()
                        + Matrix::from_diagonal(&random.vector(1000, 4000)),
                    // Skew and falling: A'P + PA < 0 with P = I.
                    a: random.skew::<S, D>(2000) - Matrix::from_diagonal(&rates),
                }
            })
            .collect();
        let ds = LpvDs::new(Vector::zeros(), Matrix::identity(), &parts).expect("within range");
        let motion = Motion::Lpv(ds.certify().expect("stable"));
        let positions = (0..POSITIONS).map(|_| random.vector(-500, 500)).collect();
        Self { motion, positions }
    }

    /// f(x) at one of the positions.
    #[inline(never)]
    pub fn velocity(&self, position: &Vector<S, D>) -> Vector<S, D> {
        self.motion.velocity(position)
    }
}
