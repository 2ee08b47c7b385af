//! Makes the demonstrations in `demos/` and learns the skills in `models/` from them.
//!
//! Hand movements are smooth strokes that overlap in time (minimum jerk, Flash & Hogan 1985). Every repetition varies the
//! points it passes, its timing, and has tremor of about two millimetres. Run from the top of the repository:
//! `cargo run --release --example make-demos [FOLDER]`.

use pliant::learn::{self, Options};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

const REPETITIONS: u64 = 7;
const STEP: f64 = 0.01;

struct Shape {
    name: &'static str,
    /// Points that strokes lead to, in metres. The motion starts at the first and ends at the origin.
    points: &'static [[f64; 2]],
    /// Seconds between the starts of strokes; each stroke takes twice as long.
    rhythm: f64,
}

const SHAPES: [Shape; 3] = [
    Shape {
        name: "sbend",
        points: &[
            [0.37, 0.41],
            [0.08, 0.44],
            [-0.02, 0.31],
            [0.10, 0.22],
            [0.30, 0.19],
            [0.40, 0.10],
            [0.28, 0.00],
            [0.0, 0.0],
        ],
        rhythm: 0.42,
    },
    Shape {
        name: "hook",
        points: &[[0.26, 0.28], [0.26, 0.05], [0.22, -0.14], [0.09, -0.17], [0.01, -0.10], [0.0, 0.0]],
        rhythm: 0.42,
    },
    Shape {
        name: "arch",
        points: &[[-0.42, -0.02], [-0.38, 0.20], [-0.25, 0.29], [-0.12, 0.26], [-0.05, 0.14], [0.0, 0.0]],
        rhythm: 0.40,
    },
];

/// A normal deviate, near enough.
fn normal(rng: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0
}

/// Part of a stroke that is done at part `s` of its time.
fn minimum_jerk(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s * s * s * (10.0 + s * (6.0 * s - 15.0))
}

/// Rows `t,x,y` of one repetition.
fn repetition(shape: &Shape, rng: &mut ChaCha8Rng) -> Result<String, std::fmt::Error> {
    let last = shape.points.len() - 1;
    let mut vary = |spread: f64| [spread * normal(rng), spread * normal(rng)];
    let common = vary(0.008);
    let points: Vec<[f64; 2]> = shape
        .points
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let own = vary(if i == last { 0.0 } else { 0.004 });
            let fade = (last - i) as f64 / last as f64;
            std::array::from_fn(|c| p[c] + own[c] + fade * common[c])
        })
        .collect();
    let tempo = 1.0 + 0.06 * normal(rng);
    let starts: Vec<f64> = (0..last).map(|i| shape.rhythm * tempo * (i as f64 + 0.04 * normal(rng)).max(0.0)).collect();
    let stroke = 2.0 * shape.rhythm * tempo;
    let end = starts[last - 1] + stroke;

    // Tremor: white noise through two low-pass filters of 0.1 s, which leave about a fifth of its size.
    let mut filters = [[0.0; 2]; 2];
    let mut text = String::from("t,x,y\n");
    for i in 0..=(end / STEP).ceil() as usize {
        let t = i as f64 * STEP;
        let rest = ((end - t) / 0.5).clamp(0.0, 1.0);
        let mut x = points[0];
        for (c, x) in x.iter_mut().enumerate() {
            for (k, start) in starts.iter().enumerate() {
                *x += (points[k + 1][c] - points[k][c]) * minimum_jerk((t - start) / stroke);
            }
            filters[0][c] += 0.1 * (0.010 * normal(rng) - filters[0][c]);
            filters[1][c] += 0.1 * (filters[0][c] - filters[1][c]);
            *x += filters[1][c] * rest;
        }
        // A tenth of a millimetre; adding zero turns -0.0000 into 0.0000.
        let [x, y] = x.map(|c| (c * 1e4).round() / 1e4 + 0.0);
        writeln!(text, "{t:.2},{x:.4},{y:.4}")?;
    }
    Ok(text)
}

fn main() -> Result<(), Box<dyn Error>> {
    let root = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".into()));
    fs::create_dir_all(root.join("models"))?;
    for (number, shape) in SHAPES.iter().enumerate() {
        let folder = root.join("demos").join(shape.name);
        fs::create_dir_all(&folder)?;
        for i in 1..=REPETITIONS {
            let mut rng = ChaCha8Rng::seed_from_u64(100 * number as u64 + i);
            fs::write(folder.join(format!("{}-{i}.csv", shape.name)), repetition(shape, &mut rng)?)?;
        }
        let options = Options { name: shape.name.into(), ..Options::default() };
        let learnt = learn::learn(&[folder], &options, &|_| ())?;
        learnt.model.write(&root.join("models").join(format!("{}.toml", shape.name)))?;
        let q = learnt.quality;
        println!(
            "{}: {} components, RMSE {:.3} m/s, e_dot {:.3}, path error {:.1} mm, {} of {} rollouts arrive",
            shape.name,
            learnt.model.component.len(),
            q.rmse,
            q.e_dot,
            1e3 * q.path_error,
            q.converged,
            q.rollouts,
        );
    }
    Ok(())
}
