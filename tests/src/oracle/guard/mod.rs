//! The guard, section 7, as something to check against: the half-spaces that the page names, the nearest velocity by brute
//! force, and whether a step ends in a core.

mod nearest;
mod polygon;

use nalgebra::DVector;

use super::error::OracleError;
use super::evaluation::{bodies, cloud};
use super::geometry::{length, turned_left, unit, vector};
use super::obstacle::Body;
use super::scene::OracleScene;
use super::shape::{Inner, Shape, away, turned_right};
pub(super) use nearest::{Bound, least_violation, nearest};

/// Units of rounding, at the size of the position or of the body, that a gap is reduced by.
const ROUNDING: f64 = 16.0;
/// Nor less than this, m; in f64 that is the most of all three for every size there may be, so the body's does not enter here.
const SKIN: f64 = 0.0000152587890625;

/// The share of what is lacking that is made up for in the outer half of the skin.
const HOLD: f64 = 0.06;

/// A half-space of displacements: n.delta >= -gap.
#[derive(Debug, Clone, PartialEq)]
pub struct HalfSpace {
    /// The obstacle; the number of obstacles for the scan.
    pub obstacle: usize,
    /// n, of unit length.
    pub normal: Vec<f64>,
    /// m, without the skin.
    pub gap: f64,
}

/// All half-spaces at a position.
#[derive(Debug, Clone, PartialEq)]
pub struct HalfSpaces {
    /// In the order of the obstacles, the scan last.
    pub all: Vec<HalfSpace>,
    /// False where the page does not determine one: at the centre of an obstacle, in a wall where a step is longer than its rounding or what is left after the bend, and of a moving obstacle as far away as counts.
    pub complete: bool,
    /// False where rounding decides behind which line a piece of a polygon is kept.
    pub determined: bool,
}

/// A core in which a step ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Violation {
    /// The obstacle; the number of obstacles for the scan.
    pub obstacle: usize,
    /// Its Gamma where the step ends.
    pub gamma: f64,
}

/// What the guard should have commanded.
#[derive(Debug, Clone, PartialEq)]
pub struct Guarded {
    /// The nearest velocity; none where there is none, m/s.
    pub velocity: Option<Vec<f64>>,
    /// The least that the largest violation can be, m/s; 0 where there is a velocity.
    pub violation: f64,
}

impl Guarded {
    /// By how much a velocity misses the worst half-space, m/s; negative where it keeps them all.
    pub fn missed(spaces: &HalfSpaces, x: &[f64], u: &[f64], alpha: f64, dt: f64) -> f64 {
        let u = DVector::from_column_slice(u);
        bounds(spaces, x, alpha, dt)
            .iter()
            .map(|bound| bound.least - bound.normal.dot(&u))
            .fold(f64::NEG_INFINITY, f64::max)
    }
}

/// The cores of the scene at the next sample in which x + u dt lies, by membership alone.
///
/// # Errors
/// Where an input has the wrong dimension or is not a permitted value.
pub fn violations(next: &OracleScene, x: &[f64], u: &[f64], dt: f64) -> Result<Vec<Violation>, OracleError> {
    let d = next.dimension;
    let end = vector(x, d, "position")? + vector(u, d, "velocity")? * dt;
    let mut gammas: Vec<f64> = bodies(next)?.iter().map(|body| body.gamma(&end)).collect();
    gammas.extend(cloud(next)?.iter().map(|cloud| cloud.least(&end)));
    let inside = |(obstacle, gamma): (usize, &f64)| (*gamma <= 1.0).then_some(Violation { obstacle, gamma: *gamma });
    Ok(gammas.iter().enumerate().filter_map(inside).collect())
}

