//! The P that demands least of the demonstrations, and the nearest paths along which its V falls.
//!
//! Where a demonstration moves away from the attractor in P's metric, no motion with this certificate can follow it. How much that costs is
//! known before anything is fitted: sqrt(V) e^(sigma t) may never rise, so the nearest sequence that does not (isotonic regression) says how far
//! the path has to give way, and the half space of falling V how much the velocity has to. P is where these cost least. What is learnt are the
//! paths that give way: they can be followed, and so their velocities belong together.

use super::fit::{MAX_CONDITION, condition};
use super::gmm::cholesky;
use super::refine::Path;
use nalgebra::{DMatrix, DVector, SMatrix, SVector};

/// A demonstration in normalised units, thinned.
#[derive(Debug, Clone)]
pub struct Track<const D: usize> {
    /// Positions.
    pub x: Vec<SVector<f64, D>>,
    /// Velocities.
    pub v: Vec<SVector<f64, D>>,
    /// Time of each sample.
    pub t: Vec<f64>,
    /// How far it was shifted to end at the attractor.
    pub shift: f64,
}

impl<const D: usize> Track<D> {
    /// How far the direction at x is to be believed, 0 to 1. Seen from the attractor, the shift has turned it by about shift/|x|, which is much where
    /// x is close; the square of that is its variance.
    pub fn belief(&self, x: &SVector<f64, D>) -> f64 {
        let close = KNOWN * KNOWN * x.norm_squared();
        if self.shift > 0.0 { close / (close + self.shift * self.shift) } else { 1.0 }
    }

    /// The path from where rollouts begin.
    pub fn after_start(&self) -> Path<D> {
        let first = self.x.len() / 50;
        Path { x: self.x[first..].to_vec(), duration: self.t[self.t.len() - 1] - self.t[first] }
    }
}

/// Reference paths and velocities fall a little faster than the rate asked for, so that they lie inside the certificate.
pub const INSIDE: f64 = 1.1;
/// A direction that is known to this angle, in radians, counts half.
const KNOWN: f64 = 0.02;

/// Relative importance: a path error of one extent, a velocity error of the mean speed, a direction error.
const PATH: f64 = 10.0;
const DIRECTION: f64 = 4.0;
/// Far is worse than in proportion.
const FAR: f64 = 30.0;
/// Weight of the samples where rollouts begin, against all others together.
const PINNED: f64 = 100.0;
/// Where a path is pressed flat it is followed at this part of the speed that was shown, or faster.
const SLOWEST: f64 = 0.33;
/// Distance from the attractor, in extents, below which ratios of V say nothing.
const CLOSE: f64 = 1e-3;

/// The nearest non-increasing sequence, in weighted least squares (pool adjacent violators).
fn non_increasing(z: &mut [f64], weight: &[f64], blocks: &mut Vec<(f64, f64, usize)>) {
    blocks.clear();
    for (&z, &w) in z.iter().zip(weight) {
        let mut block = (z, w, 1);
        while let Some(&(value, other, count)) = blocks.last() {
            if value >= block.0 {
                break;
            }
            let sum = other + block.1;
            block = ((value * other + block.0 * block.1) / sum, sum, count + block.2);
            blocks.pop();
        }
        blocks.push(block);
    }
    let mut rest = z.iter_mut();
    for &(value, _, count) in blocks.iter() {
        rest.by_ref().take(count).for_each(|z| *z = value);
    }
}

/// Room for the intermediate results, so that a search allocates once.
#[derive(Default)]
struct Scratch {
    z: Vec<f64>,
    before: Vec<f64>,
    weight: Vec<f64>,
    blocks: Vec<(f64, f64, usize)>,
}

