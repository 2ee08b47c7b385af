//! What is seen of a scene, how exactly and how late.

use std::collections::VecDeque;

use nalgebra::Vector3;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::run::{PERCEPTION_TICKS, TICK};
use crate::scene::{PosedObstacle, Scene};

/// How well the obstacles of a scene are seen. By default exactly and at once.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Perception {
    /// Standard deviation of each coordinate of an obstacle's centre, m. Where it is above zero, places and velocities are tracked.
    pub noise: f64,
    /// Ticks (ms) from what is seen to when it is told.
    pub latency: u64,
    /// Of the noise.
    pub seed: u64,
}

/// What was seen of a scene.
#[derive(Clone, Debug)]
pub struct Sight<'a> {
    /// The tick at which it was so.
    pub tick: u64,
    /// The obstacles as they seemed.
    pub obstacles: Vec<PosedObstacle<'a>>,
}

impl Sight<'_> {
    /// The scene time at which it was so, s.
    pub fn time(&self) -> f64 {
        self.tick as f64 * TICK
    }
}

/// A camera over a scene: looks 30 times a second, and tells what it saw when it has understood it.
#[derive(Clone, Debug)]
pub struct Camera<'a> {
    scene: &'a Scene,
    perception: Perception,
    random: ChaCha8Rng,
    tracks: Vec<Track>,
    under_way: VecDeque<(u64, Sight<'a>)>,
}

impl<'a> Camera<'a> {
    /// One that has not looked yet.
    pub fn new(scene: &'a Scene, perception: Perception) -> Self {
        let random = ChaCha8Rng::seed_from_u64(perception.seed);
        Self { scene, perception, random, tracks: Vec::new(), under_way: VecDeque::new() }
    }

    /// What becomes known at this tick; to be asked at every tick in turn. The first look is known at once, for it was taken in peace.
    pub fn at(&mut self, tick: u64) -> Option<Sight<'a>> {
        if tick.is_multiple_of(PERCEPTION_TICKS) {
            let sight = self.look(tick);
            let due = if tick == 0 { 0 } else { tick + self.perception.latency };
            self.under_way.push_back((due, sight));
        }
        match self.under_way.front() {
            Some((due, _)) if *due <= tick => self.under_way.pop_front().map(|(_, sight)| sight),
            _ => None,
        }
    }

    fn look(&mut self, tick: u64) -> Sight<'a> {
        let mut obstacles: Vec<_> = self.scene.obstacles_at(tick as f64 * TICK).collect();
        if self.perception.noise > 0.0 {
            let planar = self.scene.dimension() == 2;
            for (i, o) in obstacles.iter_mut().enumerate() {
                let mut seen = o.pose.center;
                for x in seen.iter_mut().take(if planar { 2 } else { 3 }) {
                    *x += self.perception.noise * normal(&mut self.random);
                }
                match self.tracks.get_mut(i) {
                    Some(track) => track.update(&seen, PERCEPTION_TICKS as f64 * TICK),
                    None => self.tracks.push(Track { place: seen, velocity: Vector3::zeros() }),
                }
                if let Some(track) = self.tracks.get(i) {
                    (o.pose.center, o.pose.velocity) = (track.place, track.velocity);
                }
            }
        }
        Sight { tick, obstacles }
    }
}

/// Place and velocity of something seen again and again: an alpha-beta filter, which is a Kalman filter for constant velocity at rest.
#[derive(Clone, Copy, Debug)]
struct Track {
    place: Vector3<f64>,
    velocity: Vector3<f64>,
}

/// The share of a surprise that is believed of the place, and the share that goes, over the time between, to the velocity: critically damped.
const ALPHA: f64 = 0.4;
const BETA: f64 = ALPHA * ALPHA / (2.0 - ALPHA);

impl Track {
    fn update(&mut self, seen: &Vector3<f64>, dt: f64) {
        let expected = self.place + self.velocity * dt;
        let surprise = seen - expected;
        self.place = expected + surprise * ALPHA;
        self.velocity += surprise * (BETA / dt);
    }
}

/// A sample of the standard normal distribution (Box & Muller 1958).
fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (random.random(), random.random());
    libm::sqrt(-2.0 * libm::log(1.0 - u)) * libm::cos(std::f64::consts::TAU * v)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> Scene {
        let text = "ds.linear = { attractor = [1, 0], gain = 1 }\n[[start]]\nposition = [-1, 0]\n[[obstacle]]\nname = \"ball\"\n\
            shape = { ellipsoid = [0.1, 0.1] }\ncenter = [0, 1]\nvelocity = [0.1, -0.05]\n";
        Scene::parse("s.toml", text, "".as_ref()).unwrap()
    }

    fn sights(scene: &Scene, perception: Perception) -> Vec<(u64, Sight<'_>)> {
        let mut camera = Camera::new(scene, perception);
        (0..3000).filter_map(|tick| Some((tick, camera.at(tick)?))).collect()
    }

    #[test]
    fn by_default_all_is_seen_exactly_and_at_once() {
        let scene = scene();
        for (tick, sight) in sights(&scene, Perception::default()) {
            assert_eq!(tick, sight.tick);
            assert_eq!(sight.obstacles, scene.obstacles_at(sight.time()).collect::<Vec<_>>());
        }
    }

    #[test]
    fn late_and_noisy_it_is_told_in_order_and_the_track_is_better_than_what_is_seen() {
        let scene = scene();
        let noise = 0.005;
        let seen = sights(&scene, Perception { noise, latency: 15, seed: 3 });
        assert!(seen.len() > 80 && seen[0].0 == 0);
        assert!(seen.iter().skip(1).all(|(told, sight)| *told == sight.tick + 15 && sight.tick % 33 == 0));
        let settled: Vec<_> =
            seen.iter().skip(30).map(|(_, s)| (s.obstacles[0].pose, scene.obstacles()[0].at(s.time()).pose)).collect();
        let rms = |f: &dyn Fn(&(crate::scene::Pose, crate::scene::Pose)) -> f64| {
            (settled.iter().map(|p| f(p).powi(2)).sum::<f64>() / settled.len() as f64).sqrt()
        };
        let place = rms(&|(seen, true_)| (seen.center - true_.center).norm());
        let velocity = rms(&|(seen, true_)| (seen.velocity - true_.velocity).norm());
        // Raw, both would be sqrt(2) noise, and 2 noise over 33 ms.
        assert!(place > 0.2 * noise && place < 1.1 * noise, "{place}");
        assert!(velocity < 0.3 * 2.0 * noise / 0.033, "{velocity}");
        // The same seed sees the same.
        let again = sights(&scene, Perception { noise, latency: 15, seed: 3 });
        assert!(seen.iter().zip(&again).all(|(a, b)| a.1.obstacles == b.1.obstacles));
    }

    #[test]
    fn the_noise_is_normal() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let all: Vec<f64> = (0..100_000).map(|_| normal(&mut random)).collect();
        let moment = |n: i32| all.iter().map(|x| x.powi(n)).sum::<f64>() / all.len() as f64;
        assert!(moment(1).abs() < 0.02 && (moment(2) - 1.0).abs() < 0.02 && (moment(4) - 3.0).abs() < 0.15);
    }
}
