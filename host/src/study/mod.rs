//! The studies and experiments of the paper, run again: tables, figures, and whether its claims hold.
//!
//! Everything is computed three ways ([`mod@column`]): the paper to the letter, Pliant's default, and the method the paper builds on. A part of the
//! paper is a module: [`trajectories`] (Fig. 3), [`stiffness_time`] and [`reduction`] (Fig. 4), [`experiments`] (section V), and what the paper
//! does not show, [`placements`]. Beside them [`lasa`] learns a whole set of motions. Each ends with [`Findings`]. The same seed gives the same findings on any number of cores.
//!
//! ```
//! use pliant::study::skill::Skills;
//! # fn main() -> Result<(), pliant::error::Error> {
//! let skills = Skills::new(None, &|_| {})?; // the project's own motions
//! assert!((skills.s.place(1.0).at - skills.s.goal()).norm() < 0.01);
//! # Ok(())
//! # }
//! ```

pub mod column;
pub mod cpu;
pub mod drive;
pub mod experiments;
pub mod findings;
pub mod lasa;
pub mod measure;
pub mod parallel;
pub mod placements;
pub mod reduction;
pub mod skill;
pub mod stiffness_time;
pub mod table;
pub mod trajectories;
pub mod world;

pub use findings::{Findings, Verdict};

use crate::error::Error;
use crate::plot::chart::charts;
use skill::Skills;

/// Both of the paper's studies of time, with the figure they share.
///
/// # Errors
/// None for the skills there are.
pub fn time(skills: &Skills, done: &(dyn Fn(usize) + Sync)) -> Result<Findings, Error> {
    let (mut found, left) = stiffness_time::study(skills, done)?;
    let (other, right) = reduction::study(skills, done)?;
    found.append(other);
    let caption = "Time past an obstacle as its soft layer becomes thicker, and time saved against the original method by where a motion starts \
                   (a cell a start, in an area as large as the paper's; the circle is where the demonstrations start in the mean, the star the goal)";
    found.figures.push(("time", caption.into(), charts(&[left, right], 2, 560.0)));
    Ok(found)
}
