//! The world a moment later: obstacles and attractor go on as they move.

use nalgebra::DVector;

use super::error::OracleError;
use super::geometry::{length, unit};
use super::scene::{OracleRotation, OracleScene, OracleSpin};

/// The scene `dt` later, s: every pose, what has grown and aged, and the attractor.
///
/// # Errors
/// Where a planar rotation is asked to turn about another axis and has no such turn.
pub fn carried(scene: &OracleScene, dt: f64) -> Result<OracleScene, OracleError> {
    let mut later = scene.clone();
    for obstacle in &mut later.obstacles {
        obstacle.center.iter_mut().zip(&obstacle.velocity).for_each(|(c, v)| *c += v * dt);
        obstacle.rotation = turned(obstacle.rotation, obstacle.spin, dt)?;
        obstacle.grown += obstacle.growth * dt;
        obstacle.aged += obstacle.ageing * dt;
    }
    if let Some(drift) = &mut later.drift {
        drift.displacement.iter_mut().zip(&drift.velocity).for_each(|(d, v)| *d += v * dt);
    }
    Ok(later)
}

/// The rotation after a turn in the world's frame.
fn turned(rotation: OracleRotation, spin: OracleSpin, dt: f64) -> Result<OracleRotation, OracleError> {
    Ok(match (rotation, spin) {
        (OracleRotation::Angle(angle), OracleSpin::Planar(rate)) => OracleRotation::Angle(angle + rate * dt),
        (OracleRotation::Angle(angle), OracleSpin::Spatial(_)) => {
            let half = 0.5 * angle;
            turned(OracleRotation::Quaternion([half.cos(), 0.0, 0.0, half.sin()]), spin, dt)?
        }
        (OracleRotation::Quaternion(own), OracleSpin::Planar(rate)) => {
            turned(OracleRotation::Quaternion(own), OracleSpin::Spatial([0.0, 0.0, rate]), dt)?
        }
        (OracleRotation::Quaternion(own), OracleSpin::Spatial(rate)) => {
            let rate = DVector::from_column_slice(&rate) * dt;
            let Some(axis) = unit(&rate) else {
                return Ok(rotation);
            };
            let (sin, cos) = (0.5 * length(&rate)).sin_cos();
            let own = unit(&DVector::from_column_slice(&own)).ok_or(OracleError::Value("rotation"))?;
            OracleRotation::Quaternion(product(
                [cos, axis[0] * sin, axis[1] * sin, axis[2] * sin],
                [own[0], own[1], own[2], own[3]],
            ))
        }
    })
}

/// The rotation b, then a.
pub(super) fn product(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

#[cfg(test)]
mod tests {
    use super::super::geometry::rotation_matrix;
    use super::super::obstacle::Body;
    use super::super::random_scene::{Recipe, generate_from};
    use super::*;

    #[test]
    fn a_surface_goes_where_its_velocity_says() {
        // The point of a surface on a fixed ray of the frame moves along the normal as s does, to first order.
        for seed in 0..60 {
            let recipe = Recipe { moving: 1.0, growing: 0.0, walls: 0.3, ..Recipe::new(2 + (seed % 2) as usize) };
            let scene = generate_from(&recipe, seed, 0).scene;
            let dt = 1e-6;
            let later = carried(&scene, dt).unwrap();
            let ray = DVector::from_fn(scene.dimension, |i, _| [0.6, -0.64, 0.48][i]);
            let ray = unit(&ray).unwrap();
            for (now, then) in scene.obstacles.iter().zip(&later.obstacles) {
                let body = |o| Body::new(o, scene.dimension, scene.method).unwrap();
                let (now, then) = (body(now), body(then));
                let on = |b: &Body| b.world(&(&ray * b.reach(&ray, 1.0, false)));
                let x = on(&now);
                let moved = (on(&then) - &x) / dt;
                let n = now.normal(&x);
                assert!((n.dot(&moved) - n.dot(&now.surface_velocity(&x))).abs() < 1e-4, "seed {seed}");
            }
        }
    }

    #[test]
    fn a_quarter_turn_about_the_worlds_axis() {
        let start = OracleRotation::Quaternion([0.5, 0.5, 0.5, 0.5]);
        let turned = turned(start, OracleSpin::Spatial([0.0, 0.0, std::f64::consts::PI]), 0.5).unwrap();
        let expected = rotation_matrix(OracleRotation::Angle(std::f64::consts::FRAC_PI_2), 3).unwrap()
            * rotation_matrix(start, 3).unwrap();
        assert!((rotation_matrix(turned, 3).unwrap() - expected).amax() < 1e-15);
    }
}
