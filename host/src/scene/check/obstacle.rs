//! The checks of one obstacle.

use std::ops::Range;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use pliant_core::RANGE;
use pliant_core::obstacle::{MAX_CURVATURE, MAX_SPEED, MIN_AXIS};
use toml::Spanned;

use super::{Check, From, Kind};
use crate::scene::convert::in_range;
use crate::scene::error::SceneError;
use crate::scene::file::{Numbers, ObstacleFile, ShapeFile, Turning};
use crate::scene::obstacle::{SceneObstacle, Shape, Track, level};

/// The core's bound on soft ratios and margins.
const LARGEST_RATIO: f64 = 100.0;
/// A reference point has to be this far inside the core (Gamma) to be there in `f32` too.
const INSIDE: f64 = 0.999;
/// How far a quaternion's length may be from one.
const UNIT: f64 = 5e-4;

impl Check<'_> {
    pub(super) fn obstacle(
        &self,
        id: u16,
        file: &Spanned<ObstacleFile>,
        before: &[SceneObstacle],
        attractor: &Vector3<f64>,
        timeout: f64,
    ) -> Result<SceneObstacle, SceneError> {
        let span = file.span();
        let file = file.get_ref();
        let ones = Vector3::from_fn(|i, _| if i < self.dimension { 1.0 } else { 0.0 });
        let name = self.name(&file.name, before)?;
        let ShapeFile::Ellipsoid(axes) = &file.shape;
        let axes = self.numbers(axes, "obstacle.shape.ellipsoid", MIN_AXIS, RANGE)?;
        let margin = match &file.margin {
            Some(margin) => self.numbers(margin, "obstacle.margin", 1.0, LARGEST_RATIO)?,
            None => ones,
        };
        let obstacle = SceneObstacle {
            id,
            name,
            soft_ratio: self.soft_ratio(file, &axes, &ones)?,
            curvature: self.curvature(file.curvature.as_ref())?,
            margin,
            reference: file.reference.as_ref().map_or(Ok(Vector3::zeros()), |r| self.point(r, "obstacle.reference"))?,
            track: self.track(file, span.clone())?,
            rotation: self.rotation(file)?,
            angular_velocity: self.angular_velocity(file.angular_velocity.as_ref())?,
            shape: Shape::Ellipsoid { axes },
        };
        if level(&obstacle.reference, &axes, obstacle.curvature) >= INSIDE {
            let at = file.reference.as_ref().map_or(span, |r| r.span());
            return Err(self.error(Kind::Geometry, "obstacle.reference", at, "is outside the hard core"));
        }
        self.whereabouts(&obstacle, file, span, attractor, timeout)?;
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

    fn soft_ratio(
        &self,
        file: &ObstacleFile,
        axes: &Vector3<f64>,
        ones: &Vector3<f64>,
    ) -> Result<Vector3<f64>, SceneError> {
        let keys = [
            ("stiffness", file.stiffness.as_ref().map(Spanned::span)),
            ("soft", file.soft.as_ref().map(Spanned::span)),
            ("layer", file.layer.as_ref().map(Spanned::span)),
        ];
        let mut given: Vec<_> = keys.into_iter().filter_map(|(key, span)| Some((key, span?))).collect();
        given.sort_by_key(|(_, span)| span.start);
        let mut given = given.into_iter();
        let Some((first, span)) = given.next() else {
            return Ok(*ones);
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
            let ratio = soft.zip_map(axes, |b, a| if a > 0.0 { b / a } else { 0.0 });
            if let Some((i, _)) = ratio.iter().enumerate().find(|(i, rho)| *i < self.dimension && **rho < 1.0) {
                let problem = format!("{} is smaller than the hard semi-axis {}", soft[i], axes[i]);
                let at = file.soft.as_ref().and_then(|s| s.get_ref().get(i)).map_or(span, Spanned::span);
                return Err(self.error(Kind::Value, "obstacle.soft", at, problem));
            }
            ("obstacle.soft", ratio)
        } else {
            let layer =
                file.layer.as_ref().map_or(Ok(0.0), |l| self.number(l, "obstacle.layer", From(0.0), f64::MAX))?;
            ("obstacle.layer", axes.map(|a| if a > 0.0 { (a + layer) / a } else { 0.0 }))
        };
        if ratio.max() > LARGEST_RATIO {
            let problem = format!("makes a soft semi-axis {:.4e} times the hard one", ratio.max());
            return Err(self.error(Kind::Value, field, span, problem));
        }
        Ok(ratio)
    }

    fn curvature(&self, curvature: Option<&Spanned<i64>>) -> Result<u8, SceneError> {
        let Some(p) = curvature else {
            return Ok(1);
        };
        match u8::try_from(*p.get_ref()) {
            Ok(value) if (1..=MAX_CURVATURE).contains(&value) => Ok(value),
            _ => Err(self.error(Kind::Value, "obstacle.curvature", p.span(), format!("is {}", p.get_ref()))),
        }
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

    fn track(&self, file: &ObstacleFile, span: Range<usize>) -> Result<Track, SceneError> {
        let velocity = file
            .velocity
            .as_ref()
            .map_or(Ok(Vector3::zeros()), |v| self.numbers(v, "obstacle.velocity", -MAX_SPEED, MAX_SPEED))?;
        let center = file.center.as_ref().map(|c| self.point(c, "obstacle.center")).transpose()?;
        let Some(path) = &file.path else {
            let from = center
                .ok_or_else(|| self.error(Kind::Missing, "obstacle.center", span, "is missing, and so is a `path`"))?;
            return Ok(Track::Straight { from, velocity });
        };
        if let (Some(v), true) = (&file.velocity, velocity != Vector3::zeros()) {
            let problem = "is there beside `path`, which says how the obstacle moves";
            return Err(self.error(Kind::Conflict, "obstacle.velocity", v.span(), problem));
        }
        let mut points: Vec<(f64, Vector3<f64>)> = Vec::with_capacity(path.get_ref().len() + 1);
        for row in path.get_ref() {
            let next = self.path_point(row)?;
            if let (None, Some(from)) = (points.last(), center) {
                if next.0 > 0.0 {
                    points.push((0.0, from));
                } else if (from - next.1).norm() > 1e-9 {
                    let at = file.center.as_ref().map_or(span, |c| c.span());
                    let problem = "is not where the `path` is at t = 0; leave it out";
                    return Err(self.error(Kind::Conflict, "obstacle.center", at, problem));
                }
            }
            if let Some((t, from)) = points.last() {
                let problem = if next.0 <= *t {
                    format!("time {} does not come after {t}", next.0)
                } else if (next.1 - from).abs().max() > MAX_SPEED * (next.0 - t) {
                    format!("between {t} s and {} s it is faster than {MAX_SPEED} m/s", next.0)
                } else {
                    points.push(next);
                    continue;
                };
                return Err(self.error(Kind::Value, "obstacle.path", row.span(), problem));
            }
            points.push(next);
        }
        if points.is_empty() {
            return Err(self.error(Kind::Value, "obstacle.path", path.span(), "has no point"));
        }
        Ok(Track::Path(points))
    }

    fn path_point(&self, row: &Numbers) -> Result<(f64, Vector3<f64>), SceneError> {
        let field = "obstacle.path";
        let numbers = row.get_ref();
        let (Some(t), true) = (numbers.first(), numbers.len() == self.dimension + 1) else {
            let problem = format!(
                "a point has {} numbers; a time and {} coordinates make {}",
                numbers.len(),
                self.dimension,
                self.dimension + 1
            );
            return Err(self.error(Kind::Dimension, field, row.span(), problem));
        };
        let t = self.number(t, field, From(0.0), f64::MAX)?;
        let mut center = Vector3::zeros();
        for (to, n) in center.iter_mut().zip(numbers.iter().skip(1)) {
            *to = self.number(n, field, From(-RANGE), RANGE)?;
        }
        Ok((t, center))
    }

    /// What depends on where the obstacle is.
    fn whereabouts(
        &self,
        obstacle: &SceneObstacle,
        file: &ObstacleFile,
        span: Range<usize>,
        attractor: &Vector3<f64>,
        timeout: f64,
    ) -> Result<(), SceneError> {
        if obstacle.at(0.0).gamma(attractor) <= 1.0 {
            let (field, at) = match (&file.center, &file.path) {
                (Some(center), _) => ("obstacle.center", center.span()),
                (None, Some(path)) => ("obstacle.path", path.span()),
                (None, None) => ("obstacle.center", span.clone()),
            };
            let problem = "puts the attractor inside the hard core, where no motion can end";
            let allowed = "a place where the hard core, its margin included, does not hold the attractor";
            return Err(self.error(Kind::Geometry, field, at, problem).allowing(allowed));
        }
        if !in_range(&obstacle.at(timeout).pose.center) {
            let at = file.velocity.as_ref().map_or(span, |v| v.span());
            let problem = format!("takes the obstacle beyond +-1000 m before the timeout of {timeout} s");
            return Err(self.error(Kind::Value, "obstacle.velocity", at, problem));
        }
        Ok(())
    }
}
