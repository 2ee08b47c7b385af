//! One obstacle: a hard core, perhaps in a soft layer, that moves.
//!
//! # Gamma
//!
//! ```text
//! Gamma(x)   = gamma(q_i / (eta_i L_i))    <= 1: hard
//! Gamma_k(x) = gamma(q_i / (rho_i L_i))    <= 1: soft, where not hard        q = Q' (x - c)
//! ```
//!
//! Both are dimensionless; x and c in m, in the world's frame; q in m, in the obstacle's. gamma and the lengths L (m)
//! are from the [`shape`](crate::shape): for an ellipsoid Gamma = sum_i |q_i / (eta_i a_i)|^2p, after Khansari-Zadeh
//! & Billard (2012) with the safety factors eta inside, so that the inflated surface is the one that cannot be
//! penetrated. Gamma_k is eq. 13 of Chen et al., with ln k + 1 = rho; eta does not scale it, and where eta >= rho
//! there is no soft layer: margin wins over softness. A wall has 1/gamma, and both its surfaces come inwards:
//! L_i/eta_i, L_i/rho_i.
//!
//! # Growth and ageing
//!
//! Each semi-extent e_i of the shape (semi-axes, half sides, radius, half length with the radius; of a polygon, for
//! both axes, the distance of its nearest edge from the origin) has by now grown by `grown`, the growth rate times
//! the time. Ageing (see [`Ageing`](crate::Ageing)) has added `aged` to the hard core alone:
//!
//! ```text
//! Gamma:    eta_i becomes eta_i (1 + grown/e_i) + aged/e_i         wall: 1/eta_i becomes (1 + grown/e_i)/eta_i - aged/e_i
//! Gamma_k:  rho_i becomes rho_i (1 + grown/e_i)                    wall: 1/rho_i becomes (1 + grown/e_i)/rho_i
//! ```
//!
//! No semi-extent shrinks below [`Scalar::MIN_AXIS`], no wall's scale by ageing below a tenth. Of a core smaller than
//! as given the reference point is nearer to the centre in proportion.
//!
//! # Motion
//!
//! ```text
//! c <- c + v dt,   Q <- Q turned by w dt           between sightings, each tick
//! s(x) = v + w x (x - c) + b n,   n = g/|g|        surface velocity at x, m/s
//! ```
//!
//! b (m/s, along n, positive towards free space) is how fast the surface moves because the core grows or ages, never
//! less towards free space than it really does: where the rate brings the surface there, rate times eta_max times 1
//! for an ellipsoid with p = 1, sqrt(d) for other shapes, and for a polygon the length of the vector of its largest
//! |coordinates| over e; where it retreats, rate times min e/max e. (Of a wall eta counts as 1 where it comes, and
//! divides where it retreats.) Ageing always comes, and eta does not scale it. [`Obstacle::surface_velocity`] is s
//! without b n.
//!
//! Growth, ageing and b are ours. Errors: [`ObstacleError`] names the field at fault; an [`Obstacle`] that was made
//! has no other way to fail.

mod abreast;
mod keep_out;
mod motion;
mod reference;
mod sample;
mod spec;

#[cfg(test)]
mod tests;

pub use crate::shape::MAX_CURVATURE;
pub use spec::{MAX_RATIO, MAX_SPEED, MIN_AXIS, ObstacleError, ObstacleSpec};

pub(crate) use abreast::Abreast;
pub(crate) use keep_out::{Engulfed, Outlook};
pub(crate) use sample::{Sample, SoftLayer};

