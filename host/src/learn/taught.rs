//! What is learnt along one demonstration: its samples, with velocities that the certificate allows, and the nearest path that it allows.

use super::beside;
use super::gmm::Samples;
use super::reference::{Track, admissible, follow};
use nalgebra::SMatrix;

/// A sample moved farther than this, in extents, is learnt in both places.
const MOVED: f64 = 3e-3;

/// Samples of one demonstration to learn from, in normalised units.
pub struct Taught<const D: usize> {
    /// The nearest path along which V falls.
    pub reference: Track<D>,
    /// Where the demonstration was, and where it had to give way its reference too.
    pub samples: Samples<D>,
    /// How far each sample's direction is to be believed, 0 to 1.
    pub belief: Vec<f64>,
    /// The sample of the reference that each sample belongs to.
    along: Vec<usize>,
}

impl<const D: usize> Taught<D> {
    /// What V = x'Px falling at this rate leaves of a demonstration.
    pub fn new(shown: &Track<D>, p: &SMatrix<f64, D, D>, rate: f64) -> Self {
        // No skill waits: where a demonstrator does, most of all at the start, it goes on.
        let going = beside::going(shown);
        let (reference, away) = follow(&going, p, rate);
        let (mut samples, mut belief, mut along) = (Samples { x: vec![], v: vec![] }, vec![], vec![]);
        for (i, (x, v)) in going.x.iter().zip(&going.v).enumerate() {
            let mut teach = |x, v| {
                samples.x.push(x);
                samples.v.push(v);
                belief.push(going.belief(&x));
                along.push(i);
            };
            teach(*x, admissible(x, v, p, rate));
            if away[i] > MOVED {
                teach(reference.x[i], reference.v[i]);
            }
        }
        Self { reference, samples, belief, along }
    }

    /// The number of the piece each sample is in, of `count` pieces alike in length, turning and time.
    pub fn pieces(&self, count: usize) -> Vec<usize> {
        let piece = pieces(&self.reference, count);
        self.along.iter().map(|&i| piece[i]).collect()
    }
}

fn pieces<const D: usize>(track: &Track<D>, count: usize) -> Vec<usize> {
    /// Turning, in radians, that counts as none.
    const STRAIGHT: f64 = 0.3;
    let n = track.x.len();
    let step = |i: usize| {
        let (a, b) = (track.v[i], track.v[i - 1]);
        let size = a.norm() * b.norm();
        let turn = if size > 0.0 { (a.dot(&b) / size).clamp(-1.0, 1.0).acos() } else { 0.0 };
        ((track.x[i] - track.x[i - 1]).norm(), turn)
    };
    let (length, turning) = (1..n).map(step).fold((1e-12, STRAIGHT), |s, p| (s.0 + p.0, s.1 + p.1));
    let mut along = vec![0.0; n];
    for i in 1..n {
        let (step, turn) = step(i);
        along[i] = along[i - 1] + step / length + turn / turning + 1.0 / n as f64;
    }
    let total = along[n - 1].max(1e-12);
    along.iter().map(|a| ((a / total * count as f64) as usize).min(count - 1)).collect()
}
