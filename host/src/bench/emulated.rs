//! Instructions a tick on emulated boards, counted by QEMU, and whether the boards' commands have the bits of this machine's.
//!
//! Counts do not depend on this machine or what else it does: an instruction is an instruction. How long one takes on a board is for the board
//! to say; on a Cortex-M4 without wait states it is below two cycles.

use std::io::{BufRead, BufReader};
use std::process::Stdio;

use pliant_bench::{Kind, bits};
use pliant_core::scalar::Fixed;
use serde::{Deserialize, Serialize};

use crate::bridge::BridgeError;
use crate::bridge::device::emulator::{Emulator, Image};

/// Boards, each with an image that measures what the core is good at.
const IMAGES: [Image; 2] = [
    Image { machine: "mps2-an386", package: "pliant-mps2-bench", target: "thumbv7em-none-eabihf" },
    Image { machine: "mps2-an385", package: "pliant-mps2-bench", target: "thumbv6m-none-eabi" },
];

/// One instruction, 64 ns of emulated time, whatever the machine does: what the image counts by.
const COUNTING: [&str; 6] = ["-icount", "shift=6,align=off,sleep=off", "-serial", "null", "-nic", "none"];

/// What to do.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// Ticks of each case.
    pub ticks: u32,
    /// Ticks whose bits are compared.
    pub bits: u32,
    /// Only scenes of this kind.
    pub scene: Option<Kind>,
}

/// Instructions a tick, with so many obstacles.
#[derive(Clone, Debug, Serialize)]
pub struct Ticks {
    /// Obstacles.
    pub obstacles: u16,
    /// Of the workspace.
    pub dimension: usize,
    /// Components of the skill.
    pub k: usize,
    /// The number type.
    pub scalar: String,
    /// The processor.
    pub core: String,
    /// Median in the common case, ellipsoids in soft layers.
    pub instructions_per_tick: u32,
    /// The longest of any scene without range points.
    pub worst: u32,
    /// Every scene.
    pub scenes: Vec<Scene>,
}

/// Instructions a tick in one kind of scene, half of the positions adverse.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Scene {
    /// Its name: see `pliant_bench::Kind`.
    pub scene: String,
    /// Range points of a scan.
    pub points: usize,
    /// Ticks measured.
    pub ticks: u32,
    /// Half of them took no more.
    pub median: u32,
    /// 99 % took no more.
    pub p99: u32,
    /// The longest.
    pub worst: u32,
}

/// Instructions that it takes to put an obstacle into a full table; which cores overlap is found then.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Upserts {
    /// Obstacles that the table has room for.
    pub room: usize,
    /// See `pliant_bench::Kind`; `groups` are eights that overlap, with one obstacle that comes to overlap them all and goes again.
    pub scene: String,
    /// Of the workspace.
    pub dimension: usize,
    /// The number type.
    pub scalar: String,
    /// The processor.
    pub core: String,
    /// Upserts measured.
    pub upserts: u32,
    /// Half of them took no more.
    pub median: u32,
    /// 99 % took no more.
    pub p99: u32,
    /// The longest.
    pub worst: u32,
}

/// A digest of commands, from a board and from here.
#[derive(Clone, Debug, Serialize)]
pub struct Bits {
    /// Commands.
    pub ticks: u32,
    /// The number type.
    pub scalar: String,
    /// The processor.
    pub core: String,
    /// What the board computed,
    pub board: String,
    /// and what this machine did.
    pub host: String,
}

impl Bits {
    /// All the same?
    pub fn equal(&self) -> bool {
        self.board == self.host
    }
}

/// What a board says, a line each.
#[derive(Deserialize)]
#[serde(untagged)]
enum Line {
    Upserts(Upserts),
    Case {
        obstacles: u16,
        dimension: usize,
        k: usize,
        scalar: String,
        core: String,
        #[serde(flatten)]
        scene: Scene,
    },
    /// A part of a case took longer than the board can count: no figures.
    Overflow {
        overflow: String,
        scene: String,
        core: String,
    },
    Bits {
        bits: u32,
        scalar: String,
        core: String,
        digest: String,
    },
}

/// All that the boards said.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Report {
    /// A line for each number of obstacles.
    pub ticks: Vec<Ticks>,
    /// A line for each scene.
    pub upserts: Vec<Upserts>,
    /// A line for each number type.
    pub bits: Vec<Bits>,
}

