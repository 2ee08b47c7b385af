//! Settings.

use super::{finite, round};
use crate::message::{DeviceError, Field, Settings, Steering};
use pliant_core::SettingsError;
use pliant_core::{Ageing, Guard, Limits, Scalar, SteeringPolicy};

/// Settings that were checked, from a [`ToDevice::Configure`](crate::ToDevice::Configure).
///
/// ```
/// use pliant_protocol::convert::settings;
/// use pliant_protocol::message::{DeviceError, Field, Settings};
///
/// assert_eq!(settings(&Settings::default()), Ok(pliant_core::Settings::default()));
/// let backwards = Settings { speed: -0.5, ..Settings::default() };
/// assert_eq!(settings(&backwards), Err(DeviceError::OutOfRange(Field::Speed)));
/// ```
///
/// # Errors
///
/// A number is not finite, or out of the range that [`SettingsError`] states.
pub fn settings(wire: &Settings) -> Result<pliant_core::Settings<f32>, DeviceError> {
    let steering = match wire.steering {
        Steering::Fixed { angle: x } | Steering::WithFlow { beta: x } => x,
    };
    finite(&[wire.gain], Field::Gain)?;
    finite(&[steering], Field::Steering)?;
    finite(&[wire.speed], Field::Speed)?;
    finite(wire.acceleration.as_slice(), Field::Acceleration)?;
    finite(&[wire.deceleration], Field::Deceleration)?;
    finite(&[wire.time_to_live, wire.growth, wire.hold], Field::Ageing)?;
    finite(wire.guard.as_slice(), Field::Guard)?;
    let settings = pliant_core::Settings {
        deformable: wire.deformable,
        gain: wire.gain,
        steering: match wire.steering {
            Steering::Fixed { angle } => SteeringPolicy::fixed(angle),
            Steering::WithFlow { beta } => SteeringPolicy::WithFlow { beta },
        },
        limits: Limits { speed: wire.speed, acceleration: wire.acceleration, deceleration: wire.deceleration },
        ageing: Ageing { time_to_live: wire.time_to_live, growth: wire.growth, hold: wire.hold },
        guard: wire.guard.map(|approach| Guard { approach }),
    };
    settings.check().map_err(|error| DeviceError::OutOfRange(error.into()))?;
    Ok(settings)
}

impl From<SettingsError> for Field {
    fn from(error: SettingsError) -> Self {
        match error {
            SettingsError::Gain => Self::Gain,
            SettingsError::Steering => Self::Steering,
            SettingsError::Speed => Self::Speed,
            SettingsError::Acceleration => Self::Acceleration,
            SettingsError::Deceleration => Self::Deceleration,
            SettingsError::Ageing => Self::Ageing,
            SettingsError::Guard => Self::Guard,
        }
    }
}

impl<S: Scalar> From<&pliant_core::Settings<S>> for Settings {
    fn from(core: &pliant_core::Settings<S>) -> Self {
        let (limits, ageing) = (&core.limits, &core.ageing);
        Self {
            deformable: core.deformable,
            steering: match core.steering {
                SteeringPolicy::Fixed { cos, sin } => Steering::Fixed { angle: round(sin.atan2(cos)) },
                SteeringPolicy::WithFlow { beta } => Steering::WithFlow { beta: round(beta) },
            },
            gain: round(core.gain),
            speed: round(limits.speed),
            acceleration: limits.acceleration.map(round),
            deceleration: round(limits.deceleration),
            time_to_live: round(ageing.time_to_live),
            growth: round(ageing.growth),
            hold: round(ageing.hold),
            guard: core.guard.as_ref().map(|guard| round(guard.approach)),
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self::from(&pliant_core::Settings::<f32>::default())
    }
}
