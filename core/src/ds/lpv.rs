//! The LPV-DS: a Gaussian mixture that blends linear systems with one attractor.

use crate::{Matrix, RANGE, Scalar, Vector, in_range, times};

/// Most components a skill may have: what a device has room for.
pub const MAX_COMPONENTS: usize = 16;

/// One linear system and the Gaussian that says where it rules. [`ModelField`] has the ranges.
#[derive(Clone, Debug, PartialEq)]
pub struct Component<S: Scalar, const D: usize> {
    /// log pi_k - 1/2 log det Sigma_k; a constant common to all components may be left out.
    pub log_weight: S,
    /// mu_k, m.
    pub mean: Vector<S, D>,
    /// W_k, 1/m: lower triangular with W'W = Sigma^-1, so that (x - mu)' Sigma^-1 (x - mu) = |W (x - mu)|^2 is never
    /// negative, whatever the rounding.
    pub whitening: Matrix<S, D>,
    /// A_k, 1/s.
    pub a: Matrix<S, D>,
}

/// A learnt skill, with the Lyapunov matrix P that is said to prove it stable.
///
/// ```text
/// f(x)    = sum_k gamma_k(x) A_k (x - x*)                                              m/s
/// gamma_k = softmax_k( log pi_k - 1/2 log det Sigma_k - 1/2 |W_k (x - mu_k)|^2 )       W'W = Sigma^-1
/// ```
///
/// The largest exponent is subtracted before exponentiating, so the weights sum to one however far x is from the
/// data; a component whose exponent is more than 40 below the largest counts nothing. Figueroa & Billard, CoRL 2018;
/// eqs. 1-5 of Chen et al.
///
/// Built by [`LpvDs::new`], driven only once [`LpvDs::certify`] has found the proof to hold.
///
/// ```
/// use pliant_core::nalgebra::{Matrix2, Vector2};
/// use pliant_core::{Component, LpvDs};
/// let part = |x, a| Component { log_weight: 0.0, mean: Vector2::new(x, 0.0), whitening: Matrix2::identity() * 20.0, a };
/// let (left, right) = (part(-0.5, Matrix2::new(-1.0_f64, 1.0, -1.0, -1.0)), part(0.5, -Matrix2::identity()));
/// let skill = LpvDs::new(Vector2::zeros(), Matrix2::identity(), &[left, right]).unwrap();
/// // Ten standard deviations from the middle one system alone rules; in the middle both do.
/// assert_eq!(skill.velocity(&Vector2::new(0.5, 0.0)), Vector2::new(-0.5, 0.0));
/// assert!((skill.velocity(&Vector2::new(0.0, 0.2)) - Vector2::new(0.1, -0.2)).norm() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LpvDs<S: Scalar, const D: usize> {
    attractor: Vector<S, D>,
    lyapunov: Matrix<S, D>,
    components: heapless::Vec<Component<S, D>, MAX_COMPONENTS>,
}

/// Why a set of numbers is not a skill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModelError {
    /// The field at fault.
    pub field: ModelField,
    /// The component at fault, if it is one component's field.
    pub component: Option<usize>,
}

/// A field of a skill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelField {
    /// x*: finite, within range.
    Attractor,
    /// The gain of a linear motion: positive, at most 1000 1/s.
    Gain,
    /// P: finite, at most 1e6.
    Lyapunov,
    /// The number of components: 1 to [`MAX_COMPONENTS`].
    Components,
    /// log pi - 1/2 log det Sigma: finite, within +-1e6.
    Weight,
    /// mu: finite, within range.
    Mean,
    /// W: finite, at most 1e6 1/m (a tenth of a millimetre is 1e4).
    Whitening,
    /// A: finite, at most 1e4 1/s.
    A,
}

impl core::fmt::Display for ModelError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        if let Some(k) = self.component {
            write!(f, "components[{k}].")?;
        }
        f.write_str(match self.field {
            ModelField::Attractor => "attractor is not finite, or beyond +-1000 m",
            ModelField::Gain => "gain is not above 0 and at most 1000 1/s",
            ModelField::Lyapunov => "lyapunov has an entry that is not finite, or beyond +-1e6",
            ModelField::Components => "components are not 1 to 16",
            ModelField::Weight => "log_weight is not finite, or beyond +-1e6",
            ModelField::Mean => "mean is not finite, or beyond +-1000 m",
            ModelField::Whitening => "whitening has an entry that is not finite, or beyond +-1e6 1/m",
            ModelField::A => "a has an entry that is not finite, or beyond +-1e4 1/s",
        })
    }
}