/// Runs every board's image; `each` is told of every case as it is done.
///
/// # Errors
/// QEMU or an image is missing, or an image failed.
pub fn measure(wanted: Wanted, mut each: impl FnMut(&str)) -> Result<Report, BridgeError> {
    let mut report = Report::default();
    for image in &IMAGES {
        let emulator = Emulator::find(image)?;
        let scene = wanted.scene.map(|kind| format!("scene={}", kind.name()));
        let words = ["bench".into(), format!("ticks={}", wanted.ticks), format!("bits={}", wanted.bits)];
        let words: Vec<String> = words.into_iter().chain(scene).collect();
        let mut process = emulator.start(COUNTING, &words, Stdio::piped())?;
        let lost = |error| BridgeError::Emulator(format!("what {} says was lost: {error}", image.machine));
        for line in process.stdout().map(BufReader::new).into_iter().flat_map(BufReader::lines) {
            report.take(&line.map_err(lost)?, &mut each);
        }
        process.finish()?;
    }
    Ok(report)
}

impl Report {
    fn take(&mut self, line: &str, each: &mut impl FnMut(&str)) {
        match serde_json::from_str(line) {
            Ok(Line::Upserts(upserts)) => {
                each(&format!("{}, an upsert into {}, {}", upserts.core, upserts.room, upserts.scene));
                self.upserts.push(upserts);
            }
            Ok(Line::Case { obstacles, dimension, k, scalar, core, scene }) => {
                each(&format!("{core}, {obstacles} obstacles in {dimension}-D, {}", scene.scene));
                let same = |t: &Ticks| (t.obstacles, t.dimension, t.k) == (obstacles, dimension, k) && t.core == core;
                let at = self.ticks.iter().position(same).unwrap_or_else(|| {
                    let (instructions_per_tick, worst, scenes) = (scene.median, 0, Vec::new());
                    self.ticks.push(Ticks {
                        obstacles,
                        dimension,
                        k,
                        scalar,
                        core,
                        instructions_per_tick,
                        worst,
                        scenes,
                    });
                    self.ticks.len() - 1
                });
                let ticks = &mut self.ticks[at];
                if scene.points == 0 {
                    ticks.worst = ticks.worst.max(scene.worst);
                }
                ticks.scenes.push(scene);
            }
            Ok(Line::Bits { bits: ticks, scalar, core, digest: board }) => {
                let host = match scalar.as_str() {
                    "fixed" => bits::run::<Fixed>(ticks, |_, _| ()),
                    _ => bits::run::<f32>(ticks, |_, _| ()),
                };
                self.bits.push(Bits { ticks, scalar, core, board, host: format!("{host:016x}") });
            }
            Ok(Line::Overflow { overflow, scene, core }) => {
                each(&format!("{core}, {overflow}, {scene}: longer than the board can count, and left out"));
            }
            // Not for us.
            Err(_) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_one_case_go_together() {
        let mut report = Report::default();
        let line = |scene: &str, points: usize, median: u32, worst: u32| {
            format!(
                r#"{{"part":"tick","obstacles":8,"points":{points},"scene":"{scene}","dimension":2,"k":4,"scalar":"fixed","core":"M0",
                "ticks":10,"median":{median},"p99":1,"worst":{worst},"worst_at":3,"digest":"0"}}"#
            )
        };
        for text in [line("ellipsoids", 0, 5, 7), line("mixed", 0, 8, 9), line("mixed", 128, 80, 90)] {
            report.take(&text, &mut |_| ());
        }
        let [ticks] = report.ticks.as_slice() else { panic!("{report:?}") };
        assert_eq!((ticks.instructions_per_tick, ticks.worst, ticks.scenes.len()), (5, 9, 3));
        let line = r#"{"part":"upsert","room":64,"scene":"groups","dimension":2,"scalar":"f32","core":"M4","upserts":5,"median":1,"p99":2,"worst":3,"worst_at":4}"#;
        report.take(line, &mut |_| ());
        assert_eq!((report.upserts.len(), report.upserts[0].worst, report.ticks.len()), (1, 3, 1));
        report.take("something else", &mut |_| ());
        let digest = bits::run::<Fixed>(1000, |_, _| ());
        report.take(&format!(r#"{{"bits":1000,"scalar":"fixed","core":"M0","digest":"{digest:016x}"}}"#), &mut |_| ());
        assert!(report.bits[0].equal());
    }
}
