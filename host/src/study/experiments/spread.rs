//! The claims of the experiments over other places than the one that was chosen: a figure that depends on the place is one of many.

use super::cases::{one, two};
use super::outcome::{intersection, soft};
use crate::error::Error;
use crate::study::column::Column;
use crate::study::drive::{Driving, Robot, Step, drive};
use crate::study::findings::Verdict;
use crate::study::measure::{change_percent, mean_speed, sorted};
use crate::study::parallel;
use crate::study::skill::Skill;
use crate::study::table::signed;
use crate::study::world::{Body, World};

/// How much faster (in percent) robots are than by the original method, each by the place of the obstacles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spread {
    /// In the soft layer of one cylinder, by increasing gain.
    pub soft: Vec<f64>,
    /// Where two layers overlap, likewise.
    pub intersection: Vec<f64>,
    /// Places at which the default touched a core, or missed the goal though the original method did not.
    pub failed: usize,
    /// Places at which one of the two never met the layer, or the overlap: nothing to compare.
    pub unmet: usize,
    /// Places at which the original method did, which leaves nothing to compare with; and those of them at which the default did too.
    pub void: (usize, usize),
}

/// Shares of the path at which obstacles are put.
const SHARES: [f64; 18] =
    [0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95];
/// How far to the left of the path the cylinder is, m.
const LEFT: [f64; 6] = [-0.04, -0.025, -0.01, 0.01, 0.025, 0.04];
/// How far apart the cores of a pair are, m: from hardly passable to layers that hardly overlap.
const GAPS: [f64; 6] = [0.0125, 0.015, 0.0175, 0.02, 0.025, 0.03];

/// Over places along the whole path and on both sides of it.
///
/// # Errors
/// None: a place at which a scene is not allowed (a core on the start) is left out.
pub fn spread(skill: &Skill, done: &(dyn Fn(usize) + Sync)) -> Result<Spread, Error> {
    let mut worlds: Vec<(bool, Vec<Body>)> = Vec::new();
    for share in SHARES {
        worlds.extend(LEFT.iter().map(|left| (true, one(skill, share, *left))));
        worlds.extend(GAPS.iter().flat_map(|gap| [-1.0, 1.0].map(|side| (false, two(skill, share, *gap, side)))));
    }
    let found = parallel::map(&worlds, done, |(single, bodies)| {
        let within: fn(&Step) -> bool = if *single { soft } else { intersection };
        let world = World::new(skill, bodies.clone());
        let of = |column: Column| {
            // A core on the start or the goal is a place that cannot be.
            let Ok(scene) = world.scene("place", column) else { return Ok(None) };
            let run = drive(&scene, &skill.start, &Driving::of(Robot::Lagging), None)?;
            Ok::<_, Error>(Some((mean_speed(&run, within), run.reached, run.touched())))
        };
        let (ours, original) = (of(Column::Pliant)?, of(Column::Original)?);
        Ok(ours.zip(original).map(|((ours, arrived, touched), (original, by_original, on_original))| {
            let change = ours.zip(original).map(|(ours, original)| change_percent(ours, original));
            Place { single: *single, arrived, touched, comparable: by_original && !on_original, change }
        }))
    })?;
    let all = || found.iter().flatten();
    let changes = |single: bool| sorted(all().filter(|p| p.single == single && p.comparable).filter_map(|p| p.change));
    let void = || all().filter(|p| !p.comparable);
    Ok(Spread {
        soft: changes(true),
        intersection: changes(false),
        failed: all().filter(|p| p.touched || (p.comparable && !p.arrived)).count(),
        unmet: all().filter(|p| p.comparable && p.change.is_none()).count(),
        void: (void().count(), void().filter(|p| !p.arrived || p.touched).count()),
    })
}

impl Spread {
    /// Is the sign of both claims the same at every place?
    pub fn verdict(&self) -> Verdict {
        let faster = self.soft.iter().filter(|x| **x > 0.0).count();
        let slower = self.intersection.iter().filter(|x| **x < 0.0).count();
        let range =
            |all: &[f64]| format!("{} to {} %", signed(all.first().copied(), 1), signed(all.last().copied(), 1));
        Verdict {
            claim: "faster in a soft layer, slower in an intersection, wherever the obstacles are".into(),
            paper: "-".into(),
            measured: format!(
                "faster at {faster} of {} places ({}), slower at {slower} of {} ({}); at {} more a path does not meet what is compared; at {} the original never arrives, and at {} of these neither does the default",
                self.soft.len(),
                range(&self.soft),
                self.intersection.len(),
                range(&self.intersection),
                self.unmet,
                self.void.0,
                self.void.1
            ),
            holds: (!self.soft.is_empty() || !self.intersection.is_empty())
                .then_some((faster, slower, self.failed) == (self.soft.len(), self.intersection.len(), 0)),
            vital: false,
        }
    }
}

/// What came of a place.
struct Place {
    single: bool,
    arrived: bool,
    touched: bool,
    /// Did the original method arrive, and touch nothing?
    comparable: bool,
    change: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_place_with_the_other_sign_is_enough_to_fail() {
        let spread = |soft: &[f64], intersection: &[f64]| Spread {
            soft: soft.to_vec(),
            intersection: intersection.to_vec(),
            ..Spread::default()
        };
        let holds = |soft: &[f64], intersection: &[f64]| spread(soft, intersection).verdict().holds;
        assert_eq!(holds(&[0.1, 9.0], &[-9.0, -0.1]), Some(true));
        assert_eq!(holds(&[-0.1, 9.0], &[-9.0, -0.1]), Some(false), "slower in a soft layer");
        assert_eq!(holds(&[0.1, 9.0], &[-9.0, 0.1]), Some(false), "faster in an intersection");
        assert_eq!(holds(&[-9.0, -0.1], &[0.1, 9.0]), Some(false), "both the wrong way round");
        assert_eq!(holds(&[0.0], &[-1.0]), Some(false), "no change is no gain");
        assert_eq!(holds(&[], &[-1.0]), Some(true));
        assert_eq!(holds(&[], &[]), None);
        assert_eq!(Spread { failed: 1, ..spread(&[1.0], &[-1.0]) }.verdict().holds, Some(false), "a core, or no goal");
        let says = spread(&[-0.1, 9.0], &[-9.0, 0.1]).verdict().measured;
        assert!(says.contains("faster at 1 of 2 places (-0.1 to +9.0 %), slower at 1 of 2 (-9.0 to +0.1 %)"), "{says}");
    }
}
