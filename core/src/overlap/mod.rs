//! A point inside several hard cores at once, if there is one.
//!
//! Every core is taken in convex [`Part`]s, and a point that several parts have in common is searched by [`ellipsoid`]s: what is still
//! possible lies in one, and each look from its centre cuts some of it off. So cores are told to be apart by proof, and overlaps are found
//! however shallow, as far as the numbers tell.

mod ellipsoid;
mod pair;
mod part;

use crate::obstacle::Obstacle;
use crate::shape::{Shape, root};
use crate::{Scalar, Vector, norm};
use ellipsoid::search;
use part::{MOST_PARTS, Part, parts};

/// Most obstacles of which a point in common is searched.
pub(crate) const MOST: usize = 8;

/// How deep inside a point is to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Depth {
    /// Inside: the first point that is will do.
    Any,
    /// Well inside, if that is possible.
    Ample,
    /// As deep as can be, nearly.
    Deepest,
}

impl Depth {
    /// The gauge below which no deeper point is searched.
    fn enough<S: Scalar>(self) -> S {
        match self {
            Self::Any => S::one(),
            Self::Ample => S::from_f64(0.85),
            Self::Deepest => S::zero(),
        }
    }
}

/// Do these hard cores overlap? Two walls never do.
pub(crate) fn overlap<S: Scalar, const D: usize>(a: &Obstacle<S, D>, b: &Obstacle<S, D>) -> bool {
    if !are_near(a, b) {
        return false;
    }
    if !a.spec().wall && !b.spec().wall && meet_on_the_way(a, b) {
        return true;
    }
    let others: Few<_, MOST_PARTS> = few(parts(b, a));
    parts(a, b).any(|one| others.iter().any(|other| search(&[&one, other], Depth::Any).is_some()))
}

/// Have they a point in common between their centres? Gauges grow in proportion along a ray, so what they are there follows from what
/// each is at the other's centre.
fn meet_on_the_way<S: Scalar, const D: usize>(a: &Obstacle<S, D>, b: &Obstacle<S, D>) -> bool {
    let (of_a, of_b) = (a.gauge(&b.spec().center).0, b.gauge(&a.spec().center).0);
    // 1/of_a + 1/of_b > 1, with something left for rounding.
    of_a * of_b < (of_a + of_b) * S::from_f64(0.999)
}

/// May these overlap, as far as balls round them say, and for what is inside a wall the corners of its box?
fn are_near<S: Scalar, const D: usize>(a: &Obstacle<S, D>, b: &Obstacle<S, D>) -> bool {
    match (a.spec().wall, b.spec().wall) {
        (true, true) => false,
        (true, false) => may_reach(a, b),
        (false, true) => may_reach(b, a),
        _ => norm(&(a.spec().center - b.spec().center)) <= a.outer() + b.outer(),
    }
}

/// May an obstacle reach a wall?
fn may_reach<S: Scalar, const D: usize>(wall: &Obstacle<S, D>, b: &Obstacle<S, D>) -> bool {
    let gamma = wall.gamma(&b.spec().center);
    let inside = gamma > S::one() && !wall.is_near(gamma, b.outer());
    // Where the free space is convex it holds all that is between corners it holds.
    let convex = !matches!(wall.spec().shape, Shape::Polygon(_));
    !(inside || convex && (0..1 << D).all(|n| wall.gamma(&b.corner(n)) > S::one()))
}

/// The point that is deepest inside where the reference points of all of these may be, m: of two ellipsoids exactly, else
/// nearly; `None` if they have none in common.
pub(crate) fn common<S: Scalar, const D: usize>(
    members: &heapless::Vec<&Obstacle<S, D>, MOST>,
) -> Option<Vector<S, D>> {
    if let [a, b] = members.as_slice()
        && let Some(point) = pair::deepest(a, b)
    {
        return point;
    }
    let parts: Few<_, MOST> = few(members.iter().map(|o| Part::in_sight(o)));
    let parts: Few<_, MOST> = few(parts.iter());
    search(&parts, Depth::Deepest).map(|(_, x)| x)
}

/// A few things in room for so many.
type Few<T, const MOST: usize> = heapless::Vec<T, MOST>;

/// The first of them that there is room for: `collect` would panic if there were more.
fn few<T, const MOST: usize>(all: impl Iterator<Item = T>) -> Few<T, MOST> {
    let mut few = Few::new();
    for one in all {
        if few.push(one).is_err() {
            break;
        }
    }
    few
}

/// Where an obstacle's reference point may be: inside its core, of a polygon where all of it is seen from.
pub(crate) struct Sight<'a, S: Scalar, const D: usize> {
    part: Part<'a, S, D>,
    of: &'a Obstacle<S, D>,
}

/// Up to which gauge, to the power of 2p, a reference point is drawn from where it has to be, and what is aimed at.
const DRAWN: (f64, f64) = (0.8, 0.78);
/// Most steps to there.
const STEPS: u8 = 8;

impl<'a, S: Scalar, const D: usize> Sight<'a, S, D> {
    pub fn of(obstacle: &'a Obstacle<S, D>) -> Self {
        Self { part: Part::in_sight(obstacle), of: obstacle }
    }

    /// A point of it in another's hard core, well inside both if that is possible, of two ellipsoids the deepest; m.
    pub fn meets(&self, other: &Obstacle<S, D>) -> Option<Vector<S, D>> {
        if !are_near(self.of, other) {
            // They have moved apart since they were compared.
            return None;
        }
        if let Some(point) = pair::deepest(self.of, other) {
            return point;
        }
        let depth = if other.spec().wall { Depth::Any } else { Depth::Ample };
        let mut best = (S::one(), None);
        for part in parts(other, self.of) {
            if let Some((gauge, x)) = search(&[&self.part, &part], depth)
                && gauge < best.0
            {
                best = (gauge, Some(x));
                if gauge < depth.enough() {
                    break;
                }
            }
        }
        best.1
    }

    /// May the reference point be drawn to there?
    pub fn reaches(&self, x: &Vector<S, D>) -> bool {
        self.part.look(x).is_none_or(|look| look.gauge <= root(S::from_f64(DRAWN.0), self.of.power()))
    }

    /// From a point of it, the place nearest to `end` on the way there to which the reference point may be drawn, or nearly, m; the point
    /// itself if there is none.
    pub fn drawn(&self, point: &Vector<S, D>, end: &Vector<S, D>) -> Vector<S, D> {
        let level = |gamma: f64| root(S::from_f64(gamma), self.of.power());
        let (most, aim) = (level(DRAWN.0), level(DRAWN.1));
        let way = end - point;
        let mut back = S::zero();
        for _ in 0..STEPS {
            let x = end - way * back;
            let Some(look) = self.part.look(&x) else { return x };
            if look.gauge <= most {
                return x;
            }
            // Newton's steps along the gauge, which is convex: they come from outside and do not pass what they aim at.
            let rises = S::dot(look.normal.as_slice(), way.as_slice());
            back += (look.gauge - aim) * (look.metres / rises);
            if !(rises > S::zero() && back < S::one()) {
                break;
            }
        }
        *point
    }
}
