//! How fast the normal of an obstacle turns, from its shape alone: section 2 of docs/method.md says over which share of a polygon's edge it does.

use crate::world::{judge::corners, numbers};
use pliant_core::{Obstacle, Scalar, Shape, Vector};

type Corner = [f64; 2];

/// A polygon's hard core about its centre, in the world's frame, m.
struct Outline(Vec<Corner>);

/// Bounds the turning of an obstacle's unit normal between two points outside of it, rad/m.
pub fn rate<S: Scalar, const D: usize>(o: &Obstacle<S, D>, ends: [&Vector<S, D>; 2]) -> f64 {
    // Safety factors of up to 1.4 an axis turn a normal by so much more.
    let stretched = 1.4 * 1.4;
    let number = S::to_f64;
    match &o.spec().shape {
        // The normal is along u_i^(2p - 1)/a_i, of which the largest u_i is at least the gauge over d^(1/2p).
        Shape::Ellipsoid { axes, curvature } => {
            let (least, most) =
                axes.iter().fold((f64::MAX, 0.0), |(l, m), a| (f64::min(l, number(*a)), f64::max(m, number(*a))));
            f64::from(2 * curvature - 1) * most / (least * least) * 2.0 * stretched
        }
        Shape::Box { rounding, .. } | Shape::Cylinder { rounding, .. } => stretched / number(*rounding),
        Shape::Capsule { radius, .. } => stretched / number(*radius),
        Shape::Polygon(polygon) => {
            let center = numbers(&o.spec().center);
            let plane = |x: Vector<f64, D>| [x[0] - center[0], x[1] - center[1]];
            let outline = Outline(corners(o, polygon.vertices()).into_iter().map(plane).collect());
            outline.rate(ends.map(|x| plane(numbers(x))))
        }
    }
}

impl Outline {
    fn at(&self, i: usize) -> Corner {
        self.0[i % self.0.len()]
    }

    /// Of the edge from the i-th corner on: m, with m.x = 1 along it.
    fn normal(&self, i: usize) -> Corner {
        let (v, w) = (self.at(i), self.at(i + 1));
        let twice = cross(v, w);
        [(w[1] - v[1]) / twice, (v[0] - w[0]) / twice]
    }

    /// The edge that the ray through u leaves by.
    fn leaves(&self, u: Corner) -> usize {
        let through = |i: &usize| cross(self.at(*i), u) >= 0.0 && cross(u, self.at(i + 1)) > 0.0;
        (0..self.0.len()).find(through).unwrap_or(0)
    }

    /// Between rays through two points the edges the shorter way round from one to the other are met.
    fn rate(&self, ends: [Corner; 2]) -> f64 {
        let n = self.0.len();
        let [from, to] = if cross(ends[0], ends[1]) >= 0.0 { ends } else { [ends[1], ends[0]] };
        let (first, last) = (self.leaves(from), self.leaves(to));
        (0..=(last + n - first) % n).flat_map(|i| ends.map(|u| self.rate_of(first + i, u))).fold(0.0, f64::max)
    }

    /// While the ray through u passes an edge.
    fn rate_of(&self, i: usize, u: Corner) -> f64 {
        let n = self.0.len();
        let (v, w, m) = (self.at(i), self.at(i + 1), self.normal(i));
        let (own, unit) = (1.0 / length(m), scaled(m));
        let area = cross(v, w);
        // The ray turns by |dx|/|u| at most, so its place t on the edge, at p = u/(m.u), changes by |p| |dx| / ((m.u) area).
        let gauge = dot(m, u).max(1.0);
        let farthest = length(v).max(length(w));
        let place = farthest / (gauge * area);
        let ends = [(i + n - 1, w), (i + 1, v)];
        ends.into_iter().fold(0.0, |most, (neighbour, opposite)| {
            let far = 1.0 / length(self.normal(neighbour));
            let other = scaled(self.normal(neighbour));
            let (fall, least) = (far - dot(other, opposite), 0.8 * far.min(own));
            let band = if fall * 0.2 > least { least / fall } else { 0.2 };
            // Half of the way from one to the other over the band; of (1 - a) m + a o, whose length is never less than the shortest, across it.
            let change = cross(unit, other).abs() * 0.5 / band * place;
            f64::max(most, change / shortest(unit, other).powi(2))
        })
    }
}

fn scaled(a: Corner) -> Corner {
    let size = length(a);
    a.map(|x| x / size)
}

/// Of all (1 - a) m + a o, 0 <= a <= 1/2, the least length.
fn shortest(m: Corner, o: Corner) -> f64 {
    let d = [o[0] - m[0], o[1] - m[1]];
    let square = dot(d, d);
    let a = if square > 0.0 { (-dot(m, d) / square).clamp(0.0, 0.5) } else { 0.0 };
    length([m[0] + a * d[0], m[1] + a * d[1]])
}

fn cross(a: Corner, b: Corner) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn dot(a: Corner, b: Corner) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn length(a: Corner) -> f64 {
    dot(a, a).sqrt()
}
