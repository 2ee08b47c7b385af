//! What becomes of what nobody speaks of any more.

use crate::Scalar;

/// What happens to an obstacle that nobody speaks of any more. By its age (s since it was seen):
///
/// ```text
/// t = min(age, hold)
/// hard semi-extent = eta (as seen + obstacle's own growth * t) + growth * max(0, t - time_to_live)
/// ```
///
/// with eta the obstacle's safety factor. Its velocity and spin end at `hold` as well. Every hard semi-extent becomes
/// longer by the same length: semi-axes, half sides, radius and half length with the radius; of a polygon all of it
/// in proportion, by the distance of its nearest edge. A wall's free space becomes smaller by as much, but never
/// below a tenth.
///
/// ```
/// use pliant_core::nalgebra::Vector2;
/// use pliant_core::{Ageing, Obstacle, ObstacleSpec, Status, Table};
/// let ageing = Ageing { time_to_live: 0.2, growth: 0.02, hold: 1.0 };
/// let mut table: Table<f64, 2, 1> = Table::new();
/// let ball = ObstacleSpec { velocity: Vector2::new(0.1, 0.0), ..ObstacleSpec::default() };
/// table.upsert(7, Obstacle::new(ball).unwrap(), 0.0, &ageing).unwrap();
/// let mut status = Status::empty();
/// for _ in 0..2000 {
///     status = table.advance(0.001, &ageing);
/// }
/// let ball = table.iter().next().unwrap().obstacle();
/// assert_eq!(status, Status::HELD);
/// let right = ball.surface(&Vector2::new(1.0, 0.0)).x; // 1 s at 0.1 m/s, 5 cm, and 0.8 s at 0.02 m/s
/// assert!((right - (0.1 + 0.05 + 0.016)).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ageing<S> {
    /// Age, s, 0 to 3600, up to which an obstacle is carried on by its velocity and trusted.
    pub time_to_live: S,
    /// Beyond it every hard semi-extent grows by this, m/s, 0 to 10, for what is not seen may be anywhere near.
    pub growth: S,
    /// Age, s, from the time to live to 3600, at which it stops moving and growing and is flagged as held.
    pub hold: S,
}

impl<S: Scalar> Default for Ageing<S> {
    /// 0.2 s, 0.02 m/s, 1 s.
    fn default() -> Self {
        Self { time_to_live: S::from_f64(0.2), growth: S::from_f64(0.02), hold: S::one() }
    }
}
