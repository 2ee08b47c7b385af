//! The convex parts of cores.

use crate::obstacle::Obstacle;
use crate::shape::{MAX_VERTICES, SIGHT, Shape};
use crate::{Scalar, Vector, norm, unit};

/// Most parts of a core: a polygon's pieces.
pub(super) const MOST_PARTS: usize = MAX_VERTICES;
/// Steps towards where an obstacle is farthest beyond a wall.
const STEPS: usize = 6;

/// n.(x - c) = distance, c the obstacle's centre: n of unit length, m.
pub(super) struct Plane<S: Scalar, const D: usize> {
    normal: Vector<S, D>,
    distance: S,
}

/// The normals of a sector's sides, both through the obstacle's centre.
type Sector<S, const D: usize> = Option<[Vector<S, D>; 2]>;

/// A convex part of what a point is to be inside of.
pub(super) enum Part<'a, S: Scalar, const D: usize> {
    /// All of a core that is no polygon.
    Whole(&'a Obstacle<S, D>),
    /// What is behind planes: of a polygon a piece, within its sector, or where all of it is seen from.
    Behind { of: &'a Obstacle<S, D>, planes: heapless::Vec<Plane<S, D>, MAX_VERTICES>, sector: Sector<S, D> },
    /// What is beyond a plane that has a wall's free space behind it, or that within a sector.
    Beyond { wall: &'a Obstacle<S, D>, plane: Plane<S, D>, sector: Sector<S, D> },
}

/// The convex parts of a hard core that may reach another.
pub(super) fn parts<'a, 'b, S: Scalar, const D: usize>(
    o: &'a Obstacle<S, D>,
    other: &'b Obstacle<S, D>,
) -> impl Iterator<Item = Part<'a, S, D>> + use<'a, 'b, S, D> {
    let ball = Ball { at: other.spec().center - o.spec().center, radius: other.outer() };
    let count = o.pieces().map_or(1, |pieces| pieces.count());
    (0..count).filter_map(move |i| match o.pieces() {
        Some(pieces) => pieces.edges(i).and_then(|(first, count)| Part::piece(o, first, count, &ball)),
        None if o.spec().wall => Plane::passed(o, other).map(|plane| Part::Beyond { wall: o, plane, sector: None }),
        None => Some(Part::Whole(o)),
    })
}

/// Where another may be, from the centre, m.
struct Ball<S: Scalar, const D: usize> {
    at: Vector<S, D>,
    radius: S,
}

impl<'a, S: Scalar, const D: usize> Part<'a, S, D> {
    /// Where an obstacle's reference point may be.
    pub fn in_sight(o: &'a Obstacle<S, D>) -> Self {
        let Shape::Polygon(polygon) = &o.spec().shape else { return Self::Whole(o) };
        let mut planes = heapless::Vec::new();
        let all = polygon.vertices().len();
        for edge in edges(o, all, all) {
            let (length, normal) = unit(&across(&edge));
            if length > S::zero() {
                let distance = along(&normal, &edge[0]) * S::from_f64(SIGHT);
                // Cannot be full: there are no more edges.
                let _ = planes.push(Plane { normal, distance });
            }
        }
        Self::Behind { of: o, planes, sector: None }
    }

    /// A piece of a polygon, of a wall of what is outside, if a ball may reach it.
    fn piece(o: &'a Obstacle<S, D>, first: usize, count: usize, ball: &Ball<S, D>) -> Option<Self> {
        let Shape::Polygon(polygon) = &o.spec().shape else { return None };
        let all = polygon.vertices().len();
        let (begin, end) = (o.to_corner(first + all - 1)?, o.to_corner(first + count - 1)?);
        let sides = [across(&[Vector::zeros(), begin]), -across(&[Vector::zeros(), end])];
        // A convex polygon is all one piece, all round.
        let sector = if count < all { Some(sides) } else { None };
        let out_of_reach = |side: &Vector<S, D>| along(side, &ball.at) > norm(side) * ball.radius;
        if sector.iter().flatten().any(out_of_reach) {
            return None;
        }
        let sector = sector.map(|sides| sides.map(|side| unit(&side).1));
        let mut planes = heapless::Vec::new();
        for edge in edges(o, first + all, count) {
            let (length, normal) = unit(&across(&edge));
            let distance = along(&normal, &edge[0]);
            let far = along(&normal, &ball.at) - distance;
            if o.spec().wall {
                let plane = Plane { normal, distance };
                return (far >= -ball.radius).then_some(Self::Beyond { wall: o, plane, sector });
            }
            if far > ball.radius {
                return None;
            }
            if length > S::zero() {
                let _ = planes.push(Plane { normal, distance });
            }
        }
        Some(Self::Behind { of: o, planes, sector })
    }

    pub fn obstacle(&self) -> &'a Obstacle<S, D> {
        match self {
            Self::Whole(o) | Self::Behind { of: o, .. } | Self::Beyond { wall: o, .. } => o,
        }
    }

    /// Is it of what lies beyond a wall?
    pub fn is_beyond(&self) -> bool {
        matches!(self, Self::Beyond { .. })
    }

    /// How it looks from x; nothing from its centre.
    pub fn look(&self, x: &Vector<S, D>) -> Option<Look<S, D>> {
        let away = x - self.obstacle().spec().center;
        match self {
            Self::Whole(o) => {
                let (gauge, outward) = o.gauge(x);
                let (length, normal) = unit(&outward);
                // The gauge is convex, and as steep along the whole ray.
                let metres = along(&normal, &away) / gauge;
                (length > S::zero()).then_some(Look { gauge, normal, offset: S::zero(), metres })
            }
            Self::Behind { planes, sector, .. } => outside(sector, &away).or_else(|| {
                let gauges = planes.iter().map(|p| (along(&p.normal, &away) / p.distance, p));
                let (gauge, plane) = gauges.reduce(|most, p| if p.0 > most.0 { p } else { most })?;
                Some(Look { gauge, normal: plane.normal, offset: S::zero(), metres: plane.distance })
            }),
            Self::Beyond { wall, plane, sector } => {
                let gauge = wall.gamma(x);
                let elsewhere = if gauge < S::one() { None } else { outside(sector, &away) };
                let offset = plane.distance - along(&plane.normal, &away);
                elsewhere.or(Some(Look { gauge, normal: -plane.normal, offset, metres: S::zero() }))
            }
        }
    }
}

