//! One obstacle: its gammas, its normal and the velocity of its surface, section 2.

use nalgebra::{DMatrix, DVector};

use super::error::OracleError;
use super::geometry::{cross, length, rotation_matrix, turned_left, unit, vector};
use super::polygon::SIGHT;
use super::scene::{OracleMethod, OracleObstacle, OracleSpin};
use super::shape::Shape;

/// No semi-extent is shorter, m.
const SHORTEST: f64 = 1e-4;

/// An obstacle, checked and brought into matrices.
pub(super) struct Body {
    pub(super) center: DVector<f64>,
    pub(super) rotation: DMatrix<f64>,
    pub(super) shape: Shape,
    pub(super) wall: bool,
    /// What the surface that is impenetrable is larger than the shape, along each axis.
    pub(super) hard: DVector<f64>,
    /// What the soft shell is larger than the shape.
    pub(super) soft: DVector<f64>,
    /// e of the shape as given.
    pub(super) extents: DVector<f64>,
    reference: DVector<f64>,
    hub: Option<DVector<f64>>,
    velocity: DVector<f64>,
    spin: OracleSpin,
    /// b, of the surface towards free space.
    swelling: f64,
    /// The same as if nothing in it cancelled, m/s.
    restless: f64,
}

impl Body {
    pub(super) fn new(obstacle: &OracleObstacle, dimension: usize, method: OracleMethod) -> Result<Self, OracleError> {
        let shape = Shape::new(&obstacle.shape, dimension)?;
        let extents = vector(&obstacle.shape.semi_extents(), dimension, "shape")?;
        let margin = vector(&obstacle.margin, dimension, "margin")?;
        let soft_ratio = match method {
            OracleMethod::Original => DVector::from_element(dimension, 1.0),
            OracleMethod::Deformable => vector(&obstacle.soft_ratio, dimension, "soft ratio")?,
        };
        if margin.iter().any(|eta| *eta < 1.0) {
            return Err(OracleError::Value("margin"));
        }
        if obstacle.soft_ratio.len() != dimension || obstacle.soft_ratio.iter().any(|rho| !(*rho >= 1.0)) {
            return Err(OracleError::Value("soft ratio"));
        }
        let even = |factors: &[f64]| factors.iter().all(|factor| *factor == factors[0]);
        if matches!(shape, Shape::Star(_)) && !(even(&obstacle.margin) && even(&obstacle.soft_ratio)) {
            return Err(OracleError::Value("factors of a polygon"));
        }
        let amounts = [obstacle.grown, obstacle.growth, obstacle.aged, obstacle.ageing];
        if amounts.iter().any(|amount| !amount.is_finite()) || obstacle.aged < 0.0 || obstacle.ageing < 0.0 {
            return Err(OracleError::Value("growth"));
        }
        match obstacle.spin {
            OracleSpin::Planar(w) if w.is_finite() => {}
            OracleSpin::Spatial(w) if dimension == 3 && w.iter().all(|c| c.is_finite()) => {}
            _ => return Err(OracleError::Value("spin")),
        }
        let growing = vector(&obstacle.shape.growing_extents(), dimension, "shape")?;
        let size = growing.map(|e| (e + obstacle.grown).max(SHORTEST) / e);
        let aged = growing.map(|e| obstacle.aged / e);
        let (hard, soft) = if obstacle.wall {
            let new = size.component_div(&margin);
            (new.zip_map(&aged, |new, aged| (new - aged).max(new / 10.0)), size.component_div(&soft_ratio))
        } else {
            (margin.component_mul(&size) + aged, size.component_mul(&soft_ratio))
        };
        let given = vector(&obstacle.reference, dimension, "reference")?;
        let reference = given.zip_map(&hard, |r, scale| r * scale.min(1.0));
        // A wall grows away from the free space.
        let outward = if obstacle.wall { -obstacle.growth } else { obstacle.growth };
        let fastest = match &shape {
            Shape::Ellipsoid { exponent, .. } if *exponent == 2.0 => 1.0,
            Shape::Star(_) => extents.norm() / growing.min(),
            _ => (dimension as f64).sqrt(),
        };
        let retreats = outward < 0.0;
        let factor = match (obstacle.wall, retreats) {
            (false, false) => margin.max(),
            (true, true) => 1.0 / margin.max(),
            _ => 1.0,
        };
        let speed = outward * factor * if retreats { growing.min() / growing.max() } else { fastest };
        Ok(Self {
            center: vector(&obstacle.center, dimension, "center")?,
            rotation: rotation_matrix(obstacle.rotation, dimension)?,
            shape,
            wall: obstacle.wall,
            hard,
            soft,
            extents,
            reference,
            hub: obstacle.hub.as_ref().map(|hub| vector(hub, dimension, "hub")).transpose()?,
            velocity: vector(&obstacle.velocity, dimension, "velocity")?,
            spin: obstacle.spin,
            swelling: speed + obstacle.ageing * fastest,
            restless: (obstacle.growth.abs() + obstacle.ageing) * fastest,
        })
    }