impl Scratch {
    /// log sqrt(V) + sigma t before and after, and the distance a unit of it stands for times the length it counts for.
    fn level<const D: usize>(&mut self, track: &Track<D>, p: &SMatrix<f64, D, D>, sigma: f64) {
        self.z.clear();
        self.weight.clear();
        let n = track.x.len();
        for i in 0..n {
            let px = p * track.x[i];
            let v = track.x[i].dot(&px).max(CLOSE * CLOSE);
            self.z.push(0.5 * v.ln() + sigma * track.t[i]);
            let reach = v / px.norm().max(CLOSE);
            let length = (track.x[(i + 1).min(n - 1)] - track.x[i.saturating_sub(1)]).norm();
            self.weight.push(reach * reach * (length + 1e-4) + 1e-12);
        }
        // Rollouts begin where the demonstration did: the first samples do not give way.
        let pinned = PINNED * self.weight.iter().sum::<f64>();
        for w in self.weight.iter_mut().take(n / 50 + 1) {
            *w = pinned;
        }
        self.before.clear();
        self.before.extend_from_slice(&self.z);
        non_increasing(&mut self.z, &self.weight, &mut self.blocks);
    }
}

/// What P costs.
fn price<const D: usize>(tracks: &[Track<D>], p: &SMatrix<f64, D, D>, sigma: f64, scratch: &mut Scratch) -> f64 {
    let (mut away, mut total, mut slower, mut turned, mut count) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for track in tracks {
        scratch.level(track, p, sigma);
        for (i, (x, v)) in track.x.iter().zip(&track.v).enumerate() {
            let px = p * x;
            let size = px.norm().max(1e-9);
            let reach = x.dot(&px) / size;
            let length = if i > 0 { (x - track.x[i - 1]).norm() } else { 0.0 };
            away += length * reach * ((scratch.z[i] - scratch.before[i]).exp() - 1.0).abs();
            total += length;
            let excess = (px.dot(v) / size + sigma * reach).max(0.0);
            slower += excess;
            let sine = (excess / v.norm().max(1e-9)).min(1.0);
            turned += 1.0 - (1.0 - sine * sine).sqrt();
            count += 1.0;
        }
    }
    let away = away / f64::max(total, 1e-9);
    PATH * away * (1.0 + FAR * away) + (slower + DIRECTION * turned) / f64::max(count, 1.0)
}

/// P of least price: from the identity, from a grid of stretched ones and from those of the linear motion nearest to what was shown, by a
/// pattern search.
pub fn search<const D: usize>(tracks: &[Track<D>], sigma: f64) -> SMatrix<f64, D, D> {
    let mut scratch = Scratch::default();
    let mut best = (f64::INFINITY, SMatrix::<f64, D, D>::identity());
    let mut offer = |best: &mut (f64, SMatrix<f64, D, D>), p: SMatrix<f64, D, D>| {
        let p = (p + p.transpose()) * (0.5 * D as f64 / p.trace());
        if condition(&p) > MAX_CONDITION {
            return false;
        }
        let cost = price(tracks, &p, sigma, &mut scratch);
        let better = cost < best.0;
        if better {
            *best = (cost, p);
        }
        better
    };
    offer(&mut best, SMatrix::identity());
    for direction in directions::<D>() {
        for stretch in [0.02, 0.05, 0.15, 0.4, 2.5, 7.0, 20.0, 50.0] {
            offer(&mut best, SMatrix::identity() + direction * direction.transpose() * (stretch - 1.0));
        }
    }
    for p in of_nearest_linear(tracks) {
        offer(&mut best, p);
    }
    let mut step = 0.3;
    while step > 0.003 {
        let mut better = false;
        for r in 0..D {
            for c in r..D {
                for sign in [1.0, -1.0] {
                    // A step in the metric of P itself: L (I + h E)^2 L'.
                    let Some(l) = cholesky(&best.1) else { continue };
                    let mut e = SMatrix::<f64, D, D>::identity();
                    e[(r, c)] += sign * step;
                    if r != c {
                        e[(c, r)] += sign * step;
                    }
                    better |= offer(&mut best, l * e * e * l.transpose());
                }
            }
        }
        if !better {
            step *= 0.5;
        }
    }
    best.1
}

/// The P of A'P + PA = -I for the A that fits all velocities best in least squares, and for this A with faster and faster decay: where a motion is
/// nearly linear, its own V falls along it, which a grid in space may miss. Some may not be definite.
fn of_nearest_linear<const D: usize>(tracks: &[Track<D>]) -> Vec<SMatrix<f64, D, D>> {
    let (mut xx, mut vx) = (SMatrix::<f64, D, D>::zeros(), SMatrix::<f64, D, D>::zeros());
    for (x, v) in tracks.iter().flat_map(|t| t.x.iter().zip(&t.v)) {
        xx += x * x.transpose();
        vx += v * x.transpose();
    }
    let Some(inverse) = (xx + SMatrix::identity() * (1e-6 * xx.trace())).try_inverse() else { return vec![] };
    let a = vx * inverse;
    [0.0, 0.1, 0.3, 1.0].iter().filter_map(|decay| lyapunov(&(a - SMatrix::identity() * (decay * a.norm())))).collect()
}