use crate::shape::{Body, Pieces, Shape, root};
use crate::{Matrix, Scalar, Vector, rotation, times, transposed_times};

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
    /// diag(hard) Q': u = scaling (x - c).
    scaling: Matrix<S, D>,
    /// 1/(eta L), with growth and ageing: u = q * hard.
    hard: Vector<S, D>,
    /// 1/(rho L), with growth.
    soft: Vector<S, D>,
    /// Beyond this Gamma there is no soft layer.
    soft_until: S,
    /// From the centre to the reference point, in the world's frame, m: as long as nothing turns it stays.
    offset: Vector<S, D>,
    /// From there to the reference point of the tree's root, in the world's frame, m; zero where there is none. And
    /// is there one?
    lean: Vector<S, D>,
    leans: bool,
    /// Is it an ellipsoid with p = 1, and no wall? The usual case goes a short way.
    plain: bool,
    /// Is it of the usual kind altogether: plain, at rest, and its r leads from its reference point?
    usual: bool,
    /// Is Gamma the square of the gauge? Of a wall and a superellipsoid it is not.
    quadratic: bool,
    /// Does it move, turn or grow? Does it turn? Has it a `swelling`?
    moves: bool,
    spins: bool,
    swells: bool,
    /// How fast the surface moves along the shape's normal because it grows, m/s: never less towards the free side
    /// than it really does.
    swelling: S,
    /// 1/radius of the largest ball inside, 1/m.
    slimmest: S,
    /// In fixed point, of what is thin: how many times larger it is looked at, and the inverse.
    enlarged: Option<(S, S)>,
    /// By how much the surface counts as nearer to the guard for the body's size, m; and the gauge so far out.
    blur: S,
    rim: S,
    /// The lengths at which hard scaled coordinates are one before ageing, m, and how much longer each becomes for
    /// each metre of it.
    young: Vector<S, D>,
    per_metre: Vector<S, D>,
    /// What follows from the shape alone: the lengths at which its scaled coordinates are one, m, and those that
    /// growth is measured by, m; how much the surface moves where these become a metre longer, at most and at least,
    /// m; 1/radius of the largest ball inside, in scaled coordinates.
    unit: Vector<S, D>,
    extent: Vector<S, D>,
    most: S,
    least: S,
    inner: S,
    body: Body<S, D>,
    spec: ObstacleSpec<S, D>,
    /// The reference point in the obstacle's frame, its own or one shared with obstacles it overlaps; and u = q *
    /// this when it was chosen.
    local_reference: Vector<S, D>,
    chosen_at: Vector<S, D>,
    /// `lean` in the obstacle's frame.
    local_lean: Vector<S, D>,
    /// How much each semi-extent has grown, m.
    grown: S,
    /// How much ageing has added, m, and adds, m/s.
    aged: S,
    ageing: S,
}

impl<S: Scalar, const D: usize> Obstacle<S, D> {
    /// Checks every field. It is at rest in time: a [`Table`](crate::Table) carries it on.
    ///
    /// # Errors
    /// The first field that is out of its range, as [`ObstacleError`] states it.
    pub fn new(mut spec: ObstacleSpec<S, D>) -> Result<Self, ObstacleError> {
        const { assert!(D == 2 || D == 3, "obstacles are in the plane or in space") };
        spec.check()?;
        // Now, for the first turn would do it, and the surface jump.
        spec.rotation = rotation::righted(&spec.rotation);
        let (body, unit) = spec.shape.body(spec.wall);
        if !(body.sight(&spec.shape, &spec.reference.component_div(&unit)).0 < S::one()) {
            return Err(ObstacleError::Reference);
        }
        let extent = spec.shape.growing_extent();
        let nothing = Vector::zeros();
        let mut obstacle = Self {
            scaling: Matrix::zeros(),
            hard: nothing,
            soft: nothing,
            soft_until: S::one(),
            offset: nothing,
            lean: nothing,
            leans: false,
            plain: !spec.wall && body.is_ellipsoid(),
            usual: false,
            quadratic: !spec.wall && body.power() == 1,
            moves: false,
            spins: false,
            swelling: S::zero(),
            swells: false,
            slimmest: S::one(),
            enlarged: None,
            blur: S::zero(),
            rim: S::one(),
            young: nothing,
            per_metre: unit.component_div(&extent),
            unit,
            extent,
            most: spec.shape.growing_most(),
            least: spec.shape.growing_least(),
            inner: S::one() / body.inner(&spec.shape),
            body,
            spec,
            local_reference: nothing,
            chosen_at: nothing,
            local_lean: nothing,
            grown: S::zero(),
            aged: S::zero(),
            ageing: S::zero(),
        };
        obstacle.rescale();
        obstacle.set_speeds();
        obstacle.share_reference(None);
        Ok(obstacle)
    }

    /// Where and how it is now: the specification, with centre and rotation carried on to the present, and motion
    /// zero once it is held. The shape is as it was given: growth and ageing are not in it.
    pub fn spec(&self) -> &ObstacleSpec<S, D> {
        &self.spec
    }

    /// Gamma(x), dimensionless, at x (m, world's frame), with safety factors, growth and ageing: below 1 in the hard
    /// core, 1 on its surface, above 1 outside; 0 at the centre, at that of a wall [`Scalar::MAX`].
    ///
    /// ```text
    /// Gamma(x) = gamma(q_i/(eta_i L_i)), of a wall 1/gamma(q_i eta_i/L_i)
    /// ```
    pub fn gamma(&self, x: &Vector<S, D>) -> S {
        self.level(&self.scaled(x)).0
    }

