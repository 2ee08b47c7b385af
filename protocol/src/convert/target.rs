//! A moving attractor.

use super::{finite, flat, vector};
use crate::message::{DeviceError, Field};
use pliant_core::obstacle::MAX_SPEED;
use pliant_core::{RANGE, Vector};

/// Where an attractor is and how it moves; checked by [`target`].
#[derive(Clone, Debug, PartialEq)]
pub struct Target<const D: usize> {
    position: Vector<f32, D>,
    velocity: Vector<f32, D>,
}

impl<const D: usize> Target<D> {
    /// Where it is, in m.
    pub fn position(&self) -> &Vector<f32, D> {
        &self.position
    }

    /// Its velocity, in m/s.
    pub fn velocity(&self) -> &Vector<f32, D> {
        &self.velocity
    }

    /// Where it is `age` seconds later, in m; not checked against the range.
    pub fn after(&self, age: f32) -> Vector<f32, D> {
        self.position + self.velocity * age
    }
}

/// An attractor that was checked, from a [`ToDevice::Aim`](crate::ToDevice::Aim).
///
/// ```
/// use pliant_protocol::convert::target;
/// use pliant_protocol::message::{DeviceError, Field};
///
/// let there = target::<2>(&[0.5, 0.25, 0.0], &[0.1, 0.0, 0.0]).unwrap();
/// assert_eq!(there.after(0.5).x, 0.55);
/// assert_eq!(target::<2>(&[0.5, 0.25, 0.1], &[0.0; 3]), Err(DeviceError::Dimension));
/// assert_eq!(target::<3>(&[2e3, 0.25, 0.1], &[0.0; 3]), Err(DeviceError::OutOfRange(Field::Attractor)));
/// ```
///
/// # Errors
///
/// A number is not finite, there is a z in two dimensions, or the position is beyond 1000 m or the velocity beyond
/// 100 m/s.
pub fn target<const D: usize>(position: &[f32; 3], velocity: &[f32; 3]) -> Result<Target<D>, DeviceError> {
    finite(position, Field::Attractor)?;
    finite(velocity, Field::AttractorVelocity)?;
    flat::<D>(position)?;
    flat::<D>(velocity)?;
    let within = |v: &[f32; 3], bound: f64| v.iter().all(|x| x.abs() <= bound as f32);
    if !within(position, RANGE) {
        return Err(DeviceError::OutOfRange(Field::Attractor));
    }
    if !within(velocity, MAX_SPEED) {
        return Err(DeviceError::OutOfRange(Field::AttractorVelocity));
    }
    Ok(Target { position: vector(position), velocity: vector(velocity) })
}
