//! Polygons in the plane that are star-shaped about their origin: not convex, but every ray from the origin leaves them once.

mod keep_out;
mod pieces;

pub(crate) use pieces::Pieces;

use super::{Place, Surface};
use crate::{ObstacleError, RANGE, Scalar, Vector};

/// Scaled coordinates beyond which fixed point looks along their direction.
const FAR_OFF: f64 = 8.0;

/// Most corners of a polygon.
pub const MAX_VERTICES: usize = 12;
/// The share of an edge, at each end, over which the normal turns towards that of the neighbour.
const BLEND: f64 = 0.2;
/// How far the neighbour's line may come nearer along that share, of the distance of the nearer of the two from the origin: the further the
/// neighbour turns away, the shorter the share.
const FALL: f64 = 0.8;
/// A reference point is behind every edge's line by at least a fifth of the origin's distance from it. FALL/8, what
/// the blend may take of that, is less.
pub(crate) const SIGHT: f64 = 0.8;

/// A polygon, star-shaped about the origin: [`Polygon::new`] checks the number of corners, an obstacle the rest.
///
/// Between two corners v and w a point is u = alpha v + beta w, and its gauge is alpha + beta. The gradient of the
/// gauge is along the edge's normal, which would jump at a corner; near one it is blended with that of the next edge, so that the
/// velocity is continuous: at the corner it halves the angle between the two, so along either edge the flow goes on the way it went. Where that edge
/// turns away steeply it is so only very near, for the normal must lead away from every reference point there may be.
///
/// ```
/// use pliant_core::{Obstacle, ObstacleSpec, Vector, shape::{Polygon, Shape}};
/// let arrow = Polygon::new(&[[0.1, 0.0], [-0.06, 0.08], [-0.02, 0.0], [-0.06, -0.08]]).unwrap();
/// let obstacle = Obstacle::new(ObstacleSpec { shape: Shape::Polygon(arrow), ..ObstacleSpec::default() }).unwrap();
/// assert!((obstacle.gamma(&Vector::<f64, 2>::new(-0.02, 0.0)) - 1.0).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon<S> {
    vertices: heapless::Vec<[S; 2], MAX_VERTICES>,
}

/// An edge from `from` to `to`, which is `along`; `normal.z = 1` along it. `across` is the unit normal, `distance` that of its line from the origin.
struct Edge<S> {
    from: [S; 2],
    to: [S; 2],
    along: [S; 2],
    normal: [S; 2],
    across: [S; 2],
    distance: S,
}

impl<S: Scalar> Edge<S> {
    /// None where the edge's line goes through the origin or on its wrong side.
    fn new(from: [S; 2], to: [S; 2]) -> Option<Self> {
        let along = sub(to, from);
        // Over its own length first: in fixed point twice the area that a short edge spans has few digits left.
        let (_, across) = S::unit([along[1], -along[0]]);
        let distance = dot(across, from).min(dot(across, to));
        // |normal| = 1/distance of the edge's line.
        let normal = across.map(|n| n / distance);
        (cross(from, to) > S::zero() && distance > S::zero()).then_some(Self {
            from,
            to,
            along,
            normal,
            across,
            distance,
        })
    }

    /// Its share in the normal of a neighbour, at this share of that one's length from the corner between them; `opposite` is the neighbour's other
    /// corner, `distance` that of its line. A half at the corner, fading over a band.
    fn share(&self, away: S, opposite: [S; 2], distance: S) -> S {
        let band = S::from_f64(BLEND);
        let (fall, most) =
            (self.distance - dot(self.across, opposite), S::from_f64(FALL) * self.distance.min(distance));
        let band = if fall * band > most { most / fall } else { band };
        ((band - away) / band).max(S::zero()).min(S::one()) * S::from_f64(0.5)
    }
}

impl<S: Scalar> Polygon<S> {
    /// From its corners, counter-clockwise, m.
    ///
    /// # Errors
    ///
    /// [`ObstacleError::Corners`] unless there are three to [`MAX_VERTICES`]. Whether they go once round the origin and are all seen from
    /// there is checked by [`Obstacle::new`](crate::Obstacle::new): [`ObstacleError::Vertices`].
    pub fn new(vertices: &[[S; 2]]) -> Result<Self, ObstacleError> {
        match heapless::Vec::from_slice(vertices) {
            Ok(vertices) if vertices.len() >= 3 => Ok(Self { vertices }),
            _ => Err(ObstacleError::Corners),
        }
    }