/// P of A'P + PA = -I, D^2 equations in as many entries.
fn lyapunov<const D: usize>(a: &SMatrix<f64, D, D>) -> Option<SMatrix<f64, D, D>> {
    let mut equations = DMatrix::<f64>::zeros(D * D, D * D);
    for r in 0..D {
        for c in 0..D {
            for s in 0..D {
                equations[(r * D + c, s * D + c)] += a[(s, r)];
                equations[(r * D + c, r * D + s)] += a[(s, c)];
            }
        }
    }
    let right = DVector::from_fn(D * D, |i, _| if i / D == i % D { -1.0 } else { 0.0 });
    let p = equations.lu().solve(&right)?;
    Some(SMatrix::from_fn(|r, c| p[r * D + c]))
}

/// Unit vectors over half the circle, or the axes, edges and corners of a cube.
fn directions<const D: usize>() -> Vec<SVector<f64, D>> {
    if D == 2 {
        return (0..12)
            .map(|i| {
                let (s, c) = (f64::from(i) * std::f64::consts::PI / 12.0).sin_cos();
                SVector::from_fn(|r, _| if r == 0 { c } else { s })
            })
            .collect();
    }
    let mut all = Vec::new();
    for code in 0..3_usize.pow(D as u32) {
        let v = SVector::<f64, D>::from_fn(|r, _| (code / 3_usize.pow(r as u32) % 3) as f64 - 1.0);
        let first = v.iter().copied().find(|c| *c != 0.0);
        if first.is_some_and(|c| c > 0.0) {
            all.push(v.normalize());
        }
    }
    all
}

/// The demonstration, moved as little as P asks for, and how far each sample was moved.
pub fn follow<const D: usize>(track: &Track<D>, p: &SMatrix<f64, D, D>, sigma: f64) -> (Track<D>, Vec<f64>) {
    let mut scratch = Scratch::default();
    scratch.level(track, p, sigma);
    let mut moved = track.clone();
    for i in 0..track.x.len() {
        let change = (scratch.z[i] - scratch.before[i]).exp();
        if (change - 1.0).abs() < 1e-6 {
            continue;
        }
        // Along V's gradient: x + a P x with V times change^2, a root of a quadratic.
        let x = track.x[i];
        let px = p * x;
        let ppx = p * px;
        let (a, b, c) = (px.dot(&ppx), px.norm_squared(), x.dot(&px) * (1.0 - change * change));
        let root = b * b - a * c;
        let step = if root >= 0.0 && a > 0.0 { -c / (b + root.sqrt()) } else { -b / a.max(1e-12) };
        moved.x[i] = x + px * step;
    }
    let n = track.x.len();
    for i in 0..n {
        let (a, b) = (i.saturating_sub(2), (i + 2).min(n - 1));
        let away = (moved.x[i] - track.x[i]).norm();
        if away > 1e-3 && track.t[b] > track.t[a] {
            let v = (moved.x[b] - moved.x[a]) / (track.t[b] - track.t[a]);
            let least = SLOWEST * track.v[i].norm();
            let size = v.norm();
            moved.v[i] = if size > 1e-9 { v * (least.max(size) / size) } else { v };
        }
    }
    let away = moved.x.iter().zip(&track.x).map(|(a, b)| (a - b).norm()).collect();
    (moved, away)
}

/// The velocity nearest to v along which V falls at the rate sigma.
pub fn admissible<const D: usize>(
    x: &SVector<f64, D>,
    v: &SVector<f64, D>,
    p: &SMatrix<f64, D, D>,
    sigma: f64,
) -> SVector<f64, D> {
    let px = p * x;
    let size = px.norm_squared();
    let excess = px.dot(v) + sigma * x.dot(&px);
    if excess > 0.0 && size > 1e-18 { v - px * (excess / size) } else { *v }
}
