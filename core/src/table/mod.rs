//! The obstacles there are, in room for a fixed number of them, and what becomes of them between two sightings.
//!
//! Whoever sees obstacles puts them in by an identifier ([`Table::upsert`]), as often as they are seen. In between,
//! every tick of dt seconds carries each one on by what was said of it ([`Table::advance`]). How far that is trusted
//! depends on its age, how long ago it was seen ([`Ageing`]):
//!
//! ```text
//! age < time to live           c += v dt,  Q turns by w dt,  every semi-extent += growth dt
//! time to live <= age < hold   the same, and the hard core's semi-extents += (ageing growth) dt:  EXTRAPOLATED
//! hold <= age                  it stays where it is, as large as it is:                           HELD
//! ```
//!
//! In the second line its surface velocity has the rate of ageing along its normal too, so that the modulation sees
//! it come. What ageing has added is gone with the next sighting. The soft layer does not age: margin wins over
//! softness. A scan's radius grows by the same rule. All of this is ours.
//!
//! # Overlapping cores
//!
//! When the table changes, and only then, cores that overlap are found and get reference points together: a common
//! point of all of them where there is one, so that the flow goes round their union as round one body (after Huber,
//! Billard & Slotine 2019). Others are gone through as a tree, from a root whose reference point all refer to as far
//! as it sees them. Where a tree or ring has no point in common the flow may end in a notch, and [`Status::CLUSTER`]
//! says so. The points move on with their obstacles until the table changes again. A change costs a bounded number of
//! evaluations of Gamma, up to some thousands where many cores overlap: it is made between two ticks, and may take
//! longer than one. How points are searched is in section 4 of `docs/method.md`.

mod ageing;
mod clusters;
mod pace;

#[cfg(test)]
mod tests;

pub use ageing::Ageing;

use core::hint::select_unpredictable;

use crate::guard::Stride;
use crate::modulation::Modulation;
use crate::obstacle::Abreast;
use crate::scalar::lanes::Lanes;
use crate::surroundings::Surroundings;
use crate::{Obstacle, Scalar, Scan, Status, Vector};
use clusters::Clusters;
use pace::Pace;

/// An obstacle, who it is, and how long ago it was seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry<S: Scalar, const D: usize> {
    id: u16,
    obstacle: Obstacle<S, D>,
    age: S,
}

impl<S: Scalar, const D: usize> Entry<S, D> {
    /// The identifier its owner gave it.
    pub fn id(&self) -> u16 {
        self.id
    }
    /// As it is now: pose and size carried on to the present.
    pub fn obstacle(&self) -> &Obstacle<S, D> {
        &self.obstacle
    }
    /// How long ago it was seen, s; it stops at [`Ageing::hold`].
    pub fn age(&self) -> S {
        self.age
    }

    /// So many seconds pass at once, as they would in short steps.
    fn pass(&mut self, time: S, ageing: &Ageing<S>) {
        let age = (self.age + time).min(ageing.hold);
        let (moving, growing) = (age - self.age, age - self.age.max(ageing.time_to_live));
        if moving > S::zero() {
            self.obstacle.carry(moving);
        }
        if age >= ageing.time_to_live {
            self.obstacle.ages(ageing.growth);
            self.obstacle.age(growing.max(S::zero()));
        }
        if age >= ageing.hold {
            self.obstacle.hold();
        }
        self.age = age;
    }
}

/// The nearer of two: a Gamma, and whose it is.
#[inline(always)]
fn nearer<S: Scalar, T>(one: (S, T), best: (S, T)) -> (S, T) {
    // A branch is often predicted wrongly here.
    select_unpredictable(one.0 < best.0, one, best)
}

/// There is no room for another obstacle; none was dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableFull;

impl core::fmt::Display for TableFull {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the table has no room for another obstacle")
    }
}

impl core::error::Error for TableFull {}

/// At most `CAP` (1 to 64; more does not compile) obstacles by their identifiers, and one scan. The [module](self)
/// says how they age and go together.
///
/// Obstacles whose hard cores overlap share a reference point, found when the table changes and carried along with
/// them until it changes again.
///
/// ```
/// use pliant_core::{Ageing, Obstacle, ObstacleSpec, Table, TableFull};
/// let ball = || Obstacle::new(ObstacleSpec::<f32, 2>::default()).unwrap();
/// let mut table: Table<f32, 2, 1> = Table::new();
/// let ageing = Ageing::default();
/// table.upsert(7, ball(), 0.0, &ageing).unwrap();
/// table.upsert(7, ball(), 0.0, &ageing).unwrap(); // the same one again
/// assert_eq!(table.upsert(8, ball(), 0.0, &ageing), Err(TableFull));
/// assert!(table.remove(7) && table.is_empty());
/// ```
#[derive(Clone, Debug)]
pub struct Table<S: Scalar, const D: usize, const CAP: usize> {
    entries: heapless::Vec<Entry<S, D>, CAP>,
    clusters: Clusters<CAP>,
    scan: Scan<S, D>,
    pace: Pace<S>,
    revision: u32,
}

