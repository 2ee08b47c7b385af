//! Which hard cores overlap: told right however shallow the overlap, of every pair of shapes and of walls.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod world;

use pliant_core::{Ageing, Fixed, Obstacle, ObstacleSpec, Scalar, Shape, Status, Table, Vector};
use rand::Rng;
use world::{Random, random, shape, turn};

/// Depths and gaps, over the size of the smaller core.
const DEPTHS: [f64; 6] = [0.0005, 0.001, 0.003, 0.01, 0.03, 0.1];

/// Two cores, or one and a wall, as they were made in the numbers `S`, and the same in `f64`.
struct Pair<S: Scalar, const D: usize> {
    a: [ObstacleSpec<S, D>; 2],
    exact: [Obstacle<f64, D>; 2],
    /// Points of their surfaces; none of a wall's.
    surfaces: [Vec<Vector<f64, D>>; 2],
    size: f64,
}

fn direction<const D: usize>(r: &mut Random) -> Vector<f64, D> {
    loop {
        let v = Vector::<f64, D>::from_fn(|_, _| r.random_range(-1.0..1.0));
        if (0.05..1.0).contains(&v.norm()) {
            return v.normalize();
        }
    }
}

fn exact<S: Scalar, const D: usize>(spec: &ObstacleSpec<S, D>) -> Option<Obstacle<f64, D>> {
    let numbers = |v: &Vector<S, D>| v.map(|x| x.to_f64());
    let shape = match &spec.shape {
        Shape::Ellipsoid { axes, curvature } => Shape::Ellipsoid { axes: numbers(axes), curvature: *curvature },
        Shape::Box { half, rounding } => Shape::Box { half: numbers(half), rounding: rounding.to_f64() },
        Shape::Cylinder { radius, half_length, rounding } => {
            Shape::Cylinder { radius: radius.to_f64(), half_length: half_length.to_f64(), rounding: rounding.to_f64() }
        }
        Shape::Capsule { radius, half_length } => {
            Shape::Capsule { radius: radius.to_f64(), half_length: half_length.to_f64() }
        }
        Shape::Polygon(polygon) => {
            let corners: Vec<_> = polygon.vertices().iter().map(|v| v.map(|x| x.to_f64())).collect();
            Shape::Polygon(pliant_core::shape::Polygon::new(&corners).ok()?)
        }
    };
    let rotation = spec.rotation.map(|x| x.to_f64());
    let spec =
        ObstacleSpec { shape, rotation, center: numbers(&spec.center), wall: spec.wall, ..ObstacleSpec::default() };
    Obstacle::new(spec).ok()
}

impl<S: Scalar, const D: usize> Pair<S, D> {
    fn new(r: &mut Random, wall: bool) -> Option<Self> {
        let make = |r: &mut Random| {
            let size = r.random_range(0.03..0.15);
            let spec =
                ObstacleSpec { shape: shape::<S, D>(r, size, true), rotation: turn(r), ..ObstacleSpec::default() };
            Obstacle::new(spec.clone()).ok().map(|_| spec)
        };
        let first = if wall {
            let wall = world::wall::<S, D>(r, true);
            ObstacleSpec { velocity: Vector::zeros(), ..wall.spec().clone() }
        } else {
            make(r)?
        };
        let mut second = make(r)?;
        second.center = first.center;
        let all = [first, second];
        let exact = [exact(&all[0])?, exact(&all[1])?];
        let points = if D == 2 { 2000 } else { 20_000 };
        let mut surface = |o: &Obstacle<f64, D>| -> Vec<_> {
            if o.spec().wall {
                return Vec::new();
            }
            (0..points).map(|_| o.surface(&direction(r))).collect()
        };
        let surfaces = [surface(&exact[0]), surface(&exact[1])];
        let outer = |n: usize| surfaces[n].iter().fold(0.0, |m: f64, x| m.max((x - exact[n].spec().center).norm()));
        let size = if wall { outer(1) } else { outer(0).min(outer(1)) };
        Some(Self { a: all, exact, surfaces, size })
    }

