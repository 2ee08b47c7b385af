//! The weights of section 4 of docs/method.md: by hand, as ratios, in every number type.

extern crate std;

use super::*;
use crate::scalar::Fixed;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::vec::Vec;

/// The weights of obstacles with these Gammas, read off where obstacle n alone asks for the speed v_n: with all directions along f the mean of angles
/// leaves f's, and the mean speed is sum_n w_n v_n.
fn mean<S: Scalar>(gammas: &[S], speeds: &[S]) -> f64 {
    let nearest = gammas.iter().fold(S::MAX, |m, g| m.min(*g));
    let (one, zero) = (S::one(), S::zero());
    let mut modulation: Modulation<S, 2, 16> = Modulation::new(&Vector::<S, 2>::new(one, zero));
    for (gamma, speed) in gammas.iter().zip(speeds) {
        // Where g.r is nothing the velocity past it is that of its surface.
        let unusable = Vector::zeros();
        let surface_velocity = Vector::<S, 2>::new(*speed, zero);
        modulation.push(&Sample { gamma: *gamma, outward: unusable, arm: unusable, surface_velocity });
    }
    let (velocity, unusable) = modulation.finish(nearest, None);
    assert!(unusable && velocity[1].to_f64().abs() < 1e-5);
    velocity[0].to_f64()
}

/// Of the n-th alone.
fn weight_of<S: Scalar>(gammas: &[f64], n: usize) -> f64 {
    let gammas: Vec<S> = gammas.iter().map(|g| S::from_f64(*g)).collect();
    let speeds: Vec<S> = (0..gammas.len()).map(|m| if m == n { S::one() } else { S::zero() }).collect();
    mean(&gammas, &speeds)
}

fn by_hand<S: Scalar>() {
    let few = 64.0 * S::EPSILON.to_f64();
    for (gammas, weights) in [
        // 1/3, 1/1.25, 1 over 32/15
        (&[4.0, 2.25, 2.0][..], &[20.0 / 128.0, 48.0 / 128.0, 60.0 / 128.0][..]),
        (&[3.0, 3.0], &[0.5, 0.5]),
        (&[2.0, 3.0, 2.0, 6.0], &[10.0 / 27.0, 5.0 / 27.0, 10.0 / 27.0, 2.0 / 27.0]),
        // On a surface its own obstacle alone counts; inside of several, each as much.
        (&[1.0, 5.0], &[1.0, 0.0]),
        (&[0.25, 5.0, 1.0, 1.5], &[0.5, 0.0, 0.5, 0.0]),
    ] {
        for (n, weight) in weights.iter().enumerate() {
            let found = weight_of::<S>(gammas, n);
            assert!((found - weight).abs() <= few, "{found} is not {weight}: {n} of {gammas:?}");
        }
    }
}

#[test]
fn weights_are_as_reckoned_by_hand() {
    by_hand::<f64>();
    by_hand::<f32>();
    by_hand::<Fixed>();
}

/// w_n = (1/(Gamma_n - 1)) / sum_m (1/(Gamma_m - 1)), however many there are and in which lane they come.
fn ratios<S: Scalar>(seed: u64) {
    let r = &mut ChaCha8Rng::seed_from_u64(seed);
    for _ in 0..20_000 {
        let gammas: Vec<S> = (0..r.random_range(2..=16)).map(|_| S::from_f64(r.random_range(1.05..20.0f64))).collect();
        let speeds: Vec<S> = gammas.iter().map(|_| S::from_f64(r.random_range(0.1..1.0f64))).collect();
        let nearness: Vec<f64> = gammas.iter().map(|g| 1.0 / (g.to_f64() - 1.0)).collect();
        let all: f64 = nearness.iter().sum();
        let expected: f64 = nearness.iter().zip(&speeds).map(|(w, v)| w / all * v.to_f64()).sum();
        // Each Gamma - 1 is off by a unit of Gamma, up to 20 of them in 0.05; each of the sums has 16 terms of at most one.
        let bound = S::EPSILON.to_f64() * (20.0 / 0.05 + 64.0);
        let found = mean(&gammas, &speeds);
        assert!((found - expected).abs() <= bound, "{found} is not {expected}: {gammas:?} {speeds:?}");
    }
}

#[test]
fn weights_are_in_the_ratio_of_nearness() {
    ratios::<f64>(1);
    ratios::<f32>(2);
    ratios::<Fixed>(3);
}