    /// The corners, counter-clockwise, m.
    pub fn vertices(&self) -> &[[S; 2]] {
        &self.vertices
    }

    /// Within range, each corner to the left of the one before as seen from the origin, once round, and no edge passes the origin closer
    /// than the least semi-axis.
    pub(super) fn check(&self) -> Result<(), ObstacleError> {
        let bound = S::from_f64(RANGE);
        if !self.vertices.iter().flatten().all(|x| x.abs() <= bound) {
            return Err(ObstacleError::Vertices);
        }
        let (scaled, longest) = self.scaled();
        let around = scaled.edges().count() == self.vertices.len();
        // Each edge turns by less than half a turn, so the first axis is crossed upwards as often as the polygon goes round.
        let turns = scaled.pairs().filter(|(a, b)| a[1] < S::zero() && b[1] >= S::zero()).count();
        let roomy = scaled.inner() * longest >= S::MIN_AXIS;
        if around && turns == 1 && roomy { Ok(()) } else { Err(ObstacleError::Vertices) }
    }

    /// In terms of its longest semi-extent, and that, m: small polygons would lose their digits in fixed point.
    pub(super) fn scaled(&self) -> (Scaled<'_, S>, S) {
        let [x, y] = self.extent();
        let longest = x.max(y);
        (Scaled { vertices: &self.vertices, scale: S::one() / longest }, longest)
    }

    pub(super) fn extent(&self) -> [S; 2] {
        self.vertices.iter().fold([S::zero(); 2], |[x, y], v| [x.max(v[0].abs()), y.max(v[1].abs())])
    }
}

/// A polygon's corners, all times a scale.
pub(super) struct Scaled<'a, S> {
    vertices: &'a [[S; 2]],
    scale: S,
}

impl<S: Scalar> Polygon<S> {
    /// With a scale found before.
    pub(super) fn at_scale(&self, scale: S) -> Scaled<'_, S> {
        Scaled { vertices: &self.vertices, scale }
    }

    /// And with the pieces.
    pub(super) fn in_pieces<'a>(&'a self, scale: S, pieces: &'a Pieces) -> InPieces<'a, S> {
        InPieces { polygon: self.at_scale(scale), pieces }
    }
}

impl<S: Scalar> Scaled<'_, S> {
    pub fn scale(&self) -> S {
        self.scale
    }

    /// At most 1 where the whole polygon is seen from, with some to spare: a convex function like gamma, and never
    /// below it. And where it grows to.
    pub fn sight<const D: usize>(&self, u: &Vector<S, D>) -> (S, Vector<S, D>) {
        let u = plane(u);
        let (most, steepest) = self.edges().fold((S::zero(), [S::zero(); 2]), |(most, steepest), edge| {
            let here = dot(edge.normal, u);
            if here > most { (here, edge.normal) } else { (most, steepest) }
        });
        let share = most / S::from_f64(SIGHT);
        (share * share, vector(steepest))
    }

    /// The convex pieces, of a wall those of all that is outside.
    pub fn pieces(&self, wall: bool) -> Pieces {
        Pieces::new(self.edges(), wall)
    }

    /// The corner with the largest w.u.
    pub fn farthest<const D: usize>(&self, w: &Vector<S, D>) -> Vector<S, D> {
        let w = plane(w);
        let corners = self.vertices.iter().map(|v| (dot(*v, w), v));
        let most = corners.reduce(|most, v| if v.0 > most.0 { v } else { most });
        most.map_or_else(Vector::zeros, |(_, v)| vector(v.map(|x| x * self.scale)))
    }

    /// The distance of the nearest edge's line from the origin.
    pub fn inner(&self) -> S {
        self.edges().fold(S::MAX, |least, e| least.min(S::one() / S::norm(&e.normal)))
    }

    /// How far u is from the nearest edge.
    pub fn distance<const D: usize>(&self, u: &Vector<S, D>) -> S {
        let u = plane(u);
        self.pairs().fold(S::MAX, |least, (from, to)| {
            let (length, ahead) = S::unit(sub(to, from));
            let corner = sub(u, from);
            let along = dot(corner, ahead);
            let here = if along > S::zero() && along < length { cross(ahead, corner).abs() } else { S::norm(&corner) };
            least.min(here)
        })
    }

    /// Every corner, with the one before it.
    fn pairs(&self) -> impl Iterator<Item = ([S; 2], [S; 2])> {
        let scale = self.scale;
        let scaled = move |v: &[S; 2]| [v[0] * scale, v[1] * scale];
        let mut before = self.vertices.last().map_or([S::zero(); 2], scaled);
        self.vertices.iter().map(move |v| {
            let here = scaled(v);
            (core::mem::replace(&mut before, here), here)
        })
    }

    fn edges(&self) -> impl Iterator<Item = Edge<S>> {
        self.pairs().filter_map(|(from, to)| Edge::new(from, to))
    }

    /// The place of the corner at which the edge ends that the ray through u leaves by.
    fn leaving(&self, u: [S; 2]) -> Option<usize> {
        let turn = |v: &[S; 2]| cross([v[0] * self.scale, v[1] * self.scale], u);
        let mut before = turn(self.vertices.last()?);
        self.vertices.iter().position(|v| {
            let here = turn(v);
            let between = before >= S::zero() && here < S::zero();
            before = here;
            between
        })
    }

    /// The edge that ends at the i-th corner.
    fn ending(&self, i: usize) -> Option<Edge<S>> {
        let at = |i: usize| self.vertices.get(i).map(|v| [v[0] * self.scale, v[1] * self.scale]);
        Edge::new(at(self.before(i))?, at(i)?)
    }

    /// The places of the corners before and after the i-th.
    fn before(&self, i: usize) -> usize {
        if i == 0 { self.vertices.len() - 1 } else { i - 1 }
    }

    fn after(&self, i: usize) -> usize {
        if i + 1 == self.vertices.len() { 0 } else { i + 1 }
    }
}