    /// The point in the obstacle's frame.
    pub(super) fn local(&self, x: &DVector<f64>) -> DVector<f64> {
        self.rotation.tr_mul(&(x - &self.center))
    }

    /// The point of the world from its place in the obstacle's frame.
    pub(super) fn world(&self, q: &DVector<f64>) -> DVector<f64> {
        &self.center + &self.rotation * q
    }

    /// The point as the unscaled shape has it.
    fn scaled(&self, x: &DVector<f64>, scale: &DVector<f64>) -> DVector<f64> {
        self.local(x).component_div(scale)
    }

    /// The point in the coordinates in which the hard surface is that of the unscaled shape.
    pub(super) fn scaled_hard(&self, x: &DVector<f64>) -> DVector<f64> {
        self.scaled(x, &self.hard)
    }

    /// lambda of the hard surface, whatever is free.
    pub(super) fn gauge(&self, x: &DVector<f64>) -> f64 {
        self.shape.gauge(&self.scaled(x, &self.hard))
    }

    /// gamma of the hard surface, whatever is free.
    pub(super) fn plain_gamma(&self, x: &DVector<f64>) -> f64 {
        self.shape.gamma(&self.scaled(x, &self.hard))
    }

    /// Gamma.
    pub(super) fn gamma(&self, x: &DVector<f64>) -> f64 {
        self.turned(self.plain_gamma(x))
    }

    /// Gamma_k.
    pub(super) fn gamma_soft(&self, x: &DVector<f64>) -> f64 {
        self.turned(self.shape.gamma(&self.scaled(x, &self.soft)))
    }

    fn turned(&self, gamma: f64) -> f64 {
        if self.wall { 1.0 / gamma } else { gamma }
    }

    /// At most 1 where the reference point may be: Gamma, but of a polygon by what is in sight.
    pub(super) fn sight(&self, x: &DVector<f64>) -> f64 {
        match &self.shape {
            Shape::Star(star) => (star.beyond(&self.scaled_hard(x)) / SIGHT).powi(2),
            _ => self.gamma(x),
        }
    }

    /// Where on a ray of the obstacle's frame, a unit vector, Gamma (hard) or Gamma_k (soft) has a value.
    pub(super) fn reach(&self, ray: &DVector<f64>, gamma: f64, soft: bool) -> f64 {
        let scale = if soft { &self.soft } else { &self.hard };
        self.turned(gamma).powf(1.0 / self.shape.exponent()) / self.shape.gauge(&ray.component_div(scale))
    }

    /// dlambda/dx of the hard surface, outward of the shape: along each axis e_i of the frame by 1/scale_i of what the
    /// shape has.
    pub(super) fn gauge_gradient(&self, x: &DVector<f64>) -> DVector<f64> {
        let own = self.shape.gauge_gradient(&self.scaled(x, &self.hard));
        self.rotation
            .column_iter()
            .zip(own.iter().zip(&self.hard))
            .fold(DVector::zeros(x.len()), |sum, (axis, (slope, scale))| sum + axis * (slope / scale))
    }

    /// dgamma/dx of the hard surface: gamma = lambda^2p.
    pub(super) fn plain_gradient(&self, x: &DVector<f64>) -> DVector<f64> {
        let power = self.shape.exponent();
        self.gauge_gradient(x) * (power * self.gauge(x).powf(power - 1.0))
    }

    /// dGamma/dx, in the direction the page gives it for a polygon.
    pub(super) fn gradient(&self, x: &DVector<f64>) -> DVector<f64> {
        let plain = self.plain_gradient(x);
        if self.wall { -plain / self.plain_gamma(x).powi(2) } else { plain }
    }

    /// n, towards free space; zero at the centre, where there is none.
    pub(super) fn normal(&self, x: &DVector<f64>) -> DVector<f64> {
        let out = unit(&self.gauge_gradient(x)).unwrap_or_else(|| DVector::zeros(x.len()));
        if self.wall { -out } else { out }
    }

