//! Problems of every kind: plain, hardly feasible, touching, doubled, nearly parallel, as far as the ball reaches.

use pliant_core::guard::HalfSpace;
use pliant_core::{Scalar, Vector};

/// SplitMix64.
pub struct Random(pub u64);

#[derive(Clone, Debug)]
pub struct Problem<S: Scalar, const D: usize> {
    pub wanted: Vector<S, D>,
    pub sides: Vec<HalfSpace<S, D>>,
    pub speed: S,
    /// Made round a velocity that is allowed, but for rounding.
    pub room: bool,
    /// No two half-spaces meet at a sharp angle but by chance, or exactly.
    pub blunt: bool,
}

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    pub fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// In the unit ball.
    fn inside<const D: usize>(&mut self) -> Vector<f64, D> {
        loop {
            let v = Vector::<f64, D>::from_fn(|_, _| self.between(-1.0, 1.0));
            if v.norm() <= 1.0 && v.norm() > 1e-3 {
                return v;
            }
        }
    }

    fn unit<const D: usize>(&mut self) -> Vector<f64, D> {
        self.inside::<D>().normalize()
    }

    pub fn shuffle<T>(&mut self, list: &mut [T]) {
        for i in (1..list.len()).rev() {
            list.swap(i, self.below(i + 1));
        }
    }

    /// Of one to `most` half-spaces; every number rounded to `S`.
    pub fn problem<S: Scalar, const D: usize>(&mut self, most: usize) -> Problem<S, D> {
        // Within the range of fixed point, and not so slow that nothing is left of it there.
        let (slowest, farthest) = if S::FLOATS { (1e-6, 1000.0) } else { (0.1, 300.0) };
        let speed = [0.5, 0.5, 1.0, 3.0, 0.02, 1e-6f64][self.below(6)].max(slowest);
        let wanted = match self.below(6) {
            0 => Vector::zeros(),
            1 => self.unit() * speed,
            2 => self.inside() * (5.0 * speed),
            _ => self.inside() * speed,
        };
        let middle = self.inside::<D>() * speed;
        let axis = self.unit::<D>();
        let spread = 10f64.powf(self.between(-8.0, 0.0));
        let kind = self.below(9);
        let count = 1 + self.below(most);
        let mut sides: Vec<(Vector<f64, D>, f64)> = Vec::new();
        while sides.len() < count {
            let n = match kind {
                5 => (axis + self.inside() * spread).normalize() * if self.below(2) == 0 { 1.0 } else { -1.0 },
                6 => (axis + self.inside() * spread).normalize(),
                _ => self.unit(),
            };
            let b = match kind {
                0 => self.between(-1.1, 0.4) * speed,
                // Somewhere there is room: a lot, none, or as good as none.
                1 => n.dot(&middle) - self.between(0.0, 0.5) * speed,
                2 => n.dot(&middle),
                3 => n.dot(&middle) + self.between(-1.0, 1.0) * spread * speed,
                // As far as the ball reaches, and a little farther.
                4 => speed * (1.0 + self.between(-1.0, 1.0) * spread),
                7 => self.between(-3.0, 3.0) * speed,
                8 => self.between(-1.0, farthest) * speed,
                _ => n.dot(&middle) - self.between(-0.1, 1.0) * spread * speed,
            };
            sides.push((n, b));
            if self.below(8) == 0 {
                let (n, b) = sides[self.below(sides.len())];
                sides.push(match self.below(3) {
                    0 => (n, b),
                    1 if kind == 2 => (-n, -n.dot(&middle)),
                    1 if kind != 1 => (-n, -b),
                    _ => (n, b - self.between(0.0, 0.1) * speed),
                });
            }
        }
        self.shuffle(&mut sides);
        let round = |v: Vector<f64, D>| v.map(S::from_f64);
        Problem {
            wanted: round(wanted),
            sides: sides.into_iter().map(|(n, b)| HalfSpace { normal: round(n), offset: S::from_f64(b) }).collect(),
            speed: S::from_f64(speed),
            room: matches!(kind, 1 | 2),
            blunt: !matches!(kind, 5 | 6) || spread > 1e-2,
        }
    }
}