    /// Gamma_k(x), dimensionless, at x (m, world's frame), with growth: at most 1 in the soft layer (and in the
    /// core). Of a rigid obstacle, rho = 1, it is that of its shape without safety factor and ageing.
    ///
    /// ```text
    /// Gamma_k(x) = gamma(q_i/(rho_i L_i)), of a wall 1/gamma(q_i rho_i/L_i)
    /// ```
    pub fn gamma_soft(&self, x: &Vector<S, D>) -> S {
        self.level(&self.local(x).component_mul(&self.soft)).0
    }

    /// g = dGamma/dx, 1/m, D entries in the world's frame; zero at the centre. Near a polygon's corners, where Gamma
    /// has a kink, the blend of both sides that the method uses. Of a wall it points into the free space.
    ///
    /// ```text
    /// g = Q diag(1/(eta_i L_i)) gamma'(u),   of a wall -Q diag(eta_i/L_i) gamma'(u)/gamma(u)^2
    /// ```
    pub fn gradient(&self, x: &Vector<S, D>) -> Vector<S, D> {
        let u = self.scaled(x);
        let (gamma, direction) = self.body.level(&self.spec.shape, &u);
        let along = direction.dot(&u);
        if !(along > S::zero()) {
            return Vector::zeros();
        }
        // gamma is homogeneous of degree 2p: its gradient times u is 2p gamma.
        let length = S::from_f64(2.0 * f64::from(self.body.power())) * gamma / along;
        let gradient = times(&self.spec.rotation, &(direction.component_mul(&self.hard) * length));
        if !self.spec.wall {
            return gradient;
        }
        // So near the centre that the square of gamma is nothing, it is the centre.
        let inwards = -gradient / (gamma * gamma);
        if inwards.iter().all(|x| x.is_finite()) { inwards } else { Vector::zeros() }
    }

    /// The point of the hard surface (safety factors, growth and ageing included) that the ray from the centre along
    /// `direction` (world's frame, any length) meets, m: c + direction/lambda with lambda the gauge of the direction.
    /// The centre for a direction of zero.
    ///
    /// ```
    /// use pliant_core::{Obstacle, ObstacleSpec, Vector};
    /// let ball = Obstacle::new(ObstacleSpec::<f64, 2>::default()).unwrap();
    /// assert!((ball.surface(&Vector::<f64, 2>::new(0.0, 3.0)).y - 0.05).abs() < 1e-12);
    /// ```
    pub fn surface(&self, direction: &Vector<S, D>) -> Vector<S, D> {
        self.on_surface(direction, &self.hard)
    }

    /// The same for the soft layer, Gamma_k = 1: m.
    pub fn soft_surface(&self, direction: &Vector<S, D>) -> Vector<S, D> {
        self.on_surface(direction, &self.soft)
    }

    /// The velocity of the obstacle's matter at x (m, world's frame), m/s: v + w x (x - c), without growth.
    pub fn surface_velocity(&self, x: &Vector<S, D>) -> Vector<S, D> {
        self.spec.velocity + times(&self.spec.spin, &(x - self.spec.center))
    }

    /// All of the hard core lies within this of the centre, m.
    pub(crate) fn outer(&self) -> S {
        let least = self.unit.iter().zip(self.hard.iter()).fold(S::MAX, |m, (l, hard)| m.min(*l * *hard));
        self.spec.shape.outer() / least
    }

    /// B, of an ellipsoid c + B y, |y| <= 1, that holds the hard core, m.
    pub(crate) fn ellipsoid_around(&self) -> Matrix<S, D> {
        let half = self.box_around();
        // Round a box it is larger than the box by the root of D.
        let larger = if self.body.is_ellipsoid() {
            1.0
        } else if D == 2 {
            core::f64::consts::SQRT_2
        } else {
            1.732_050_807_568_877_2
        };
        let larger = S::from_f64(larger);
        Matrix::from_fn(|i, j| self.spec.rotation[(i, j)] * (half[j] * larger))
    }

    /// Half of the box along its axes that holds the hard core, m.
    fn box_around(&self) -> Vector<S, D> {
        self.spec.shape.extent().component_div(&self.unit.component_mul(&self.hard))
    }

    /// A corner of the box along its axes that holds the hard core, m: bit i of n says on which side along axis i.
    pub(crate) fn corner(&self, n: usize) -> Vector<S, D> {
        let half = self.box_around();
        let corner = Vector::from_fn(|i, _| if n >> i & 1 == 0 { half[i] } else { -half[i] });
        self.spec.center + times(&self.spec.rotation, &corner)
    }

