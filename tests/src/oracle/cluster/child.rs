//! Whether the reference point of a child in a tree is where the page has it: from a point that it shares with its parent
//! towards the parent's own reference point, as far as Gamma of the child is at most 0.8; for a polygon by what is in sight.

use nalgebra::DVector;

use super::super::geometry::{length, unit};
use super::super::obstacle::Body;
use super::super::shape::Shape;
use super::overlap::{Sharing, sight_and_core};

/// Gamma of the child up to which its reference point goes.
const DEPTH: f64 = 0.8;
/// Gamma of the child that a search of few steps may leave below that.
const COARSE: f64 = 0.1;
/// Rounding of a Gamma.
const ROUNDING: f64 = 1e-9;
/// Places looked at along the way from the shared point.
const PLACES: usize = 2000;

/// Checks the reference point of a child, which was as `before`; `own` is that of its parent.
///
/// # Errors
/// Says what is not as the page has it.
pub(super) fn check(child: &Body, before: &Body, parent: &Body, own: &DVector<f64>) -> Result<(), String> {
    let place = child.reference();
    if matches!(child.shape, Shape::Star(_)) && length(&(&place - before.reference())) < 1e-9 {
        // Of its own, for where it is in sight its parent is not.
        return match sight_and_core(child, parent) {
            Sharing::Common => Err(String::from("it has kept its own, and its parent is in sight")),
            _ => Ok(()),
        };
    }
    let gamma = child.sight(&place);
    let shared = |x: &DVector<f64>| child.sight(x).max(parent.gamma(x)) <= 1.0 + ROUNDING;
    let starts_there = shared(&place);
    if parent.wall {
        return if starts_there { Ok(()) } else { Err(String::from("it is not where the child is beyond the wall")) };
    }
    if gamma > DEPTH + ROUNDING {
        // Too far out already where the two overlap: it has not gone anywhere.
        return if starts_there { Ok(()) } else { Err(format!("Gamma of the child is {gamma} beside the overlap")) };
    }
    let back = &place - own;
    let Some(away) = unit(&back) else {
        return Ok(()); // It is at the parent's own reference point.
    };
    if !starts_there && !meets(child, parent, &place, &away) {
        return Err(String::from("it is not on the way from the overlap to the parent's reference point"));
    }
    // Nowhere further on is it allowed to be, or nearly.
    let onward = &place - &away * (1e-3 * length(&back)).max(1e-6);
    let (next, end) = (child.sight(&onward), length(&back) < 1e-6 * child.bound());
    if end || next > DEPTH - COARSE {
        Ok(())
    } else {
        Err(format!("Gamma of the child is only {gamma}, {next} further on"))
    }
}

/// Whether a ray from a place comes through a point that two cores share.
fn meets(child: &Body, parent: &Body, place: &DVector<f64>, away: &DVector<f64>) -> bool {
    let reach = child.bound() + length(&(place - &child.center));
    let worst = |t: f64| {
        let x = place + away * t;
        child.sight(&x).max(parent.gamma(&x))
    };
    let step = reach / PLACES as f64;
    let Some(best) = (0..=PLACES).map(|i| i as f64 * step).min_by(|a, b| worst(*a).total_cmp(&worst(*b))) else {
        return false;
    };
    let (mut low, mut high) = ((best - step).max(0.0), best + step);
    for _ in 0..100 {
        let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if worst(left) < worst(right) { high = right } else { low = left }
    }
    worst(0.5 * (low + high)).min(worst(best)) <= 1.0 + ROUNDING
}
