//! What the robot may be asked for: the fourth stage of a tick.
//!
//! With u the wanted velocity, u_previous the command of the last tick, v the largest speed and a the largest
//! acceleration,
//!
//! ```text
//! u  <- u min(1, v/|u|)                                      |u| <= v: scaled, direction kept
//! du <- u - u_previous,  u <- u_previous + du min(1, a dt/|du|)  |du| <= a dt: the change is shortened
//! u  <- u min(1, v/|u|)                                      once more: v may have been lowered since the last command
//! ```
//!
//! all in the Euclidean norm, in m/s, m/s^2 and s. The second line acts where an acceleration is set, the third where
//! the second did. A speed that is lowered holds at once, whatever acceleration it takes. This stage knows no
//! obstacles: that a velocity that could not change fast enough does not end in a core is the
//! [`guard`](crate::guard)'s part, which may exceed a, never v.

use crate::{Scalar, Status, Vector, unit};

/// Bounds on the commanded velocity. Their ranges are those of [`Settings::check`](crate::Settings::check).
///
/// ```
/// use pliant_core::nalgebra::Vector2;
/// use pliant_core::{Limits, Status};
/// let limits = Limits { speed: 0.5, acceleration: Some(10.0), ..Limits::default() };
/// let (u, status) = limits.apply(Vector2::new(3.0, 4.0), &Vector2::zeros(), 0.001);
/// assert!((u - Vector2::new(0.006, 0.008)).norm() < 1e-15); // 10 m/s^2 for 1 ms
/// assert_eq!(status, Status::SPEED_LIMITED | Status::ACCELERATION_LIMITED);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits<S> {
    /// v, largest speed, m/s: above 0, at most 100.
    pub speed: S,
    /// a, largest change of velocity, m/s^2: above 0, at most 10^4; `None` leaves it free.
    pub acceleration: Option<S>,
    /// How fast a command ramps to zero when the robot's state stays away, m/s^2: above 0, at most 10^4.
    pub deceleration: S,
}

impl<S: Scalar> Default for Limits<S> {
    /// 0.5 m/s, no acceleration limit, 2 m/s^2.
    fn default() -> Self {
        Self { speed: S::from_f64(0.5), acceleration: None, deceleration: S::from_f64(2.0) }
    }
}

impl<S: Scalar> Limits<S> {
    /// `wanted` within the limits, where the last command was `previous` (both m/s) and `dt` >= 0 seconds pass: the
    /// [module](self)'s three lines. With it [`Status::SPEED_LIMITED`] where the first line shortened,
    /// [`Status::ACCELERATION_LIMITED`] where the second did. Not-a-number goes through.
    pub fn apply<const D: usize>(
        &self,
        wanted: Vector<S, D>,
        previous: &Vector<S, D>,
        dt: S,
    ) -> (Vector<S, D>, Status) {
        let (velocity, fast) = shortened(wanted, self.speed);
        let mut status = if fast { Status::SPEED_LIMITED } else { Status::empty() };
        let Some(acceleration) = self.acceleration else {
            return (velocity, status);
        };
        let (change, hard) = shortened(velocity - previous, acceleration * dt);
        if !hard {
            return (velocity, status);
        }
        status |= Status::ACCELERATION_LIMITED;
        // Only where the limit has been lowered since: then it counts for more.
        (shortened(previous + change, self.speed).0, status)
    }

    /// The velocity one step of `dt` >= 0 seconds nearer to standing still than `previous` (m/s):
    ///
    /// ```text
    /// u = p - p min(1, deceleration dt/|p|),   p = previous min(1, speed/|previous|)
    /// ```
    ///
    /// zero, exactly, once |p| <= deceleration dt.
    pub fn ramp_down<const D: usize>(&self, previous: &Vector<S, D>, dt: S) -> Vector<S, D> {
        let previous = shortened(*previous, self.speed).0;
        previous - shortened(previous, self.deceleration * dt).0
    }
}

/// The vector, at most `length` long, and whether it had to be shortened.
fn shortened<S: Scalar, const D: usize>(v: Vector<S, D>, length: S) -> (Vector<S, D>, bool) {
    // Halved, so that the length of the largest vector fits; divided first, so that in fixed point the ratio keeps
    // its digits.
    let half = S::from_f64(0.5);
    let halved = v * half;
    let (own, unit) = unit(&halved);
    if own > length * half { (unit * length, true) } else { (v, false) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speed_then_acceleration() {
        let limits = Limits { speed: 1.0, acceleration: Some(10.0), deceleration: 2.0 };
        let still = Vector::<f64, 2>::zeros();
        let (v, status) = limits.apply(Vector::<f64, 2>::new(3.0, 4.0), &still, 0.001);
        assert!((v - Vector::<f64, 2>::new(0.006, 0.008)).norm() < 1e-15);
        assert_eq!(status, Status::SPEED_LIMITED | Status::ACCELERATION_LIMITED);
    }

    #[test]
    fn a_lowered_limit_holds_at_once() {
        let limits = Limits { speed: 0.1, acceleration: Some(5.0), deceleration: 2.0 };
        let before = Vector::<f64, 2>::new(1.2, -1.6);
        for (v, _) in [limits.apply(before, &before, 0.001), (limits.ramp_down(&before, 0.001), Status::empty())] {
            assert!(v.norm() <= 0.1 + 1e-15, "{v}");
        }
    }

    #[test]
    fn a_ramp_ends_at_rest_and_stays() {
        let limits = Limits::<f64>::default();
        let mut v = Vector::<f64, 2>::new(0.3, -0.4);
        for _ in 0..249 {
            v = limits.ramp_down(&v, 0.001);
            assert!(v.norm() > 0.0);
        }
        v = limits.ramp_down(&limits.ramp_down(&v, 0.001), 0.001);
        assert_eq!(v, Vector::<f64, 2>::zeros());
    }
}
