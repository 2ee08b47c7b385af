//! The checks of a hard core's shape.

use nalgebra::Vector3;
use pliant_core::RANGE;
use pliant_core::obstacle::MAX_CURVATURE;
use pliant_core::shape::MAX_VERTICES;
use toml::Spanned;

use super::{Check, From, Kind};
use crate::scene::error::SceneError;
use crate::scene::file::{Number, Numbers, Rows, ShapeFile};
use crate::scene::shape::{LEAST, Shape, distance, edges, turn};

/// The radius of edges where none is given, over the least half side.
const ROUNDING: f64 = 0.1;

impl Check<'_> {
    pub(super) fn shape(
        &self,
        file: &Spanned<ShapeFile>,
        curvature: Option<&Spanned<i64>>,
    ) -> Result<Shape, SceneError> {
        let shape = self.bare_shape(file)?;
        match (shape, curvature) {
            (Shape::Ellipsoid { axes, .. }, curvature) => {
                Ok(Shape::Ellipsoid { axes, curvature: self.curvature(curvature)? })
            }
            (other, Some(p)) => {
                let problem = format!("is for `ellipsoid`, not for `{}`", other.key());
                Err(self.error(Kind::Conflict, "obstacle.curvature", p.span(), problem))
            }
            (other, None) => Ok(other),
        }
    }

    fn bare_shape(&self, file: &Spanned<ShapeFile>) -> Result<Shape, SceneError> {
        let shape = file.get_ref();
        let keys = [
            ("ellipsoid", shape.ellipsoid.as_ref().map(Spanned::span)),
            ("box", shape.cuboid.as_ref().map(Spanned::span)),
            ("cylinder", shape.cylinder.as_ref().map(Spanned::span)),
            ("capsule", shape.capsule.as_ref().map(Spanned::span)),
            ("polygon", shape.polygon.as_ref().map(Spanned::span)),
        ];
        let mut given: Vec<_> = keys.into_iter().filter_map(|(key, span)| Some((key, span?))).collect();
        given.sort_by_key(|(_, span)| span.start);
        if let [(first, _), (second, span), ..] = &given[..] {
            let problem = format!("is there beside `{first}`: an obstacle has one shape");
            return Err(self.error(Kind::Conflict, &format!("obstacle.shape.{second}"), span.clone(), problem));
        }
        let key = given.first().map_or("", |(key, _)| *key);
        if let (Some(rounding), "ellipsoid" | "capsule" | "polygon") = (&shape.rounding, key) {
            let problem = format!("is for `box` and `cylinder`, not for `{key}`");
            return Err(self.error(Kind::Conflict, "obstacle.shape.rounding", rounding.span(), problem));
        }
        if let Some(axes) = &shape.ellipsoid {
            let axes = self.numbers(axes, "obstacle.shape.ellipsoid", LEAST, RANGE)?;
            Ok(Shape::Ellipsoid { axes, curvature: 1 })
        } else if let Some(half) = &shape.cuboid {
            let half = self.numbers(half, "obstacle.shape.box", LEAST, RANGE)?;
            let least = half.iter().copied().filter(|a| *a > 0.0).fold(f64::INFINITY, f64::min);
            Ok(Shape::Box { half, rounding: self.rounding(shape.rounding.as_ref(), least)? })
        } else if let Some(sizes) = &shape.cylinder {
            let [radius, half_length] = self.round(sizes, "cylinder", LEAST)?;
            let rounding = self.rounding(shape.rounding.as_ref(), radius.min(half_length))?;
            Ok(Shape::Cylinder { radius, half_length, rounding })
        } else if let Some(sizes) = &shape.capsule {
            let [radius, half_length] = self.round(sizes, "capsule", 0.0)?;
            Ok(Shape::Capsule { radius, half_length })
        } else if let Some(corners) = &shape.polygon {
            self.polygon(corners)
        } else {
            Err(self.error(Kind::Missing, "obstacle.shape", file.span(), "names no shape"))
        }
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

    fn rounding(&self, rounding: Option<&Number>, least: f64) -> Result<f64, SceneError> {
        let field = "obstacle.shape.rounding";
        rounding.map_or(Ok((least * ROUNDING).max(LEAST)), |r| self.number(r, field, From(LEAST), least))
    }

    /// Radius and half length of a body that is round about its third axis.
    fn round(&self, sizes: &Numbers, key: &str, least_length: f64) -> Result<[f64; 2], SceneError> {
        let field = format!("obstacle.shape.{key}");
        if self.dimension != 3 {
            let problem = format!("is for scenes of three dimensions, and this one has {}", self.dimension);
            let allowed = "in 2-D `box = [hx, hy]`; with a `rounding` of its lesser half side it is round at both ends";
            return Err(self.error(Kind::Dimension, &field, sizes.span(), problem).allowing(allowed));
        }
        let [radius, half_length] = &sizes.get_ref()[..] else {
            let problem = format!("has {} numbers; a radius and half a length make 2", sizes.get_ref().len());
            return Err(self.error(Kind::Value, &field, sizes.span(), problem));
        };
        let radius = self.number(radius, &field, From(LEAST), RANGE)?;
        Ok([radius, self.number(half_length, &field, From(least_length), RANGE - radius)?])
    }

    fn polygon(&self, corners: &Rows) -> Result<Shape, SceneError> {
        let field = "obstacle.shape.polygon";
        if self.dimension != 2 {
            let problem = format!("is for scenes of two dimensions, and this one has {}", self.dimension);
            return Err(self.error(Kind::Dimension, field, corners.span(), problem).allowing("a shape in space"));
        }
        let rows = corners.get_ref();
        if !(3..=MAX_VERTICES).contains(&rows.len()) {
            let problem = format!("has {} corners", rows.len());
            return Err(self.error(Kind::Value, field, corners.span(), problem));
        }
        let points: Vec<Vector3<f64>> = rows.iter().map(|row| self.point(row, field)).collect::<Result<_, _>>()?;
        let mut vertices: Vec<[f64; 2]> = points.iter().map(|p| [p.x, p.y]).collect();
        // Clockwise is turned round, the first corner kept.
        let clockwise = edges(&vertices).map(|(a, b)| turn(a, b)).sum::<f64>() < 0.0;
        if clockwise {
            vertices[1..].reverse();
        }
        let row_of = |i: usize| if clockwise && i > 0 { vertices.len() - i } else { i };
        for (i, (from, to)) in edges(&vertices).enumerate() {
            if distance(from, to) < LEAST {
                let at = rows.get(row_of(i)).map_or(corners.span(), Spanned::span);
                let problem = format!(
                    "the edge between [{}, {}] and [{}, {}] shows the origin its outer side, or passes through it",
                    from[0], from[1], to[0], to[1]
                );
                return Err(self.error(Kind::Geometry, field, at, problem));
            }
        }
        if edges(&vertices).filter(|(a, b)| a[1] < 0.0 && b[1] >= 0.0).count() != 1 {
            let problem = "goes round its origin more than once";
            return Err(self.error(Kind::Geometry, field, corners.span(), problem));
        }
        Ok(Shape::Polygon { vertices })
    }
}
