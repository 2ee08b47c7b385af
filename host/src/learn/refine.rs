//! All parameters at once, by Levenberg and Marquardt's rule, within the certificate.
//!
//! What is minimised is the velocity error at the samples, in length and in direction, and how far rollouts stray from the demonstrations' paths.

#![expect(clippy::needless_range_loop, reason = "one index runs through several matrices, as in the formulas")]

use super::field::{Field, triangle};
use super::fit::{MAX_CONDITION, condition};
use nalgebra::{SMatrix, SVector};

/// Components of less weight than this do not enter a sample's derivative.
const FAINT: f64 = 1e-4;

/// A path to follow, in normalised units.
#[derive(Debug, Clone)]
pub struct Path<const D: usize> {
    /// Positions from the sample where rollouts start.
    pub x: Vec<SVector<f64, D>>,
    /// Seconds (normalised) between the first and the last.
    pub duration: f64,
}

/// What is weighed how.
#[derive(Debug, Clone)]
pub struct Weights {
    /// Of the direction error, against the velocity error.
    pub direction: f64,
    /// Speed below which the direction counts less.
    pub slow: f64,
    /// Of the rollouts' distance from the paths.
    pub path: f64,
    /// Of being ahead or behind on the path, against being beside it.
    pub pace: f64,
    /// A rollout farther from its path than this goes on from the path.
    pub leash: f64,
    /// How often such an error counts.
    pub snap: f64,
    /// Part of the path that a rollout may be ahead or behind.
    pub window: f64,
}

impl Default for Weights {
    fn default() -> Self {
        Self { direction: 1.5, slow: 0.03, path: 100.0, pace: 0.1, leash: 0.06, snap: 8.0, window: 0.1 }
    }
}

/// Samples and tracks to follow.
pub struct Task<'a, const D: usize> {
    /// Positions.
    pub x: &'a [SVector<f64, D>],
    /// Velocities.
    pub v: &'a [SVector<f64, D>],
    /// How far each sample's direction is to be believed, 0 to 1.
    pub belief: &'a [f64],
    /// Demonstrations to roll out along.
    pub tracks: &'a [Path<D>],
    /// Of the errors.
    pub weights: Weights,
}

/// Steps of a rollout while learning.
const STEPS: usize = 100;
/// A residual every so many steps.
const EVERY: usize = 2;

/// Normal equations: H and g of 1/2 d'Hd + g'd, and the cost.
struct Normal {
    n: usize,
    h: Vec<f64>,
    g: Vec<f64>,
    cost: f64,
}

impl Normal {
    fn new(n: usize) -> Self {
        Self { n, h: vec![0.0; n * n], g: vec![0.0; n], cost: 0.0 }
    }
}

fn dimension<const D: usize, const B: usize>(field: &Field<D>) -> usize {
    field.parts.len() * B + triangle(D)
}

