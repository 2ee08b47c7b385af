//! Scenes of the oracle as the files a user would write.

use std::fmt::Write;

use crate::oracle::{
    OracleMethod, OracleMotion, OracleObstacle, OracleRotation, OracleScene, OracleShape, OracleSpin, OracleSteering,
};

/// The scene as TOML, as it is at first: a file says how fast things grow, not how much they have grown, and its attractor starts
/// where it was learnt ([`OracleScene::at_first`]). A learnt motion is named as `model.toml`, beside the scene; see [`model_toml`].
pub fn scene_toml(scene: &OracleScene, starts: &[Vec<f64>]) -> String {
    let mut text = String::from("[ds]\n");
    match &scene.motion {
        OracleMotion::Linear { attractor, gain } => {
            let _ = writeln!(text, "linear = {{ attractor = {attractor:?}, gain = {gain:?} }}");
        }
        OracleMotion::Lpv { .. } => text += "model = \"model.toml\"\n",
    }
    let method = match scene.method {
        OracleMethod::Original => "original",
        OracleMethod::Deformable => "deformable",
    };
    let _ = writeln!(text, "[modulation]\nmethod = \"{method}\"\nc = {:?}", scene.gain);
    let _ = match scene.steering {
        OracleSteering::Fixed { angle } => writeln!(text, "steering = {{ fixed = {angle:?} }}"),
        OracleSteering::WithFlow { beta } => writeln!(text, "steering = \"with-flow\"\nbeta = {beta:?}"),
    };
    let _ = writeln!(text, "[limits]\nspeed = {:?}", scene.limits.speed);
    if let Some(acceleration) = scene.limits.acceleration {
        let _ = writeln!(text, "acceleration = {acceleration:?}");
    }
    let _ = match scene.guard {
        Some(approach) => writeln!(text, "[guard]\napproach = {approach:?}"),
        None => writeln!(text, "[guard]\nenabled = false"),
    };
    if let Some(drift) = &scene.drift {
        let _ = writeln!(text, "[attractor]\nvelocity = {:?}", drift.velocity);
    }
    if let Some(scan) = &scene.scan {
        let _ = writeln!(text, "[scan]\npoints = {:?}\nradius = {:?}", scan.points, scan.radius);
    }
    for start in starts {
        let _ = writeln!(text, "[[start]]\nposition = {start:?}");
    }
    for (n, o) in scene.obstacles.iter().enumerate() {
        obstacle(&mut text, n, o);
    }
    text
}

fn obstacle(text: &mut String, n: usize, o: &OracleObstacle) {
    // The layer of a wall lies within.
    let extent = |(e, rho): (&f64, &f64)| if o.wall { e / rho } else { e * rho };
    let soft: Vec<f64> = o.shape.semi_extents().iter().zip(&o.soft_ratio).map(extent).collect();
    let _ = writeln!(text, "[[obstacle]]\nname = \"number {n}\"\nshape = {{ {} }}", shape(&o.shape));
    if let OracleShape::Ellipsoid { curvature, .. } = o.shape {
        let _ = writeln!(text, "curvature = {curvature}");
    }
    let _ = writeln!(text, "center = {:?}\nsoft = {soft:?}\nwall = {}\ngrowth = {:?}", o.center, o.wall, o.growth);
    let _ = writeln!(text, "margin = {:?}\nreference = {:?}\nvelocity = {:?}", o.margin, o.reference, o.velocity);
    let spatial = o.center.len() == 3;
    let _ = match o.rotation {
        OracleRotation::Angle(angle) if spatial => {
            writeln!(text, "rotation = [{:?}, 0.0, 0.0, {:?}]", (angle / 2.0).cos(), (angle / 2.0).sin())
        }
        OracleRotation::Angle(angle) => writeln!(text, "angle = {angle:?}"),
        OracleRotation::Quaternion(q) => writeln!(text, "rotation = {q:?}"),
    };
    let _ = match o.spin {
        OracleSpin::Planar(rate) if spatial => writeln!(text, "angular_velocity = [0.0, 0.0, {rate:?}]"),
        OracleSpin::Planar(rate) => writeln!(text, "angular_velocity = {rate:?}"),
        OracleSpin::Spatial(rate) => writeln!(text, "angular_velocity = {rate:?}"),
    };
}

fn shape(shape: &OracleShape) -> String {
    match shape {
        OracleShape::Ellipsoid { axes, .. } => format!("ellipsoid = {axes:?}"),
        OracleShape::Box { half, rounding } => format!("box = {half:?}, rounding = {rounding:?}"),
        OracleShape::Cylinder { radius, half_length, rounding } => {
            format!("cylinder = [{radius:?}, {half_length:?}], rounding = {rounding:?}")
        }
        OracleShape::Capsule { radius, half_length } => format!("capsule = [{radius:?}, {half_length:?}]"),
        OracleShape::Polygon { vertices } => format!("polygon = {vertices:?}"),
    }
}

/// The learnt motion as a model file; none for a linear one.
pub fn model_toml(motion: &OracleMotion) -> Option<String> {
    let OracleMotion::Lpv { attractor, lyapunov, components } = motion else {
        return None;
    };
    let mut text = format!(
        "format = 1\nname = \"oracle\"\ndimension = {}\nattractor = {attractor:?}\nlyapunov = {lyapunov:?}\n",
        attractor.len()
    );
    for c in components {
        let _ = writeln!(
            text,
            "[[component]]\nprior = {:?}\nmean = {:?}\ncovariance = {:?}\na = {:?}",
            c.prior, c.mean, c.covariance, c.a
        );
    }
    Some(text)
}
