//! The checks of one obstacle.

use std::ops::Range;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use pliant_core::obstacle::{MAX_RATIO as LARGEST_RATIO, MAX_SPEED};
use pliant_core::{ObstacleError, RANGE};
use toml::Spanned;

use super::{Check, From, Kind};
use crate::scene::convert::{ConvertError, in_range};
use crate::scene::error::SceneError;
use crate::scene::file::{Numbers, ObstacleFile, Turning};
use crate::scene::obstacle::SceneObstacle;
use crate::scene::shape::Shape;
use crate::scene::track::Track;

/// A reference point that is this much farther out has to be inside the core, for it to be there in `f32` too.
const OUTSIDE: f64 = 1.0005;
/// How far a quaternion's length may be from one.
const UNIT: f64 = 5e-4;
/// How far a polygon's two factors may be apart, in proportion.
const ALIKE: f64 = 1e-4;
/// Why a polygon has one factor.
const ONE_FACTOR: &str = "a polygon has one factor for both: with two, a part of it could be uncovered";

/// The two factors of a polygon, if they are not one.
fn unequal(shape: &Shape, factors: &Vector3<f64>) -> Option<[f64; 2]> {
    let polygon = matches!(shape, Shape::Polygon { .. });
    (polygon && (factors.x - factors.y).abs() > ALIKE * factors.x).then_some([factors.x, factors.y])
}

/// Rounded to six digits.
fn six_digits(x: f64) -> f64 {
    let unit = 10f64.powi(5 - x.abs().max(1e-300).log10().floor() as i32);
    (x * unit).round() / unit
}

