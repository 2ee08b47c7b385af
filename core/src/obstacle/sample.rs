//! An obstacle as it looks from one point.

use super::Obstacle;
use crate::{Scalar, Vector, times, transposed_times, unit};

/// What the modulation wants to know of an obstacle.
#[derive(Clone, Debug)]
pub(crate) struct Sample<S: Scalar, const D: usize> {
    pub gamma: S,
    /// The shape's normal, of any length that is neither huge nor tiny; zero at the centre. Of a wall it points into the wall, for there it
    /// is that leads away from the reference point: the modulation does not know one side from the other.
    pub outward: Vector<S, D>,
    /// Along r, from the reference point to x; in m but for what is thin in fixed point.
    pub arm: Vector<S, D>,
    /// m/s, growth included.
    pub surface_velocity: Vector<S, D>,
}

/// What the adaptive motion wants to know of the soft layer it is in.
#[derive(Clone, Debug)]
pub(crate) struct SoftLayer<S: Scalar, const D: usize> {
    /// Gamma_k, no less than 1e-9: of a very thick layer's, deep inside, the square would leave the range of f32.
    pub gamma_soft: S,
    /// phi: 0 at the shell, 1 from a thin band on inwards.
    pub fade: S,
    /// n, the unit normal; of a wall inwards.
    pub normal: Vector<S, D>,
    /// Along r, from the reference point to x; in m but for what is thin in fixed point.
    pub arm: Vector<S, D>,
    /// The obstacle's first axis in the world's frame.
    pub first_axis: Vector<S, D>,
    /// In space, the axis about which a fixed side is found, in the world's frame.
    pub leaning: Vector<S, D>,
}

/// How fast phi grows inside the shell, over Gamma_k: within 0.1 of it.
const FADING: f64 = 10.0;

/// That axis in the obstacle's frame: one along which robots seldom approach.
const LEANING: [f64; 3] = [1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0];

impl<S: Scalar, const D: usize> Obstacle<S, D> {
    /// How far the surface that was sampled may come in a step of `dt`, s, and as much again for the curve of its way, m.
    #[inline(always)]
    pub(crate) fn comes(&self, sample: &Sample<S, D>, dt: S) -> S {
        let twice = dt + dt;
        let way = sample.surface_velocity.iter().fold(S::zero(), |sum, s| sum + s.abs()) * twice;
        if self.swells { self.comes_growing(way, twice) } else { way }
    }

    /// What motion and growth come to together at one place says little of others: there they need not cancel.
    #[cold]
    #[inline(never)]
    fn comes_growing(&self, way: S, twice: S) -> S {
        let growth = self.swelling.abs() * twice;
        way + growth + growth
    }

    /// How it looks from x.
    #[inline(always)]
    pub(crate) fn sample(&self, x: &Vector<S, D>) -> Sample<S, D> {
        let away = x - self.spec.center;
        let (gamma, direction) = self.level(&times(&self.scaling, &away));
        // In fixed point what is thin is looked at larger: its normal is too long, and the arm too short, for the range of their products.
        let enlarged = self.enlarged.filter(|_| !S::FLOATS);
        let shape_normal = match enlarged {
            Some((_, smaller)) => transposed_times(&(self.scaling * smaller), &direction),
            None => transposed_times(&self.scaling, &direction),
        };
        let mut surface_velocity = Vector::zeros();
        if self.moves {
            surface_velocity = self.surface_velocity(x);
            if self.swells {
                surface_velocity += unit(&shape_normal).1 * self.swelling;
            }
        }
        let mut arm = away - self.offset;
        if self.leans {
            arm -= self.lean * self.leaning(&shape_normal, &arm);
        }
        if let Some((larger, _)) = enlarged {
            arm *= larger;
        }
        Sample { gamma, outward: shape_normal, arm, surface_velocity }
    }

    /// May a point with this Gamma be in the soft layer, or in the core?
    #[inline(always)]
    pub(crate) fn may_be_soft(&self, gamma: S) -> bool {
        gamma <= self.soft_until
    }

    /// The soft layer at x, where nothing was sampled.
    #[inline(never)]
    pub(crate) fn soft_layer_at(&self, x: &Vector<S, D>) -> Option<SoftLayer<S, D>> {
        self.soft_layer(x, self.sample(x))
    }

    /// The soft layer at x, if x is in it and not in the core, from what was sampled there.
    #[inline(never)]
    pub(crate) fn soft_layer(&self, x: &Vector<S, D>, sample: Sample<S, D>) -> Option<SoftLayer<S, D>> {
        let gamma_soft = self.gamma_soft(x);
        if !(sample.gamma > S::one() && gamma_soft <= S::one()) {
            return None;
        }
        let normal = unit(&sample.outward).1;
        Some(SoftLayer {
            gamma_soft: gamma_soft.max(S::from_f64(1e-9)),
            fade: ((S::one() - gamma_soft) * S::from_f64(FADING)).min(S::one()),
            normal: if self.spec.wall { -normal } else { normal },
            arm: sample.arm,
            leaning: if D == 3 {
                self.spec.rotation * Vector::from_fn(|i, _| S::from_f64(LEANING[i]))
            } else {
                Vector::zeros()
            },
            first_axis: self.spec.rotation.column(0).into_owned(),
        })
    }
}
