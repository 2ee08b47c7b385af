//! The checks of how something moves.

use nalgebra::Vector3;
use pliant_core::RANGE;
use pliant_core::obstacle::MAX_SPEED;

use super::{Check, From, Kind};
use crate::scene::error::SceneError;
use crate::scene::file::{Numbers, Rows};
use crate::scene::track::Track;

/// The last time of a path, s: longer than any run.
const LAST: f64 = 1e6;

impl Check<'_> {
    /// A velocity and a path exclude each other. `field` is the table they are keys of; `from` is where a straight track begins, and a path
    /// whose first point comes later; none if neither has to.
    pub(super) fn track(
        &self,
        field: &str,
        velocity: Option<&Numbers>,
        path: Option<&Rows>,
        from: Option<Vector3<f64>>,
    ) -> Result<Option<Track>, SceneError> {
        let velocity_field = format!("{field}.velocity");
        let speed =
            velocity.map_or(Ok(Vector3::zeros()), |v| self.numbers(v, &velocity_field, -MAX_SPEED, MAX_SPEED))?;
        let Some(path) = path else {
            return Ok(from.map(|from| Track::Straight { from, velocity: speed }));
        };
        if let (Some(v), true) = (velocity, speed != Vector3::zeros()) {
            let problem = "is there beside `path`, which says how it moves";
            return Err(self.error(Kind::Conflict, &velocity_field, v.span(), problem));
        }
        self.path(&format!("{field}.path"), path, from).map(|points| Some(Track::Path(points)))
    }

    fn path(
        &self,
        field: &str,
        path: &Rows,
        from: Option<Vector3<f64>>,
    ) -> Result<Vec<(f64, Vector3<f64>)>, SceneError> {
        let mut points: Vec<(f64, Vector3<f64>)> = Vec::with_capacity(path.get_ref().len() + 1);
        for row in path.get_ref() {
            let next = self.path_point(field, row)?;
            if let (None, Some(from), true) = (points.last(), from, next.0 > 0.0) {
                points.push((0.0, from));
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
                return Err(self.error(Kind::Value, field, row.span(), problem));
            }
            points.push(next);
        }
        if points.is_empty() {
            return Err(self.error(Kind::Value, field, path.span(), "has no point"));
        }
        Ok(points)
    }

    fn path_point(&self, field: &str, row: &Numbers) -> Result<(f64, Vector3<f64>), SceneError> {
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
        let t = self.number(t, field, From(0.0), LAST)?;
        let mut place = Vector3::zeros();
        for (to, n) in place.iter_mut().zip(numbers.iter().skip(1)) {
            *to = self.number(n, field, From(-RANGE), RANGE)?;
        }
        Ok((t, place))
    }
}
