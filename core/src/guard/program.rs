//! The velocity nearest to the wanted one in an intersection of half-spaces and a ball.
//!
//! The incremental scheme known from ORCA (van den Berg et al. 2011), with the most violated half-space always next: if the
//! best velocity so far violates a half-space, then the best one that does not lies on its boundary, and what is left is the
//! same question in one dimension less, among the half-spaces met before. Usually one to three of them matter.
//!
//! Where nothing is allowed, the least violation t is found by the same scheme: t equals the violation of the half-space i met
//! last, so the others ask for (n_j - n_i).u >= b_j - b_i, and the best velocity is the farthest along n_i.

use crate::{Matrix, RANGE, Scalar, Vector, norm, unit};

/// The velocities `{ u : normal.u >= offset }`, D entries in the world's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace<S: Scalar, const D: usize> {
    /// Unit vector into the half-space.
    pub normal: Vector<S, D>,
    /// Least speed along the normal, m/s.
    pub offset: S,
}

impl<S: Scalar, const D: usize> HalfSpace<S, D> {
    /// How far a velocity is outside, m/s; negative inside.
    fn violation(&self, velocity: &Vector<S, D>) -> S {
        self.offset - self.normal.dot(velocity)
    }

    /// Does it exclude anything in a direction that can be told?
    fn has_side(&self) -> bool {
        self.normal.dot(&self.normal) > S::from_f64(0.25) && self.offset.abs() <= S::MAX
    }
}

/// What [`nearest`] found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution<S: Scalar, const D: usize> {
    /// The velocity to go on with, m/s.
    pub velocity: Vector<S, D>,
    /// Is it another than the wanted one?
    pub changed: bool,
    /// How far it is outside the half-space it violates most, m/s; zero where there is a velocity that violates none.
    pub violation: S,
    /// Is there a velocity that violates none?
    pub feasible: bool,
}

impl<S: Scalar, const D: usize> Solution<S, D> {
    /// A velocity that violates none.
    pub(super) fn found(velocity: Vector<S, D>, wanted: &Vector<S, D>) -> Self {
        Self { velocity, changed: velocity != *wanted, violation: S::zero(), feasible: true }
    }
}

/// The velocity nearest to `wanted` (m/s) in all half-spaces and the ball |u| <= `speed` (m/s):
///
/// ```text
/// min |u - wanted|   over   n_i.u >= b_i for every i,   |u| <= speed
/// ```
///
/// Where there is none, the ball stays and every offset is lowered by the same t, the least that leaves a velocity. Half-spaces
/// are satisfied to within 64 epsilon `speed`, which is what rounding may cost (in fixed point, 64 steps of the number), and a
/// set of them that leaves nothing by less than that counts as feasible. A half-space without a direction (a normal of zero) or
/// with an entry that is not a number is ignored; a `wanted` that is not finite counts as zero. The half-spaces may be left in
/// another order; which one they came in does not matter to the result, but to rounding.
///
/// Found exactly, by the incremental scheme known from ORCA (van den Berg et al. 2011), with the most violated
/// half-space always next. No errors: there is always an answer, and [`Solution::feasible`] says of which kind.
///
/// ```
/// use pliant_core::Vector;
/// use pliant_core::guard::{HalfSpace, nearest};
/// let wall = HalfSpace { normal: Vector::<f64, 2>::new(-1.0, 0.0), offset: -0.1 };
/// let found = nearest(&Vector::<f64, 2>::new(0.4, 0.3), &mut [wall], 0.5);
/// assert!(found.changed && found.feasible);
/// assert!((found.velocity - Vector::<f64, 2>::new(0.1, 0.3)).norm() < 1e-15);
/// ```
pub fn nearest<S: Scalar, const D: usize>(
    wanted: &Vector<S, D>,
    half_spaces: &mut [HalfSpace<S, D>],
    speed: S,
) -> Solution<S, D> {
    let best = least(wanted, half_spaces, speed);
    if best.feasible { best } else { nearest_of_least(wanted, half_spaces, speed, best) }
}

