//! How an obstacle moves, turns, grows and ages between two sightings.

use super::Obstacle;
use crate::{Matrix, Scalar, Vector, is_zero, rotation};

/// Where scaled coordinates are steeper than this, 1/m, the products of a normal or an arm with velocities may leave fixed point's range.
const STEEP: f64 = 16.0;

/// By a power of two, for that is exact.
fn enlarged<S: Scalar>(steepest: S) -> Option<(S, S)> {
    let half = S::from_f64(0.5);
    let (mut larger, mut smaller, mut steep) = (S::one(), S::one(), steepest);
    // The steepest there is, 500 per metre and what shrinks below that, is left far behind.
    while steep > S::from_f64(STEEP) && smaller > S::from_f64(1.0 / 16384.0) {
        (larger, smaller, steep) = (larger + larger, smaller * half, steep * half);
    }
    (smaller < S::one()).then_some((larger, smaller))
}

impl<S: Scalar, const D: usize> Obstacle<S, D> {
    /// Does it move, turn or grow?
    #[inline(always)]
    pub(crate) fn moves(&self) -> bool {
        self.moves
    }

    /// Carries pose and size on by `dt` seconds, but for ageing.
    #[inline(always)]
    pub(crate) fn advance(&mut self, dt: S) {
        self.carry_on(dt, S::zero());
    }

    /// The same, and makes the core larger by ageing, at the rate it [`ages`](Self::ages) at. The soft layer stays
    /// where it is: margin wins over softness.
    #[inline(always)]
    pub(crate) fn advance_and_age(&mut self, dt: S) {
        self.carry_on(dt, self.ageing);
    }

    #[inline(always)]
    fn carry_on(&mut self, dt: S, rate: S) {
        if !self.moves {
            return;
        }
        let ages = rate != S::zero();
        self.spec.center += self.spec.velocity * dt;
        if self.spins {
            self.spec.rotation = rotation::turned(&self.spec.rotation, &self.spec.spin, dt);
        }
        if ages {
            self.aged += rate * dt;
        }
        // What follows from pose and size is found once, whatever has changed.
        if self.spec.growth != S::zero() {
            self.grown += self.spec.growth * dt;
            self.rescale();
        } else if ages {
            self.inflate();
        } else if self.spins {
            self.pose_changed();
        }
    }

    /// Carries pose and size on by a time that may be long: in steps that turn it little, at most 100.
    pub(crate) fn carry(&mut self, time: S) {
        let fastest = self.spec.spin.iter().fold(S::zero(), |m, x| m.max(x.abs()));
        let wanted = fastest * time * S::from_f64(20.0);
        let mut steps = S::one();
        while steps < wanted && steps < S::from_f64(100.0) {
            steps += S::one();
        }
        let mut left = steps;
        while left > S::zero() {
            self.advance(time / steps);
            left -= S::one();
        }
    }

    /// Makes the core larger by ageing alone, for `dt` seconds.
    pub(crate) fn age(&mut self, dt: S) {
        self.aged += self.ageing * dt;
        self.inflate();
    }

    /// From now on it grows by ageing, at `rate` m/s: what its surface velocity says, and what
    /// [`advance_and_age`](Self::advance_and_age) does.
    pub(crate) fn ages(&mut self, rate: S) {
        if rate != self.ageing {
            self.ageing = rate;
            self.set_speeds();
        }
    }

    /// Stops all motion: nobody knows any more.
    pub(crate) fn hold(&mut self) {
        if !self.moves {
            return;
        }
        self.spec.velocity = Vector::zeros();
        self.spec.spin = Matrix::zeros();
        (self.spec.growth, self.ageing) = (S::zero(), S::zero());
        self.set_speeds();
    }

    /// All that follows from the size.
    pub(super) fn rescale(&mut self) {
        let (one, zero) = (S::one(), S::zero());
        let shortest = self.extent.iter().fold(S::MAX, |m, x| m.min(*x));
        // A shrinking body ends as one with the least semi-extent there may be.
        let floor = S::MIN_AXIS - shortest;
        if self.grown <= floor {
            self.grown = floor;
            self.spec.growth = self.spec.growth.max(zero);
            self.set_speeds();
        }
        // Lengths, for in fixed point how many times as large it is may be out of range.
        let size = self.per_metre.zip_map(&self.extent, |more, a| (a + self.grown) * more);
        let wall = self.spec.wall;
        let scaled = |ratio: &Vector<S, D>| size.zip_map(ratio, |l, ratio| if wall { l / ratio } else { l * ratio });
        self.young = scaled(&self.spec.margin);
        self.soft = scaled(&self.spec.soft_ratio).map(|l| one / l);
        // Ageing makes the layer thinner, so what is found without it holds.
        self.hard = self.young.map(|l| one / l);
        self.soft_until = self.soft_reach();
        self.inflate();
    }

    /// The hard core's scale, with what ageing adds to it. Of a wall's free space something is left.
    fn inflate(&mut self) {
        let (aged, one) = (self.aged, S::one());
        let wall = self.spec.wall;
        let lengths = self.young.zip_map(&self.per_metre, |l, more| {
            if wall { (l - aged * more).max(l * S::from_f64(0.1)) } else { l + aged * more }
        });
        self.hard = lengths.map(|l| one / l);
        if !S::FLOATS {
            self.enlarged = enlarged(self.steepest());
        }
        self.slimmest = self.hard.iter().fold(S::zero(), |m, x| m.max(*x)) * self.inner;
        // No body below 1 m is large enough for that, in any number.
        if self.hard.iter().any(|inverse| *inverse < one) || self.blur > S::zero() {
            self.blur_changed(&lengths);
        }
        self.pose_changed();
    }

    /// How much nearer the surface counts.
    #[inline(never)]
    fn blur_changed(&mut self, lengths: &Vector<S, D>) {
        self.blur = crate::guard::blur(lengths.iter().fold(S::zero(), |m, l| m.max(*l)));
        self.rim = S::one() + self.blur * self.slimmest;
    }

    /// How the surface moves, and whether anything does.
    pub(super) fn set_speeds(&mut self) {
        let zero = S::zero();
        let (grows, wall) = (self.spec.growth, self.spec.wall);
        // Towards free space the surface moves no faster than this, and away from it no slower.
        let (most, least) = (self.most, self.least);
        let ageing = if wall { -self.ageing } else { self.ageing };
        // A safety factor is one on the growth as well; of a wall it divides.
        let eta = self.spec.margin.iter().fold(S::one(), |m, eta| m.max(*eta));
        let retreats = (grows > zero) == wall;
        let eta = match (wall, retreats) {
            (false, false) => eta,
            (true, true) => S::one() / eta,
            _ => S::one(),
        };
        self.swelling = ageing * most + grows * eta * if retreats { least } else { most };
        self.swells = self.swelling != S::zero();
        self.spins = !is_zero(&self.spec.spin);
        self.moves = self.spins || !is_zero(&self.spec.velocity) || grows != zero || self.ageing != zero;
        self.sort();
    }

    /// The Gamma beyond which no point is in the soft layer.
    fn soft_reach(&self) -> S {
        let ratio = self.hard.zip_map(&self.soft, |hard, soft| if self.spec.wall { soft / hard } else { hard / soft });
        let most = ratio.iter().fold(S::zero(), |m, x| m.max(*x));
        if !(most > S::one()) {
            return S::zero();
        }
        (most * most).powi(self.body.power()) * S::from_f64(1.001)
    }
}
