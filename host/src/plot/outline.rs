//! Outlines of obstacles: as they are in 2-D; their silhouettes in 3-D, where all shapes are convex. And how far away they are.

use std::f64::consts::TAU;

use nalgebra::{Point2, Vector3};

use super::View;
use crate::scene::{PosedObstacle, Shape};

/// A closed line, counter-clockwise.
pub type Polygon = Vec<Point2<f64>>;

/// What is inside a closed line, or outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Where it ends.
    pub ring: Polygon,
    /// Is it what is around the line?
    pub outside: bool,
}

impl Region {
    /// Is a point in it?
    pub fn holds(&self, p: &Point2<f64>) -> bool {
        let ends = self.ring.iter().skip(1).chain(self.ring.iter().take(1));
        // A ray to the right leaves the inside by one crossing more than it enters it.
        let crosses = |(a, b): (&Point2<f64>, &Point2<f64>)| {
            (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)
        };
        let inside = self.ring.iter().zip(ends).filter(|edge| crosses(*edge)).count() % 2 == 1;
        inside != self.outside
    }

    /// Has it a point in common with another, as far as the points of both outlines tell?
    pub fn meets(&self, other: &Self) -> bool {
        self.ring.iter().any(|p| other.holds(p)) || other.ring.iter().any(|p| self.holds(p))
    }
}

/// Points of a planar outline, besides corners.
const AROUND: u32 = 720;
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

/// The surface's outline as it is seen.
pub fn outline(o: &PosedObstacle<'_>, surface: Surface, view: &View) -> Polygon {
    let around = Around::new(o, surface);
    if view.is_projection() {
        return hull(around.mesh(MESH).iter().map(|p| view.project(p)).collect());
    }
    angles(&o.shape).map(|a| view.project(&around.at(a.cos(), a.sin(), 0.0))).collect()
}

/// The outline of what two soft layers in space, with what is in them, have in common; none if that is nothing. Not for walls.
pub fn common(a: &PosedObstacle<'_>, b: &PosedObstacle<'_>, view: &View) -> Option<Polygon> {
    let of = |this: &PosedObstacle<'_>, other: &PosedObstacle<'_>| {
        let mut points = Around::new(this, Surface::Shell).mesh(MESH);
        points.retain(|p| other.gamma_soft(p) <= 1.0);
        points
    };
    let points: Vec<_> = of(a, b).iter().chain(&of(b, a)).map(|p| view.project(p)).collect();
    (points.len() > 2).then(|| hull(points)).filter(|ring| ring.len() > 2)
}

/// The point of the hard core's surface that is nearest to another one, m.
pub fn nearest(o: &PosedObstacle<'_>, to: &Vector3<f64>) -> Vector3<f64> {
    let around = Around::new(o, Surface::Core);
    let at = |u: f64, v: f64| around.at(v.sin() * u.cos(), v.sin() * u.sin(), v.cos());
    let planar = o.obstacle.dimension() == 2;
    let (across, down) = if planar { (180, 0) } else { (36, 18) };
    let mut step = TAU / f64::from(across);
    let coarse = (0..across).flat_map(|i| (0..=down).map(move |j| (i, j)));
    let mut best = (f64::INFINITY, 0.0, 0.0);
    let take = |u: f64, v: f64, best: &mut (f64, f64, f64)| {
        let d = (at(u, v) - to).norm_squared();
        let better = d < best.0;
        if better {
            *best = (d, u, v);
        }
        better
    };
    for (i, j) in coarse {
        let v = if planar { TAU / 4.0 } else { TAU / 2.0 * f64::from(j) / f64::from(down) };
        take(TAU * f64::from(i) / f64::from(across), v, &mut best);
    }
    // From the best of a coarse mesh on to where no small step is better.
    while step > 1e-7 {
        let (_, u, v) = best;
        let mut better = false;
        for i in -1..=1 {
            for j in if planar { 0..=0 } else { -1..=1 } {
                better |= take(u + step * f64::from(i), v + step * f64::from(j), &mut best);
            }
        }
        if !better {
            step /= 2.0;
        }
    }
    at(best.1, best.2)
}

