//! Nominal motion: where the robot would go if nothing were in the way.
//!
//! A learnt skill is a linear-parameter-varying dynamical system (LPV-DS; Figueroa & Billard, CoRL 2018; eqs. 1-5 of
//! Chen et al.)
//!
//! ```text
//! f(x)    = sum_k gamma_k(x) A_k (x - x*)                       m/s
//! gamma_k = pi_k N(x; mu_k, Sigma_k) / sum_j pi_j N(x; mu_j, Sigma_j)
//! ```
//!
//! with a quadratic Lyapunov function that proves it ends at its attractor x*:
//!
//! ```text
//! V(x) = (x - x*)' P (x - x*),   P = P' > 0,   A_k' P + P A_k < 0 for every k
//! dV/dt = sum_k gamma_k (x - x*)' (A_k' P + P A_k) (x - x*) < 0      but at x*, for gamma_k >= 0 sum to 1
//! ```
//!
//! [`Certified`] is that proof as a type: nothing else can be driven, but for [`Motion::linear`], f(x) = -gain (x -
//! x*), which needs none. The proof is of the motion in continuous time, without obstacles. Where the attractor
//! moves, [`Moving`] carries the motion along.

mod certificate;
mod lpv;
mod moving;

pub use certificate::{Certificate, CertificateError, Certified};
pub use lpv::{Component, LpvDs, MAX_COMPONENTS, ModelError, ModelField};
pub use moving::Moving;

use crate::{Scalar, Vector, in_range};

/// A motion that is stable: by construction, or by its certificate.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion<S: Scalar, const D: usize> {
    /// f(x) = -gain (x - attractor), gain in 1/s.
    Linear(LinearDs<S, D>),
    /// A learnt skill with its proof.
    Lpv(Certified<LpvDs<S, D>>),
}

/// Straight to the attractor, exponentially: f(x) = -gain (x - attractor), gain in 1/s.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearDs<S: Scalar, const D: usize> {
    attractor: Vector<S, D>,
    gain: S,
}

impl<S: Scalar, const D: usize> LinearDs<S, D> {
    /// Where it ends, m.
    pub fn attractor(&self) -> &Vector<S, D> {
        &self.attractor
    }
    /// The gain, 1/s.
    pub fn gain(&self) -> S {
        self.gain
    }
}

impl<S: Scalar, const D: usize> Motion<S, D> {
    /// Straight to `attractor` (m) at `gain` (1/s) times the distance.
    ///
    /// # Errors
    /// [`ModelField::Attractor`] where a coordinate is not within +-1000 m, [`ModelField::Gain`] where the gain is
    /// not above 0 and at most 1000 1/s.
    ///
    /// ```
    /// use pliant_core::{Motion, Vector};
    /// let motion = Motion::linear(Vector::<f64, 2>::zeros(), 2.0).unwrap();
    /// assert_eq!(motion.velocity(&Vector::<f64, 2>::new(0.5, 0.0)).x, -1.0);
    /// assert!(Motion::linear(Vector::<f64, 2>::zeros(), 0.0).is_err());
    /// ```
    pub fn linear(attractor: Vector<S, D>, gain: S) -> Result<Self, ModelError> {
        if !in_range(&attractor) {
            return Err(ModelError::of(ModelField::Attractor));
        }
        if !(gain > S::zero() && gain <= S::from_f64(1000.0)) {
            return Err(ModelError::of(ModelField::Gain));
        }
        Ok(Self::Linear(LinearDs { attractor, gain }))
    }

    /// f(x), in m/s, at x in m (within [`RANGE`](crate::RANGE)); zero at the attractor.
    pub fn velocity(&self, x: &Vector<S, D>) -> Vector<S, D> {
        match self {
            Self::Linear(ds) => (ds.attractor - x) * ds.gain,
            Self::Lpv(ds) => ds.velocity(x),
        }
    }

    /// x*, where the motion ends, in m.
    pub fn attractor(&self) -> &Vector<S, D> {
        match self {
            Self::Linear(ds) => &ds.attractor,
            Self::Lpv(ds) => ds.attractor(),
        }
    }
}
