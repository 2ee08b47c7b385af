//! Other learners of motions with this kind of certificate.

use super::Measured;
use crate::study::table::Table;

/// The thirty motions of the LASA handwriting set (Khansari-Zadeh & Billard 2011).
const LASA: [&str; 30] = [
    "Angle",
    "BendedLine",
    "CShape",
    "DoubleBendedLine",
    "GShape",
    "JShape",
    "JShape_2",
    "Khamesh",
    "LShape",
    "Leaf_1",
    "Leaf_2",
    "Line",
    "Multi_Models_1",
    "Multi_Models_2",
    "Multi_Models_3",
    "Multi_Models_4",
    "NShape",
    "PShape",
    "RShape",
    "Saeghe",
    "Sharpc",
    "Sine",
    "Snake",
    "Spoon",
    "Sshape",
    "Trapezoid",
    "WShape",
    "Worm",
    "Zshape",
    "heee",
];

/// Are all of these of the LASA set, by their names?
pub fn are_lasa(measured: &[Measured]) -> bool {
    measured.iter().all(|m| LASA.contains(&m.name.as_str()))
}

/// What another learner does on the thirty motions.
pub struct Peer {
    /// What it is.
    pub name: &'static str,
    /// Motions that were tried.
    pub tried: u32,
    /// Of those, motions it learns, where that was counted.
    pub learnt: Option<u32>,
    /// Of those tried, motions whose certificate does not hold.
    pub broken: u32,
    /// Median time of a motion, s.
    pub seconds: f64,
    /// Medians of RMSE (mm/s), e_dot, DTWD (mm), where the seed does not decide.
    pub medians: Option<[f64; 3]>,
}

/// Measured for this project before its own learner was written, not taken from their authors.
pub const PEERS: [Peer; 3] = [
    Peer { name: "lpvds (DAMM, SCS), as it comes", tried: 11, learnt: None, broken: 6, seconds: 20.0, medians: None },
    Peer {
        name: "lpvds with Clarabel",
        tried: 30,
        learnt: Some(27),
        broken: 0,
        seconds: 0.58,
        medians: Some([5.10, 0.061, 652.0]),
    },
    Peer {
        name: "ds-opt's recipe (EM and BIC, P of CLF-DM, convex fit)",
        tried: 30,
        learnt: Some(30),
        broken: 0,
        seconds: 0.43,
        medians: Some([3.72, 0.038, 385.0]),
    },
];

/// Whose figures these are.
pub const SOURCE: &str = "Beside other learners. Their figures were measured once for this project, on all 30 motions (lpvds as it comes: 11 of \
them) and a 2-core machine, by the same definitions and every fifth sample too; they are neither their authors' nor measured by this command. \
lpvds: Sun et al. 2023 (DAMM). ds-opt: Figueroa & Billard 2018";

/// The table's head.
pub fn table() -> Table {
    let header = ["learner", "learnt", "certificate broken", "s a motion", "RMSE mm/s", "e_dot", "DTWD mm"];
    Table::new("peers", SOURCE, &header)
}