/// The same as [`nearest`], but where there is none, any velocity of those with the least violation.
pub(super) fn least<S: Scalar, const D: usize>(
    wanted: &Vector<S, D>,
    half_spaces: &mut [HalfSpace<S, D>],
    speed: S,
) -> Solution<S, D> {
    let speed = if speed > S::zero() { speed } else { S::zero() };
    let (goal, start) = within_ball(wanted, speed);
    let Some(half_spaces) = violated(&start, half_spaces, speed) else {
        return Solution::found(start, wanted);
    };
    if let Some(velocity) = within_all(goal, start, half_spaces, speed) {
        return Solution::found(velocity, wanted);
    }
    let velocity = least_violation(start, half_spaces, speed);
    let violation = worst(half_spaces, &velocity);
    let best = Solution { velocity, changed: velocity != *wanted, violation, feasible: false };
    // What is missed by no more than rounding is not missed.
    if violation > margin(speed) {
        return best;
    }
    let nearer = nearest_of_least(wanted, half_spaces, speed, best);
    Solution::found(if nearer.violation <= margin(speed) { nearer.velocity } else { velocity }, wanted)
}

/// Of all velocities that violate no half-space by more than this one, which violates them least, the nearest to the wanted one.
pub(super) fn nearest_of_least<S: Scalar, const D: usize>(
    wanted: &Vector<S, D>,
    half_spaces: &mut [HalfSpace<S, D>],
    speed: S,
    best: Solution<S, D>,
) -> Solution<S, D> {
    let speed = if speed > S::zero() { speed } else { S::zero() };
    let (goal, start) = within_ball(wanted, speed);
    let half_spaces = with_sides(half_spaces);
    let tolerance = coarsest(half_spaces, speed);
    let most = best.violation + tolerance;
    let nearer = Programme::nearest(goal, start, speed, most, tolerance).solve(half_spaces);
    let violated = |velocity: Vector<S, D>| {
        let violation = worst(half_spaces, &velocity);
        Solution { velocity, changed: velocity != *wanted, violation, feasible: false }
    };
    nearer.map(violated).filter(|nearer| nearer.violation <= most + tolerance).unwrap_or(best)
}

/// The same as [`nearest`], and nothing where there is none.
pub(super) fn allowed<S: Scalar, const D: usize>(
    wanted: &Vector<S, D>,
    half_spaces: &mut [HalfSpace<S, D>],
    speed: S,
) -> Option<Vector<S, D>> {
    let (goal, start) = within_ball(wanted, speed);
    match violated(&start, half_spaces, speed) {
        Some(half_spaces) => within_all(goal, start, half_spaces, speed),
        None => Some(start),
    }
}

/// The half-spaces that have a side, if a velocity violates one of them.
fn violated<'a, S: Scalar, const D: usize>(
    velocity: &Vector<S, D>,
    half_spaces: &'a mut [HalfSpace<S, D>],
    speed: S,
) -> Option<&'a mut [HalfSpace<S, D>]> {
    let tolerance = rounding(speed);
    half_spaces.iter().any(|h| h.violation(velocity) > tolerance).then(|| with_sides(half_spaces))
}

/// The velocity nearest to the goal that violates none; `start` is the one in the ball.
fn within_all<S: Scalar, const D: usize>(
    goal: Vector<S, D>,
    start: Vector<S, D>,
    half_spaces: &mut [HalfSpace<S, D>],
    speed: S,
) -> Option<Vector<S, D>> {
    // What asks for more than the speed is fulfilled by none.
    let most = speed + margin(speed);
    if half_spaces.iter().any(|h| h.offset > most) {
        return None;
    }
    let velocity = Programme::nearest(goal, start, speed, S::zero(), rounding(speed)).solve(half_spaces)?;
    (worst(half_spaces, &velocity) <= margin(speed)).then_some(velocity)
}

/// By how much a half-space may be missed.
fn margin<S: Scalar>(speed: S) -> S {
    rounding(speed) * S::from_f64(4.0)
}

/// The wanted velocity itself, cut down to a length one can calculate with, and the one nearest to it in the ball.
fn within_ball<S: Scalar, const D: usize>(wanted: &Vector<S, D>, speed: S) -> (Vector<S, D>, Vector<S, D>) {
    let range = S::from_f64(RANGE);
    let largest = wanted.iter().fold(S::zero(), |m, x| if x.abs() <= m { m } else { x.abs() });
    let goal = if largest <= range {
        *wanted
    } else if largest.is_finite() {
        wanted / largest * range
    } else {
        Vector::zeros()
    };
    // A velocity just limited to this speed, longer only by rounding, is to stay what it is.
    let limit = speed + rounding(speed);
    let length = norm(&goal);
    if length <= limit {
        return (goal, goal);
    }
    // In fixed point a small share of a large goal has few digits.
    (goal, if S::FLOATS { goal * (speed / length) } else { unit(&goal).1 * speed })
}

