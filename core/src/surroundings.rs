//! All obstacles as they look from one point.

use crate::obstacle::SoftLayer;
use crate::{Obstacle, Scalar, Vector};

/// What one look at the table finds.
#[derive(Debug)]
pub(crate) struct Surroundings<S: Scalar, const D: usize, const CAP: usize> {
    /// The soft layers x is in.
    pub soft: heapless::Vec<SoftLayer<S, D>, CAP>,
    /// The least Gamma; the largest number there is if there is no obstacle.
    ///
    /// Between two lists, for compilers clear what lies between two lengths of zero at one go, room for what is in the lists and all.
    pub gamma: S,
    /// Places in the table of the obstacles that may be reached by the next sample, each with how far to look for its surface, m.
    pub near: heapless::Vec<(usize, S), CAP>,
    /// Whose the least Gamma is; nobody's for the scan.
    pub nearest: Option<u16>,
    /// The velocity round all obstacles, m/s.
    pub velocity: Vector<S, D>,
    /// Was a reference point unusable?
    pub unusable: bool,
}

impl<S: Scalar, const D: usize, const CAP: usize> Surroundings<S, D, CAP> {
    /// Nothing yet; `f` is the velocity to bend, m/s.
    #[inline(always)]
    pub fn new(f: &Vector<S, D>) -> Self {
        Self {
            soft: heapless::Vec::new(),
            gamma: S::MAX,
            near: heapless::Vec::new(),
            nearest: None,
            velocity: *f,
            unusable: false,
        }
    }

    /// Lists an obstacle that has this Gamma, by its place in the table, if its surface may come within `reach`, m.
    #[inline(always)]
    pub fn note_near(&mut self, obstacle: &Obstacle<S, D>, gamma: S, index: usize, reach: S) {
        if obstacle.is_near(gamma, reach) {
            // Cannot be full: it has the table's own capacity.
            let _ = self.near.push((index, reach));
        }
    }

    /// Lists the obstacle's soft `layer`, if x is in it and layers count.
    #[inline(always)]
    pub fn note_soft(
        &mut self,
        obstacle: &Obstacle<S, D>,
        gamma: S,
        deformable: bool,
        layer: impl FnOnce(&Obstacle<S, D>) -> Option<SoftLayer<S, D>>,
    ) {
        // The usual answer first.
        if obstacle.may_be_soft(gamma)
            && deformable
            && let Some(layer) = layer(obstacle)
        {
            // Nor can this.
            let _ = self.soft.push(layer);
        }
    }
}