impl<const D: usize> Task<'_, D> {
    /// Cost of f where v was shown, its gradient's half, and its metric: |f - v|^2 + direction belief |f/|f| - v/|v||^2, lengths bounded
    /// below.
    #[inline]
    fn compare(
        &self,
        f: &SVector<f64, D>,
        v: &SVector<f64, D>,
        belief: f64,
    ) -> (f64, SVector<f64, D>, SMatrix<f64, D, D>) {
        let slow = self.weights.slow * self.weights.slow;
        let size = 1.0 / (f.norm_squared() + slow).sqrt();
        let heading = f * size;
        let e = f - v;
        let turn = heading - v / (v.norm_squared() + slow).sqrt();
        let slope = (SMatrix::<f64, D, D>::identity() - heading * heading.transpose()) * size;
        let direction = self.weights.direction * belief;
        (
            e.norm_squared() + direction * turn.norm_squared(),
            e + slope * turn * direction,
            SMatrix::identity() + slope * slope * direction,
        )
    }

    fn velocities<const B: usize>(&self, field: &Field<D>, normal: &mut Normal) {
        let (n, parts) = (normal.n, field.parts.len());
        let base = parts * B;
        let w = 1.0 / self.x.len().max(1) as f64;
        for ((x, v), &belief) in self.x.iter().zip(self.v).zip(self.belief) {
            let local = field.at(x);
            let (cost, e, metric) = self.compare(&local.f, v, belief);
            normal.cost += w * cost;
            let mut active = [0usize; super::gmm::MAX_COMPONENTS];
            let mut blocks = [[[0.0; B]; D]; super::gmm::MAX_COMPONENTS];
            let mut count = 0;
            for k in 0..parts {
                if local.gamma[k] > FAINT {
                    active[count] = k;
                    blocks[count] = field.block::<B>(k, x, &local);
                    count += 1;
                }
            }
            let shared = field.shared(x, &local);
            for a in 0..count {
                let (ka, ja) = (active[a], &blocks[a]);
                for i in 0..B {
                    let row = ka * B + i;
                    let mut c = [0.0; D];
                    for r in 0..D {
                        normal.g[row] += w * ja[r][i] * e[r];
                        for s in 0..D {
                            c[r] += w * metric[(r, s)] * ja[s][i];
                        }
                    }
                    for b in a..count {
                        let at = row * n + active[b] * B;
                        let jb = &blocks[b];
                        if let Some(h) = normal.h.get_mut(at..at + B) {
                            for r in 0..D {
                                for j in 0..B {
                                    h[j] += c[r] * jb[r][j];
                                }
                            }
                        }
                    }
                    for j in 0..triangle(D) {
                        let mut sum = 0.0;
                        for r in 0..D {
                            sum += c[r] * shared[r][j];
                        }
                        normal.h[row * n + base + j] += sum;
                    }
                }
            }
            for i in 0..triangle(D) {
                for r in 0..D {
                    normal.g[base + i] += w * shared[r][i] * e[r];
                    let c: f64 = (0..D).map(|s| w * metric[(r, s)] * shared[s][i]).sum();
                    for j in i..triangle(D) {
                        normal.h[(base + i) * n + base + j] += c * shared[r][j];
                    }
                }
            }
        }
    }

    /// Cost of the rollouts, and their part of the normal equations where asked for.
    fn rollouts<const B: usize>(&self, field: &Field<D>, mut normal: Option<&mut Normal>) -> f64 {
        if self.weights.path <= 0.0 || self.tracks.is_empty() {
            return 0.0;
        }
        let n = dimension::<D, B>(field);
        let parts = field.parts.len();
        let base = parts * B;
        let w = self.weights.path / (self.tracks.len() * (STEPS / EVERY)) as f64;
        let mut cost = 0.0;
        let mut s = vec![[0.0; D]; n];
        for track in self.tracks {
            let mut x = track.x[0];
            s.fill([0.0; D]);
            let dt = track.duration / STEPS as f64;
            for step in 1..=STEPS {
                let local = field.at(&x);
                let k1 = local.f;
                let k2 = field.velocity(&(x + k1 * (dt / 2.0)));
                let middle = x + k2 * (dt / 2.0);
                let at_middle = field.at(&middle);
                let k3 = at_middle.f;
                let k4 = field.velocity(&(x + k3 * dt));
                x += (k1 + (k2 + k3) * 2.0 + k4) * (dt / 6.0);
                if normal.is_some() {
                    // The sensitivities by the midpoint rule: S+ = (I + dt J + dt^2/2 J^2) S + dt (I + dt/2 J) F.
                    let j = field.slope(&at_middle) * dt;
                    let carry = SMatrix::<f64, D, D>::identity() + j + j * j * 0.5;
                    let input = (SMatrix::<f64, D, D>::identity() + j * 0.5) * dt;
                    for column in s.iter_mut() {
                        let c = carry * SVector::<f64, D>::from(*column);
                        *column = c.into();
                    }
                    let mut add = |at: usize, v: SVector<f64, D>| {
                        let v = input * v;
                        for r in 0..D {
                            s[at][r] += v[r];
                        }
                    };
                    for k in 0..parts {
                        if at_middle.gamma[k] > FAINT {
                            let block = field.block::<B>(k, &middle, &at_middle);
                            for i in 0..B {
                                add(k * B + i, SVector::from_fn(|r, _| block[r][i]));
                            }
                        }
                    }
                    let shared = field.shared(&middle, &at_middle);
                    for i in 0..triangle(D) {
                        add(base + i, SVector::from_fn(|r, _| shared[r][i]));
                    }
                }
                if step % EVERY != 0 {
                    continue;
                }
                let (point, tangent, inside) =
                    nearest_on(&track.x, &x, step as f64 / STEPS as f64, self.weights.window);
                let timed = timed(&track.x, step as f64 / STEPS as f64);
                let e = x - point;
                // Beside the path in full, along it by the share of the pace; too far ahead or behind counts in full as well.
                let pace = self.weights.pace;
                let along = if inside { tangent * tangent.transpose() } else { SMatrix::zeros() };
                let beside = SMatrix::<f64, D, D>::identity() - along;
                let lost = e.norm() > self.weights.leash;
                let w = if lost { w * self.weights.snap } else { w };
                let late = along * (x - timed);
                cost += w * ((beside * e).norm_squared() + pace * late.norm_squared());
                if let Some(normal) = normal.as_deref_mut() {
                    let metric = beside + along * pace;
                    let residual = beside * e + late * pace;
                    for i in 0..n {
                        let c = metric * SVector::<f64, D>::from(s[i]) * w;
                        normal.g[i] += SVector::<f64, D>::from(s[i]).dot(&residual) * w;
                        let row = &mut normal.h[i * n + i..(i + 1) * n];
                        for (h, other) in row.iter_mut().zip(&s[i..]) {
                            for r in 0..D {
                                *h += c[r] * other[r];
                            }
                        }
                    }
                }
                if lost {
                    // Lost: what follows would tell nothing. Go on from the path.
                    x = point;
                    s.fill([0.0; D]);
                }
            }
        }
        cost
    }

    fn cost<const B: usize>(&self, field: &Field<D>) -> f64 {
        let mut cost = 0.0;
        for ((x, v), &belief) in self.x.iter().zip(self.v).zip(self.belief) {
            cost += self.compare(&field.velocity(x), v, belief).0;
        }
        cost / self.x.len().max(1) as f64 + self.rollouts::<B>(field, None)
    }
}

