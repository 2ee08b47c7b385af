//! One obstacle: a hard core, perhaps in a soft layer, that moves.
//!
//! ```text
//! Gamma(x)   = gamma(q_i / (eta_i L_i))    <= 1: hard
//! Gamma_k(x) = gamma(q_i / (rho_i L_i))    <= 1: soft, where not hard        q = Q' (x - c)
//! ```
//!
//! with gamma and the lengths L from the [`shape`](crate::shape): for an ellipsoid Gamma = sum_i |q_i / (eta_i a_i)|^2p, after
//! Khansari-Zadeh & Billard (2012) with the safety factors eta inside, so that the inflated surface is the one that cannot be penetrated.
//! Gamma_k is eq. 13 of Chen et al., with ln k + 1 = rho. A wall has 1/gamma, and both its surfaces come inwards: L_i/eta_i, L_i/rho_i.

mod motion;
mod reference;
mod sample;
mod spec;

#[cfg(test)]
mod tests;

pub use crate::shape::MAX_CURVATURE;
pub use spec::{MAX_RATIO, MAX_SPEED, MIN_AXIS, ObstacleError, ObstacleSpec};

pub(crate) use sample::{Sample, SoftLayer};

use crate::shape::{Body, Place, root};
use crate::{Scalar, Vector, norm};

/// A checked obstacle, at its present pose and size.
///
/// ```
/// use pliant_core::{Obstacle, ObstacleError, ObstacleSpec, Shape, Vector};
/// let ball = Obstacle::new(ObstacleSpec::<f64, 2>::default()).unwrap();
/// assert!((ball.gamma(&Vector::<f64, 2>::new(0.1, 0.0)) - 4.0).abs() < 1e-12);
/// let flat = Shape::ellipsoid(Vector::<f64, 2>::new(0.1, 0.0));
/// let flat = ObstacleSpec { shape: flat, ..ObstacleSpec::default() };
/// assert_eq!(Obstacle::new(flat).unwrap_err(), ObstacleError::Axes);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle<S: Scalar, const D: usize> {
    /// 1/(eta L), with growth and ageing: u = q * hard.
    hard: Vector<S, D>,
    /// 1/(rho L), with growth.
    soft: Vector<S, D>,
    /// Beyond this Gamma there is no soft layer.
    soft_until: S,
    /// From the centre to the reference point, in the world's frame, m: as long as nothing turns it stays.
    offset: Vector<S, D>,
    /// Does it move, turn or grow? Does it turn?
    moves: bool,
    spins: bool,
    /// How fast the surface moves along the shape's normal because it grows, m/s: never less towards the free side than it really does.
    swelling: S,
    /// 1/radius of the largest ball inside, 1/m.
    slimmest: S,
    /// The lengths at which hard scaled coordinates are one before ageing, m, and how much longer each becomes for each metre of it.
    young: Vector<S, D>,
    per_metre: Vector<S, D>,
    /// 1/radius of the largest ball inside, in scaled coordinates.
    inner: S,
    body: Body<S, D>,
    spec: ObstacleSpec<S, D>,
    /// The reference point in the obstacle's frame, its own or one shared with obstacles it overlaps; and u = q * this when it was chosen.
    local_reference: Vector<S, D>,
    chosen_at: Vector<S, D>,
    /// How much each semi-extent has grown, m.
    grown: S,
    /// How much ageing has added, m, and adds, m/s.
    aged: S,
    ageing: S,
}

impl<S: Scalar, const D: usize> Obstacle<S, D> {
    /// Checks every field.
    ///
    /// # Errors
    /// The first field that is out of its range, as [`ObstacleError`] states it.
    pub fn new(spec: ObstacleSpec<S, D>) -> Result<Self, ObstacleError> {
        spec.check()?;
        let (body, unit) = spec.shape.body();
        if !(body.sight(&spec.shape, &spec.reference.component_div(&unit)).0 < S::one()) {
            return Err(ObstacleError::Reference);
        }
        let nothing = Vector::zeros();
        let mut obstacle = Self {
            hard: nothing,
            soft: nothing,
            soft_until: S::one(),
            offset: nothing,
            moves: false,
            spins: false,
            swelling: S::zero(),
            slimmest: S::one(),
            young: nothing,
            per_metre: unit.component_div(&spec.shape.growing_extent()),
            inner: S::one() / body.inner(&spec.shape),
            body,
            spec,
            local_reference: nothing,
            chosen_at: nothing,
            grown: S::zero(),
            aged: S::zero(),
            ageing: S::zero(),
        };
        obstacle.rescale();
        obstacle.share_reference(None);
        Ok(obstacle)
    }

    /// Where and how it is now: the specification, with the pose carried on to the present.
    pub fn spec(&self) -> &ObstacleSpec<S, D> {
        &self.spec
    }

    /// Gamma(x), dimensionless, with safety factors, growth and ageing; the largest number there is at the centre of a wall.
    pub fn gamma(&self, x: &Vector<S, D>) -> S {
        self.turned_out(self.body.level(&self.spec.shape, &self.local(x).component_mul(&self.hard)).0)
    }

    /// Gamma_k(x), dimensionless.
    pub fn gamma_soft(&self, x: &Vector<S, D>) -> S {
        self.turned_out(self.body.level(&self.spec.shape, &self.local(x).component_mul(&self.soft)).0)
    }

