//! f(x) of a skill has no jump, however far from the data.
//!
//! Along a step from x to y the logarithms l_k of the weights change by d_k. With delta = max d_k - min d_k the weights move by no more than
//! tanh(delta/4) from some components to others, so
//!
//! ```text
//! |f(y) - f(x)| <= max |A_k| |y - x| + tanh(delta/4) max |(A_j - A_k)(y - x*)|
//! ```
//!
//! over the components that weigh anything, e^-45 of the largest, at x or y. delta is computed here in f64 from the model's own numbers; what rounding in the
//! scalar under test may do to each l_k, rho, makes it wider by 4 rho. A switch from one component to another moves f by the second term whole.
//!
//! Steps come from a search for a jump: two places at one distance, then always the half in which the heaviest component changes, or else f changes
//! more, until no number of the scalar lies between. So the last steps are a unit in the last place long, at every distance. Steps by which a switch
//! would have been seen are counted for each power of ten, and must be there: in f32 far out they are one in fifty of what they are near, for
//! weights may change hands there from one number to the next. [`a_hard_switch_is_found`] is the same with a mixture that switches.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

use nalgebra::Cholesky;
use pliant_core::{Component, Fixed, LpvDs, Matrix, RANGE, Scalar, Vector};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Out to so many times the data's extent, from a thousandth of it.
const FAR: f64 = 1000.0;
/// Powers of ten of the distance, in extents, from -3.
const DECADES: usize = 6;
/// Lighter than e^-WEIGHTLESS of the heaviest a component moves nothing.
const WEIGHTLESS: f64 = 45.0;

fn samples() -> usize {
    std::env::var("PLIANT_SAMPLES").ok().and_then(|n| n.parse().ok()).unwrap_or(1_000_000)
}

/// How a scalar rounds: to half of `relative` of a number, and to half of `absolute`; and the deepest |W (x - mu)| that it holds.
trait Rounded: Scalar {
    const RELATIVE: f64;
    const ABSOLUTE: f64;
    const DEEPEST: f64;
}

impl Rounded for f64 {
    const RELATIVE: f64 = f64::EPSILON;
    const ABSOLUTE: f64 = 0.0;
    const DEEPEST: f64 = f64::INFINITY;
}

impl Rounded for f32 {
    const RELATIVE: f64 = f32::EPSILON as f64;
    const ABSOLUTE: f64 = 0.0;
    const DEEPEST: f64 = f64::INFINITY;
}

impl Rounded for Fixed {
    const RELATIVE: f64 = 0.0;
    const ABSOLUTE: f64 = 1.0 / (1 << 20) as f64;
    const DEEPEST: f64 = 350.0;
}

/// A skill in f64, its numbers those that the scalar holds.
struct Reference<const D: usize> {
    attractor: Vector<f64, D>,
    parts: Vec<Component<f64, D>>,
    extent: f64,
}

impl<const D: usize> Reference<D> {
    fn of<S: Scalar>(ds: &LpvDs<S, D>) -> Self {
        let parts: Vec<_> = ds
            .components()
            .iter()
            .map(|c| Component {
                log_weight: c.log_weight.to_f64(),
                mean: c.mean.map(S::to_f64),
                whitening: c.whitening.map(S::to_f64),
                a: c.a.map(S::to_f64),
            })
            .collect();
        let attractor = ds.attractor().map(S::to_f64);
        let (low, high) = parts.iter().fold((attractor, attractor), |(l, h), c| (l.inf(&c.mean), h.sup(&c.mean)));
        Self { attractor, parts, extent: (high - low).norm().max(0.1) }
    }

    fn logs(&self, x: &Vector<f64, D>) -> Vec<f64> {
        self.parts.iter().map(|c| c.log_weight - (c.whitening * (x - c.mean)).norm_squared() / 2.0).collect()
    }

    /// |W (x - mu)| by norms, so no less than it is.
    fn depth(c: &Component<f64, D>, x: &Vector<f64, D>) -> f64 {
        c.whitening.norm() * (x - c.mean).norm()
    }
}

fn heaviest(logs: &[f64]) -> usize {
    (0..logs.len()).max_by(|&i, &j| logs[i].total_cmp(&logs[j])).unwrap_or(0)
}

