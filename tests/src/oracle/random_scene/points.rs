//! Positions of a kind in a scene.

use nalgebra::DVector;
use rand::Rng;

use super::super::evaluation::{Region, region};
use super::super::obstacle::Body;
use super::super::scene::OracleScene;
use super::random::{direction, power_of_ten, rounded_vector};

/// Draws for one position before the scene is taken to have none of its kind.
const TRIES: usize = 300;

/// What a position was drawn for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PointKind {
    /// In no layer, among the obstacles.
    Free,
    /// Just outside a hard surface: Gamma - 1 from 1e-6 to 0.1.
    Surface,
    /// In one soft layer.
    Soft,
    /// In two or more soft layers.
    Intersection,
    /// Inside a core.
    Hard,
    /// 20 to 900 m away.
    Far,
}

impl PointKind {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::Free, Self::Surface, Self::Soft, Self::Intersection, Self::Hard, Self::Far];
}

/// A position and what it was drawn for.
#[derive(Debug, Clone, PartialEq)]
pub struct SamplePoint {
    /// m
    pub x: Vec<f64>,
    /// What it was drawn for; the region is checked, so `Soft` is in one soft layer and in no core.
    pub kind: PointKind,
}

/// Up to `count` positions of a kind; fewer where the scene has none, as without soft layers.
pub fn sample(rng: &mut impl Rng, scene: &OracleScene, kind: PointKind, count: usize) -> Vec<SamplePoint> {
    let bodies: Result<Vec<Body>, _> =
        scene.obstacles.iter().map(|obstacle| Body::new(obstacle, scene.dimension, scene.method)).collect();
    let Ok(bodies) = bodies else {
        return Vec::new();
    };
    (0..count)
        .filter_map(|_| (0..TRIES).find_map(|_| draw(rng, scene.dimension, &bodies, kind)))
        .map(|x| SamplePoint { x, kind })
        .collect()
}

fn draw(rng: &mut impl Rng, dimension: usize, bodies: &[Body], kind: PointKind) -> Option<Vec<f64>> {
    let x = match kind {
        PointKind::Free => DVector::from_fn(dimension, |_, _| rng.random_range(-2.0..2.0)),
        PointKind::Far => direction(rng, dimension) * rng.random_range(20.0..900.0),
        _ => near_obstacle(rng, bodies, kind)?,
    };
    // The position that counts is the one after rounding.
    let x = rounded_vector(&x);
    let found = region(bodies, &DVector::from_column_slice(&x));
    let fits = match kind {
        PointKind::Free | PointKind::Far => found == Region::Free,
        PointKind::Surface => found != Region::Hard,
        PointKind::Soft => found == Region::Soft,
        PointKind::Intersection => found == Region::Intersection,
        PointKind::Hard => found == Region::Hard,
    };
    fits.then_some(x)
}

fn near_obstacle(rng: &mut impl Rng, bodies: &[Body], kind: PointKind) -> Option<DVector<f64>> {
    if bodies.is_empty() {
        return None;
    }
    let body = &bodies[rng.random_range(0..bodies.len())];
    let ray = direction(rng, body.center.len());
    let hard = body.gamma(&body.world(&ray)).powf(-1.0 / body.exponent);
    let reach = match kind {
        PointKind::Surface => hard * (1.0 + power_of_ten(rng, -6.0, -1.0)).powf(1.0 / body.exponent),
        PointKind::Hard => hard * rng.random_range(0.05..0.99),
        _ => {
            let (hard, soft) = layer_reach(body, &ray)?;
            rng.random_range(hard..soft)
        }
    };
    Some(on_ray(body, &ray, reach))
}

/// Where a ray from the centre, given in the obstacle's frame, enters and leaves the soft layer.
pub(super) fn layer_reach(body: &Body, ray: &DVector<f64>) -> Option<(f64, f64)> {
    let unit_point = body.world(ray);
    let hard = body.gamma(&unit_point).powf(-1.0 / body.exponent);
    let soft = body.gamma_soft(&unit_point).powf(-1.0 / body.exponent);
    (soft > hard * (1.0 + 1e-6)).then_some((hard, soft))
}

/// The point at a distance from the centre on a ray of the obstacle's frame.
pub(super) fn on_ray(body: &Body, ray: &DVector<f64>, distance: f64) -> DVector<f64> {
    body.world(&(ray * distance))
}