    /// r, from the reference point to x; in a tree from as near to its root's as leaves n.r a tenth of that.
    pub(super) fn radius(&self, x: &DVector<f64>) -> DVector<f64> {
        let own = self.reference();
        let Some(hub) = self.hub() else {
            return x - own;
        };
        let normal = self.normal(x);
        let seen = |from: &DVector<f64>| normal.dot(&(x - from));
        let (least, far) = (0.1 * seen(&own), seen(&hub));
        if least <= 0.0 {
            return x - own;
        }
        // What is seen falls evenly from `own` to `hub`.
        let share = if far >= least { 1.0 } else { (seen(&own) - least) / (seen(&own) - far) };
        x - (&own + (hub - &own) * share)
    }

    /// The reference point of its tree's root in the world.
    pub(super) fn hub(&self) -> Option<DVector<f64>> {
        self.hub.as_ref().map(|hub| self.world(hub))
    }

    /// The reference point in the world.
    pub(super) fn reference(&self) -> DVector<f64> {
        self.world(&self.reference)
    }

    /// Direction of the first axis in the x-y plane, rad.
    pub(super) fn heading(&self) -> f64 {
        self.rotation[(1, 0)].atan2(self.rotation[(0, 0)])
    }

    /// A vector of the obstacle's frame in the world's; of a longer one what there is room for.
    pub(super) fn in_world(&self, own: &[f64]) -> DVector<f64> {
        &self.rotation * DVector::from_fn(self.rotation.nrows(), |i, _| own[i])
    }

    /// v + w x (x - c) + b n.
    pub(super) fn surface_velocity(&self, x: &DVector<f64>) -> DVector<f64> {
        let arm = x - &self.center;
        let turning = match self.spin {
            OracleSpin::Planar(w) if arm.len() == 2 => turned_left(&arm) * w,
            OracleSpin::Planar(w) => cross(&DVector::from_column_slice(&[0.0, 0.0, w]), &arm),
            OracleSpin::Spatial(w) => cross(&DVector::from_column_slice(&w), &arm),
        };
        let standing = &self.velocity + turning;
        if self.swelling == 0.0 { standing } else { standing + self.normal(x) * self.swelling }
    }

    /// The gauge changes by no more than 1 on a way of this length: the least of the semi-extents of the hard surface, of a polygon the distance of its
    /// nearest edge from the centre.
    pub(super) fn least_extent(&self) -> f64 {
        match &self.shape {
            Shape::Star(star) => self.hard.min() / star.slopes().iter().map(length).fold(0.0, f64::max),
            _ => self.extents.component_mul(&self.hard).min(),
        }
    }

    /// What no point of the body is faster than, grown until it reaches x, m/s.
    pub(super) fn fastest(&self, x: &DVector<f64>) -> f64 {
        let turning = match self.spin {
            OracleSpin::Planar(w) => w.abs(),
            OracleSpin::Spatial(w) => DVector::from_column_slice(&w).norm(),
        };
        self.velocity.norm() + turning * (x - &self.center).norm() + self.restless * self.gauge(x).max(1.0)
    }

    /// Radius of a ball about the centre that holds the hard surface.
    pub(super) fn bound(&self) -> f64 {
        self.extents.component_mul(&self.hard).norm()
    }
}

#[cfg(test)]
mod tests {
    use super::super::carried;
    use super::super::random_scene::{Recipe, generate_from};
    use super::super::scene::{OracleRotation, OracleShape};
    use super::*;

    fn v(values: &[f64]) -> DVector<f64> {
        DVector::from_column_slice(values)
    }

    fn body(obstacle: &OracleObstacle) -> Body {
        Body::new(obstacle, obstacle.center.len(), OracleMethod::Deformable).unwrap()
    }

