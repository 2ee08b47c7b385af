//! Raw range points as one obstacle: a planar scan or a depth patch, without a shape.
//!
//! Each point p_i (m) is a rigid ball of radius R (m) at rest, with Gamma_i = |x - p_i|^2 / R^2. As in fast obstacle
//! avoidance for lidar (Huber, Slotine & Billard 2022) there is one modulation from all points rather than one a
//! point: with weights w_i proportional to 1/(Gamma_i - 1) and n_i = (x - p_i)/|x - p_i|,
//!
//! ```text
//! nbar = sum_i w_i n_i,   xdot = M f with n = r = nbar/|nbar| and 1/G = |nbar| / min_i Gamma_i
//! ```
//!
//! On the surface of a point's ball nbar is its normal and the flow slides along it; between points on two sides nbar
//! is short and the flow passes through the middle unbent: there G is beyond what counts. Where min_i Gamma_i <= 1, G
//! is that itself. Among obstacles the scan counts as one more of them ([`modulation`](crate::modulation)) and has no
//! soft layer; the [`guard`](crate::guard) keeps off each point, by a half-space with n = n_i and gap = |x - p_i| -
//! R.
//!
//! A scan that is older than its time to live grows: R += (ageing growth) dt, up to its hold time (see [`Ageing`]);
//! it does not move.

#[cfg(test)]
mod tests;

use crate::obstacle::Sample;
use crate::table::Ageing;
use crate::{Scalar, Status, Vector, in_range, norm};

/// Most points of a scan; thin out what has more.
pub const MAX_POINTS: usize = 128;

/// A set of range points, all seen at one time. A [`Table`](crate::Table) holds one.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan<S: Scalar, const D: usize> {
    points: heapless::Vec<Vector<S, D>, MAX_POINTS>,
    radius: S,
    /// The radius before ageing, m.
    young: S,
    age: S,
}

/// Why a set of points is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScanError {
    /// More than [`MAX_POINTS`].
    Points,
    /// This point is not finite, or beyond +-1000 m.
    Point(usize),
    /// Not between [`Scalar::MIN_AXIS`] and 100 m.
    Radius,
}

impl core::fmt::Display for ScanError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Points => f.write_str("points are more than 128"),
            Self::Point(k) => write!(f, "points[{k}] is not finite, or beyond +-1000 m"),
            Self::Radius => f.write_str("radius is not from 0.1 mm (in fixed point 2 mm) to 100 m"),
        }
    }
}

impl core::error::Error for ScanError {}

impl<S: Scalar, const D: usize> Default for Scan<S, D> {
    /// No points.
    fn default() -> Self {
        Self { points: heapless::Vec::new(), radius: S::MIN_AXIS, young: S::MIN_AXIS, age: S::zero() }
    }
}

impl<S: Scalar, const D: usize> Scan<S, D> {
    /// Points (m), each to be kept away from by `radius` (m): half their spacing and more, so that nothing fits
    /// between them; plus the robot's own size.
    ///
    /// # Errors
    /// [`ScanError`]: more than [`MAX_POINTS`], the first point that is out of range, or a radius below [`Scalar::MIN_AXIS`] or above 100 m.
    ///
    /// ```
    /// use pliant_core::{Scan, Vector};
    /// let wall: Vec<_> = (0..20).map(|i| Vector::<f64, 2>::new(0.5, 0.02 * f64::from(i))).collect();
    /// let scan = Scan::new(&wall, 0.03).unwrap();
    /// assert!((scan.gamma(&Vector::<f64, 2>::new(0.44, 0.1)) - 4.0).abs() < 1e-9);
    /// ```
    pub fn new(points: &[Vector<S, D>], radius: S) -> Result<Self, ScanError> {
        if let Some(bad) = points.iter().position(|p| !in_range(p)) {
            return Err(ScanError::Point(bad));
        }
        if !(radius >= S::MIN_AXIS && radius <= S::from_f64(100.0)) {
            return Err(ScanError::Radius);
        }
        let points = heapless::Vec::from_slice(points).map_err(|_| ScanError::Points)?;
        Ok(Self { points, radius, young: radius, age: S::zero() })
    }

