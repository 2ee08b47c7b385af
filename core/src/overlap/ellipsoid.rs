//! The search by ellipsoids.
//!
//! What several convex parts have in common lies in an ellipsoid. From its centre x each part shows a plane that it is behind; the
//! smallest ellipsoid round what is left of the one before takes its place (Bland, Goldfarb & Todd 1981, with deep cuts): with n of unit
//! length, all of the part at least b behind x, and E = { x + B y : |y| <= 1 },
//!
//! ```text
//! r = |B' n|,  a = b / r,  h = B' n / r,  w = B h
//! x <- x - (1 + D a)/(D + 1) w
//! B <- sqrt(D^2 (1 - a^2)/(D^2 - 1)) (B - (1 - sqrt((D - 1)(1 - a)/((D + 1)(1 + a)))) w h')
//! ```
//!
//! Where a is 1 nothing is left: they are apart. Where x is inside all, what is deeper than x remains to be searched.

use super::part::{Look, Part};
use super::{Depth, Few, MOST, few};
use crate::{Matrix, Scalar, Vector, transposed_times, unit};

/// Most looks, in the plane and in space.
const LOOKS: [u8; 2] = [32, 64];
/// By this share of the ellipsoid's reach a cut is less deep than the numbers say, for they are rounded.
const SLACK: f64 = 0.01;
/// The deepest point is found where no other can be deeper by as much, over the gauge.
const NEARLY: f64 = 0.1;

/// A point that parts have in common, m, and the largest of its gauges there, below one.
pub(super) fn search<S: Scalar, const D: usize>(parts: &[&Part<'_, S, D>], depth: Depth) -> Option<(S, Vector<S, D>)> {
    let start = on_the_way(parts);
    if let Some((x, looks)) = &start
        && let Some(worst) = worst(looks)
        && worst.gauge < depth.enough()
    {
        return Some((worst.gauge, *x));
    }
    let mut left = Ellipsoid::around(parts)?;
    let (mut x, mut looks) = start.unwrap_or_else(|| (left.center, look(parts, &left.center)));
    let (mut best, mut level) = (None, S::one());
    for _ in 0..LOOKS[usize::from(D > 2)] {
        let worst = worst(&looks);
        let gauge = worst.map_or(S::zero(), |look| look.gauge);
        if gauge < level {
            (best, level) = (Some((gauge, x)), gauge);
        }
        let deepest = || worst.is_none_or(|look| left.reach(&look.normal).0 < look.metres * S::from_f64(NEARLY));
        if best.is_some() && (level < depth.enough() || deepest()) {
            break;
        }
        let mut less = false;
        for look in &looks {
            match left.cut(&look.normal, look.beyond(level), &x) {
                Left::Nothing => return best,
                Left::Less => less = true,
                Left::All => {}
            }
        }
        if !less {
            break;
        }
        (x, looks) = (left.center, look(parts, &left.center));
    }
    best
}

/// The one that is least inside.
fn worst<S: Scalar, const D: usize>(looks: &Looks<S, D>) -> Option<&Look<S, D>> {
    looks.iter().reduce(|most, look| if look.gauge > most.gauge { look } else { most })
}

/// How the parts look from x. A part's own centre shows no plane: it is as deep inside as can be.
type Looks<S, const D: usize> = Few<Look<S, D>, MOST>;

fn look<S: Scalar, const D: usize>(parts: &[&Part<'_, S, D>], x: &Vector<S, D>) -> Looks<S, D> {
    few(parts.iter().filter_map(|part| part.look(x)))
}

/// Of two, the point between their centres where both gauges are the same, for most that overlap do so there; and how they look from it,
/// which is as from the other's centre.
fn on_the_way<S: Scalar, const D: usize>(parts: &[&Part<'_, S, D>]) -> Option<(Vector<S, D>, Looks<S, D>)> {
    let [a, b] = parts else { return None };
    if a.is_beyond() || b.is_beyond() {
        return None;
    }
    let (from, to) = (a.obstacle().spec().center, b.obstacle().spec().center);
    let (of_a, of_b) = (a.look(&to)?, b.look(&from)?);
    if !(of_a.metres > S::zero() && of_b.metres > S::zero()) {
        // The way is in no sector of theirs.
        return None;
    }
    let share = of_b.gauge / (of_a.gauge + of_b.gauge);
    let looks = [of_a.nearer(share), of_b.nearer(S::one() - share)];
    Some((from + (to - from) * share, few(looks.into_iter())))
}

/// What is left of an ellipsoid after a cut.
enum Left {
    All,
    Less,
    Nothing,
}

/// { center + size axes y : |y| <= 1 }, m.
struct Ellipsoid<S: Scalar, const D: usize> {
    center: Vector<S, D>,
    /// B, over the size, so that small ones do not lose their digits.
    axes: Matrix<S, D>,
    size: S,
}

impl<S: Scalar, const D: usize> Ellipsoid<S, D> {
    /// One round the smallest obstacle that the parts are of.
    fn around(parts: &[&Part<'_, S, D>]) -> Option<Self> {
        let sizes = parts.iter().map(|part| (part.obstacle().outer(), part.obstacle()));
        let (size, o) = sizes.reduce(|least, part| if part.0 < least.0 { part } else { least })?;
        Some(Self { center: o.spec().center, axes: o.ellipsoid_around() / size, size })
    }

    /// r, m, and h.
    fn reach(&self, normal: &Vector<S, D>) -> (S, Vector<S, D>) {
        let (length, h) = unit(&transposed_times(&self.axes, normal));
        (length * self.size, h)
    }

    /// Only what is behind the plane n.(y - x) = -beyond is of interest.
    fn cut(&mut self, normal: &Vector<S, D>, beyond: S, x: &Vector<S, D>) -> Left {
        let one = S::one();
        let d = S::from_f64(if D == 2 { 2.0 } else { 3.0 });
        let (reach, h) = self.reach(normal);
        let moved = S::dot(normal.as_slice(), (self.center - x).as_slice());
        if !(reach > S::zero()) {
            return Left::Nothing;
        }
        let a = (beyond + moved) / reach - S::from_f64(SLACK);
        if a >= one {
            return Left::Nothing;
        }
        if !(a * d > -one) {
            return Left::All;
        }
        let w = self.axes * h;
        self.center -= w * ((one + d * a) / (d + one) * self.size);
        let flatter = one - ((d - one) * (one - a) / ((d + one) * (one + a))).sqrt();
        let wider = (d * d * (one - a * a) / (d * d - one)).sqrt();
        self.axes = (self.axes - w * h.transpose() * flatter) * wider;
        Left::Less
    }
}
