//! Seeded numbers.

use crate::Number;
use crate::number::ONE;
use pliant_core::{Matrix, Vector, rotation};

/// Marsaglia's xorshift with 64 bits of state, its upper half taken: cheap on a 32-bit core, and good enough to throw obstacles about.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Each seed its own sequence.
    pub fn new(seed: u32) -> Self {
        // Neighbouring seeds would begin alike.
        let mut state = u64::from(seed).wrapping_add(0x9e37_79b9_7f4a_7c15);
        state = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        state = (state ^ (state >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        Self((state ^ (state >> 31)) | 1)
    }

    /// 32 bits.
    pub fn bits(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 32) as u32
    }

    /// From 0 to below `n`.
    pub fn below(&mut self, n: u32) -> u32 {
        ((u64::from(self.bits()) * u64::from(n)) >> 32) as u32
    }

    /// In one of `n` cases.
    pub fn one_in(&mut self, n: u32) -> bool {
        self.below(n) == 0
    }

    /// From `low` to `high`, both in thousandths.
    pub fn between<S: Number>(&mut self, low: i32, high: i32) -> S {
        let units = |thousandths: i32| thousandths * ONE / 1000;
        let (low, high) = (units(low), units(high));
        S::units(low + self.below((high - low + 1).unsigned_abs()) as i32)
    }

    /// Each entry as [`Random::between`].
    pub fn vector<S: Number, const D: usize>(&mut self, low: i32, high: i32) -> Vector<S, D> {
        Vector::from_fn(|_, _| self.between(low, high))
    }

    /// A direction, of no particular length.
    pub fn direction<S: Number, const D: usize>(&mut self) -> Vector<S, D> {
        let mut v: Vector<S, D> = self.vector(-1000, 1000);
        if self.one_in(4) {
            // Along an axis, where symmetric shapes are special.
            let axis = self.below(D as u32) as usize;
            v = Vector::from_fn(|i, _| if i == axis { v[i] } else { S::zero() });
        }
        if v.iter().all(|x| x.abs() < S::units(64)) { Vector::from_element(S::one()) } else { v }
    }

    /// A skew matrix, entries up to `thousandths`.
    pub fn skew<S: Number, const D: usize>(&mut self, thousandths: i32) -> Matrix<S, D> {
        let mut skew = Matrix::zeros();
        for i in 0..D {
            for j in 0..i {
                let x: S = self.between(-thousandths, thousandths);
                (skew[(i, j)], skew[(j, i)]) = (x, -x);
            }
        }
        skew
    }

    /// A rotation by some angle.
    pub fn rotation<S: Number, const D: usize>(&mut self) -> Matrix<S, D> {
        let spin = self.skew(1500);
        rotation::turned(&rotation::turned(&Matrix::identity(), &spin, S::one()), &spin, S::one())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_kept_and_met() {
        let mut random = Random::new(1);
        let all: [f32; 2000] = core::array::from_fn(|_| random.between(-20, 30));
        assert!(all.iter().all(|x| (-0.0201..=0.0301).contains(x)));
        assert!(all.iter().any(|x| *x < -0.019) && all.iter().any(|x| *x > 0.029));
    }

    #[test]
    fn rotations_are_rotations() {
        let mut random = Random::new(2);
        for _ in 0..100 {
            let q = random.rotation::<f64, 3>();
            assert!((q.transpose() * q - Matrix::<f64, 3>::identity()).amax() < 1e-9);
        }
    }
}