    /// The points, m.
    pub fn points(&self) -> &[Vector<S, D>] {
        &self.points
    }

    /// What each is kept away from by, m, ageing included.
    pub fn radius(&self) -> S {
        self.radius
    }

    /// min_i |x - p_i|^2/R^2, dimensionless, at x in m: the least Gamma of all points; [`Scalar::MAX`] without points.
    pub fn gamma(&self, x: &Vector<S, D>) -> S {
        self.points.iter().fold(S::MAX, |least, p| least.min(self.gamma_of(p, x)))
    }

    /// As one obstacle, and the least Gamma; no sample without points or where all are too far to matter.
    pub(crate) fn sample(&self, x: &Vector<S, D>) -> (S, Option<Sample<S, D>>) {
        let (one, zero) = (S::one(), S::zero());
        let gamma = self.gamma(x);
        if !(gamma < S::FAR) {
            return (gamma, None);
        }
        let nearest = (gamma - one).max(zero);
        let (mut sum, mut normal) = (zero, Vector::<S, D>::zeros());
        for p in &self.points {
            let distance = self.gamma_of(p, x) - one;
            let weight = crate::modulation::weight(distance, nearest);
            if weight > zero {
                let away = x - p;
                let length = norm(&away);
                sum += weight;
                if length > zero {
                    normal += away * (weight / length);
                }
            }
        }
        let normal = normal / sum;
        let share = norm(&normal).min(one);
        // On a surface nothing may flow in, whatever the other points touched at the same time say.
        let far = gamma > one && share <= gamma / S::FAR;
        let effective = if gamma <= one || far { gamma } else { gamma / share };
        if far || !(effective < S::FAR) {
            return (gamma, None);
        }
        // Of unit length, for in fixed point a short one has no square.
        let normal = if share > zero { normal / share } else { normal };
        let sample = Sample { gamma: effective, outward: normal, arm: normal, surface_velocity: Vector::zeros() };
        (gamma, Some(sample))
    }

    /// Half-spaces that keep x out of every ball within `reach`; see [`Obstacle::keep_out`](crate::Obstacle).
    pub(crate) fn keep_out(&self, x: &Vector<S, D>, reach: S, mut keep: impl FnMut(Vector<S, D>, S)) {
        let far = reach + self.radius;
        for p in &self.points {
            let away = x - p;
            if away.iter().any(|a| a.abs() > far) {
                continue;
            }
            let length = norm(&away);
            if length > S::zero() {
                keep(away / length, length - self.radius);
            } else {
                keep(Vector::from_fn(|i, _| if i == 0 { S::one() } else { S::zero() }), -self.radius);
            }
        }
    }

    /// Lets `dt` seconds pass: what nobody confirms grows, then stops growing.
    pub(crate) fn advance(&mut self, dt: S, ageing: &Ageing<S>) {
        if self.points.is_empty() || self.age >= ageing.hold {
            return;
        }
        if self.age >= ageing.time_to_live {
            self.radius += ageing.growth * dt;
        }
        self.age += dt;
    }

    /// The same for a time that may be long.
    pub(crate) fn pass(&mut self, time: S, ageing: &Ageing<S>) {
        if !self.points.is_empty() {
            self.carry(self.age + time, ageing);
        }
    }

    /// As it is at that age.
    pub(crate) fn carry(&mut self, age: S, ageing: &Ageing<S>) {
        // Who knows no age is taken for as old as can be; and it may come out of a table, where it was old.
        self.age = if age <= ageing.hold { age.max(S::zero()) } else { ageing.hold };
        self.radius = self.young + ageing.growth * (self.age - ageing.time_to_live).max(S::zero());
    }

    pub(crate) fn status(&self, ageing: &Ageing<S>) -> Status {
        if self.points.is_empty() || self.age < ageing.time_to_live {
            Status::empty()
        } else if self.age < ageing.hold {
            Status::EXTRAPOLATED
        } else {
            Status::HELD
        }
    }

    fn gamma_of(&self, p: &Vector<S, D>, x: &Vector<S, D>) -> S {
        let u = (x - p) * (S::one() / self.radius);
        S::dot(u.as_slice(), u.as_slice())
    }
}
