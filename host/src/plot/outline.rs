//! Outlines of obstacles: as they are in 2-D; the section with a plane and the shadow on it in 3-D. All convex.

use std::f64::consts::TAU;

use nalgebra::{Point2, Vector3};

use super::View;
use crate::scene::PosedObstacle;

/// A convex polygon, counter-clockwise.
pub type Polygon = Vec<Point2<f64>>;

/// Points of a planar outline.
const AROUND: u32 = 180;
/// Meridians and parallels of a surface in space.
const MESH: (u32, u32) = (240, 120);

/// Which surface of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// The hard core itself.
    Core,
    /// The core with its safety factors.
    Margin,
    /// The end of the soft layer.
    Shell,
}

/// The surface's outline in the plane of the view; none where the plane misses it.
pub fn section(o: &PosedObstacle<'_>, surface: Surface, view: &View) -> Option<Polygon> {
    let Some((axis, level)) = view.plane else {
        return Some((0..AROUND).map(|i| view.project(&boundary(o, surface, planar(i)))).collect());
    };
    let mut crossings = Vec::new();
    let above = |p: &Vector3<f64>| p[axis] - level;
    for_each_edge(o, surface, |a, b| {
        let (da, db) = (above(&a), above(&b));
        if (da <= 0.0) != (db <= 0.0) {
            crossings.push(view.project(&(a + (b - a) * (da / (da - db)))));
        }
    });
    (crossings.len() > 2).then(|| hull(crossings)).filter(|p| p.len() > 2)
}

/// The outline of the surface's projection.
pub fn shadow(o: &PosedObstacle<'_>, surface: Surface, view: &View) -> Polygon {
    let mut points = Vec::new();
    for_each_edge(o, surface, |a, _| points.push(view.project(&a)));
    hull(points)
}

fn planar(i: u32) -> Vector3<f64> {
    let angle = TAU * f64::from(i) / f64::from(AROUND);
    Vector3::new(angle.cos(), angle.sin(), 0.0)
}

/// The point of the surface in a direction of the obstacle's frame, of unit axes.
fn boundary(o: &PosedObstacle<'_>, surface: Surface, direction: Vector3<f64>) -> Vector3<f64> {
    let axes = match surface {
        Surface::Core => o.obstacle.axes(),
        Surface::Margin => o.obstacle.axes().component_mul(&o.obstacle.margin()),
        Surface::Shell => o.obstacle.axes().component_mul(&o.obstacle.soft_ratio()),
    };
    let two_p = 2 * i32::from(o.obstacle.curvature());
    let level: f64 = direction.iter().map(|u| u.powi(two_p)).sum();
    let on_unit = direction / level.powf(1.0 / f64::from(two_p));
    o.pose.center + o.pose.rotation * on_unit.component_mul(&axes)
}

fn for_each_edge(o: &PosedObstacle<'_>, surface: Surface, mut edge: impl FnMut(Vector3<f64>, Vector3<f64>)) {
    let at = |i: u32, j: u32| {
        let (u, v) = (TAU * f64::from(i) / f64::from(MESH.0), TAU / 2.0 * f64::from(j) / f64::from(MESH.1));
        boundary(o, surface, Vector3::new(v.sin() * u.cos(), v.sin() * u.sin(), v.cos()))
    };
    for i in 0..MESH.0 {
        for j in 0..MESH.1 {
            edge(at(i, j), at(i, j + 1));
            edge(at(i, j), at(i + 1, j));
        }
    }
}

/// Convex hull by monotone chains.
fn hull(mut points: Vec<Point2<f64>>) -> Polygon {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let chain = |points: &mut dyn Iterator<Item = &Point2<f64>>| {
        let mut chain: Polygon = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..] {
                if (b - a).perp(&(p - a)) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(*p);
        }
        chain.pop();
        chain
    };
    let mut lower = chain(&mut points.iter());
    lower.extend(chain(&mut points.iter().rev()));
    lower
}

/// What two convex polygons have in common (Sutherland & Hodgman); none if nothing.
pub fn overlap(a: &Polygon, b: &Polygon) -> Option<Polygon> {
    let mut left = a.clone();
    for (i, from) in b.iter().enumerate() {
        let to = &b[(i + 1) % b.len()];
        let side = |p: &Point2<f64>| (to - from).perp(&(p - from));
        let mut kept = Vec::with_capacity(left.len() + 1);
        for (j, p) in left.iter().enumerate() {
            let next = &left[(j + 1) % left.len()];
            let (here, there) = (side(p), side(next));
            if here >= 0.0 {
                kept.push(*p);
            }
            if (here >= 0.0) != (there >= 0.0) {
                kept.push(p + (next - p) * (here / (here - there)));
            }
        }
        left = kept;
    }
    (left.len() > 2).then_some(left)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64) -> Polygon {
        [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(a, b)| Point2::new(a + x, b + y)).to_vec()
    }

    fn area(p: &Polygon) -> f64 {
        (0..p.len()).map(|i| p[i].coords.perp(&p[(i + 1) % p.len()].coords)).sum::<f64>() / 2.0
    }

    #[test]
    fn overlaps_have_the_area_they_should() {
        let half = overlap(&square(0.0, 0.0), &square(0.5, 0.5)).unwrap();
        assert!((area(&half) - 0.25).abs() < 1e-12);
        assert!((area(&overlap(&square(0.0, 0.0), &square(0.0, 0.0)).unwrap()) - 1.0).abs() < 1e-12);
        assert!(overlap(&square(0.0, 0.0), &square(2.0, 0.0)).is_none());
    }

    #[test]
    fn a_hull_leaves_out_what_is_inside() {
        let mut points = square(0.0, 0.0);
        points.push(Point2::new(0.5, 0.4));
        let hull = hull(points);
        assert_eq!(hull.len(), 4);
        assert!((area(&hull) - 1.0).abs() < 1e-12);
    }
}