/// What rounding may do to a scalar product with a unit vector, for velocities of this size. In fixed point the error does not
/// shrink with the numbers.
fn rounding<S: Scalar>(size: S) -> S {
    let relative = S::EPSILON * S::from_f64(16.0);
    if S::FLOATS { relative * size } else { relative }
}

/// The half-spaces that have a side, moved to the front.
fn with_sides<S: Scalar, const D: usize>(half_spaces: &mut [HalfSpace<S, D>]) -> &mut [HalfSpace<S, D>] {
    let mut rest = half_spaces.iter_mut();
    let mut count = 0;
    while let Some(h) = rest.next() {
        if !h.has_side() {
            let Some(last) = rest.rfind(|other| other.has_side()) else { break };
            core::mem::swap(h, last);
        }
        count += 1;
    }
    half_spaces.get_mut(..count).unwrap_or_default()
}

/// The largest violation, or zero.
fn worst<S: Scalar, const D: usize>(half_spaces: &[HalfSpace<S, D>], velocity: &Vector<S, D>) -> S {
    half_spaces.iter().fold(S::zero(), |m, h| m.max(h.violation(velocity)))
}

/// The most violated half-space moved to the front, if its violation is above `bound`.
fn worst_first<S: Scalar, const D: usize>(
    half_spaces: &mut [HalfSpace<S, D>],
    velocity: &Vector<S, D>,
    bound: S,
) -> Option<HalfSpace<S, D>> {
    let (first, others) = half_spaces.split_first_mut()?;
    let mut largest = first.violation(velocity);
    let mut found = None;
    for h in others {
        let violation = h.violation(velocity);
        if violation > largest {
            (largest, found) = (violation, Some(h));
        }
    }
    if !(largest > bound) {
        return None;
    }
    if let Some(h) = found {
        core::mem::swap(first, h);
    }
    Some(*first)
}

/// What rounding may do to any violation there may be: whatever the least one is, t, no offset is above speed + t.
fn coarsest<S: Scalar, const D: usize>(half_spaces: &[HalfSpace<S, D>], speed: S) -> S {
    rounding(half_spaces.iter().fold(speed, |m, h| m.max(h.offset)))
}

/// A velocity in the ball whose largest violation is least.
fn least_violation<S: Scalar, const D: usize>(
    start: Vector<S, D>,
    half_spaces: &mut [HalfSpace<S, D>],
    speed: S,
) -> Vector<S, D> {
    let tolerance = coarsest(half_spaces, speed);
    let mut velocity = start;
    let mut least = S::zero();
    for active in 0..half_spaces.len() {
        let Some((done, rest)) = half_spaces.split_at_mut_checked(active) else { break };
        let Some(h) = worst_first(rest, &velocity, least + tolerance) else { break };
        // There is always a velocity; if rounding hides it, then the gain is no larger than rounding.
        let Some(better) = Programme::lowest(h, speed, tolerance).solve(done) else { break };
        velocity = better;
        least = h.violation(&velocity).max(S::zero());
    }
    velocity
}

/// What makes a velocity the best.
enum Goal<S: Scalar, const D: usize> {
    /// To be near to this one.
    Near(Vector<S, D>),
    /// To be far along this direction.
    Along(Vector<S, D>),
}

/// The best velocity in the ball of which no half-space is violated more than `level`.
struct Programme<S: Scalar, const D: usize> {
    goal: Goal<S, D>,
    /// The best velocity in all of the ball.
    best: Vector<S, D>,
    /// Its own violation is what is allowed to the others: an offset alone is the same everywhere.
    level: HalfSpace<S, D>,
    speed: S,
    tolerance: S,
}

/// The part of a line, plane or space through the ball's inside.
struct Flat<S: Scalar, const D: usize> {
    dimension: usize,
    /// The centre of that part: the point nearest to zero.
    centre: Vector<S, D>,
    radius: S,
    /// Takes any vector to its part along the flat.
    along: Matrix<S, D>,
}

