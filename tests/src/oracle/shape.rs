//! Gauges: how far out of a shape a point is, and which way is out. Section 2.
//!
//! A rounded shape is known here by one question only, whether a point is within R of the body inside it. Its gauge is found
//! by bisection on that question, its normal by the direction from the nearest point of that body.

use nalgebra::DVector;

use super::error::OracleError;
use super::geometry::{length, turned_left, unit, vector};
use super::polygon::Star;
use super::scene::OracleShape;

/// A shape, checked.
pub(super) enum Shape {
    Ellipsoid { axes: DVector<f64>, exponent: f64 },
    Rounded { inner: Inner, rounding: f64, reach: f64 },
    Star(Star),
}

/// A body that a ball of the rounding is rolled around.
pub(super) enum Inner {
    /// Half sides.
    Box(Vec<f64>),
    /// About the third axis; radius 0 is a segment.
    Cylinder { radius: f64, half_length: f64 },
}

impl Shape {
    pub(super) fn new(shape: &OracleShape, d: usize) -> Result<Self, OracleError> {
        let positive = |values: &[f64], what| {
            if values.iter().all(|v| v.is_finite() && *v > 0.0) { Ok(()) } else { Err(OracleError::Value(what)) }
        };
        let fits = |rounding: f64, extents: &[f64]| {
            positive(&[rounding], "rounding")?;
            let least = extents.iter().copied().fold(f64::INFINITY, f64::min);
            if rounding <= least { Ok(()) } else { Err(OracleError::Value("rounding")) }
        };
        let spatial = if d == 3 { Ok(()) } else { Err(OracleError::Shape("shape")) };
        let reach = length(&DVector::from_vec(shape.semi_extents()));
        Ok(match shape {
            OracleShape::Ellipsoid { axes, curvature } => {
                let axes = vector(axes, d, "axes")?;
                positive(axes.as_slice(), "axes")?;
                if !(1..=8).contains(curvature) {
                    return Err(OracleError::Value("curvature"));
                }
                Self::Ellipsoid { axes, exponent: 2.0 * f64::from(*curvature) }
            }
            OracleShape::Box { half, rounding } => {
                positive(vector(half, d, "half sides")?.as_slice(), "half sides")?;
                fits(*rounding, half)?;
                Self::Rounded {
                    inner: Inner::Box(half.iter().map(|h| h - rounding).collect()),
                    rounding: *rounding,
                    reach,
                }
            }
            OracleShape::Cylinder { radius, half_length, rounding } => {
                spatial?;
                positive(&[*radius, *half_length], "cylinder")?;
                fits(*rounding, &[*radius, *half_length])?;
                let inner = Inner::Cylinder { radius: radius - rounding, half_length: half_length - rounding };
                Self::Rounded { inner, rounding: *rounding, reach }
            }
            OracleShape::Capsule { radius, half_length } => {
                spatial?;
                positive(&[*radius, *half_length], "capsule")?;
                let inner = Inner::Cylinder { radius: 0.0, half_length: *half_length };
                Self::Rounded { inner, rounding: *radius, reach }
            }
            OracleShape::Polygon { vertices } => {
                if d != 2 {
                    return Err(OracleError::Shape("shape"));
                }
                Self::Star(Star::new(vertices)?)
            }
        })
    }

    /// 2p
    pub(super) fn exponent(&self) -> f64 {
        match self {
            Self::Ellipsoid { exponent, .. } => *exponent,
            _ => 2.0,
        }
    }

    /// gamma
    pub(super) fn gamma(&self, y: &DVector<f64>) -> f64 {
        match self {
            Self::Ellipsoid { axes, exponent } => y.iter().zip(axes).map(|(q, a)| (q / a).abs().powf(*exponent)).sum(),
            _ => self.gauge(y).powi(2),
        }
    }

    /// lambda
    pub(super) fn gauge(&self, y: &DVector<f64>) -> f64 {
        match self {
            Self::Ellipsoid { exponent, .. } => self.gamma(y).powf(1.0 / exponent),
            Self::Rounded { inner, rounding, reach } => match unit(y) {
                Some(ray) => length(y) / surface(inner, *rounding, *reach, &ray),
                None => 0.0,
            },
            Self::Star(star) => star.at(y).gauge,
        }
    }

    /// dlambda/dy, for a polygon with the direction that the page gives it; zero at the origin.
    pub(super) fn gauge_gradient(&self, y: &DVector<f64>) -> DVector<f64> {
        let Some(ray) = unit(y) else {
            return DVector::zeros(y.len());
        };
        match self {
            Self::Ellipsoid { axes, exponent } => {
                // Of the point of the surface on the ray, whose slope all points of the ray share.
                let on = &ray / self.gauge(&ray);
                let steep = |(q, a): (&f64, &f64)| ((q / a).abs().powf(exponent - 1.0) / a).copysign(*q);
                DVector::from_iterator(y.len(), on.iter().zip(axes).map(steep))
            }
            Self::Rounded { inner, rounding, reach } => {
                let on = &ray * surface(inner, *rounding, *reach, &ray);
                let out = away(inner, &on);
                let out = unit(&out).unwrap_or(out);
                // lambda is 1 at the surface and grows in proportion along the ray.
                let rise = out.dot(&on);
                out / rise
            }
            Self::Star(star) => star.at(y).blended,
        }
    }
}

/// Distance from the origin to the surface along a unit vector.
fn surface(inner: &Inner, rounding: f64, reach: f64, ray: &DVector<f64>) -> f64 {
    let (mut within, mut beyond) = (0.0, reach * (1.0 + 1e-9));
    loop {
        let middle = 0.5 * (within + beyond);
        if middle <= within || middle >= beyond {
            return middle;
        }
        if distance(inner, ray.as_slice(), middle) <= rounding {
            within = middle;
        } else {
            beyond = middle;
        }
    }
}

/// From the body to the point `reach` along a ray.
fn distance(inner: &Inner, ray: &[f64], reach: f64) -> f64 {
    match inner {
        Inner::Box(half) => {
            ray.iter().zip(half).map(|(q, h)| ((q * reach).abs() - h).max(0.0).powi(2)).sum::<f64>().sqrt()
        }
        Inner::Cylinder { radius, half_length } => {
            let across = ray[0].hypot(ray[1]) * reach - radius;
            let along = (ray[2] * reach).abs() - half_length;
            across.max(0.0).hypot(along.max(0.0))
        }
    }
}

/// From the nearest point of the body to y.
pub(super) fn away(inner: &Inner, y: &DVector<f64>) -> DVector<f64> {
    let nearest = match inner {
        Inner::Box(half) => DVector::from_iterator(y.len(), y.iter().zip(half).map(|(q, h)| q.clamp(-h, *h))),
        Inner::Cylinder { radius, half_length } => {
            let across = y[0].hypot(y[1]);
            let keep = if across > *radius { radius / across } else { 1.0 };
            DVector::from_column_slice(&[y[0] * keep, y[1] * keep, y[2].clamp(-half_length, *half_length)])
        }
    };
    y - nearest
}

/// The right-hand normal of a direction in the plane.
pub(super) fn turned_right(v: &DVector<f64>) -> DVector<f64> {
    -turned_left(v)
}

#[cfg(test)]
mod tests;
