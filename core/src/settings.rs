//! How obstacles bend the motion, what the robot may be asked for, and the ranges of both.

use crate::{Ageing, Guard, Limits, Scalar, SteeringPolicy};

/// Fastest speed limit, m/s.
const MAX_SPEED: f64 = 100.0;
/// Largest limit of an acceleration, m/s^2.
const MAX_ACCELERATION: f64 = 1e4;

/// How obstacles bend the motion, and what the robot may be asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<S> {
    /// Are soft layers soft? If not, this is the original method: every rho = ln k + 1 counts as 1.
    pub deformable: bool,
    /// c, how hard soft layers push, m/s, 0 to 10; eqs. 15 and 27 of Chen et al., see [`adaptive`](crate::adaptive).
    pub gain: S,
    /// Which way the push in a soft layer points, and what bounds it.
    pub steering: SteeringPolicy<S>,
    /// Speed (m/s) and acceleration (m/s^2).
    pub limits: Limits<S>,
    /// What becomes of obstacles that are not updated.
    pub ageing: Ageing<S>,
    /// Keeps every sample out of every hard core; `None` leaves it to the modulation, as the papers do.
    pub guard: Option<Guard<S>>,
}

impl<S: Scalar> Default for Settings<S> {
    /// Deformable, c = 0.03 m/s, with the flow at most as fast again, guarded, and the defaults of [`Limits`],
    /// [`Ageing`] and [`Guard`].
    fn default() -> Self {
        Self {
            deformable: true,
            gain: S::from_f64(0.03),
            steering: SteeringPolicy::WithFlow { beta: S::one() },
            limits: Limits::default(),
            ageing: Ageing::default(),
            guard: Some(Guard::default()),
        }
    }
}

/// The setting that is out of its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingsError {
    /// c: 0 to 10 m/s.
    Gain,
    /// cos^2 theta_2 + sin^2 theta_2 = 1 to within 1e-3, or beta 0 to 10.
    Steering,
    /// [`Limits::speed`]: above 0, at most 100 m/s.
    Speed,
    /// [`Limits::acceleration`]: none, or above 0 and at most 10^4 m/s^2.
    Acceleration,
    /// [`Limits::deceleration`]: above 0, at most 10^4 m/s^2.
    Deceleration,
    /// Times 0 to 3600 s with hold no less than time to live, growth 0 to 10 m/s.
    Ageing,
    /// alpha: above 0, at most 1.
    Guard,
}

impl core::fmt::Display for SettingsError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Gain => "gain is not from 0 to 10 m/s",
            Self::Steering => "steering has cos^2 + sin^2 further than 1e-3 from 1, or a beta that is not from 0 to 10",
            Self::Speed => "limits.speed is not above 0 and at most 100 m/s",
            Self::Acceleration => "limits.acceleration is neither none nor above 0 and at most 10^4 m/s^2",
            Self::Deceleration => "limits.deceleration is not above 0 and at most 10^4 m/s^2",
            Self::Ageing => {
                "ageing has a time not from 0 to 3600 s, a hold below time_to_live, or a growth not from 0 to 10 m/s"
            }
            Self::Guard => "guard.approach is not above 0 and at most 1",
        })
    }
}

impl core::error::Error for SettingsError {}

impl<S: Scalar> Settings<S> {
    /// Checks every range. A [`Controller`](crate::Controller) takes what fails for something else, so settings that come from outside are to
    /// be checked first.
    ///
    /// # Errors
    /// The first setting out of its range, or not a number, as [`SettingsError`] states it.
    ///
    /// ```
    /// use pliant_core::{Limits, Settings, SettingsError};
    /// let limits = Limits { speed: 0.0, ..Limits::default() };
    /// assert_eq!(Settings { limits, ..Settings::<f32>::default() }.check(), Err(SettingsError::Speed));
    /// assert_eq!(Settings::<f32>::default().check(), Ok(()));
    /// ```
    pub fn check(&self) -> Result<(), SettingsError> {
        let from_zero = |x: S, high: f64| x >= S::zero() && x <= S::from_f64(high);
        let above_zero = |x: S, high: f64| x > S::zero() && x <= S::from_f64(high);
        let steering = match self.steering {
            SteeringPolicy::Fixed { cos, sin } => (cos * cos + sin * sin - S::one()).abs() <= S::from_f64(1e-3),
            SteeringPolicy::WithFlow { beta } => from_zero(beta, 10.0),
        };
        let Ageing { time_to_live, growth, hold } = self.ageing;
        let ageing = from_zero(time_to_live, 3600.0)
            && from_zero(growth, 10.0)
            && from_zero(hold, 3600.0)
            && hold >= time_to_live;
        let check = |ok: bool, error: SettingsError| if ok { Ok(()) } else { Err(error) };
        check(from_zero(self.gain, 10.0), SettingsError::Gain)?;
        check(steering, SettingsError::Steering)?;
        check(above_zero(self.limits.speed, MAX_SPEED), SettingsError::Speed)?;
        check(self.limits.acceleration.is_none_or(|a| above_zero(a, MAX_ACCELERATION)), SettingsError::Acceleration)?;
        check(above_zero(self.limits.deceleration, MAX_ACCELERATION), SettingsError::Deceleration)?;
        check(ageing, SettingsError::Ageing)?;
        check(self.guard.is_none_or(|guard| above_zero(guard.approach, 1.0)), SettingsError::Guard)
    }

    /// The same with every setting in its range. A speed or an acceleration that is not counts as the nearest that is, as the least where it
    /// is no number; of the others that does the default.
    ///
    /// ```
    /// use pliant_core::{Limits, Settings};
    /// let limits = Limits { speed: f32::NAN, ..Limits::default() };
    /// let settings = Settings { limits, gain: -1.0, ..Settings::default() }.within_ranges();
    /// assert_eq!(settings.check(), Ok(()));
    /// assert!(settings.limits.speed < 1e-6 && settings.gain == 0.03);
    /// ```
    pub fn within_ranges(mut self) -> Self {
        let usual = Self::default();
        let least = S::EPSILON;
        // Each is right once it has been put right.
        while let Err(error) = self.check() {
            match error {
                SettingsError::Gain => self.gain = usual.gain,
                SettingsError::Steering => self.steering = usual.steering,
                SettingsError::Speed => self.limits.speed = least.max(self.limits.speed).min(S::from_f64(MAX_SPEED)),
                SettingsError::Acceleration => {
                    let most = S::from_f64(MAX_ACCELERATION);
                    self.limits.acceleration = self.limits.acceleration.map(|a| least.max(a).min(most));
                }
                SettingsError::Deceleration => self.limits.deceleration = usual.limits.deceleration,
                SettingsError::Ageing => self.ageing = usual.ageing,
                SettingsError::Guard => self.guard = usual.guard,
            }
        }
        self
    }
}
