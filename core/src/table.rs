//! The obstacles there are, in room for a fixed number of them.

use crate::obstacle::Sample;
use crate::{Obstacle, Scalar, Status, Vector};

/// What happens to an obstacle that nobody speaks of any more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ageing<S> {
    /// Age, s, up to which an obstacle is carried on by its velocity and trusted.
    pub time_to_live: S,
    /// Beyond it every hard semi-axis grows by this, m/s, for what is not seen may be anywhere near.
    pub growth: S,
    /// Age, s, at which it stops moving and growing and is flagged as held.
    pub hold: S,
}

impl<S: Scalar> Default for Ageing<S> {
    /// 0.2 s, 0.02 m/s, 1 s.
    fn default() -> Self {
        Self { time_to_live: S::from_f64(0.2), growth: S::from_f64(0.02), hold: S::one() }
    }
}

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
    /// As it is now.
    pub fn obstacle(&self) -> &Obstacle<S, D> {
        &self.obstacle
    }
    /// Seconds since it was seen.
    pub fn age(&self) -> S {
        self.age
    }
}

/// There is no room for another obstacle; none was dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableFull;

/// At most `CAP` obstacles by their identifiers.
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
#[derive(Clone, Debug, Default)]
pub struct Table<S: Scalar, const D: usize, const CAP: usize> {
    entries: heapless::Vec<Entry<S, D>, CAP>,
    revision: u32,
}

impl<S: Scalar, const D: usize, const CAP: usize> Table<S, D, CAP> {
    /// An empty table.
    pub fn new() -> Self {
        Self { entries: heapless::Vec::new(), revision: 0 }
    }

    /// Puts an obstacle in, or in the place of the one with the same identifier. `age` is how many seconds ago it was seen as
    /// described; it is carried on to now as [`Table::advance`] would have done.
    ///
    /// # Errors
    /// [`TableFull`]; then nothing has changed.
    pub fn upsert(
        &mut self,
        id: u16,
        mut obstacle: Obstacle<S, D>,
        age: S,
        ageing: &Ageing<S>,
    ) -> Result<(), TableFull> {
        let age = age.max(S::zero()).min(ageing.hold);
        if age > S::zero() {
            obstacle.carry(age);
        }
        if age > ageing.time_to_live {
            obstacle.grow(ageing.growth, age - ageing.time_to_live);
        }
        if age >= ageing.hold {
            obstacle.hold();
        }
        let entry = Entry { id, obstacle, age };
        match self.entries.iter_mut().find(|e| e.id == id) {
            Some(old) => *old = entry,
            None => self.entries.push(entry).map_err(|_| TableFull)?,
        }
        self.revision = self.revision.wrapping_add(1);
        Ok(())
    }

    /// Takes an obstacle out; was it there?
    pub fn remove(&mut self, id: u16) -> bool {
        let Some(index) = self.entries.iter().position(|e| e.id == id) else {
            return false;
        };
        self.entries.swap_remove(index);
        self.revision = self.revision.wrapping_add(1);
        true
    }

    /// Takes all obstacles out.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.revision = self.revision.wrapping_add(1);
    }

    /// Counts the changes made by others (not the passage of time), so that a command can name the table it was computed from.
    pub fn revision(&self) -> u32 {
        self.revision
    }

    /// How many obstacles there are.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// No obstacles?
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The obstacles, in no particular order.
    pub fn iter(&self) -> impl Iterator<Item = &Entry<S, D>> {
        self.entries.iter()
    }

    /// Lets `dt` seconds pass: obstacles move on, and the ones nobody spoke of grow, then stop.
    pub fn advance(&mut self, dt: S, ageing: &Ageing<S>) {
        for entry in &mut self.entries {
            // Beyond the hold time nothing changes, so the age may stop there too and never loses its last digit.
            if entry.age >= ageing.hold {
                entry.obstacle.hold();
                continue;
            }
            entry.obstacle.advance(dt);
            if entry.age >= ageing.time_to_live {
                entry.obstacle.grow(ageing.growth, dt);
            }
            entry.age += dt;
        }
    }

    /// How old obstacles are, as status flags.
    pub fn status(&self, ageing: &Ageing<S>) -> Status {
        self.entries.iter().fold(Status::empty(), |status, entry| {
            if entry.age >= ageing.hold {
                status | Status::HELD
            } else if entry.age >= ageing.time_to_live {
                status | Status::EXTRAPOLATED
            } else {
                status
            }
        })
    }

    /// All obstacles as they look from x. With `deformable` false every soft layer is ignored.
    pub(crate) fn surroundings(&self, x: &Vector<S, D>, deformable: bool) -> Surroundings<S, D, CAP> {
        let mut around = Surroundings { samples: heapless::Vec::new(), gamma: S::MAX, nearest: None };
        for entry in &self.entries {
            let (gamma, sample) = entry.obstacle.sample(x);
            if gamma < around.gamma {
                (around.gamma, around.nearest) = (gamma, Some(entry.id));
            }
            if let Some(mut sample) = sample {
                if !deformable {
                    sample.gamma_soft = S::MAX;
                }
                // Cannot be full: it has the table's own capacity.
                let _ = around.samples.push(sample);
            }
        }
        around
    }
}

