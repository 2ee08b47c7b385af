//! Samples are told apart by where they go, not only by where they are.

use crate::learn::gmm::{Mixture, Samples, fit};
use nalgebra::Vector2;

/// Two strokes on one line, there from -1 to 0.6 and back from 1 to -0.6: where they overlap, places are the same and directions are not.
fn there_and_back() -> Samples<2> {
    let (mut x, mut v) = (vec![], vec![]);
    for i in 0..200 {
        let s = f64::from(i) / 199.0;
        let across = 0.02 * (37.0 * s).sin();
        for way in [1.0, -1.0] {
            x.push(Vector2::new(way * (1.6 * s - 1.0), across));
            v.push(Vector2::new(way, 0.0));
        }
    }
    Samples { x, v }
}

/// Where the two components lie on the line, and their spread along it.
fn on_the_line(mixture: &Mixture<2>) -> Vec<(f64, f64)> {
    let mut all: Vec<_> = mixture.components().map(|(_, mean, c)| (mean.x, c[(0, 0)].sqrt())).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

#[test]
fn strokes_there_and_back_on_one_line_are_two() {
    // Uniform over a length of 1.6: its middle, and 1.6 / sqrt(12).
    let stroke = 1.6 / 12f64.sqrt();
    for seed in 0..5 {
        let found = on_the_line(&fit(&there_and_back(), 2, 2.0, seed).expect("fits"));
        assert_eq!(found.len(), 2);
        for ((mean, spread), middle) in found.into_iter().zip([-0.2, 0.2]) {
            assert!((mean - middle).abs() < 0.02 && (spread - stroke).abs() < 0.02, "seed {seed}: {mean} {spread}");
        }
        // By places alone the line falls into its halves.
        let halves = on_the_line(&fit(&there_and_back(), 2, 0.0, seed).expect("fits"));
        assert!(halves[0].0 < -0.3 && halves[1].0 > 0.3, "seed {seed}: {halves:?}");
    }
}