impl<S: Scalar, const D: usize, const CAP: usize> Default for Table<S, D, CAP> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Scalar, const D: usize, const CAP: usize> Table<S, D, CAP> {
    /// An empty table.
    pub fn new() -> Self {
        const { assert!(D == 2 || D == 3, "obstacles are in the plane or in space") };
        Self {
            entries: heapless::Vec::new(),
            clusters: Clusters::new(),
            scan: Scan::default(),
            pace: Pace::default(),
            revision: 0,
        }
    }

    /// Puts an obstacle in, or in the place of the one with the same identifier. `age` is how many seconds ago it was
    /// seen as described: below 0 counted as 0, above the hold time, or no number, as that. It is carried on to now as
    /// [`Table::advance`] would have done (one that turns in at most 100 steps). Cores that overlap get their
    /// reference points.
    ///
    /// # Errors
    /// [`TableFull`] where `CAP` others are there already; then nothing has changed.
    pub fn upsert(
        &mut self,
        id: u16,
        mut obstacle: Obstacle<S, D>,
        age: S,
        ageing: &Ageing<S>,
    ) -> Result<(), TableFull> {
        // Who knows no age is taken for as old as can be.
        let age = if age <= ageing.hold { age.max(S::zero()) } else { ageing.hold };
        // It may come out of a table, where it was old.
        obstacle.ages(S::zero());
        let mut entry = Entry { id, obstacle, age: S::zero() };
        entry.pass(age, ageing);
        let index = match self.entries.iter_mut().enumerate().find(|(_, e)| e.id == id) {
            Some((index, old)) => {
                *old = entry;
                index
            }
            None => {
                self.entries.push(entry).map_err(|_| TableFull)?;
                self.entries.len().saturating_sub(1)
            }
        };
        self.clusters.changed(index, &mut self.entries);
        self.pace = Pace::of(self.entries.iter().map(Entry::obstacle));
        self.revision = self.revision.wrapping_add(1);
        Ok(())
    }

    /// Takes an obstacle out, and lets those that it overlapped find their reference points anew; was it there?
    pub fn remove(&mut self, id: u16) -> bool {
        let Some(index) = self.entries.iter().position(|e| e.id == id) else {
            return false;
        };
        self.entries.swap_remove(index);
        let last = self.entries.len();
        self.clusters.removed(index, last, &mut self.entries);
        self.pace = Pace::of(self.entries.iter().map(Entry::obstacle));
        self.revision = self.revision.wrapping_add(1);
        true
    }

    /// Puts a scan in the place of the one before; `age` is how many seconds ago it was taken, as in
    /// [`Table::upsert`]. One without points takes it away. Scans take no part in what overlaps.
    pub fn set_scan(&mut self, mut scan: Scan<S, D>, age: S, ageing: &Ageing<S>) {
        scan.carry(age, ageing);
        self.scan = scan;
        self.revision = self.revision.wrapping_add(1);
    }