/// The nearest point of a path within a window about a part of it, the tangent there, and whether it is inside the window.
fn nearest_on<const D: usize>(
    path: &[SVector<f64, D>],
    x: &SVector<f64, D>,
    time: f64,
    window: f64,
) -> (SVector<f64, D>, SVector<f64, D>, bool) {
    let last = path.len() - 1;
    let low = ((time - window).max(0.0) * last as f64) as usize;
    let high = (((time + window).min(1.0) * last as f64) as usize).min(last);
    let mut best = (f64::INFINITY, low);
    for (i, p) in path.iter().enumerate().take(high + 1).skip(low) {
        let d = (p - x).norm_squared();
        if d < best.0 {
            best = (d, i);
        }
    }
    let i = best.1;
    let (a, b) = (i.saturating_sub(1), (i + 1).min(last));
    let tangent = (path[b] - path[a]).try_normalize(1e-9).unwrap_or_else(SVector::zeros);
    let inside = i > low && i < high;
    if !inside {
        return (path[i], tangent, false);
    }
    let limit = (path[b] - path[a]).norm() * 0.5;
    let along = tangent.dot(&(x - path[i]));
    (path[i] + tangent * along.clamp(-limit, limit), tangent, true)
}

fn timed<const D: usize>(path: &[SVector<f64, D>], part: f64) -> SVector<f64, D> {
    let at = part * (path.len() - 1) as f64;
    let i = (at as usize).min(path.len() - 1);
    let j = (i + 1).min(path.len() - 1);
    path[i] + (path[j] - path[i]) * (at - i as f64)
}

