//! All stages at one position.

use nalgebra::DVector;

use super::adaptation::{Layer, adapt, alignment};
use super::combination::{combine, weights};
use super::error::OracleError;
use super::geometry::{length, vector};
use super::limits::limit;
use super::modulation::{FAR, Modulated, modulate, modulate_cloud, outward_radius};
use super::motion::carried;
use super::obstacle::Body;
use super::scan::{Cloud, CloudView};
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
    /// The smallest Gamma, of all obstacles and points; infinity without any.
    pub min_gamma: f64,
    /// Which obstacle that is, the first of equals; the number of obstacles for the scan.
    pub nearest: Option<usize>,
    /// Where the position lies.
    pub region: Region,
    /// The weights of the components of an LPV motion.
    pub mixture: Vec<f64>,
    /// Every obstacle, in the order of the scene.
    pub obstacles: Vec<ObstacleView>,
    /// The scan as an obstacle, where there is one.
    pub scan: Option<ObstacleView>,
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
    /// Least distance of g.r / (|g|_1 |r|_1) from its threshold, of the obstacles that count.
    pub reference: f64,
    /// Least |cos(theta - theta_1)| of the obstacles that are soft here, for `fixed`; infinity otherwise.
    pub sign: f64,
    /// |f| relative to the attractor, m/s.
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
    let nominal = carried(&scene.motion, scene.drift.as_ref(), &x)?;
    let f = nominal.velocity;
    let bodies = bodies(scene)?;
    let cloud = cloud(scene)?.map(|cloud| cloud.at(&x));
    let gammas: Vec<f64> = bodies.iter().map(|body| body.gamma(&x)).collect();

    // The scan is one more obstacle, the last.
    let mut seen: Vec<(f64, Modulated)> =
        bodies.iter().zip(&gammas).map(|(body, gamma)| (*gamma, modulate(body, &x, &f))).collect();
    seen.extend(cloud.iter().map(|cloud| (cloud.gamma, modulate_cloud(cloud, &f))));
    let counted: Vec<usize> = (0..seen.len()).filter(|n| seen[*n].0 < FAR).collect();
    let shares = weights(&counted.iter().map(|n| seen[*n].0).collect::<Vec<f64>>());
    let velocities: Vec<DVector<f64>> = counted.iter().map(|n| seen[*n].1.velocity.clone()).collect();
    let u = match velocities.as_slice() {
        [] => f.clone(),
        [only] => only.clone(),
        several => combine(&f, several, &shares),
    };

    let layers: Vec<Layer> = bodies.iter().zip(&gammas).map(|(body, gamma)| layer(body, *gamma, &x)).collect();
    let adapted = adapt(&u, &nominal.relative, &layers, scene.steering, scene.gain);
    let limited = limit(&adapted, &scene.limits, tick)?;

    let mut views: Vec<ObstacleView> = bodies
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
        .chain(cloud.iter().map(|cloud| cloud_view(cloud, &f)))
        .collect();
    for ((n, velocity), share) in counted.iter().zip(&velocities).zip(&shares) {
        let view = &mut views[*n];
        view.velocity = plain(velocity);
        view.weight = *share;
        view.counted = true;
        view.reference_usable = seen[*n].1.usable;
    }
    let scan = cloud.as_ref().and_then(|_| views.pop());

    let mut reported = gammas.clone();
    reported.extend(cloud.iter().map(|cloud| cloud.least));
    let nearest = (0..reported.len()).min_by(|a, b| reported[*a].total_cmp(&reported[*b]));
    let min_gamma = nearest.map_or(f64::INFINITY, |n| reported[n]);
    let least = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::INFINITY, f64::min);
    let to_points = cloud.iter().map(|cloud| cloud.to_surface);
    let switches = Switches {
        hard: least(&mut gammas.iter().map(|gamma| (gamma - 1.0).abs()).chain(to_points)),
        soft: least(&mut layers.iter().map(|layer| (layer.gamma_soft - 1.0).abs())),
        far: least(&mut seen.iter().map(|(gamma, _)| (gamma / FAR - 1.0).abs())),
        reference: least(&mut counted.iter().map(|n| seen[*n].1.to_threshold())),
        sign: match scene.steering {
            OracleSteering::WithFlow { .. } => f64::INFINITY,
            OracleSteering::Fixed { angle } => {
                least(&mut layers.iter().filter(|layer| layer.soft_here).map(|layer| alignment(layer, angle).abs()))
            }
        },
        standstill: length(&nominal.relative),
        nearest: least(&mut (0..reported.len()).filter(|n| Some(*n) != nearest).map(|n| reported[n] / min_gamma - 1.0)),
    };
    Ok(Evaluation {
        nominal: plain(&f),
        modulated: plain(&u),
        adapted: plain(&adapted),
        limited: plain(&limited),
        min_gamma,
        nearest,
        region: region(&bodies, cloud.as_ref().map_or(f64::INFINITY, |cloud| cloud.least), &x),
        mixture: nominal.mixture,
        obstacles: views,
        scan,
        switches,
    })
}

/// The obstacles of a scene, checked.
pub(super) fn bodies(scene: &OracleScene) -> Result<Vec<Body>, OracleError> {
    scene.obstacles.iter().map(|obstacle| Body::new(obstacle, scene.dimension, scene.method)).collect()
}

/// The scan of a scene, checked.
pub(super) fn cloud(scene: &OracleScene) -> Result<Option<Cloud>, OracleError> {
    Ok(scene.scan.as_ref().map(|scan| Cloud::new(scan, scene.dimension)).transpose()?.flatten())
}

fn cloud_view(cloud: &CloudView, f: &DVector<f64>) -> ObstacleView {
    ObstacleView {
        gamma: cloud.gamma,
        gamma_soft: cloud.gamma,
        normal: plain(&cloud.normal),
        surface_velocity: vec![0.0; f.len()],
        velocity: plain(f),
        weight: 0.0,
        counted: false,
        reference_usable: true,
        soft_here: false,
        fade: 0.0,
    }
}

fn layer(body: &Body, gamma: f64, x: &DVector<f64>) -> Layer {
    let gamma_soft = body.gamma_soft(x);
    Layer {
        gamma_soft,
        soft_here: gamma > 1.0 && gamma_soft <= 1.0,
        normal: body.normal(x),
        radius: outward_radius(body, x),
        heading: body.heading(),
        leaning: body.in_world(&[1.0, 2.0, 2.0]) / 3.0,
    }
}

/// Where a position lies, from the obstacles and the least Gamma of a scan alone.
pub(super) fn region(bodies: &[Body], scan: f64, x: &DVector<f64>) -> Region {
    if scan <= 1.0 || bodies.iter().any(|body| body.gamma(x) <= 1.0) {
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