/// All the way round a planar shape, in order, each of its corners included; of a shape as wide as it is high.
fn angles(shape: &Shape) -> impl Iterator<Item = f64> + use<> {
    let mut all: Vec<f64> = (0..AROUND).map(|i| TAU * f64::from(i) / f64::from(AROUND)).collect();
    if let Shape::Polygon { vertices } = shape {
        let extent = shape.extent();
        all.extend(vertices.iter().map(|[x, y]| (y / extent.y).atan2(x / extent.x).rem_euclid(TAU)));
        all.sort_by(f64::total_cmp);
    }
    all.into_iter()
}

/// A surface to be looked at from inside.
struct Around<'a> {
    o: PosedObstacle<'a>,
    soft: bool,
    /// Half extents of the surface: what a unit direction is stretched by, so that points lie evenly on slim bodies too.
    extent: Vector3<f64>,
}

impl<'a> Around<'a> {
    fn new(o: &PosedObstacle<'a>, surface: Surface) -> Self {
        let extent = o.shape.extent();
        let scaled = |by: Vector3<f64>| {
            extent.zip_map(&by, |a, by| if o.obstacle.is_wall() && by > 0.0 { a / by } else { a * by })
        };
        let (o, extent) = match surface {
            Surface::Core => (o.without_margin(), extent),
            Surface::Margin => (o.clone(), scaled(o.obstacle.margin())),
            Surface::Shell => (o.clone(), scaled(o.obstacle.soft_ratio())),
        };
        Self { o, soft: surface == Surface::Shell, extent }
    }

    /// The point of the surface in a direction of the obstacle's frame, of unit extent.
    fn at(&self, x: f64, y: f64, z: f64) -> Vector3<f64> {
        let direction = self.o.pose.rotation * Vector3::new(x, y, z).component_mul(&self.extent);
        if self.soft { self.o.soft_surface(&direction) } else { self.o.surface(&direction) }
    }

    /// Points all over a surface in space, by meridians and parallels.
    fn mesh(&self, (across, down): (u32, u32)) -> Vec<Vector3<f64>> {
        let at = |i: u32, j: u32| {
            let (u, v) = (TAU * f64::from(i) / f64::from(across), TAU / 2.0 * f64::from(j) / f64::from(down));
            self.at(v.sin() * u.cos(), v.sin() * u.sin(), v.cos())
        };
        (0..across).flat_map(|i| (0..=down).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect()
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
    fn regions_meet_where_they_have_points_in_common() {
        let region = |x, y, outside| Region { ring: square(x, y), outside };
        let here = region(0.0, 0.0, false);
        assert!(here.holds(&Point2::new(0.5, 0.2)) && !here.holds(&Point2::new(1.5, 0.2)));
        assert!(here.meets(&region(0.5, 0.5, false)) && !here.meets(&region(2.0, 0.0, false)));
        // A wall around it touches what reaches out of it, and nothing that is within.
        let small = Region {
            ring: here.ring.iter().map(|p| Point2::from(p.coords * 0.5) + nalgebra::Vector2::new(0.2, 0.2)).collect(),
            outside: false,
        };
        assert!(region(0.0, 0.0, true).meets(&region(0.5, 0.5, false)) && !region(0.0, 0.0, true).meets(&small));
    }

    #[test]
    fn corners_of_a_polygon_are_on_its_outline() {
        let text = "ds.linear = { attractor = [2, 0], gain = 1 }\n[[start]]\nposition = [1, 1]\n[[obstacle]]\nname = \"arrow\"\n\
            center = [0, 0]\nshape = { polygon = [[0.1, 0.0], [-0.06, 0.08], [-0.02, 0.0], [-0.06, -0.08]] }\n";
        let scene = crate::scene::Scene::parse("s.toml", text, "".as_ref()).unwrap();
        let posed = scene.obstacles()[0].at(0.0);
        let outline = outline(&posed, Surface::Core, &View::of(&scene)[0]);
        for corner in [[0.1, 0.0], [-0.06, 0.08], [-0.02, 0.0], [-0.06, -0.08]] {
            assert!(outline.iter().any(|p| (p - Point2::from(corner)).norm() < 1e-9), "{corner:?}");
        }
        assert!((area(&outline) - 0.0096).abs() < 1e-6, "{}", area(&outline));
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
