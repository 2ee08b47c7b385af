//! All stages at one position.

use std::f64::consts::PI;

use nalgebra::DVector;

use super::adaptation::{Layer, adapt, alignment};
use super::combination::{combine, weights};
use super::error::OracleError;
use super::geometry::{length, vector};
use super::limits::limit;
use super::modulation::{FAR, Modulated, modulate, outward_normal, outward_radius};
use super::motion::nominal;
use super::obstacle::Body;
use super::scene::{OracleScene, OracleSteering, OracleTick};

/// Where a position lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Region {
    /// In no layer.
    Free,
    /// In the soft layer of exactly one obstacle.
    Soft,
    /// In the soft layers of two or more.
    Intersection,
    /// In a core, margin included, whatever else.
    Hard,
}

/// The velocity at each stage, and where the position lies.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// f, section 1.
    pub nominal: Vec<f64>,
    /// Section 4.
    pub modulated: Vec<f64>,
    /// Section 5.
    pub adapted: Vec<f64>,
    /// The last stage, section 6. Without an [`OracleTick`] only the speed is limited.
    pub limited: Vec<f64>,
    /// The smallest Gamma, of all obstacles; infinity without any.
    pub min_gamma: f64,
    /// Which obstacle that is, the first of equals.
    pub nearest: Option<usize>,
    /// Where the position lies.
    pub region: Region,
    /// The weights of the components of an LPV motion.
    pub mixture: Vec<f64>,
    /// Every obstacle, in the order of the scene.
    pub obstacles: Vec<ObstacleView>,
    /// How far the switches of the method are.
    pub switches: Switches,
}

/// One obstacle as seen from the position.
#[derive(Debug, Clone, PartialEq)]
pub struct ObstacleView {
    /// Gamma.
    pub gamma: f64,
    /// Gamma_k.
    pub gamma_soft: f64,
    /// n, zero at the centre.
    pub normal: Vec<f64>,
    /// s, m/s.
    pub surface_velocity: Vec<f64>,
    /// xdot_n; f for an obstacle that is left out.
    pub velocity: Vec<f64>,
    /// Its share in the mean; 0 for an obstacle that is left out.
    pub weight: f64,
    /// False where Gamma is so large that the obstacle is left out.
    pub counted: bool,
    /// False where the reference point cannot be used.
    pub reference_usable: bool,
    /// Whether its soft layer holds the position.
    pub soft_here: bool,
    /// phi.
    pub fade: f64,
}

/// Distances to the places where the method switches, and so where rounding may choose another branch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Switches {
    /// Least |Gamma - 1|.
    pub hard: f64,
    /// Least |Gamma_k - 1|. With `with-flow` the velocity is continuous there; with `fixed` it jumps.
    pub soft: f64,
    /// Least |Gamma / 1e15 - 1|.
    pub far: f64,
    /// Least distance of the cosine between gradient and radius from its threshold, of the obstacles that count.
    pub reference: f64,
    /// Least angle between a combined velocity and the exact opposite of f, rad; pi for fewer than two obstacles.
    pub opposite: f64,
    /// Least |cos(theta - theta_1)| of the obstacles that are soft here, for `fixed`; infinity otherwise.
    pub sign: f64,
    /// |f|, m/s.
    pub standstill: f64,
    /// Relative gap between the two smallest Gammas: which obstacle is nearest.
    pub nearest: f64,
}