/// Solves (H + damping diag) d = -g by Cholesky, in place on a copy; H is an upper triangle, row by row.
fn solve(normal: &Normal, damping: f64) -> Option<Vec<f64>> {
    let n = normal.n;
    let mut l = vec![0.0; n * n];
    // Lower triangle by rows, so that the inner loops run along memory.
    let mean = (0..n).map(|i| normal.h[i * n + i]).sum::<f64>() / n as f64;
    for i in 0..n {
        for j in 0..=i {
            l[i * n + j] = normal.h[j * n + i];
        }
        l[i * n + i] += damping * (normal.h[i * n + i] + 1e-4 * mean) + 1e-12 * mean + 1e-300;
    }
    for i in 0..n {
        let (above, rest) = l.split_at_mut(i * n);
        let row = &mut rest[..n];
        for j in 0..i {
            let other = &above[j * n..j * n + j + 1];
            row[j] = (row[j] - dot(&row[..j], &other[..j])) / other[j];
        }
        let d = row[i] - dot(&row[..i], &row[..i]);
        if !(d > 0.0 && d.is_finite()) {
            return None;
        }
        row[i] = d.sqrt();
    }
    let mut d: Vec<f64> = normal.g.iter().map(|g| -g).collect();
    for i in 0..n {
        let s = dot(&l[i * n..i * n + i], &d[..i]);
        d[i] = (d[i] - s) / l[i * n + i];
    }
    for i in (0..n).rev() {
        let x = d[i] / l[i * n + i];
        d[i] = x;
        for j in 0..i {
            d[j] -= l[i * n + j] * x;
        }
    }
    Some(d)
}

/// In eight strands, which run side by side; their order is fixed, so the result is the same everywhere.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut s = [0.0; 8];
    let (ca, cb) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = ca.remainder().iter().zip(cb.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in ca.zip(cb) {
        for i in 0..8 {
            s[i] += x[i] * y[i];
        }
    }
    rest + ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7]))
}

/// The least and the largest standard deviation, in extents.
const NARROW: f64 = 0.01;
const WIDE: f64 = 3.0;

/// Is the field fit for a device: nothing too narrow, too wide, too far away or too fast, and P round enough?
fn allowed<const D: usize>(field: &Field<D>) -> bool {
    let largest = field.parts.iter().map(|c| c.log_weight).fold(f64::NEG_INFINITY, f64::max);
    condition(&field.p) <= MAX_CONDITION
        && field.parts.iter().all(|c| {
            (0..D).all(|i| c.whitening[(i, i)] > 1.0 / WIDE)
                && c.whitening.norm_squared() < D as f64 / (NARROW * NARROW)
                && largest - c.log_weight < 30.0
                && c.mean.iter().all(|m| m.abs() < 3.0)
                && c.a.norm() < 300.0
        })
}

/// Runs `rounds` steps at most, each of which lowers the cost.
pub fn refine<const D: usize, const B: usize>(start: Field<D>, task: &Task<D>, rounds: usize) -> Field<D> {
    let n = dimension::<D, B>(&start);
    let mut field = start;
    let mut damping = 1e-2;
    let mut round = 0;
    while round < rounds {
        let mut normal = Normal::new(n);
        task.velocities::<B>(&field, &mut normal);
        normal.cost += task.rollouts::<B>(&field, Some(&mut normal));
        let cost = normal.cost;
        let mut accepted = false;
        while round < rounds {
            round += 1;
            if let Some(step) = solve(&normal, damping) {
                let mut next = field.moved::<B>(&step);
                if next.update() && allowed(&next) {
                    let c = task.cost::<B>(&next);
                    if c < cost {
                        let gain = (cost - c) / cost;
                        field = next;
                        damping = (damping * 0.3).max(1e-7);
                        accepted = gain > 1e-4;
                        break;
                    }
                }
            }
            damping *= 4.0;
            if damping > 1e4 {
                break;
            }
        }
        if !accepted {
            break;
        }
    }
    field
}