/// A polygon along with its convex pieces.
pub(super) struct InPieces<'a, S> {
    polygon: Scaled<'a, S>,
    pieces: &'a Pieces,
}

impl<S: Scalar, const D: usize> Surface<S, D> for InPieces<'_, S> {
    fn level(&self, u: &Vector<S, D>) -> (S, Vector<S, D>) {
        let (mut u, mut unit, polygon) = (plane(u), S::one(), &self.polygon);
        // In fixed point products of what is far away leave the range, and what saturates has another direction.
        if !S::FLOATS {
            let largest = u[0].abs().max(u[1].abs());
            if largest > S::from_f64(FAR_OFF) {
                (u, unit) = (u.map(|x| x / largest), largest);
            }
        }
        let Some((end, edge)) = polygon.leaving(u).and_then(|end| Some((end, polygon.ending(end)?))) else {
            return (S::zero(), Vector::zeros());
        };
        let gauge = dot(edge.normal, u);
        let beta = cross(edge.from, u) / cross(edge.from, edge.to);
        // Where on the edge, 0 to 1.
        let along = beta / gauge;
        let corners = [(along, polygon.before(end), edge.to), (S::one() - along, polygon.after(end), edge.from)];
        let mut normal = edge.across;
        for (away, neighbour, opposite) in corners {
            // Far from both corners no neighbour counts.
            if away < S::from_f64(BLEND)
                && let Some(neighbour) = polygon.ending(neighbour)
            {
                let share = neighbour.share(away, opposite, edge.distance);
                let own = S::one() - share;
                normal = [0, 1].map(|i| normal[i] * own + neighbour.across[i] * share);
            }
        }
        let gauge = gauge * unit;
        (gauge * gauge, vector(normal))
    }

    fn keep_out(&self, at: &Place<'_, S, D>, keep: impl FnMut(Vector<S, D>, S)) {
        keep_out::keep_out(self.polygon.pairs(), self.pieces, at, keep);
    }
}

fn plane<S: Scalar, const D: usize>(v: &Vector<S, D>) -> [S; 2] {
    let mut all = v.iter().copied();
    [all.next().unwrap_or_else(S::zero), all.next().unwrap_or_else(S::zero)]
}

fn vector<S: Scalar, const D: usize>(v: [S; 2]) -> Vector<S, D> {
    Vector::from_fn(|i, _| v.get(i).copied().unwrap_or_else(S::zero))
}

fn cross<S: Scalar>(a: [S; 2], b: [S; 2]) -> S {
    a[0] * b[1] - a[1] * b[0]
}

fn dot<S: Scalar>(a: [S; 2], b: [S; 2]) -> S {
    a[0] * b[0] + a[1] * b[1]
}

/// |v_1| + |v_2|
fn size<S: Scalar>(v: [S; 2]) -> S {
    v[0].abs() + v[1].abs()
}

fn sub<S: Scalar>(a: [S; 2], b: [S; 2]) -> [S; 2] {
    [a[0] - b[0], a[1] - b[1]]
}