    /// Takes all obstacles out, and the scan.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.clusters = Clusters::new();
        self.pace = Pace::default();
        self.scan = Scan::default();
        self.revision = self.revision.wrapping_add(1);
    }

    /// Counts the changes made by others (not the passage of time), so that a command can name the table it was
    /// computed from.
    pub fn revision(&self) -> u32 {
        self.revision
    }

    /// How many obstacles there are, the scan not counted.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// No obstacles, and no scan?
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty() && self.scan.points().is_empty()
    }

    /// The obstacles, in no particular order.
    pub fn iter(&self) -> impl Iterator<Item = &Entry<S, D>> {
        self.entries.iter()
    }

    /// The scan.
    pub fn scan(&self) -> &Scan<S, D> {
        &self.scan
    }

    /// Lets `dt` seconds pass, none if that is below 0 or no number: obstacles move on, and the ones nobody spoke of grow, then stop; the
    /// [module](self) has the formulas. How old they were before the step, as [`Status::EXTRAPOLATED`] and
    /// [`Status::HELD`], and [`Status::CLUSTER`] where some overlap without a common point.
    pub fn advance(&mut self, dt: S, ageing: &Ageing<S>) -> Status {
        let mut status = self.scan.status(ageing) | self.clusters.status();
        let fresh = ageing.time_to_live.min(ageing.hold);
        let dt = S::zero().max(dt);
        if dt > S::from_f64(pace::LONG) {
            for entry in &mut self.entries {
                if entry.age >= ageing.hold {
                    status |= Status::HELD;
                } else if entry.age >= fresh {
                    status |= Status::EXTRAPOLATED;
                }
                entry.pass(dt, ageing);
            }
            self.scan.pass(dt, ageing);
            return status;
        }
        for entry in &mut self.entries {
            if entry.age < fresh {
                entry.obstacle.advance(dt);
                entry.age += dt;
                if entry.age >= fresh && entry.age >= ageing.time_to_live {
                    // So that whoever looks next sees it coming.
                    entry.obstacle.ages(ageing.growth);
                }
                continue;
            }
            // Beyond the hold time nothing changes, so the age may stop there too and never loses its last digit.
            if entry.age >= ageing.hold {
                status |= Status::HELD;
                entry.obstacle.hold();
                continue;
            }
            entry.obstacle.advance_and_age(dt);
            status |= Status::EXTRAPOLATED;
            entry.age += dt;
            // In case it has changed: from the next step on, so that what was seen coming is what came.
            entry.obstacle.ages(ageing.growth);
        }
        self.scan.advance(dt, ageing);
        status
    }

    /// Other rules for ageing are in force from now on: those that are old say at once how fast they grow.
    pub(crate) fn rules_changed(&mut self, ageing: &Ageing<S>) {
        for entry in &mut self.entries {
            let grows = entry.age >= ageing.time_to_live && entry.age < ageing.hold;
            entry.obstacle.ages(if grows { ageing.growth } else { S::zero() });
        }
    }

    /// How all obstacles look from x, into `around`, which is new: its velocity is bent round them all. With
    /// `deformable` false every soft layer is ignored. `stride` is the step ahead, if what may bind it is to be listed.
    #[inline]
    pub(crate) fn look(
        &self,
        x: &Vector<S, D>,
        deformable: bool,
        stride: Option<&Stride<S>>,
        around: &mut Surroundings<S, D, CAP>,
    ) {
        // Here rather than in there, where each obstacle would load and store it.
        let mut modulation: Modulation<S, D, CAP> = Modulation::new(&around.velocity);
        let reach = stride.map(|stride| (stride.reach + self.pace.turning(stride), stride.dt));
        let (mut gamma, mut nearest) = (S::MAX, None);
        let (mut left, mut index) = (self.entries.iter(), 0);
        loop {
            if Abreast::<S, D>::WORTH_IT
                && let Some((few, others)) = left.as_slice().split_first_chunk()
                && let Some(abreast) = Abreast::new(few.each_ref().map(Entry::obstacle), x)
            {
                left = others.iter();
                modulation.push_abreast(&abreast);
                for (entry, one) in few.iter().zip(abreast.gamma.numbers()) {
                    if let Some((reach, _)) = reach {
                        around.note_near(&entry.obstacle, one, index, reach);
                    }
                    around.note_soft(&entry.obstacle, one, deformable, |o| o.soft_layer_at(x));
                    (gamma, nearest) = nearer((one, Some(entry)), (gamma, nearest));
                    index += 1;
                }
                continue;
            }
            let Some(entry) = left.next() else { break };
            let sample = entry.obstacle.sample(x);
            if let Some((reach, dt)) = reach {
                let reach = if entry.obstacle.moves() { reach + entry.obstacle.comes(&sample, dt) } else { reach };
                around.note_near(&entry.obstacle, sample.gamma, index, reach);
            }
            index += 1;
            if !(sample.gamma < S::FAR) {
                continue;
            }
            // First, so that what follows need not keep the sample at hand.
            modulation.push(&sample);
            around.note_soft(&entry.obstacle, sample.gamma, deformable, |o| o.soft_layer(x, sample.clone()));
            (gamma, nearest) = nearer((sample.gamma, Some(entry)), (gamma, nearest));
        }
        let (of_obstacles, mut points) = (gamma, None);
        if !self.scan.points().is_empty() {
            let (least, sample) = self.scan.sample(x);
            points = sample;
            if least < gamma {
                (gamma, nearest) = (least, None);
            }
        }
        (around.gamma, around.nearest) = (gamma, nearest.map(Entry::id));
        (around.velocity, around.unusable) = modulation.finish(of_obstacles, points.as_ref());
    }

    /// The obstacle at this place in the table.
    pub(crate) fn at(&self, index: usize) -> Option<&Obstacle<S, D>> {
        self.entries.get(index).map(|e| &e.obstacle)
    }
}