impl core::error::Error for ModelError {}

impl ModelError {
    pub(crate) fn of(field: ModelField) -> Self {
        Self { field, component: None }
    }
}

impl<S: Scalar, const D: usize> LpvDs<S, D> {
    /// A skill from x* (m), P (D x D, symmetric; its scale does not matter) and 1 to [`MAX_COMPONENTS`] components.
    /// Checks ranges; whether the motion is stable is for [`LpvDs::certify`] to say.
    ///
    /// # Errors
    /// The first field that is not finite or out of its range, as [`ModelField`] states it.
    pub fn new(
        attractor: Vector<S, D>,
        lyapunov: Matrix<S, D>,
        components: &[Component<S, D>],
    ) -> Result<Self, ModelError> {
        let within = |m: &Matrix<S, D>, bound: f64| m.iter().all(|x| x.abs() <= S::from_f64(bound));
        if !in_range(&attractor) {
            return Err(ModelError::of(ModelField::Attractor));
        }
        if !within(&lyapunov, 1e6) {
            return Err(ModelError::of(ModelField::Lyapunov));
        }
        let components = match heapless::Vec::from_slice(components) {
            Ok(components) if !components.is_empty() => components,
            _ => return Err(ModelError::of(ModelField::Components)),
        };
        for (k, c) in components.iter().enumerate() {
            let fault = if !(c.log_weight.abs() <= S::from_f64(1e6)) {
                ModelField::Weight
            } else if !in_range(&c.mean) {
                ModelField::Mean
            } else if !within(&c.whitening, 1e6) {
                ModelField::Whitening
            } else if !within(&c.a, 1e4) {
                ModelField::A
            } else {
                continue;
            };
            return Err(ModelError { field: fault, component: Some(k) });
        }
        Ok(Self { attractor, lyapunov, components })
    }

    /// f(x), m/s, at x in m. Zero at the attractor, finite for x within [`RANGE`](crate::RANGE). One exponential a
    /// component.
    pub fn velocity(&self, x: &Vector<S, D>) -> Vector<S, D> {
        // log(pi_k N_k), turned round and 1/32 as large, so that fixed point holds it up to 360 standard deviations
        // away.
        let mut depths = [S::zero(); MAX_COMPONENTS];
        let mut least = S::MAX;
        for (depth, c) in depths.iter_mut().zip(&self.components) {
            let y = times(&c.whitening, &(x - c.mean)) * S::from_f64(0.125);
            *depth = S::dot(y.as_slice(), y.as_slice()) - c.log_weight * S::from_f64(1.0 / 32.0);
            least = least.min(*depth);
        }
        // Log-sum-exp: one exponent is now zero, so the sum is at least one and nothing is 0/0 far from the data.
        let offset = x - self.attractor;
        let mut sum = S::zero();
        let mut velocity = Vector::<S, D>::zeros();
        for (depth, c) in depths.iter().zip(&self.components) {
            let exponent = (least - *depth) * S::from_f64(32.0);
            // A weight below e^-40 of the largest is less than the rounding of their sum, also in f64: the velocity
            // misses that share of what this component alone would have.
            if exponent < S::from_f64(-40.0) {
                continue;
            }
            let gamma = exponent.exp();
            sum += gamma;
            velocity += times(&c.a, &offset) * gamma;
        }
        velocity / sum
    }

    /// x*, m.
    pub fn attractor(&self) -> &Vector<S, D> {
        &self.attractor
    }

    /// P of V = (x - x*)' P (x - x*), D x D.
    pub fn lyapunov(&self) -> &Matrix<S, D> {
        &self.lyapunov
    }

    /// The components, 1 to [`MAX_COMPONENTS`].
    pub fn components(&self) -> &[Component<S, D>] {
        &self.components
    }
}

// |W (x - mu)|^2 <= (3 * 1e6 * 2 * RANGE)^2 * 3 stays finite in f32.
const _: () = assert!(9.0 * 1e12 * 4.0 * RANGE * RANGE * 3.0 < f32::MAX as f64);