/// Evaluates the method at a position. Without a tick the acceleration limit does not act.
///
/// # Errors
/// Where an input has the wrong dimension or is not a permitted value.
pub fn evaluate(scene: &OracleScene, x: &[f64], tick: Option<&OracleTick>) -> Result<Evaluation, OracleError> {
    let d = scene.dimension;
    if d != 2 && d != 3 {
        return Err(OracleError::Dimension(d));
    }
    if !(scene.gain.is_finite() && scene.gain >= 0.0) {
        return Err(OracleError::Value("gain"));
    }
    let x = vector(x, d, "position")?;
    let (f, mixture) = nominal(&scene.motion, &x)?;
    let bodies = scene
        .obstacles
        .iter()
        .map(|obstacle| Body::new(obstacle, d, scene.method))
        .collect::<Result<Vec<Body>, _>>()?;
    let gammas: Vec<f64> = bodies.iter().map(|body| body.gamma(&x)).collect();

    let counted: Vec<usize> = (0..bodies.len()).filter(|n| gammas[*n] < FAR).collect();
    let modulated: Vec<Modulated> = counted.iter().map(|n| modulate(&bodies[*n], &x, &f)).collect();
    let shares = weights(&counted.iter().map(|n| gammas[*n]).collect::<Vec<f64>>());
    let (u, to_opposite) = match modulated.as_slice() {
        [] => (f.clone(), PI),
        [only] => (only.velocity.clone(), PI),
        several => {
            let velocities: Vec<DVector<f64>> = several.iter().map(|m| m.velocity.clone()).collect();
            let combined = combine(&f, &velocities, &shares);
            (combined.velocity, combined.to_opposite)
        }
    };

    let layers: Vec<Layer> = bodies.iter().zip(&gammas).map(|(body, gamma)| layer(body, *gamma, &x)).collect();
    let adapted = adapt(&u, &f, &layers, scene.steering, scene.gain);
    let limited = limit(&adapted, &scene.limits, tick)?;

    let mut obstacles: Vec<ObstacleView> = bodies
        .iter()
        .zip(&layers)
        .zip(&gammas)
        .map(|((body, layer), gamma)| ObstacleView {
            gamma: *gamma,
            gamma_soft: layer.gamma_soft,
            normal: plain(&layer.normal),
            surface_velocity: plain(&body.surface_velocity(&x)),
            velocity: plain(&f),
            weight: 0.0,
            counted: false,
            reference_usable: true,
            soft_here: layer.soft_here,
            fade: layer.fade(),
        })
        .collect();
    for ((n, m), share) in counted.iter().zip(&modulated).zip(&shares) {
        let view = &mut obstacles[*n];
        view.velocity = plain(&m.velocity);
        view.weight = *share;
        view.counted = true;
        view.reference_usable = m.usable;
    }

    let nearest = (0..gammas.len()).min_by(|a, b| gammas[*a].total_cmp(&gammas[*b]));
    let min_gamma = nearest.map_or(f64::INFINITY, |n| gammas[n]);
    let least = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::INFINITY, f64::min);
    let switches = Switches {
        hard: least(&mut gammas.iter().map(|gamma| (gamma - 1.0).abs())),
        soft: least(&mut layers.iter().map(|layer| (layer.gamma_soft - 1.0).abs())),
        far: least(&mut gammas.iter().map(|gamma| (gamma / FAR - 1.0).abs())),
        reference: least(&mut modulated.iter().map(Modulated::to_threshold)),
        opposite: to_opposite,
        sign: match scene.steering {
            OracleSteering::WithFlow { .. } => f64::INFINITY,
            OracleSteering::Fixed { angle } => {
                least(&mut layers.iter().filter(|layer| layer.soft_here).map(|layer| alignment(layer, angle).abs()))
            }
        },
        standstill: length(&f),
        nearest: least(&mut (0..gammas.len()).filter(|n| Some(*n) != nearest).map(|n| gammas[n] / min_gamma - 1.0)),
    };
    Ok(Evaluation {
        nominal: plain(&f),
        modulated: plain(&u),
        adapted: plain(&adapted),
        limited: plain(&limited),
        min_gamma,
        nearest,
        region: region(&bodies, &x),
        mixture,
        obstacles,
        switches,
    })
}

fn layer(body: &Body, gamma: f64, x: &DVector<f64>) -> Layer {
    let gamma_soft = body.gamma_soft(x);
    Layer {
        gamma_soft,
        soft_here: gamma > 1.0 && gamma_soft <= 1.0,
        normal: outward_normal(body, x),
        radius: outward_radius(body, x),
        heading: body.heading(),
    }
}

/// Where a position lies, from the obstacles alone.
pub(super) fn region(bodies: &[Body], x: &DVector<f64>) -> Region {
    if bodies.iter().any(|body| body.gamma(x) <= 1.0) {
        return Region::Hard;
    }
    match bodies.iter().filter(|body| body.gamma_soft(x) <= 1.0).count() {
        0 => Region::Free,
        1 => Region::Soft,
        _ => Region::Intersection,
    }
}

fn plain(v: &DVector<f64>) -> Vec<f64> {
    v.as_slice().to_vec()
}

#[cfg(test)]
mod tests;