/// The obstacles that matter at one point.
pub(crate) struct Surroundings<S: Scalar, const D: usize, const CAP: usize> {
    pub samples: heapless::Vec<Sample<S, D>, CAP>,
    /// The least Gamma; the largest number there is if there is no obstacle.
    pub gamma: S,
    /// Whose it is.
    pub nearest: Option<u16>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ObstacleSpec;

    fn moving() -> Obstacle<f64, 2> {
        let velocity = Vector::<f64, 2>::new(0.1, 0.0);
        Obstacle::new(ObstacleSpec { velocity, ..ObstacleSpec::default() }).unwrap()
    }

    #[test]
    fn an_old_obstacle_moves_then_grows_then_is_held() {
        let ageing = Ageing::default();
        let mut table: Table<f64, 2, 2> = Table::new();
        table.upsert(1, moving(), 0.05, &ageing).unwrap();
        let x = |t: &Table<f64, 2, 2>| t.iter().next().unwrap().obstacle().spec().center.x;
        let gamma = |t: &Table<f64, 2, 2>| {
            let o = t.iter().next().unwrap().obstacle();
            o.gamma(&(o.spec().center + Vector::<f64, 2>::new(0.05, 0.0)))
        };
        assert!((x(&table) - 0.005).abs() < 1e-12, "carried on by its age");
        for _ in 0..100 {
            table.advance(0.001, &ageing);
        }
        assert!(table.status(&ageing).is_empty() && (gamma(&table) - 1.0).abs() < 1e-9);
        for _ in 0..350 {
            table.advance(0.001, &ageing);
        }
        assert_eq!(table.status(&ageing), Status::EXTRAPOLATED);
        assert!(gamma(&table) < 0.9, "grown: {}", gamma(&table));
        for _ in 0..2000 {
            table.advance(0.001, &ageing);
        }
        assert_eq!(table.status(&ageing), Status::HELD);
        let held = x(&table);
        assert!((held - 0.1).abs() < 1e-3, "{held}");
        table.advance(0.001, &ageing);
        assert_eq!(x(&table), held);
    }

    #[test]
    fn an_old_sighting_is_as_if_it_had_aged_here() {
        let ageing = Ageing::default();
        let spin = crate::rotation::planar_spin(5.0);
        let velocity = Vector::<f64, 2>::new(0.1, -0.2);
        let axes = Vector::<f64, 2>::new(0.08, 0.04);
        let turning = || Obstacle::new(ObstacleSpec { velocity, spin, axes, ..ObstacleSpec::default() }).unwrap();
        for milliseconds in [0, 50, 300, 999, 1000, 5000] {
            let (mut here, mut there): (Table<f64, 2, 1>, Table<f64, 2, 1>) = (Table::new(), Table::new());
            here.upsert(1, turning(), 0.0, &ageing).unwrap();
            for _ in 0..milliseconds {
                here.advance(0.001, &ageing);
            }
            there.upsert(1, turning(), f64::from(milliseconds) * 0.001, &ageing).unwrap();
            for table in [&mut here, &mut there] {
                table.advance(0.001, &ageing);
            }
            let x = Vector::<f64, 2>::new(0.3, 0.1);
            let look = |t: &Table<f64, 2, 1>| {
                let o = t.iter().next().unwrap().obstacle();
                [o.gamma(&x), o.surface_velocity(&x).x, o.surface_velocity(&x).y]
            };
            for (a, b) in look(&here).into_iter().zip(look(&there)) {
                assert!((a - b).abs() < 5e-3 * (1.0 + a.abs()), "{milliseconds} ms: {a} {b}");
            }
        }
    }

    #[test]
    fn every_change_has_its_revision() {
        let mut table: Table<f64, 2, 2> = Table::new();
        table.upsert(1, moving(), 0.0, &Ageing::default()).unwrap();
        table.advance(0.001, &Ageing::default());
        assert_eq!(table.revision(), 1);
        assert!(!table.remove(2));
        assert_eq!(table.revision(), 1);
        assert!(table.remove(1));
        table.clear();
        assert_eq!(table.revision(), 3);
    }
}
