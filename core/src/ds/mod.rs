//! Nominal motion: where the robot would go if nothing were in the way.
//!
//! A learnt skill is a linear-parameter-varying dynamical system (LPV-DS; Figueroa & Billard, CoRL 2018; eqs. 1-5 of Chen et al.)
//!
//! ```text
//! f(x) = sum_k gamma_k(x) A_k (x - x*)
//! ```
//!
//! with a quadratic Lyapunov function that proves it ends at its attractor x*. [`Certified`] is that proof as a type: nothing
//! else can be driven.

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
    /// f(x) = -gain (x - attractor).
    Linear(LinearDs<S, D>),
    /// A learnt skill.
    Lpv(Certified<LpvDs<S, D>>),
}

/// Straight to the attractor, exponentially: f(x) = -gain (x - attractor), gain in 1/s.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearDs<S: Scalar, const D: usize> {
    attractor: Vector<S, D>,
    gain: S,
}

impl<S: Scalar, const D: usize> Motion<S, D> {
    /// Straight to `attractor` (m) at `gain` (1/s) times the distance.
    ///
    /// # Errors
    /// The attractor is out of range, or the gain is not positive and at most 1000 1/s.
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

    /// f(x), in m/s, at x in m.
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