/// A part as it looks from a point x that is not its centre.
pub(super) struct Look<S: Scalar, const D: usize> {
    /// Below one inside; a convex function.
    pub gauge: S,
    /// n, of unit length: where the part's gauge is at most `level` is behind the plane n.(y - x) = -[`beyond`](Self::beyond).
    pub normal: Vector<S, D>,
    /// How far that plane is at the gauge's own level, and how much farther for each 1 less, m.
    offset: S,
    pub metres: S,
}

impl<S: Scalar, const D: usize> Look<S, D> {
    /// How far x is beyond that plane, m.
    pub fn beyond(&self, level: S) -> S {
        self.offset + (self.gauge - level) * self.metres
    }

    /// How it looks a share of the way from the part's centre to x: the gauge grows in proportion, and the plane is the same.
    pub fn nearer(self, share: S) -> Self {
        Self { gauge: self.gauge * share, offset: self.offset * share, ..self }
    }
}

impl<S: Scalar, const D: usize> Plane<S, D> {
    /// Where the ray from a wall's centre through x leaves its free space, with all of that behind it.
    fn touching(wall: &Obstacle<S, D>, x: &Vector<S, D>) -> Option<Self> {
        let (gauge, outward) = wall.gauge(x);
        let (length, normal) = unit(&outward);
        let out = along(&normal, &(x - wall.spec().center));
        (length > S::zero()).then(|| Self { normal, distance: out / gauge })
    }

    /// One that has a wall's convex free space behind it, and not all of another obstacle: from the centre of that and from each corner
    /// that sticks out, to the other's point farthest beyond the plane there, and again.
    fn passed(wall: &Obstacle<S, D>, other: &Obstacle<S, D>) -> Option<Self> {
        let sticks_out = |x: &Vector<S, D>| wall.gamma(x) < S::one();
        let corners = (0..MAX_VERTICES).map_while(|n| other.extreme(n)).filter(sticks_out);
        for start in core::iter::once(other.spec().center).chain(corners) {
            let mut x = start;
            for _ in 0..STEPS {
                let Some(plane) = Self::touching(wall, &x) else { break };
                x = other.farthest(&plane.normal);
                if sticks_out(&x) {
                    return Self::touching(wall, &x);
                }
            }
        }
        None
    }
}

/// The side of a sector that x is on the wrong side of.
fn outside<S: Scalar, const D: usize>(sector: &Sector<S, D>, away: &Vector<S, D>) -> Option<Look<S, D>> {
    let sides = sector.iter().flatten().map(|side| (along(side, away), *side));
    let (out, normal) = sides.reduce(|most, side| if side.0 > most.0 { side } else { most })?;
    (out > S::zero()).then_some(Look { gauge: S::FAR, normal, offset: out, metres: S::zero() })
}

/// `count` edges of a polygon from the one on that ends at its corner `first`, from the centre, m.
fn edges<S: Scalar, const D: usize>(
    o: &Obstacle<S, D>,
    first: usize,
    count: usize,
) -> impl Iterator<Item = [Vector<S, D>; 2]> {
    let mut before = o.to_corner(first - 1);
    (first..first + count).map_while(move |i| {
        let here = o.to_corner(i);
        Some([core::mem::replace(&mut before, here)?, here?])
    })
}

/// An edge turned by a quarter, outwards.
fn across<S: Scalar, const D: usize>(edge: &[Vector<S, D>; 2]) -> Vector<S, D> {
    let along = edge[1] - edge[0];
    Vector::from_fn(|i, _| match i {
        0 => along[1],
        1 => -along[0],
        _ => S::zero(),
    })
}

fn along<S: Scalar, const D: usize>(normal: &Vector<S, D>, v: &Vector<S, D>) -> S {
    S::dot(normal.as_slice(), v.as_slice())
}