impl Check<'_> {
    pub(super) fn obstacle(
        &self,
        id: u16,
        file: &Spanned<ObstacleFile>,
        before: &[SceneObstacle],
        target: &Track,
        timeout: f64,
    ) -> Result<SceneObstacle, SceneError> {
        let span = file.span();
        let file = file.get_ref();
        let name = self.name(&file.name, before)?;
        let shape = self.shape(&file.shape, file.curvature.as_ref())?;
        let wall = file.wall.unwrap_or(false);
        let margin = match &file.margin {
            Some(margin) => self.margin(margin, &shape)?,
            None => self.ones(),
        };
        let growth = file.growth.as_ref();
        let obstacle = SceneObstacle {
            id,
            name,
            dimension: self.dimension,
            soft_ratio: self.soft_ratio(file, &shape, wall)?,
            margin,
            reference: file.reference.as_ref().map_or(Ok(Vector3::zeros()), |r| self.point(r, "obstacle.reference"))?,
            track: self.obstacle_track(file, span.clone())?,
            rotation: self.rotation(file)?,
            angular_velocity: self.angular_velocity(file.angular_velocity.as_ref())?,
            growth: growth.map_or(Ok(0.0), |g| self.number(g, "obstacle.growth", From(-MAX_SPEED), MAX_SPEED))?,
            shape,
            wall,
        };
        self.accepted(&obstacle, file, &span)?;
        self.whereabouts(&obstacle, file, span, target, timeout)?;
        Ok(obstacle)
    }

    fn name(&self, name: &Spanned<String>, before: &[SceneObstacle]) -> Result<String, SceneError> {
        let problem = if name.get_ref().trim().is_empty() {
            "is empty".to_owned()
        } else if before.iter().any(|o| o.name() == name.get_ref()) {
            format!("\"{}\" is the name of an earlier obstacle", name.get_ref())
        } else {
            return Ok(name.get_ref().clone());
        };
        Err(self.error(Kind::Value, "obstacle.name", name.span(), problem))
    }

    fn margin(&self, margin: &Numbers, shape: &Shape) -> Result<Vector3<f64>, SceneError> {
        let factors = self.numbers(margin, "obstacle.margin", 1.0, LARGEST_RATIO)?;
        let Some([x, y]) = unequal(shape, &factors) else {
            return Ok(factors);
        };
        let problem = format!("is {x} along one axis and {y} along the other, but {ONE_FACTOR}");
        let allowed = format!("one factor twice, from 1 to 100, such as [{0:?}, {0:?}]", x.max(y));
        Err(self.error(Kind::Value, "obstacle.margin", margin.span(), problem).allowing(allowed))
    }

    fn soft_ratio(&self, file: &ObstacleFile, shape: &Shape, wall: bool) -> Result<Vector3<f64>, SceneError> {
        let ones = self.ones();
        let keys = [
            ("stiffness", file.stiffness.as_ref().map(Spanned::span)),
            ("soft", file.soft.as_ref().map(Spanned::span)),
            ("layer", file.layer.as_ref().map(Spanned::span)),
        ];
        let mut given: Vec<_> = keys.into_iter().filter_map(|(key, span)| Some((key, span?))).collect();
        given.sort_by_key(|(_, span)| span.start);
        let mut given = given.into_iter();
        let Some((first, span)) = given.next() else {
            return Ok(ones);
        };
        if let Some((second, span)) = given.next() {
            let problem = format!("is there beside `{first}`: both say how thick the soft layer is");
            let field = format!("obstacle.{second}");
            return Err(self
                .error(Kind::Conflict, &field, span, problem)
                .allowing("one of `stiffness`, `soft` and `layer`, or none for a rigid obstacle"));
        }
        let (field, ratio) = if let Some(k) = &file.stiffness {
            let k = self.number(k, "obstacle.stiffness", From(1.0), f64::MAX)?;
            ("obstacle.stiffness", ones * (k.ln() + 1.0))
        } else if let Some(soft) = &file.soft {
            let soft = self.numbers(soft, "obstacle.soft", 0.0, f64::MAX)?;
            let hard = shape.extent();
            let ratio = self.over(&soft, &hard, wall);
            if let Some((i, _)) = ratio.iter().enumerate().find(|(i, rho)| *i < self.dimension && **rho < 1.0) {
                let than = if wall { "larger" } else { "smaller" };
                let problem = format!("{} is {than} than the hard semi-axis {}", soft[i], hard[i]);
                let at = file.soft.as_ref().and_then(|s| s.get_ref().get(i)).map_or(span, Spanned::span);
                return Err(self.error(Kind::Value, "obstacle.soft", at, problem));
            }
            if let Some([x, y]) = unequal(shape, &ratio) {
                let larger = if wall { 1.0 / x.max(y) } else { x.max(y) };
                let problem = format!(
                    "makes the core {x:.4} times as large along one axis and {y:.4} along the other, but {ONE_FACTOR}"
                );
                let [a, b] = [hard.x, hard.y].map(|h| six_digits(h * larger));
                let allowed =
                    format!("the core's half extents times one factor, such as [{a}, {b}]; or `stiffness`, or `layer`");
                return Err(self.error(Kind::Value, "obstacle.soft", span, problem).allowing(allowed));
            }
            ("obstacle.soft", ratio)
        } else {
            let hard = shape.layered();
            let layer =
                file.layer.as_ref().map_or(Ok(0.0), |l| self.number(l, "obstacle.layer", From(0.0), f64::MAX))?;
            let soft = hard.map(|a| if wall { (a - layer).max(0.0) } else { a + layer });
            ("obstacle.layer", self.over(&soft, &hard, wall))
        };
        if ratio.max() > LARGEST_RATIO {
            let problem = if wall {
                "leaves less than a hundredth of the free space without soft layer".to_owned()
            } else if let (Shape::Polygon { .. }, "obstacle.layer") = (shape, field) {
                let nearest = six_digits(shape.layered().x);
                format!(
                    "makes the polygon, whose boundary comes within {nearest} m of its centre, {:.4e} times as large",
                    ratio.max()
                )
            } else {
                format!("makes a soft semi-axis {:.4e} times the hard one", ratio.max())
            };
            return Err(self.error(Kind::Value, field, span, problem));
        }
        Ok(ratio)
    }

    /// The soft layer's half extents over the hard ones; of a wall, whose layer is within, the inverse.
    fn over(&self, soft: &Vector3<f64>, hard: &Vector3<f64>, wall: bool) -> Vector3<f64> {
        let ratio = soft.zip_map(hard, |b, a| if wall { a / b } else { b / a });
        Vector3::from_fn(|i, _| if i < self.dimension { ratio[i] } else { 0.0 })
    }

    fn ones(&self) -> Vector3<f64> {
        Vector3::from_fn(|i, _| if i < self.dimension { 1.0 } else { 0.0 })
    }

    fn rotation(&self, file: &ObstacleFile) -> Result<UnitQuaternion<f64>, SceneError> {
        if let (Some(angle), 3) = (&file.angle, self.dimension) {
            return Err(self.error(Kind::Dimension, "obstacle.angle", angle.span(), "is for scenes of two dimensions"));
        }
        if let (Some(rotation), 2) = (&file.rotation, self.dimension) {
            return Err(self.error(
                Kind::Dimension,
                "obstacle.rotation",
                rotation.span(),
                "is for scenes of three dimensions",
            ));
        }
        if let Some(angle) = &file.angle {
            let angle = self.number(angle, "obstacle.angle", From(-RANGE), RANGE)?;
            return Ok(UnitQuaternion::from_scaled_axis(Vector3::z() * angle));
        }
        match &file.rotation {
            None => Ok(UnitQuaternion::identity()),
            Some(rotation) => self.quaternion(rotation),
        }
    }

    fn quaternion(&self, rotation: &Numbers) -> Result<UnitQuaternion<f64>, SceneError> {
        let field = "obstacle.rotation";
        let error = |problem: String| self.error(Kind::Value, field, rotation.span(), problem);
        let numbers = rotation.get_ref();
        for n in numbers {
            self.number(n, field, From(-RANGE), RANGE)?;
        }
        let parts: Vec<f64> = numbers.iter().map(|n| *n.get_ref()).collect();
        let [w, x, y, z] = parts[..] else {
            return Err(error(format!("has {} numbers", parts.len())));
        };
        let q = Quaternion::new(w, x, y, z);
        let length = q.norm();
        if (length - 1.0).abs() <= UNIT {
            return Ok(UnitQuaternion::new_normalize(q));
        }
        let problem = error(format!("has length {length:.4}, not 1"));
        if length < 1e-6 {
            return Err(problem);
        }
        let unit = q / length;
        Err(problem.allowing(format!(
            "a unit quaternion [w, x, y, z]; this one, made one: [{:.6}, {:.6}, {:.6}, {:.6}]",
            unit.w, unit.i, unit.j, unit.k
        )))
    }

    fn angular_velocity(&self, turning: Option<&Spanned<Turning>>) -> Result<Vector3<f64>, SceneError> {
        let field = "obstacle.angular_velocity";
        let Some(turning) = turning else {
            return Ok(Vector3::zeros());
        };
        let (found, rate) = match turning.get_ref() {
            Turning::Planar(rate) => (2, Vector3::new(0.0, 0.0, *rate)),
            Turning::Spatial(rates) => match rates[..] {
                [x, y, z] => (3, Vector3::new(x, y, z)),
                _ => (0, Vector3::zeros()),
            },
        };
        let (kind, problem) = if found != self.dimension {
            (Kind::Dimension, format!("does not fit a scene of {} dimensions", self.dimension))
        } else if let Some(bad) = rate.iter().find(|r| r.is_nan() || r.abs() > MAX_SPEED) {
            (Kind::Value, format!("{bad} is out of range"))
        } else {
            return Ok(rate);
        };
        Err(self.error(kind, field, turning.span(), problem))
    }

    fn obstacle_track(&self, file: &ObstacleFile, span: Range<usize>) -> Result<Track, SceneError> {
        let center = file.center.as_ref().map(|c| self.point(c, "obstacle.center")).transpose()?;
        let track = self.track("obstacle", file.velocity.as_ref(), file.path.as_ref(), center)?;
        if let (Some(Track::Path(points)), Some(center), Some(at)) = (&track, center, &file.center)
            && points.first().is_some_and(|(t, first)| *t == 0.0 && (center - first).norm() > 1e-9)
        {
            let problem = "is not where the `path` is at t = 0; leave it out";
            return Err(self.error(Kind::Conflict, "obstacle.center", at.span(), problem));
        }
        track.ok_or_else(|| self.error(Kind::Missing, "obstacle.center", span, "is missing, and so is a `path`"))
    }

    /// The core has the last word, in both precisions it runs in: what is left is a matter of a few digits.
    fn accepted(&self, obstacle: &SceneObstacle, file: &ObstacleFile, span: &Range<usize>) -> Result<(), SceneError> {
        let error = match self.refusal(obstacle, 0.0) {
            None => return Ok(()),
            Some(ConvertError::Obstacle { error, .. }) => error,
            Some(other) => return Err(self.error(Kind::Value, "obstacle", span.clone(), other.to_string())),
        };
        let shape = format!("obstacle.shape.{}", obstacle.shape.key());
        let (field, at) = match error {
            ObstacleError::Reference => {
                let at = file.reference.as_ref().map_or(span.clone(), |r| r.span());
                let problem = match (&obstacle.shape, obstacle.wall) {
                    (Shape::Polygon { .. }, _) => {
                        "does not see the whole polygon from inside, with a fifth of the centre's distance from the line of every edge to spare"
                    }
                    (_, true) => "is outside the free space",
                    (_, false) => "is outside the hard core",
                };
                return Err(self.error(Kind::Geometry, "obstacle.reference", at, problem));
            }
            ObstacleError::Center => ("obstacle.center", file.center.as_ref().map(Spanned::span)),
            ObstacleError::Rotation => ("obstacle.rotation", file.rotation.as_ref().map(Spanned::span)),
            ObstacleError::SoftRatio => match (&file.stiffness, &file.layer) {
                (Some(stiffness), _) => ("obstacle.stiffness", Some(stiffness.span())),
                (None, Some(layer)) => ("obstacle.layer", Some(layer.span())),
                (None, None) => ("obstacle.soft", file.soft.as_ref().map(Spanned::span)),
            },
            ObstacleError::Margin => ("obstacle.margin", file.margin.as_ref().map(Spanned::span)),
            ObstacleError::Velocity => ("obstacle.velocity", file.velocity.as_ref().map(Spanned::span)),
            ObstacleError::Spin => ("obstacle.angular_velocity", file.angular_velocity.as_ref().map(Spanned::span)),
            ObstacleError::Growth => ("obstacle.growth", file.growth.as_ref().map(Spanned::span)),
            ObstacleError::Curvature => ("obstacle.curvature", file.curvature.as_ref().map(Spanned::span)),
            ObstacleError::Rounding => ("obstacle.shape.rounding", None),
            ObstacleError::Dimension | ObstacleError::Axes | ObstacleError::Corners | ObstacleError::Vertices => {
                (shape.as_str(), None)
            }
        };
        let problem = "is refused in single precision: it is too near to a limit";
        Err(self.error(Kind::Value, field, at.unwrap_or_else(|| file.shape.span()), problem))
    }

    /// Why the core does not take it as it is at time `t`, s. Its reference point has to be a little farther inside than the core wants it.
    fn refusal(&self, obstacle: &SceneObstacle, t: f64) -> Option<ConvertError> {
        let reference = obstacle.reference * OUTSIDE;
        let obstacle = SceneObstacle { reference, ..obstacle.clone() };
        let posed = obstacle.at(t);
        match self.dimension {
            2 => posed.to_core::<f32, 2>().err().or_else(|| posed.to_core::<f64, 2>().err()),
            _ => posed.to_core::<f32, 3>().err().or_else(|| posed.to_core::<f64, 3>().err()),
        }
    }

    /// What depends on where the obstacle is.
    fn whereabouts(
        &self,
        obstacle: &SceneObstacle,
        file: &ObstacleFile,
        span: Range<usize>,
        target: &Track,
        timeout: f64,
    ) -> Result<(), SceneError> {
        for (i, (t, x)) in target.rests().into_iter().enumerate() {
            if obstacle.at(t).gamma(&x) > 1.0 {
                continue;
            }
            let (field, at) = match (&file.center, &file.path) {
                (Some(center), _) => ("obstacle.center", center.span()),
                (None, Some(path)) => ("obstacle.path", path.span()),
                (None, None) => ("obstacle.center", span.clone()),
            };
            let what = if i == 0 { "the attractor" } else { "the end of the attractor's path" };
            let (problem, allowed) = if obstacle.wall {
                let problem = format!("leaves {what} outside the wall's free space, where no motion can end");
                (problem, "a place where the wall's free space, less its margin, holds the attractor")
            } else {
                let problem = format!("puts {what} inside the hard core, where no motion can end");
                (problem, "a place where the hard core, its margin included, does not hold the attractor")
            };
            return Err(self.error(Kind::Geometry, field, at, problem).allowing(allowed));
        }
        let last = obstacle.at(timeout);
        if !in_range(&last.pose.center) {
            let at = file.velocity.as_ref().map_or(span, |v| v.span());
            let problem = format!("takes the obstacle beyond +-1000 m before the timeout of {timeout} s");
            return Err(self.error(Kind::Value, "obstacle.velocity", at, problem));
        }
        if let Some(growth) = file.growth.as_ref().filter(|g| *g.get_ref() != 0.0) {
            let error = |problem: String| self.error(Kind::Value, "obstacle.growth", growth.span(), problem);
            if last.shape.extent().max() > RANGE {
                return Err(error(format!("makes the core larger than {RANGE} m before the timeout of {timeout} s")));
            }
            // The reference point shrinks along, but near a rounded corner it may still end outside.
            let refused = (1..=16).find(|i| self.refusal(obstacle, timeout * f64::from(*i) / 16.0).is_some());
            if refused.is_some() {
                let problem = "leaves the reference point outside the core before the timeout";
                return Err(error(format!("{problem} of {timeout} s")));
            }
        }
        Ok(())
    }
}