/// The bound on a step, and whether a switch of the heaviest component would be twice that.
fn bound<S: Rounded, const D: usize>(model: &Reference<D>, x: &Vector<f64, D>, y: &Vector<f64, D>) -> (f64, bool) {
    let (before, after) = (model.logs(x), model.logs(y));
    let (i, j) = (heaviest(&before), heaviest(&after));
    let weighs = |k: &usize| before[*k] > before[i] - WEIGHTLESS || after[*k] > after[j] - WEIGHTLESS;
    let some: Vec<usize> = (0..before.len()).filter(weighs).collect();
    let change = |pick: fn(f64, f64) -> f64, from: f64| some.iter().fold(from, |b, &k| pick(b, after[k] - before[k]));
    let delta = change(f64::max, f64::MIN) - change(f64::min, f64::MAX);

    // |y|^2/2 of sums of D products: 11 half units of its bound in any order; in fixed point half a step a product, 8 times W (x - mu), squared and 32 times.
    let floating = |c: &Component<f64, D>, z: f64| 5.5 * S::RELATIVE * (z * z + c.log_weight.abs() + WEIGHTLESS);
    let fixed = |z: f64| 32.0 * S::ABSOLUTE * (z.min(S::DEEPEST) + 4.0);
    let one = |c, x| {
        let depth = Reference::depth(c, x);
        floating(c, depth) + fixed(depth)
    };
    let at = |x| some.iter().map(|&k| one(&model.parts[k], x)).fold(0.0, f64::max);
    let rho = f64::max(at(x), at(y));

    let offset = y - model.attractor;
    let along = |k: usize| model.parts[k].a * offset;
    let pairs = some.iter().flat_map(|&p| some.iter().map(move |&q| (p, q)));
    let most = pairs.map(|(p, q)| (along(p) - along(q)).norm()).fold(0.0, f64::max);
    let size = model.parts.iter().map(|c| c.a.norm()).fold(0.0, f64::max);
    let count = model.parts.len() as f64;
    let rounding = 16.0 * count * (S::RELATIVE * size * offset.norm() + S::ABSOLUTE * (1.0 + size * offset.norm()));
    let bound = size * (y - x).norm() + ((delta + 4.0 * rho) / 4.0).tanh() * most + rounding;
    (bound, i != j && (along(i) - along(j)).norm() > 2.0 * bound)
}

/// A place at a distance from the attractor in the scalar's numbers, within its range.
fn place<S: Rounded, const D: usize>(model: &Reference<D>, far: f64, rng: &mut ChaCha8Rng) -> Option<Vector<S, D>> {
    let direction = Vector::<f64, D>::from_fn(|_, _| rng.random::<f64>() - 0.5).try_normalize(1e-3)?;
    let x = model.attractor + direction * far;
    (x.amax() < RANGE && model.parts.iter().all(|c| Reference::depth(c, &x) < S::DEEPEST)).then(|| x.map(S::from_f64))
}

/// Searches for a jump of `f`; what a switch would have been seen by, in each power of ten.
fn search<S: Rounded, const D: usize>(
    model: &Reference<D>,
    f: impl Fn(&Vector<S, D>) -> Vector<S, D>,
    steps: usize,
) -> Result<[usize; DECADES], String> {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let (mut seen, mut done) = ([0; DECADES], 0);
    let real = |x: &Vector<S, D>| x.map(S::to_f64);
    let half = S::from_f64(0.5);
    while done < steps {
        let decade = rng.random::<f64>() * DECADES as f64;
        let far = model.extent * FAR * libm::pow(10.0, decade - DECADES as f64);
        let (a, b) = (place::<S, D>(model, far, &mut rng), place::<S, D>(model, far, &mut rng));
        done += 1;
        let (Some(mut x), Some(mut y)) = (a, b) else { continue };
        let (mut fx, mut fy) = (f(&x), f(&y));
        loop {
            let middle = x + (y - x) * half;
            if middle == x || middle == y {
                break;
            }
            let fm = f(&middle);
            let (from, to) = (heaviest(&model.logs(&real(&x))), heaviest(&model.logs(&real(&y))));
            let between = heaviest(&model.logs(&real(&middle)));
            let (left, right) = ((real(&fm) - real(&fx)).norm(), (real(&fy) - real(&fm)).norm());
            if if from == to { left > right } else { between != from } {
                (y, fy) = (middle, fm);
            } else {
                (x, fx) = (middle, fm);
            }
            let (bound, sharp) = bound::<S, D>(model, &real(&x), &real(&y));
            seen[decade as usize] += usize::from(sharp);
            let change = (real(&fy) - real(&fx)).norm();
            if change.is_nan() || change > bound {
                return Err(format!("{x:?} to {y:?}: {fx:?}, {fy:?}, by {change}, bound {bound}"));
            }
            done += 1;
        }
    }
    Ok(seen)
}