    /// A point of one's surface that is inside the other, where the second is this far away from its place.
    fn witness(&self, away: &Vector<f64, D>) -> Option<Vector<f64, D>> {
        let inside = |n: usize, x: &Vector<f64, D>| self.exact[n].gamma(x) < 1.0;
        let first = self.surfaces[0].iter().find(|x| inside(1, &(*x - away))).copied();
        first.or_else(|| self.surfaces[1].iter().map(|x| x + away).find(|x| inside(0, x)))
    }

    /// The last place where they touch as the second comes (a wall: goes) along a line, and the normal of the first's surface there.
    fn touch(&self, along: &Vector<f64, D>) -> Option<(Vector<f64, D>, Vector<f64, D>)> {
        let wall = self.exact[0].spec().wall;
        if wall && self.witness(&Vector::zeros()).is_some() {
            return None;
        }
        let (mut near, mut far) = (0.0, if wall { 20.0 } else { 2.0 });
        for _ in 0..45 {
            let middle = 0.5 * (near + far);
            if self.witness(&(along * middle)).is_some() == wall { far = middle } else { near = middle }
        }
        let touching = along * if wall { far } else { near };
        let normal = self.exact[0].gradient(&self.witness(&touching)?).normalize();
        Some((along * if wall { near } else { far }, normal))
    }

    /// What a table says where the second is this far away from its place.
    fn told(&self, away: &Vector<f64, D>) -> Option<bool> {
        let mut table: Table<S, D, 2> = Table::new();
        let moved = self.a[1].center + away.map(S::from_f64);
        let second = ObstacleSpec { center: moved, ..self.a[1].clone() };
        let all = [Obstacle::new(self.a[0].clone()).ok()?, Obstacle::new(second).ok()?];
        for (id, obstacle) in all.iter().enumerate() {
            table.upsert(id as u16, obstacle.clone(), S::zero(), &Ageing::default()).ok()?;
        }
        let shared = table.iter().zip(&all).any(|(e, o)| e.obstacle().reference() != o.reference());
        let tree = table.advance(S::zero(), &Ageing::default()).contains(Status::CLUSTER);
        Some(shared || tree)
    }
}

/// Both ways, from this depth on.
fn told_right<S: Scalar, const D: usize>(pairs: usize, wall: bool, least: f64) {
    let r = &mut random(7);
    let (mut deep, mut apart) = (0, 0);
    for n in 0..pairs {
        let Some(pair) = Pair::<S, D>::new(r, wall) else { continue };
        let along = direction::<D>(r);
        let Some((touching, normal)) = pair.touch(&along) else { continue };
        for depth in DEPTHS.into_iter().filter(|depth| *depth >= least) {
            // What points of the surface say is so, and a little deeper.
            let inwards = touching - normal * (depth * pair.size);
            if pair.witness(&(inwards + normal * (0.3 * depth * pair.size))).is_some() {
                deep += 1;
                assert_eq!(pair.told(&inwards), Some(true), "pair {n}, {depth} deep: {:?}", pair.a);
            }
            // Beyond a tangent plane nothing is, of what is convex; a notch may hold a star.
            let outwards = touching + normal * (depth * pair.size);
            let star = pair.a.iter().any(|spec| matches!(spec.shape, Shape::Polygon(_)));
            if !star && depth >= least.max(0.003) {
                apart += 1;
                assert_eq!(pair.told(&outwards), Some(false), "pair {n}, {depth} apart: {:?}", pair.a);
            }
        }
    }
    assert!(deep * 2 > pairs && apart * 10 > pairs, "{pairs} pairs: {deep} overlaps, {apart} gaps");
}

#[test]
fn planar_overlaps_are_found() {
    told_right::<f64, 2>(1000, false, 0.0005);
    told_right::<f32, 2>(1000, false, 0.0005);
    told_right::<Fixed, 2>(1000, false, 0.01);
}

#[test]
fn spatial_overlaps_are_found() {
    told_right::<f64, 3>(100, false, 0.0005);
    told_right::<f32, 3>(100, false, 0.0005);
    told_right::<Fixed, 3>(100, false, 0.01);
}

#[test]
fn what_sticks_into_a_wall_is_found() {
    told_right::<f64, 2>(500, true, 0.0005);
    told_right::<f32, 2>(500, true, 0.0005);
    told_right::<Fixed, 2>(500, true, 0.03);
    told_right::<f64, 3>(60, true, 0.0005);
}
