//! Places beside the demonstrations: what to learn there, and where to try it.
//!
//! A device is hardly ever where a demonstrator was. The samples say nothing about places beside them, and the certificate only that the
//! motion arrives some day: a field fitted to the samples alone may all but stand still a hand's breadth away. So the field is also told what
//! to do in a tube around the demonstrations, and tried in other places there.

use super::reference::Track;
use super::refine::Path;
use nalgebra::SVector;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Radius of the tube, in extents.
const TUBE: f64 = 0.12;
/// Samples of the tube a demonstration: beside its start, and evenly along it.
const AT_START: usize = 12;
const ALONG: usize = 12;
/// Nearer to another part of the demonstrations than this part of the radius, that part says what to do.
const BESIDE: f64 = 0.25;
/// Speed in the tube, as a share of the mean: that of the nearest path, and no less than this.
const TUBE_SPEED: f64 = 0.5;
/// The least speed learnt along a demonstration, as a share of the mean.
const LEAST_SPEED: f64 = 0.2;
/// Distance from the attractor, in extents, within which the demonstrations say all there is.
const HOME: f64 = 0.1;
/// A direction is taken over this length, in extents.
const STEP: f64 = 0.01;
/// How far beside the demonstrations a model is tried, in extents, and in how many places beside starts and beside paths.
const TRIED: f64 = 0.1;
const TRIED_STARTS: usize = 16;
const TRIED_ALONG: usize = 12;
/// How far across the motion a demonstration's companions begin, in extents.
const ACROSS: f64 = 0.02;

/// A point of the unit ball, the inner half of its radius left out.
fn offset<const D: usize>(rng: &mut ChaCha8Rng) -> SVector<f64, D> {
    loop {
        let v = SVector::<f64, D>::from_fn(|_, _| rng.random::<f64>() * 2.0 - 1.0);
        if (0.25..=1.0).contains(&v.norm_squared()) {
            return v;
        }
    }
}

/// Places to try a model: the mean start, and some beside the starts and in the first three quarters of the paths. Always the same.
pub fn places<const D: usize>(paths: &[&[SVector<f64, D>]], extent: f64) -> Vec<SVector<f64, D>> {
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let starts: Vec<_> = paths.iter().filter_map(|p| p.first().copied()).collect();
    let mut all = vec![starts.iter().sum::<SVector<f64, D>>() / starts.len().max(1) as f64];
    all.extend(starts.iter().cycle().take(TRIED_STARTS).map(|x| x + offset(&mut rng) * TRIED * extent));
    for (i, path) in paths.iter().cycle().take(TRIED_ALONG).enumerate() {
        if let Some(x) = path.get(path.len() * 3 * (i + 1) / (4 * TRIED_ALONG)) {
            all.push(x + offset(&mut rng) * TRIED * extent);
        }
    }
    all
}

/// The direction in which a track goes on from a sample.
fn onward<const D: usize>(track: &Track<D>, i: usize) -> SVector<f64, D> {
    let ahead = track.x[i..].iter().map(|x| x - track.x[i]).find(|d| d.norm() > STEP);
    ahead.map_or_else(SVector::zeros, |d| d.normalize())
}

/// Directions across one of length one, at right angles to each other.
fn across<const D: usize>(direction: &SVector<f64, D>) -> Vec<SVector<f64, D>> {
    let mut axes: Vec<usize> = (0..D).collect();
    axes.sort_by(|&a, &b| direction[a].abs().total_cmp(&direction[b].abs()));
    let mut frame = vec![*direction];
    for &axis in axes.iter().take(D - 1) {
        let mut e = SVector::<f64, D>::zeros();
        e[axis] = 1.0;
        for f in &frame {
            e -= f * f.dot(&e);
        }
        frame.extend(e.try_normalize(1e-9));
    }
    frame.split_off(1)
}

/// Paths that begin about a demonstration's start, at its very first sample and a little to each side of where rollouts begin, and come to it along
/// the way. Who follows them too has no hairline at the start, beside which the motion goes elsewhere.
pub fn companions<const D: usize>(track: &Track<D>) -> Vec<Path<D>> {
    let path = track.after_start();
    let whole = Path { x: track.x.clone(), duration: track.t[track.t.len() - 1] - track.t[0] };
    let steps = path.x.len() as f64;
    let sides = across(&onward(track, track.x.len() - path.x.len())).into_iter().flat_map(|side| [side, -side]);
    let aside = sides.map(|side| {
        let x = path.x.iter().enumerate().map(|(i, x)| x + side * (ACROSS * (1.0 - i as f64 / steps))).collect();
        Path { x, duration: path.duration }
    });
    std::iter::once(whole).chain(aside).collect()
}