/// Components at random, in the scalar's numbers.
fn synthetic<S: Scalar, const D: usize>(count: usize, seed: u64) -> LpvDs<S, D> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let parts: Vec<_> = (0..count)
        .map(|_| {
            let mean = Vector::<f64, D>::from_fn(|_, _| (rng.random::<f64>() - 0.5) * 0.5);
            let width = 20.0 + 40.0 * rng.random::<f64>();
            let whitening = Matrix::<f64, D>::from_fn(|r, c| {
                let x = rng.random::<f64>() - 0.5;
                if c > r { 0.0 } else { width * if r == c { 1.0 + x } else { x } }
            });
            let a = Matrix::<f64, D>::from_fn(|r, c| 6.0 * (rng.random::<f64>() - if r == c { 1.5 } else { 0.5 }));
            Component {
                log_weight: S::from_f64(4.0 * rng.random::<f64>()),
                mean: mean.map(S::from_f64),
                whitening: whitening.map(S::from_f64),
                a: a.map(S::from_f64),
            }
        })
        .collect();
    LpvDs::new(Vector::zeros(), Matrix::identity(), &parts).expect("within ranges")
}

/// The models that are shipped, by name.
fn shipped<S: Scalar>() -> Vec<(String, LpvDs<S, 2>)> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let mut paths: Vec<_> = std::fs::read_dir(folder).expect("models").map(|e| e.expect("a file").path()).collect();
    paths.retain(|p| p.extension().is_some_and(|e| e == "toml"));
    paths.sort();
    let number = |v: &toml::Value| v.as_float().or(v.as_integer().map(|i| i as f64)).expect("a number");
    let vector = |v: &toml::Value| Vector::<f64, 2>::from_fn(|i, _| number(&v[i]));
    let matrix = |v: &toml::Value| Matrix::<f64, 2>::from_fn(|r, c| number(&v[r][c]));
    let model = |path: &std::path::PathBuf| {
        let file: toml::Table = std::fs::read_to_string(path).expect("text").parse().expect("TOML");
        let part = |c: &toml::Value| {
            let sigma = matrix(&c["covariance"]);
            let whitening = Cholesky::new(sigma).expect("positive").l().try_inverse().expect("regular");
            Component {
                log_weight: S::from_f64(number(&c["prior"]).ln() - sigma.determinant().ln() / 2.0),
                mean: vector(&c["mean"]).map(S::from_f64),
                whitening: whitening.map(S::from_f64),
                a: matrix(&c["a"]).map(S::from_f64),
            }
        };
        let parts: Vec<_> = file["component"].as_array().expect("components").iter().map(part).collect();
        let attractor = vector(&file["attractor"]).map(S::from_f64);
        let ds = LpvDs::new(attractor, Matrix::identity(), &parts).expect("within ranges");
        (path.file_stem().expect("a name").to_string_lossy().into_owned(), ds)
    };
    paths.iter().map(model).collect()
}

fn no_jump<S: Rounded, const D: usize>(name: &str, ds: &LpvDs<S, D>, steps: usize) -> [usize; DECADES] {
    search(&Reference::of(ds), |x| ds.velocity(x), steps).unwrap_or_else(|jump| panic!("{name}: {jump}"))
}

/// All skills of a scalar; a switch would have been seen in each of the first `resolved` powers of ten.
fn all<S: Rounded>(resolved: usize) {
    let models = shipped::<S>();
    let each = samples() / (models.len() + 16);
    let mut seen = [0; DECADES];
    let mut add = |some: [usize; DECADES]| seen.iter_mut().zip(some).for_each(|(all, some)| *all += some);
    for (name, ds) in &models {
        add(no_jump(name, ds, each));
    }
    for count in 1..=8 {
        add(no_jump(&format!("{count} in the plane"), &synthetic::<S, 2>(count, count as u64), each));
        add(no_jump(&format!("{count} in space"), &synthetic::<S, 3>(count, count as u64), each));
    }
    assert!(seen[..resolved].iter().all(|&n| n > 0), "a switch would not have been seen: {seen:?}");
}

#[test]
fn no_jump_in_f64() {
    all::<f64>(DECADES);
}

#[test]
fn no_jump_in_f32() {
    all::<f32>(DECADES);
}

/// Its range ends 350 standard deviations away.
#[test]
fn no_jump_in_fixed_point() {
    all::<Fixed>(5);
}

/// The heaviest component alone: in every scalar and for every skill of more than one component, this is a jump.
#[test]
fn a_hard_switch_is_found() {
    fn found<S: Rounded, const D: usize>(ds: &LpvDs<S, D>, name: &str) {
        let model = Reference::of(ds);
        let switch = |x: &Vector<S, D>| {
            let real = x.map(S::to_f64);
            let k = heaviest(&model.logs(&real));
            (model.parts[k].a * (real - model.attractor)).map(S::from_f64)
        };
        assert!(search(&model, switch, 20_000).is_err(), "{name}: a switch is not seen");
    }
    fn every<S: Rounded>() {
        for (name, ds) in &shipped::<S>() {
            found(ds, name);
        }
        for count in 2..=8 {
            found(&synthetic::<S, 2>(count, count as u64), "in the plane");
            found(&synthetic::<S, 3>(count, count as u64), "in space");
        }
    }
    every::<f64>();
    every::<f32>();
    every::<Fixed>();
}
