//! What becomes of what nobody speaks of any more.

use crate::Scalar;

/// What happens to an obstacle that nobody speaks of any more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ageing<S> {
    /// Age, s, up to which an obstacle is carried on by its velocity and trusted.
    pub time_to_live: S,
    /// Beyond it every hard semi-axis grows by this, m/s, for what is not seen may be anywhere near.
    pub growth: S,
    /// Age, s, at which it stops moving and growing and is flagged as held.
    pub hold: S,
}

impl<S: Scalar> Default for Ageing<S> {
    /// 0.2 s, 0.02 m/s, 1 s.
    fn default() -> Self {
        Self { time_to_live: S::from_f64(0.2), growth: S::from_f64(0.02), hold: S::one() }
    }
}