    /// The n-th corner of a polygon, or of the box that holds any other, m.
    pub(crate) fn extreme(&self, n: usize) -> Option<Vector<S, D>> {
        match &self.spec.shape {
            Shape::Polygon(polygon) if n < polygon.vertices().len() => Some(self.spec.center + self.to_corner(n)?),
            Shape::Polygon(_) => None,
            _ => (n < 1 << D).then(|| self.corner(n)),
        }
    }

    /// Of its hard core the point farthest along n (world's frame, any length), m.
    pub(crate) fn farthest(&self, n: &Vector<S, D>) -> Vector<S, D> {
        // Over the longest axis: only the direction counts.
        let most = self.hard.iter().fold(S::MAX, |m, x| m.min(*x));
        let w = transposed_times(&self.spec.rotation, n).zip_map(&self.hard, |n, hard| n * (most / hard));
        let u = self.body.farthest(&self.spec.shape, &w);
        self.spec.center + times(&self.spec.rotation, &u.component_div(&self.hard))
    }

    /// From the centre to a polygon's i-th corner, counted on round it; m.
    pub(crate) fn to_corner(&self, i: usize) -> Option<Vector<S, D>> {
        let Shape::Polygon(polygon) = &self.spec.shape else { return None };
        let all = polygon.vertices().len();
        let mut i = i;
        while i >= all && all > 0 {
            i -= all;
        }
        let v = polygon.vertices().get(i)?;
        let q = Vector::<S, D>::from_fn(|i, _| v.get(i).copied().unwrap_or_else(S::zero));
        Some(times(&self.spec.rotation, &q.component_div(&self.unit.component_mul(&self.hard))))
    }

    /// A polygon's convex pieces, of a wall those of what is outside.
    pub(crate) fn pieces(&self) -> Option<&Pieces> {
        self.body.pieces()
    }

    /// (s diag(hard) Q')' (s diag(hard) Q') of an ellipsoid with p = 1, nothing of all else: s^2 P of Gamma = (x - c)' P (x - c).
    pub(crate) fn quadratic(&self, scale: S) -> Option<Matrix<S, D>> {
        self.plain.then(|| {
            let scaled = self.scaling * scale;
            scaled.transpose() * scaled
        })
    }

    /// The steepest of its scales, 1/m.
    pub(crate) fn steepest(&self) -> S {
        self.hard.iter().fold(S::zero(), |m, x| m.max(*x))
    }

    /// p: Gamma is the gauge to the power of 2p.
    pub(crate) fn power(&self) -> u8 {
        self.body.power()
    }

    /// u = diag(hard) Q' (x - c)
    #[inline(always)]
    fn scaled(&self, x: &Vector<S, D>) -> Vector<S, D> {
        times(&self.scaling, &(x - self.spec.center))
    }

    /// What follows from the pose and the size of the core.
    fn pose_changed(&mut self) {
        self.scaling = Matrix::from_fn(|i, j| self.hard[i] * self.spec.rotation[(j, i)]);
        self.place_reference();
    }

    /// q = Q' (x - c)
    #[inline(always)]
    fn local(&self, x: &Vector<S, D>) -> Vector<S, D> {
        transposed_times(&self.spec.rotation, &(x - self.spec.center))
    }

    /// Gamma at these scaled coordinates, and the direction of gamma's gradient.
    #[inline(always)]
    fn level(&self, u: &Vector<S, D>) -> (S, Vector<S, D>) {
        if self.plain {
            return (S::dot(u.as_slice(), u.as_slice()), *u);
        }
        // Taken apart, so that the result above need not pass through the memory of this one.
        let (gamma, direction) = self.level_of_others(*u);
        (gamma, Vector::from_fn(|i, _| direction[i]))
    }

    #[inline(never)]
    fn level_of_others(&self, u: Vector<S, D>) -> (S, Vector<S, D>) {
        let (gamma, direction) = self.body.level(&self.spec.shape, &u);
        let gamma = if !self.spec.wall {
            gamma
        } else if gamma > S::one() / S::FAR {
            S::one() / gamma
        } else {
            S::MAX
        };
        (gamma, direction)
    }

    fn on_surface(&self, direction: &Vector<S, D>, inverse: &Vector<S, D>) -> Vector<S, D> {
        let q = transposed_times(&self.spec.rotation, direction);
        let u = q.component_mul(inverse);
        let largest = u.iter().fold(S::zero(), |m, u| m.max(u.abs()));
        if !(largest > S::zero()) {
            return self.spec.center;
        }
        let (gamma, _) = self.body.level(&self.spec.shape, &(u / largest));
        self.spec.center + self.spec.rotation * (q / (largest * root(gamma, self.body.power())))
    }
}