/// The half-spaces of the scene at the next sample, for a robot that is at x now, moves for `dt` and wants to go at `wanted`.
///
/// # Errors
/// Where an input has the wrong dimension or is not a permitted value.
pub fn half_spaces(next: &OracleScene, x: &[f64], wanted: &[f64], dt: f64) -> Result<HalfSpaces, OracleError> {
    let d = next.dimension;
    let x = vector(x, d, "position")?;
    let step = next.limits.speed * dt;
    let asked = vector(wanted, d, "velocity")? * (dt / next.guard.unwrap_or(1.0));
    let mut all = Vec::new();
    let (mut complete, mut determined) = (true, true);
    let mut push = |obstacle, normal: &DVector<f64>, gap| {
        all.push(HalfSpace { obstacle, normal: normal.as_slice().to_vec(), gap });
    };
    let bodies = bodies(next)?;
    let reach = next.guard.map_or(f64::INFINITY, |alpha| step / alpha);
    for (n, body) in bodies.iter().enumerate() {
        // Whether the gauge says that it can be reached, or so nearly that its gap would matter; of one that moves the page
        // does not say where it is then.
        let beyond = (body.gauge(&x) - 1.0) * body.least_extent();
        let lead = if body.wall { -beyond } else { beyond };
        complete &= (lead - reach).abs() >= 2.0 * body.fastest(&x) * dt;
        if lead > reach {
            continue;
        }
        match &body.shape {
            Shape::Star(_) => {
                for side in polygon::sides(body, &x, &asked) {
                    determined &= side.clear;
                    push(n, &side.normal, side.gap);
                }
            }
            Shape::Ellipsoid { axes, exponent } => {
                let slope = body.plain_gradient(&x);
                let steep = length(&slope);
                if body.wall && steep == 0.0 {
                    // The curve is as far as it can be.
                } else if body.wall {
                    // From the surface on, where x is beyond it.
                    let on = &body.center + (&x - &body.center) / body.gauge(&x).max(1.0);
                    let past = length(&(body.scaled_hard(&x) - body.scaled_hard(&on)).component_div(axes));
                    let steepest = step / axes.component_mul(&body.hard).min() + past;
                    let bend = 1.2 * 0.5 * exponent * (exponent - 1.0) * steepest.powi(2);
                    let slope = body.plain_gradient(&on);
                    let left = 1.0 - body.plain_gamma(&on) - slope.dot(&(&x - &on)) - bend;
                    // A step too long for the bend.
                    complete &= left >= 0.0 || body.plain_gamma(&x) >= 1.0;
                    push(n, &body.normal(&on), left / length(&slope));
                } else if steep == 0.0 {
                    complete = false;
                } else {
                    // Where the ray from the centre leaves the surface.
                    let on = &body.center + (&x - &body.center) / body.gauge(&x);
                    let normal = body.normal(&x);
                    let gap = normal.dot(&(&x - on));
                    push(n, &normal, gap);
                }
            }
            Shape::Rounded { inner, rounding, .. } if body.wall => {
                let away = away(inner, &body.scaled_hard(&x));
                let left = rounding.powi(2) - (step / body.hard.min()).powi(2);
                match unit(&away) {
                    // Within the smaller body.
                    None => {}
                    Some(_) if left <= 0.0 => complete = false,
                    Some(out) => {
                        // How fast a displacement of the world goes out in scaled coordinates.
                        let slope = &body.rotation * out.component_div(&body.hard);
                        let steep = length(&slope);
                        push(n, &(-slope / steep), (left.sqrt() - length(&away)) / steep);
                    }
                }
            }
            Shape::Rounded { .. } => {
                let steep = length(&body.gauge_gradient(&x));
                if steep == 0.0 {
                    complete = false;
                } else {
                    push(n, &body.normal(&x), (body.gauge(&x) - 1.0) / steep);
                }
            }
        }
    }
    if let Some(cloud) = cloud(next)? {
        for point in &cloud.points {
            let away = &x - point;
            match unit(&away) {
                Some(normal) => push(bodies.len(), &normal, length(&away) - cloud.radius),
                None => complete = false,
            }
        }
    }
    Ok(HalfSpaces { all, complete, determined })
}

/// The convex pieces of a polygon's core: triangles of the origin and an edge, or for a wall what is beyond an edge within its
/// sector. Each as the half-planes that hold it.
pub(super) fn pieces(body: &Body) -> Vec<Vec<Bound>> {
    let Shape::Star(star) = &body.shape else {
        return Vec::new();
    };
    let corners: Vec<DVector<f64>> =
        star.corners().iter().map(|corner| body.world(&corner.component_mul(&body.hard))).collect();
    let half_plane = |inward: DVector<f64>, on: &DVector<f64>| {
        let normal = unit(&inward).unwrap_or(inward);
        Bound { least: normal.dot(on), normal }
    };
    (0..corners.len())
        .map(|i| {
            let (v, w) = (&corners[i], &corners[(i + 1) % corners.len()]);
            let edge = if body.wall { turned_right(&(w - v)) } else { turned_left(&(w - v)) };
            vec![
                half_plane(edge, v),
                half_plane(turned_left(&(v - &body.center)), v),
                half_plane(turned_right(&(w - &body.center)), w),
            ]
        })
        .collect()
}

fn bounds(spaces: &HalfSpaces, x: &[f64], alpha: f64, dt: f64) -> Vec<Bound> {
    let size = x.iter().map(|c| c * c).sum::<f64>().sqrt();
    spaces
        .all
        .iter()
        .map(|space| {
            let skin = SKIN.max(ROUNDING * f64::EPSILON * size);
            let room = space.gap - skin;
            let share = match room {
                room if room > 0.0 => alpha,
                _ if space.gap >= 0.5 * skin => HOLD,
                _ => 1.0,
            };
            Bound { normal: DVector::from_column_slice(&space.normal), least: -share * room / dt }
        })
        .collect()
}

/// The velocity nearest to `wanted` that keeps the half-spaces and the speed, by brute force.
pub fn guarded(spaces: &HalfSpaces, x: &[f64], wanted: &[f64], speed: f64, alpha: f64, dt: f64) -> Guarded {
    let bounds = bounds(spaces, x, alpha, dt);
    match nearest(&bounds, &DVector::from_column_slice(wanted), speed) {
        Some(u) => Guarded { velocity: Some(u.as_slice().to_vec()), violation: 0.0 },
        None => Guarded { velocity: None, violation: least_violation(&bounds, x.len(), speed) },
    }
}

/// Radius of a ball about the centre that is in the shape as it is scaled.
pub(super) fn inner_ball(body: &Body) -> f64 {
    let scale = body.hard.min();
    let own = match &body.shape {
        Shape::Ellipsoid { axes, .. } => axes.min(),
        Shape::Rounded { inner: Inner::Box(half), rounding, .. } => {
            half.iter().copied().fold(f64::INFINITY, f64::min) + rounding
        }
        Shape::Rounded { inner: Inner::Cylinder { radius, half_length }, rounding, .. } => {
            radius.min(*half_length) + rounding
        }
        Shape::Star(star) => {
            // The nearest point of every edge is no nearer than that of its line.
            star.slopes().iter().map(|slope| 1.0 / length(slope)).fold(f64::INFINITY, f64::min)
        }
    };
    own * scale
}

#[cfg(test)]
mod tests;
