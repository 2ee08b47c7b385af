//! The checks of starts, of where the motion ends, and of range points.

use nalgebra::Vector3;
use pliant_core::scan::MAX_POINTS;
use toml::Spanned;

use super::{Check, From, Kind};
use crate::scene::convert::in_range;
use crate::scene::error::SceneError;
use crate::scene::file::{AttractorFile, ScanFile, StartFile};
use crate::scene::obstacle::SceneObstacle;
use crate::scene::scan::SceneScan;
use crate::scene::shape::LEAST;
use crate::scene::track::Track;

/// The core's bound on the radius of a scan's points, m.
const LARGEST_RADIUS: f64 = 100.0;

impl Check<'_> {
    /// How the attractor moves, which by itself is at `home`.
    pub(super) fn attractor(
        &self,
        file: Option<&Spanned<AttractorFile>>,
        home: Vector3<f64>,
        timeout: f64,
    ) -> Result<Track, SceneError> {
        let resting = Track::Straight { from: home, velocity: Vector3::zeros() };
        let Some(table) = file else {
            return Ok(resting);
        };
        let file = table.get_ref();
        if file.velocity.is_none() && file.path.is_none() {
            let problem = "has neither `velocity` nor `path`";
            return Err(self.error(Kind::Missing, "attractor", table.span(), problem));
        }
        let track = self.track("attractor", file.velocity.as_ref(), file.path.as_ref(), Some(home))?;
        let track = track.unwrap_or(resting);
        if !in_range(&track.at(timeout).0) {
            let at = file.velocity.as_ref().map_or(table.span(), Spanned::span);
            let problem = format!("takes the attractor beyond +-1000 m before the timeout of {timeout} s");
            return Err(self.error(Kind::Value, "attractor.velocity", at, problem));
        }
        Ok(track)
    }

    pub(super) fn scan(&self, file: &ScanFile, target: &Track) -> Result<SceneScan, SceneError> {
        let field = "scan.points";
        let rows = file.points.get_ref();
        if !(1..=MAX_POINTS).contains(&rows.len()) {
            let problem = format!("has {} points", rows.len());
            return Err(self.error(Kind::Value, field, file.points.span(), problem));
        }
        let radius = self.number(&file.radius, "scan.radius", From(LEAST), LARGEST_RADIUS)?;
        let mut points = Vec::with_capacity(rows.len());
        for row in rows {
            let point = self.point(row, field)?;
            if target.rests().iter().any(|(_, x)| (x - point).norm() <= radius) {
                let problem = format!("the attractor is within the radius of {radius} m, where no motion can end");
                return Err(self.error(Kind::Geometry, field, row.span(), problem));
            }
            points.push(point);
        }
        Ok(SceneScan { points, radius })
    }

    pub(super) fn start(
        &self,
        start: &StartFile,
        obstacles: &[SceneObstacle],
        scan: Option<&SceneScan>,
    ) -> Result<Vector3<f64>, SceneError> {
        let position = self.point(&start.position, "start.position")?;
        let problem = match obstacles.iter().find(|o| o.at(0.0).gamma(&position) <= 1.0) {
            Some(o) if o.is_wall() => format!("is outside the free space of the wall \"{}\"", o.name()),
            Some(o) if o.at(0.0).without_margin().gamma(&position) > 1.0 => {
                format!("is within the margin of obstacle \"{}\", which is kept off as its hard core is", o.name())
            }
            Some(o) => format!("is inside the hard core of obstacle \"{}\"", o.name()),
            None if scan.is_some_and(|s| s.gamma(&position) <= 1.0) => {
                "is within the radius of one of the scan's points".to_owned()
            }
            None => return Ok(position),
        };
        Err(self.error(Kind::Geometry, "start.position", start.position.span(), problem))
    }
}