    /// dGamma/dx, 1/m. Near a polygon's corners, where Gamma has a kink, the blend of both sides that the method uses.
    pub fn gradient(&self, x: &Vector<S, D>) -> Vector<S, D> {
        let u = self.local(x).component_mul(&self.hard);
        let (gamma, direction) = self.body.level(&self.spec.shape, &u);
        let along = direction.dot(&u);
        if !(along > S::zero()) {
            return Vector::zeros();
        }
        // gamma is homogeneous of degree 2p: its gradient times u is 2p gamma.
        let length = S::from_f64(2.0 * f64::from(self.body.power())) * gamma / along;
        let gradient = self.spec.rotation * (direction.component_mul(&self.hard) * length);
        if self.spec.wall { -gradient / (gamma * gamma) } else { gradient }
    }

    /// The point of the hard surface (safety factors, growth and ageing included) that the ray from the centre along `direction` (world's
    /// frame, any length) meets, m.
    ///
    /// ```
    /// use pliant_core::{Obstacle, ObstacleSpec, Vector};
    /// let ball = Obstacle::new(ObstacleSpec::<f64, 2>::default()).unwrap();
    /// assert!((ball.surface(&Vector::<f64, 2>::new(0.0, 3.0)).y - 0.05).abs() < 1e-12);
    /// ```
    pub fn surface(&self, direction: &Vector<S, D>) -> Vector<S, D> {
        self.on_surface(direction, &self.hard)
    }

    /// The same for the soft layer.
    pub fn soft_surface(&self, direction: &Vector<S, D>) -> Vector<S, D> {
        self.on_surface(direction, &self.soft)
    }

    /// The velocity of the obstacle's matter at x, m/s: v + w x (x - c), without growth.
    pub fn surface_velocity(&self, x: &Vector<S, D>) -> Vector<S, D> {
        self.spec.velocity + self.spec.spin * (x - self.spec.center)
    }

    /// Calls `keep(n, gap)` for half-spaces n.delta >= -gap (n of unit length, world's frame; gap in m) of displacements of x that keep it
    /// out of the hard core (a wall: inside), however far within `step` it goes; where there is a choice, with room for `wish`. Surfaces farther than `reach` may be left out.
    pub(crate) fn keep_out(
        &self,
        x: &Vector<S, D>,
        wish: &Vector<S, D>,
        step: S,
        reach: S,
        mut keep: impl FnMut(Vector<S, D>, S),
    ) {
        let u = self.local(x).component_mul(&self.hard);
        let wish = self.spec.rotation.tr_mul(wish).component_mul(&self.hard);
        let place = Place { u, wish, inverse: &self.hard, wall: self.spec.wall, step, reach };
        self.body.keep_out(&self.spec.shape, &place, |normal, slack| {
            let length = norm(&normal);
            if length > S::zero() {
                let inverse = S::one() / length;
                keep(self.spec.rotation * (normal * inverse), slack * inverse);
            }
        });
    }

    /// May the hard surface be within `reach` (m) of a point with this Gamma?
    pub(crate) fn is_near(&self, gamma: S, reach: S) -> bool {
        let one = S::one();
        let change = reach * self.slimmest;
        // Most are far: 1.08^16 and 0.92^-16 are below 4, and p no more than 8.
        if gamma > S::from_f64(4.0) && change < S::from_f64(0.08) {
            return false;
        }
        // The gauge is gamma^(1/2p) and changes by no more than `slimmest` a metre.
        if self.spec.wall {
            let gauge = (one - change).max(S::zero());
            gamma * (gauge * gauge).powi(self.body.power()) <= one
        } else {
            gamma <= ((one + change) * (one + change)).powi(self.body.power())
        }
    }

    /// 1/(eta L), with growth and ageing, along the axes of the obstacle's frame, 1/m: of an ellipsoid 1/a.
    pub(crate) fn inverse_axes(&self) -> &Vector<S, D> {
        &self.hard
    }

    /// All of the hard core lies within this of the centre, m.
    pub(crate) fn outer(&self) -> S {
        let unit = self.spec.shape.body().1;
        let largest = unit.iter().zip(self.hard.iter()).fold(S::zero(), |m, (l, hard)| m.max(S::one() / (*l * *hard)));
        self.spec.shape.outer() * largest
    }

    /// q = Q' (x - c)
    #[inline(always)]
    fn local(&self, x: &Vector<S, D>) -> Vector<S, D> {
        self.spec.rotation.tr_mul(&(x - self.spec.center))
    }

    /// gamma, or 1/gamma for a wall.
    fn turned_out(&self, gamma: S) -> S {
        if !self.spec.wall {
            gamma
        } else if gamma > S::one() / S::FAR {
            S::one() / gamma
        } else {
            S::MAX
        }
    }

    fn on_surface(&self, direction: &Vector<S, D>, inverse: &Vector<S, D>) -> Vector<S, D> {
        let q = self.spec.rotation.tr_mul(direction);
        let u = q.component_mul(inverse);
        let largest = u.iter().fold(S::zero(), |m, u| m.max(u.abs()));
        if !(largest > S::zero()) {
            return self.spec.center;
        }
        let (gamma, _) = self.body.level(&self.spec.shape, &(u / largest));
        self.spec.center + self.spec.rotation * (q / (largest * root(gamma, self.body.power())))
    }
}