/// The demonstration at no less than a share of the mean speed, but near the attractor: a velocity for each place cannot wait.
pub fn going<const D: usize>(track: &Track<D>) -> Track<D> {
    let mut going = track.clone();
    for (i, v) in going.v.iter_mut().enumerate() {
        let share = v.norm() / LEAST_SPEED;
        if share < 1.0 && track.x[i].norm() > HOME {
            // The slower, the less its direction means.
            let direction = *v * share + onward(track, i) * (LEAST_SPEED * (1.0 - share));
            *v = direction.try_normalize(1e-9).map_or(*v, |d| d * LEAST_SPEED);
        }
    }
    going
}

/// Places in a tube about the tracks and the velocity there, in normalised units: back to the nearest path and along it.
pub fn tube<const D: usize>(tracks: &[Track<D>], seed: u64) -> Vec<(SVector<f64, D>, SVector<f64, D>)> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut all = vec![];
    for track in tracks {
        let n = track.x.len();
        for i in (0..ALONG).map(|i| i * n / ALONG).chain(std::iter::repeat_n(0, AT_START)) {
            let x = track.x[i] + offset(&mut rng) * TUBE;
            if track.x[i].norm() < HOME || x.norm() < HOME {
                continue;
            }
            let each = tracks.iter().flat_map(|t| t.x.iter().enumerate().map(move |(j, p)| (t, j, (p - x).norm())));
            let Some((path, j, distance)) = each.min_by(|a, b| a.2.total_cmp(&b.2)) else { continue };
            if distance < BESIDE * TUBE {
                continue;
            }
            let along = path.v[j].try_normalize(1e-9).unwrap_or_else(|| onward(path, j));
            // At the radius the way leads back as much as along.
            let back = (path.x[j] - x) / distance * (distance / TUBE).min(1.0);
            if let Some(direction) = (along + back).try_normalize(1e-9) {
                all.push((x, direction * path.v[j].norm().max(TUBE_SPEED)));
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    /// Along the x axis to the origin, at rest at both ends.
    fn line() -> Track<2> {
        let n = 100;
        let part = |i: usize| i as f64 / f64::from(n);
        Track {
            x: (0..=100).map(|i| Vector2::new(-(1.0 + (std::f64::consts::PI * part(i)).cos()) / 2.0, 0.0)).collect(),
            v: (0..=100).map(|i| Vector2::new((std::f64::consts::PI * part(i)).sin(), 0.0)).collect(),
            t: (0..=100).map(|i| part(i) * std::f64::consts::FRAC_PI_2).collect(),
            shift: 0.0,
        }
    }

    #[test]
    fn a_start_at_rest_is_left_and_the_goal_stays_one() {
        let (shown, learnt) = (line(), going(&line()));
        for ((x, v), shown) in shown.x.iter().zip(&learnt.v).zip(&shown.v) {
            let expected = if x.norm() > HOME { shown.x.max(LEAST_SPEED) } else { shown.x };
            assert!((v - Vector2::new(expected, 0.0)).norm() < 1e-12, "{v} at {x}");
        }
    }

    #[test]
    fn companions_begin_about_the_start_and_come_to_the_demonstration() {
        let all = companions(&line());
        assert_eq!(all.len(), 3);
        assert_eq!(all[0].x, line().x);
        for (path, sign) in all[1..].iter().zip([1.0, -1.0]) {
            let (first, last) = (path.x[0], path.x[path.x.len() - 1]);
            assert!((first.y - sign * ACROSS).abs() < 1e-12 && last.norm() < 1e-3, "{first} {last}");
        }
        let slanted = nalgebra::Vector3::new(0.6, 0.0, -0.8);
        let sides = across(&slanted);
        assert_eq!(sides.len(), 2);
        assert!(sides[0].dot(&sides[1]).abs() < 1e-12 && sides.iter().all(|s| s.dot(&slanted).abs() < 1e-12));
    }

    #[test]
    fn in_the_tube_the_way_leads_back_and_along() {
        let tube = tube(&[going(&line())], 1);
        assert!(tube.len() > ALONG);
        for (x, v) in tube {
            assert!(x.y.abs() <= TUBE && v.norm() > 0.99 * TUBE_SPEED, "{v} at {x}");
            // Beside the line; before its start and beyond it the way back is not across.
            assert!(v.x > 0.0 && (v.y * x.y < 0.0), "{v} at {x}");
        }
    }
}
