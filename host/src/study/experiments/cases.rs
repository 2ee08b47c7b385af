//! The experiments A1 to D1: what the paper's Table I puts on the table, in metres, on the path of its S-shape.

use crate::sim::Perception;
use crate::study::column::{Column, THETA};
use crate::study::skill::{Skill, Skills};
use crate::study::world::{Body, World};

/// Where A's cylinder is: at this share of the path, this far to its left, m.
pub const A_PLACE: (f64, f64) = (0.65, 0.02);
/// Where B's pair is: at this share of the path, cores this far apart, m, the cylinder to the left (1) or right (-1).
pub const B_PLACE: (f64, f64, f64) = (0.41, 0.0125, -1.0);
/// How far apart B2's hard pair is moved, so that there is a way between, m.
const B2_GAP: f64 = 0.03;
/// What the perception of D1 is like: m, and ticks (ms).
const NOISE: f64 = 0.002;
const LATENCY: u64 = 15;
/// The hard cylinder of A, B and D, m; soft to 1.5 times that.
const CYLINDER: [f64; 2] = [0.04, 0.04];
/// The hard elliptic cylinder of B, m.
const ELLIPSE: [f64; 2] = [0.08, 0.04];
/// ln k + 1 for k = e^0.5.
const RATIO: f64 = 1.5;

/// An experiment.
#[derive(Clone, Debug)]
pub struct Case<'a> {
    /// As the paper calls it.
    pub id: &'static str,
    /// What is there.
    pub world: World<'a>,
    /// By the paper's method, or by the original one?
    pub ours: bool,
    /// How well what is there is seen.
    pub perception: Perception,
}

impl Case<'_> {
    /// The ways it is computed: one for the original method, two for the paper's.
    pub fn columns(&self) -> &'static [Column] {
        if self.ours { &[Column::Pliant, Column::Letter(THETA)] } else { &[Column::Original] }
    }
}

/// A's cylinder at a share of a path, so far to its left, m.
pub fn one(skill: &Skill, share: f64, left: f64) -> Vec<Body> {
    let place = skill.place(share);
    vec![Body::new("cylinder", CYLINDER, RATIO, place.at + place.left() * left, 0.0)]
}

/// B's cylinder and ellipse on both sides of a path, cores `gap` apart, m; the ellipse lies along the path.
pub fn two(skill: &Skill, share: f64, gap: f64, side: f64) -> Vec<Body> {
    let place = skill.place(share);
    let out = place.left() * side;
    let cylinder = Body::new("cylinder", CYLINDER, RATIO, place.at + out * (gap / 2.0 + CYLINDER[0]), 0.0);
    let mut ellipse = Body::new("ellipse", ELLIPSE, RATIO, place.at, place.heading());
    ellipse.center -= out * (gap / 2.0 + ellipse.reach(&out));
    vec![cylinder, ellipse]
}

fn hardened(bodies: &[Body]) -> Vec<Body> {
    bodies.iter().map(Body::hardened).collect()
}

/// C's five along the arch: a rigid cylinder, and two pairs whose layers overlap.
fn five(skill: &Skill) -> Vec<Body> {
    let beside = |name: &str, axes: [f64; 2], ratio: f64, share: f64, left: f64, turn: f64| {
        let place = skill.place(share);
        Body::new(name, axes, ratio, place.at + place.left() * left, place.heading() + turn)
    };
    vec![
        beside("rigid cylinder", CYLINDER, 1.0, 0.5, -0.055, 0.0),
        beside("soft slim ellipse", [0.05, 0.02], 2.5, 0.2, 0.04, 0.0),
        beside("first padded ellipse", [0.08, 0.04], RATIO, 0.22, -0.065, 0.0),
        beside("soft round ellipse", [0.06, 0.05], 2.0, 0.8, 0.075, 0.0),
        beside("second padded ellipse", [0.10, 0.05], RATIO, 0.8, -0.075, 0.0),
    ]
}

/// Where D's obstacle waits for the robot, by a share of the path, and from when to when, by the share of the path that the motion without it
/// would then have done: the top of the S, its middle, its bottom.
const STATIONS: [(f64, f64, f64); 3] = [(0.24, 0.0, 0.3), (0.52, 0.46, 0.6), (0.82, 0.76, 0.9)];
/// How far to the left of the path each is, m.
const D_BESIDE: f64 = 0.032;
/// Straight pieces of the way from one to the next.
const PIECES: u32 = 12;

/// D's way from station to station, as a hand moves things: it sets out and arrives gently.
fn moving(skill: &Skill) -> Vec<Body> {
    let stations = STATIONS.map(|(share, there, leaves)| {
        let place = skill.place(share);
        (place.at + place.left() * D_BESIDE, skill.time(there), skill.time(leaves))
    });
    let [(top, ..), ..] = stations;
    let mut path = vec![[0.0, top.x, top.y]];
    for pair in stations.windows(2) {
        let [(from, _, leaves), (to, there, _)] = [pair[0], pair[1]];
        path.extend((0..=PIECES).map(|i| {
            let u = f64::from(i) / f64::from(PIECES);
            let at = from + (to - from) * (u * u * (3.0 - 2.0 * u));
            [leaves + (there - leaves) * u, at.x, at.y]
        }));
    }
    vec![Body { path, ..Body::new("cylinder", CYLINDER, RATIO, top, 0.0) }]
}

/// When a figure shows D, s: at each station.
pub fn moments(skill: &Skill) -> [f64; 3] {
    STATIONS.map(|(_, there, leaves)| (skill.time(there) + skill.time(leaves)) / 2.0)
}

/// All of them; `seed` is of the noise in what D1 sees.
pub fn cases(skills: &Skills, seed: u64) -> Vec<Case<'_>> {
    let s = &skills.s;
    let exact = Perception::default();
    let case = |id, bodies, ours| Case { id, world: World::new(s, bodies), ours, perception: exact };
    let a = one(s, A_PLACE.0, A_PLACE.1);
    let b = two(s, B_PLACE.0, B_PLACE.1, B_PLACE.2);
    let apart = {
        // As hard as B4's, and moved from the path until the way between them is open.
        let place = s.place(B_PLACE.0);
        let mut all = hardened(&b);
        for (body, side) in all.iter_mut().zip([B_PLACE.2, -B_PLACE.2]) {
            let out = place.left() * side;
            body.center = place.at + out * (B2_GAP / 2.0 + body.reach(&out));
        }
        all
    };
    vec![
        case("A1", a.clone(), true),
        case("A2", hardened(&a), false),
        case("A3", a, false),
        case("B1", b.clone(), true),
        case("B2", apart, false),
        case("B3", b.clone(), false),
        case("B4", hardened(&b), false),
        Case { id: "C1", world: World::new(&skills.recorded, five(&skills.recorded)), ours: true, perception: exact },
        Case {
            id: "D1",
            world: World::new(s, moving(s)),
            ours: true,
            perception: Perception { noise: NOISE, latency: LATENCY, seed },
        },
    ]
}
