//! Limits on speed and acceleration, section 6.

use nalgebra::DVector;

use super::error::OracleError;
use super::geometry::{length, vector};
use super::scene::{OracleLimits, OracleTick};

/// The velocity of the last stage.
pub(super) fn limit(
    u: &DVector<f64>,
    limits: &OracleLimits,
    tick: Option<&OracleTick>,
) -> Result<DVector<f64>, OracleError> {
    if limits.speed.is_nan() || limits.speed < 0.0 {
        return Err(OracleError::Value("speed limit"));
    }
    let slow = shortened(u.clone(), limits.speed);
    let (Some(acceleration), Some(tick)) = (limits.acceleration, tick) else {
        return Ok(slow);
    };
    if acceleration.is_nan() || acceleration < 0.0 {
        return Err(OracleError::Value("acceleration limit"));
    }
    if tick.dt.is_nan() || tick.dt < 0.0 {
        return Err(OracleError::Value("time step"));
    }
    let previous = vector(&tick.previous, u.len(), "previous velocity")?;
    let change = slow - &previous;
    // The speed counts for more than the change, where a limit has been lowered.
    Ok(shortened(previous + shortened(change, acceleration * tick.dt), limits.speed))
}

fn shortened(v: DVector<f64>, most: f64) -> DVector<f64> {
    let size = length(&v);
    if size > most { v * (most / size) } else { v }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limited(u: [f64; 2], speed: f64, acceleration: Option<f64>, previous: [f64; 2]) -> DVector<f64> {
        let tick = OracleTick { previous: previous.to_vec(), dt: 0.1 };
        let u = DVector::from_column_slice(&u);
        limit(&u, &OracleLimits { speed, acceleration }, Some(&tick)).unwrap()
    }

    #[test]
    fn the_speed_cap_keeps_the_direction() {
        let capped = limited([3.0, -4.0], 0.5, None, [0.0, 0.0]);
        assert!((capped - DVector::from_column_slice(&[0.3, -0.4])).amax() < 1e-15);
        assert_eq!(limited([0.3, -0.4], 0.6, None, [0.0, 0.0]).as_slice(), &[0.3, -0.4]);
        assert_eq!(limited([3.0, -4.0], f64::INFINITY, None, [0.0, 0.0]).as_slice(), &[3.0, -4.0]);
    }

    #[test]
    fn the_change_is_shortened_after_the_speed() {
        // Capped to (1, 0); from (0, 1) the change (1, -1) may be 0.2 long.
        let near = limited([5.0, 0.0], 1.0, Some(2.0), [0.0, 1.0]);
        let part = 0.2 * std::f64::consts::FRAC_1_SQRT_2;
        assert!((near - DVector::from_column_slice(&[part, 1.0 - part])).amax() < 1e-15);
        assert_eq!(limited([0.1, 0.0], 1.0, Some(2.0), [0.0, 0.0]).as_slice(), &[0.1, 0.0]);
    }
}