impl<S: Scalar, const D: usize> Flat<S, D> {
    /// The direction of a vector's part along the flat; `None` where that part is not longer than `least`.
    ///
    /// What rounding leaves of a small part need not lie along the flat, and a velocity moved that way would leave it: so the
    /// part is taken again, of the unit vector.
    fn direction(&self, part: &Vector<S, D>, least: S) -> Option<Vector<S, D>> {
        let (length, direction) = unit(part);
        if !(length > least) {
            return None;
        }
        let unit = self.along * direction;
        let squared = unit.dot(&unit);
        let rounding = S::EPSILON * S::from_f64(4.0);
        if (squared - S::one()).abs() <= rounding {
            return Some(unit);
        }
        (squared > S::from_f64(0.01)).then(|| unit / norm(&unit))
    }
}

/// The part of a unit vector along a flat that is no longer than this is rounding.
fn indistinct<S: Scalar>() -> S {
    S::EPSILON * S::from_f64(4.0)
}

impl<S: Scalar, const D: usize> Programme<S, D> {
    fn nearest(goal: Vector<S, D>, best: Vector<S, D>, speed: S, violation: S, tolerance: S) -> Self {
        let level = HalfSpace { normal: Vector::zeros(), offset: violation };
        Self { goal: Goal::Near(goal), best, level, speed, tolerance }
    }

    fn lowest(level: HalfSpace<S, D>, speed: S, tolerance: S) -> Self {
        let best = level.normal / norm(&level.normal) * speed;
        Self { goal: Goal::Along(level.normal), best, level, speed, tolerance }
    }

    fn solve(&self, half_spaces: &mut [HalfSpace<S, D>]) -> Option<Vector<S, D>> {
        if half_spaces.is_empty() {
            return Some(self.best);
        }
        let (centre, along) = (Vector::zeros(), Matrix::identity());
        self.solve_on(&Flat { dimension: D, centre, radius: self.speed, along }, self.best, half_spaces)
    }

    /// The best velocity on a flat, whose best whatever the half-spaces is known; `None` where there is none. Calls itself at most D deep.
    fn solve_on(
        &self,
        flat: &Flat<S, D>,
        best: Vector<S, D>,
        half_spaces: &mut [HalfSpace<S, D>],
    ) -> Option<Vector<S, D>> {
        let mut velocity = best;
        for active in 0..half_spaces.len() {
            let (done, rest) = half_spaces.split_at_mut_checked(active)?;
            let bound = self.level.violation(&velocity) + self.tolerance;
            let Some(h) = worst_first(rest, &velocity, bound) else { break };
            let boundary = self.cut(flat, &h)?;
            let best = self.best_on(&boundary);
            velocity = if done.is_empty() { best } else { self.solve_on(&boundary, best, done)? };
        }
        Some(velocity)
    }

    /// The best velocity on a flat, whatever the half-spaces.
    fn best_on(&self, flat: &Flat<S, D>) -> Vector<S, D> {
        if flat.dimension == 0 {
            return flat.centre;
        }
        let direction = match &self.goal {
            Goal::Near(goal) => {
                // Twice, for a goal far off is rounded to more than its part along a small flat may be.
                let step = flat.along * (flat.along * goal);
                // Not their squares: in fixed point those of a large speed do not fit, and those of a small one have no digits.
                if norm(&step) <= flat.radius {
                    return flat.centre + step;
                }
                flat.direction(&step, S::zero())
            }
            Goal::Along(direction) => flat.direction(&(flat.along * direction), indistinct()),
        };
        // Across a direction all are as good.
        direction.map_or(flat.centre, |direction| flat.centre + direction * flat.radius)
    }

    /// The part of a flat on the boundary of a half-space that is violated somewhere on it; `None` if it is everywhere.
    fn cut(&self, flat: &Flat<S, D>, h: &HalfSpace<S, D>) -> Option<Flat<S, D>> {
        let dimension = flat.dimension.checked_sub(1)?;
        let normal = h.normal - self.level.normal;
        let across = flat.direction(&(flat.along * normal), indistinct())?;
        let slope = normal.dot(&across);
        if !(slope > indistinct()) {
            return None;
        }
        let gap = h.offset - self.level.offset - normal.dot(&flat.centre);
        let radius = flat.radius;
        if !(gap.abs() - radius * slope <= self.tolerance) {
            return None;
        }
        let shift = if gap.abs() < radius * slope {
            gap / slope
        } else if gap < S::zero() {
            -radius
        } else {
            radius
        };
        Some(Flat {
            dimension,
            centre: flat.centre + across * shift,
            radius: S::other_leg(radius, shift),
            along: flat.along - across * across.transpose(),
        })
    }
}
