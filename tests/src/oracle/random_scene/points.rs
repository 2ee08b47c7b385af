//! Positions of a kind in a scene.

use nalgebra::DVector;
use rand::Rng;

use super::super::evaluation::{Region, bodies, cloud, region};
use super::super::obstacle::Body;
use super::super::scan::Cloud;
use super::super::scene::OracleScene;
use super::random::{chance, direction, power_of_ten, rounded_vector};

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
    let (Ok(bodies), Ok(cloud)) = (bodies(scene), cloud(scene)) else {
        return Vec::new();
    };
    (0..count)
        .filter_map(|_| (0..TRIES).find_map(|_| draw(rng, scene.dimension, &bodies, cloud.as_ref(), kind)))
        .map(|x| SamplePoint { x, kind })
        .collect()
}

fn draw(
    rng: &mut impl Rng,
    dimension: usize,
    bodies: &[Body],
    cloud: Option<&Cloud>,
    kind: PointKind,
) -> Option<Vec<f64>> {
    let x = match (kind, cloud) {
        (PointKind::Free, _) => DVector::from_fn(dimension, |_, _| rng.random_range(-2.0..2.0)),
        (PointKind::Far, _) => direction(rng, dimension) * rng.random_range(20.0..900.0),
        (PointKind::Surface | PointKind::Hard, Some(cloud)) if chance(rng, 0.25) => near_point(rng, cloud, kind),
        _ => near_obstacle(rng, bodies, kind)?,
    };
    // The position that counts is the one after rounding.
    let x = rounded_vector(&x);
    let position = DVector::from_column_slice(&x);
    let found = region(bodies, cloud.map_or(f64::INFINITY, |cloud| cloud.least(&position)), &position);
    let fits = match kind {
        PointKind::Free | PointKind::Far => found == Region::Free,
        PointKind::Surface => found != Region::Hard,
        PointKind::Soft => found == Region::Soft,
        PointKind::Intersection => found == Region::Intersection,
        PointKind::Hard => found == Region::Hard,
    };
    fits.then_some(x)
}

fn near_point(rng: &mut impl Rng, cloud: &Cloud, kind: PointKind) -> DVector<f64> {
    let point = &cloud.points[rng.random_range(0..cloud.points.len())];
    let gamma = match kind {
        PointKind::Hard => rng.random_range(0.05..0.98),
        _ => 1.0 + power_of_ten(rng, -6.0, -1.0),
    };
    point + direction(rng, point.len()) * (cloud.radius * f64::sqrt(gamma))
}

fn near_obstacle(rng: &mut impl Rng, bodies: &[Body], kind: PointKind) -> Option<DVector<f64>> {
    if bodies.is_empty() {
        return None;
    }
    let body = &bodies[rng.random_range(0..bodies.len())];
    let ray = direction(rng, body.center.len());
    let reach = match kind {
        PointKind::Surface => body.reach(&ray, 1.0 + power_of_ten(rng, -6.0, -1.0), false),
        PointKind::Hard => {
            let inward = rng.random_range(0.05..0.99);
            body.reach(&ray, 1.0, false) * if body.wall { 1.2 - 0.2 * inward } else { inward }
        }
        _ => {
            let (hard, soft) = layer_reach(body, &ray)?;
            hard + rng.random_range(0.0..1.0) * (soft - hard)
        }
    };
    Some(on_ray(body, &ray, reach))
}

/// Where a ray from the centre, given in the obstacle's frame, crosses the hard and the soft surface, if there is a layer.
pub(super) fn layer_reach(body: &Body, ray: &DVector<f64>) -> Option<(f64, f64)> {
    let (hard, soft) = (body.reach(ray, 1.0, false), body.reach(ray, 1.0, true));
    let (inner, outer) = if body.wall { (soft, hard) } else { (hard, soft) };
    (outer > inner * (1.0 + 1e-6)).then_some((hard, soft))
}

/// The point at a distance from the centre on a ray of the obstacle's frame.
pub(super) fn on_ray(body: &Body, ray: &DVector<f64>, distance: f64) -> DVector<f64> {
    body.world(&(ray * distance))
}