    #[test]
    fn gammas_by_hand() {
        let mut obstacle = OracleObstacle::still(&[1.0, 0.0], &[2.0, 1.0]).soft(1.5);
        obstacle.margin = vec![1.0, 1.2];
        let ellipse = body(&obstacle);
        assert!((ellipse.gamma(&v(&[5.0, 0.0])) - 4.0).abs() < 1e-15);
        assert!((ellipse.gamma(&v(&[1.0, 2.4])) - 4.0).abs() < 1e-14);
        // The soft shell ignores the margin.
        assert!((ellipse.gamma_soft(&v(&[1.0, 1.5])) - 1.0).abs() < 1e-15);
        assert!((ellipse.gamma_soft(&v(&[4.0, 0.0])) - 1.0).abs() < 1e-15);
        let obstacle = obstacle.curved(3);
        assert!((body(&obstacle).gamma(&v(&[5.0, 0.0])) - 64.0).abs() < 1e-12);
        // A quarter turn swaps the axes.
        let mut obstacle = obstacle.curved(1);
        obstacle.rotation = OracleRotation::Angle(std::f64::consts::FRAC_PI_2);
        assert!((body(&obstacle).gamma(&v(&[1.0, 4.0])) - 4.0).abs() < 1e-14);
    }

    #[test]
    fn the_heading_is_that_of_the_first_axis() {
        let mut obstacle = OracleObstacle::still(&[0.0, 0.0], &[2.0, 1.0]);
        obstacle.rotation = OracleRotation::Angle(0.6);
        assert!((body(&obstacle).heading() - 0.6).abs() < 1e-15);
        // 120 degrees about (1, 1, 1) takes x to y.
        let mut obstacle = OracleObstacle::still(&[0.0, 0.0, 0.0], &[2.0, 1.0, 1.0]);
        obstacle.rotation = OracleRotation::Quaternion([0.5, 0.5, 0.5, 0.5]);
        assert!((body(&obstacle).heading() - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    }

    #[test]
    fn the_original_method_has_no_soft_layer() {
        let obstacle = OracleObstacle::still(&[0.0, 0.0], &[1.0, 1.0]).soft(2.0);
        let rigid = Body::new(&obstacle, 2, OracleMethod::Original).unwrap();
        assert_eq!(rigid.gamma_soft(&v(&[1.5, 0.0])), 2.25);
        assert_eq!(body(&obstacle).gamma_soft(&v(&[1.5, 0.0])), 0.5625);
    }

    #[test]
    fn the_gradient_is_that_of_finite_differences() {
        let mut obstacle = OracleObstacle::still(&[0.3, -0.2, 0.1], &[0.5, 0.3, 0.4]);
        obstacle.margin = vec![1.1, 1.3, 1.0];
        obstacle.rotation = OracleRotation::Quaternion([0.8, -0.3, 0.5, 0.2]);
        for curvature in 1..=4 {
            let body = body(&obstacle.clone().curved(curvature));
            for x in [v(&[0.9, 0.2, -0.3]), v(&[0.3, -0.7, 0.5]), v(&[0.1, -0.25, 0.15])] {
                let gradient = body.gradient(&x);
                for i in 0..3 {
                    let mut step = v(&[0.0, 0.0, 0.0]);
                    step[i] = 1e-5;
                    let slope = (body.gamma(&(&x + &step)) - body.gamma(&(&x - &step))) / 2e-5;
                    assert!((slope - gradient[i]).abs() < 1e-6 * gradient.amax().max(1e-3), "{slope} {gradient}");
                }
            }
        }
    }

    #[test]
    fn gamma_is_homogeneous() {
        // Euler: (x - c).g = 2p Gamma.
        let mut obstacle = OracleObstacle::still(&[0.1, 0.2], &[0.5, 0.3]);
        obstacle.rotation = OracleRotation::Angle(0.6);
        let body = body(&obstacle.curved(2));
        let x = v(&[0.8, 0.7]);
        let euler = (&x - &body.center).dot(&body.gradient(&x)) / body.gamma(&x);
        assert!((euler - 4.0).abs() < 1e-13);
    }

    #[test]
    fn the_surface_turns_counter_clockwise() {
        let mut obstacle = OracleObstacle::still(&[1.0, 1.0], &[0.5, 0.5]);
        obstacle.velocity = vec![0.1, 0.0];
        obstacle.spin = OracleSpin::Planar(2.0);
        assert_eq!(body(&obstacle).surface_velocity(&v(&[2.0, 1.0])).as_slice(), &[0.1, 2.0]);
        let mut obstacle = OracleObstacle::still(&[0.0, 0.0, 0.0], &[0.5, 0.5, 0.5]);
        obstacle.spin = OracleSpin::Spatial([0.0, 3.0, 0.0]);
        assert_eq!(body(&obstacle).surface_velocity(&v(&[1.0, 0.0, 2.0])).as_slice(), &[6.0, 0.0, -3.0]);
    }

    #[test]
    fn a_wall_is_turned_inside_out() {
        // Free within 2 x 1, less 1.25 all round; the layer begins at 1/1.6 of it.
        let mut wall = OracleObstacle::still(&[0.0, 0.0], &[2.0, 1.0]).soft(1.6).inside_out();
        wall.margin = vec![1.25; 2];
        let body = body(&wall);
        assert!((body.gamma(&v(&[1.6, 0.0])) - 1.0).abs() < 1e-15);
        assert!((body.gamma(&v(&[0.8, 0.0])) - 4.0).abs() < 1e-14);
        assert!((body.gamma_soft(&v(&[0.0, 0.625])) - 1.0).abs() < 1e-15);
        assert!(body.gamma(&v(&[0.0, 0.0])).is_infinite());
        assert_eq!(body.normal(&v(&[0.7, 0.0])).as_slice(), &[-1.0, 0.0]);
        assert!((body.reach(&v(&[1.0, 0.0]), 4.0, false) - 0.8).abs() < 1e-15);
        // dGamma/dx = -2 (2/1.25) ... by differences.
        let slope = (body.gamma(&v(&[0.8 + 1e-6, 0.0])) - body.gamma(&v(&[0.8 - 1e-6, 0.0]))) / 2e-6;
        assert!((body.gradient(&v(&[0.8, 0.0]))[0] - slope).abs() < 1e-6);
    }

    #[test]
    fn growth_and_age_add_to_the_semi_extents() {
        let at = |o: &OracleObstacle, x: &[f64]| (body(o).gamma(&v(x)), body(o).gamma_soft(&v(x)));
        let one = |pair: (f64, f64)| (pair.0 - 1.0).abs() < 1e-14 && (pair.1 - 1.0).abs() < 1e-14;
        // Semi-axes 2.5 and 1.5, a margin of 1.2 of that, and 0.25 more with age; a layer of 1.5 times 2.5.
        let mut obstacle = OracleObstacle::still(&[0.0, 0.0], &[2.0, 1.0]).soft(1.5);
        obstacle.margin = vec![1.2, 1.2];
        (obstacle.grown, obstacle.aged) = (0.5, 0.25);
        assert!(one((at(&obstacle, &[3.25, 0.0]).0, at(&obstacle, &[3.75, 0.0]).1)));
        assert!(one((at(&obstacle, &[0.0, 2.05]).0, at(&obstacle, &[0.0, 2.25]).1)));
        // The wall: 2.5/1.2 less 0.25, 2.5/1.5; never less than a tenth.
        let mut wall = obstacle.inside_out();
        assert!(one((at(&wall, &[2.5 / 1.2 - 0.25, 0.0]).0, at(&wall, &[2.5 / 1.5, 0.0]).1)));
        wall.aged = 7.0;
        assert!((at(&wall, &[0.25 / 1.2, 0.0]).0 - 1.0).abs() < 1e-14);
        // Nothing shrinks to nothing.
        let mut gone = OracleObstacle::still(&[0.0, 0.0], &[2.0, 1.0]);
        gone.grown = -1.5;
        assert!((at(&gone, &[0.5, 0.0]).0 - 1.0).abs() < 1e-12 && (at(&gone, &[0.0, 1e-4]).0 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_growing_surface_moves_along_its_normal() {
        let mut obstacle = OracleObstacle::still(&[0.0, 0.0], &[2.0, 1.0]);
        let s = |o: &OracleObstacle| body(o).surface_velocity(&v(&[3.0, 0.0]))[0];
        (obstacle.growth, obstacle.ageing) = (0.4, 0.1);
        assert!((s(&obstacle) - 0.5).abs() < 1e-15);
        // Shrinking counts by the ratio of the extents only, ageing as growth.
        obstacle.growth = -0.4;
        assert!((s(&obstacle) + 0.1).abs() < 1e-15);
        let mut wall = obstacle.clone().inside_out();
        assert!((s(&wall) + 0.5).abs() < 1e-15);
        wall.growth = 0.4;
        assert!((s(&wall) - 0.1).abs() < 1e-15);
        // A curved one may be faster by the square root of the dimension where it grows and ages, never where it retreats.
        let mut curved = obstacle.curved(2);
        assert!((s(&curved) - (0.1 * 2.0_f64.sqrt() - 0.2)).abs() < 1e-15);
        curved.growth = 0.4;
        assert!((s(&curved) - 0.5 * 2.0_f64.sqrt()).abs() < 1e-15);
        // A polygon by the corner of what holds it over its nearest edge: |(3, 4)| / 2.
        let vertices = vec![[3.0, 0.0], [0.0, 4.0], [-3.0, 0.0], [0.0, -2.4]];
        let mut polygon = OracleObstacle::of(&[0.0, 0.0], OracleShape::Polygon { vertices });
        let s = |o: &OracleObstacle| {
            let body = body(o);
            body.normal(&v(&[3.0, 2.0])).dot(&body.surface_velocity(&v(&[3.0, 2.0])))
        };
        let edge = 3.0 * 2.4 / f64::hypot(3.0, 2.4);
        (polygon.growth, polygon.ageing) = (0.4, 0.1);
        assert!((s(&polygon) - 0.5 * 5.0 / edge).abs() < 1e-14);
        polygon.growth = -0.4;
        assert!((s(&polygon) - (0.1 * 5.0 / edge - 0.4)).abs() < 1e-14);
    }

    #[test]
    fn a_polygon_grows_alike_along_both_axes() {
        let vertices = vec![[2.0, -0.5], [2.0, 0.5], [-2.0, 0.5], [-2.0, -0.5]];
        let mut block = OracleObstacle::of(&[0.0, 0.0], OracleShape::Polygon { vertices }).soft(1.5);
        block.margin = vec![1.2; 2];
        (block.grown, block.aged) = (0.25, 0.125);
        let grown = body(&block);
        // 1.5 times as large, a margin of 1.2 of that, and a quarter with age.
        for x in [v(&[4.1, 0.0]), v(&[0.0, 1.025])] {
            assert!((grown.gamma(&x) - 1.0).abs() < 1e-14);
        }
        assert!((grown.gamma_soft(&v(&[0.0, 1.125])) - 1.0).abs() < 1e-14);
        // A factor an axis has no meaning.
        block.margin = vec![1.2, 1.0];
        let refused = Body::new(&block, 2, OracleMethod::Deformable).err();
        assert_eq!(refused, Some(OracleError::Value("factors of a polygon")));
    }

    #[test]
    fn no_surface_is_faster_than_it_is_said_to_be() {
        // Where a ray of the frame meets the surface a moment later, seen along the normal of now. (The normal of a polygon is
        // not that of its edges.)
        for seed in 0..120 {
            let recipe = Recipe { moving: 0.0, growing: 1.0, walls: 0.3, ..Recipe::new(2 + (seed % 2) as usize) };
            let scene = generate_from(&recipe, seed, 0).scene;
            let dt = 1e-6;
            let later = carried(&scene, dt).unwrap();
            for (now, then) in scene.obstacles.iter().zip(&later.obstacles) {
                let (now, then) = (body(now), body(then));
                for ray in [[0.6, -0.64, 0.48], [-1.0, 0.1, 0.2], [0.5, 0.5, 0.7], [0.1, -1.0, -0.3]] {
                    let ray = unit(&v(&ray[..scene.dimension])).unwrap();
                    let x = now.world(&(&ray * now.reach(&ray, 1.0, false)));
                    if matches!(now.shape, Shape::Star(_)) {
                        continue;
                    }
                    let n = now.normal(&x);
                    let moved = (then.world(&(&ray * then.reach(&ray, 1.0, false))) - &x) / dt;
                    let said = n.dot(&now.surface_velocity(&x));
                    assert!(n.dot(&moved) < said + 1e-4, "seed {seed}: {moved} {said}");
                }
            }
        }
    }

    #[test]
    fn what_the_method_does_not_allow_is_refused() {
        let good = OracleObstacle::still(&[0.0, 0.0], &[1.0, 1.0]);
        let refused = |obstacle: OracleObstacle| Body::new(&obstacle, 2, OracleMethod::Deformable).err();
        assert_eq!(refused(good.clone()), None);
        assert_eq!(refused(good.clone().soft(0.9)), Some(OracleError::Value("soft ratio")));
        assert_eq!(refused(OracleObstacle::still(&[0.0, 0.0], &[1.0])), Some(OracleError::Shape("axes")));
        assert_eq!(refused(good.clone().curved(9)), Some(OracleError::Value("curvature")));
        let growing = OracleObstacle { growth: f64::NAN, ..good.clone() };
        assert_eq!(refused(growing), Some(OracleError::Value("growth")));
        let spatial = OracleObstacle { spin: OracleSpin::Spatial([0.0; 3]), ..good };
        assert_eq!(refused(spatial), Some(OracleError::Value("spin")));
    }
}
