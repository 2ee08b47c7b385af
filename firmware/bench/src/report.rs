//! What a board measures and prints, one JSON object a line: the same program for every board.

use core::fmt::{self, Write};

use crate::timing::{self, Case, Clock, Part};
use crate::{Kind, Number, bits};
use pliant_core::scalar::Fixed;

/// Most ticks of a case.
pub const MAX_TICKS: usize = 20_000;

/// Most upserts of a case: some take as long as many ticks.
const MAX_UPSERTS: u32 = 1_000;

/// What to print, as it is asked for by words: `ticks=N` (of each case; 0 for none), `parts` (each part of a tick as well), `bits=N` (a digest
/// of N ticks; 0 for none), `blocks` (and of each thousand), `obstacles=N`, `dimension=N`, `points=N`, `scene=NAME` (only such cases).
///
/// ```
/// use pliant_bench::report::Wanted;
/// let wanted = Wanted::parse("bench ticks=500 bits=0 parts");
/// assert_eq!(wanted, Wanted { ticks: 500, parts: true, bits: 0, blocks: false, obstacles: None, dimension: None, points: None, scene: None });
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// Ticks of each case, at most [`MAX_TICKS`].
    pub ticks: u32,
    /// Each part of a tick as well as the whole?
    pub parts: bool,
    /// Ticks that go into the digest.
    pub bits: u32,
    /// The digests of blocks too?
    pub blocks: bool,
    /// Only cases with so many obstacles.
    pub obstacles: Option<u16>,
    /// Only cases of this dimension.
    pub dimension: Option<usize>,
    /// Only cases with a scan of so many points.
    pub points: Option<usize>,
    /// Only cases of this kind.
    pub scene: Option<Kind>,
}

impl Default for Wanted {
    /// What a report is made from: 10 000 ticks of each case.
    fn default() -> Self {
        Self {
            ticks: 10_000,
            parts: false,
            bits: 0,
            blocks: false,
            obstacles: None,
            dimension: None,
            points: None,
            scene: None,
        }
    }
}

impl Wanted {
    /// Reads the words; those it does not know are somebody else's.
    pub fn parse(words: &str) -> Self {
        words.split_whitespace().fold(Self::default(), |wanted, word| match word.split_once('=') {
            Some(("ticks", n)) => Self { ticks: n.parse().unwrap_or(wanted.ticks).min(MAX_TICKS as u32), ..wanted },
            Some(("bits", n)) => Self { bits: n.parse().unwrap_or(wanted.bits), ..wanted },
            Some(("obstacles", n)) => Self { obstacles: n.parse().ok(), ..wanted },
            Some(("dimension", n)) => Self { dimension: n.parse().ok(), ..wanted },
            Some(("points", n)) => Self { points: n.parse().ok(), ..wanted },
            Some(("scene", name)) => Self { scene: Kind::ALL.into_iter().find(|kind| kind.name() == name), ..wanted },
            None if word == "parts" => Self { parts: true, ..wanted },
            None if word == "blocks" => Self { blocks: true, ..wanted },
            _ => wanted,
        })
    }
}

/// What a core's ticks are measured in. The board gives the clock, the room for the counts and where to print.
pub struct Bench<'a, C, W> {
    /// The core, as reports call it.
    pub core: &'a str,
    /// What is counted.
    pub clock: C,
    /// Room for [`MAX_TICKS`] counts.
    pub counts: &'a mut [u32],
    /// Where lines go.
    pub out: W,
    /// What to print.
    pub wanted: Wanted,
}

impl<C: Clock, W: Write> Bench<'_, C, W> {
    /// The cases of a core with an FPU, in single precision, and the digest.
    ///
    /// # Errors
    /// Nothing can be printed.
    pub fn with_fpu(&mut self) -> fmt::Result {
        const K: usize = 8;
        self.cases::<f32, 2, 64>(0, K)?;
        self.cases::<f32, 2, 64>(8, K)?;
        self.cases::<f32, 2, 64>(16, K)?;
        self.cases::<f32, 2, 64>(64, K)?;
        self.cases::<f32, 3, 64>(0, K)?;
        self.cases::<f32, 3, 64>(16, K)?;
        self.upserts::<f32, 2, 64>()?;
        self.bits::<f32>()
    }

    /// The cases of a core without, in fixed point, and the digest.
    ///
    /// # Errors
    /// Nothing can be printed.
    pub fn without_fpu(&mut self) -> fmt::Result {
        const K: usize = 4;
        self.cases::<Fixed, 2, 8>(0, K)?;
        self.cases::<Fixed, 2, 8>(8, K)?;
        self.upserts::<Fixed, 2, 8>()?;
        self.bits::<Fixed>()
    }

    /// So many obstacles: as they usually are, mixed, in a crowd, and mixed with a scan.
    fn cases<S: Number, const D: usize, const CAP: usize>(&mut self, obstacles: u16, components: usize) -> fmt::Result {
        let kinds = [(Kind::Ellipsoids, 0), (Kind::Mixed, 0), (Kind::Crowd, 0), (Kind::Mixed, 128)];
        // Without obstacles all scenes are the same.
        let kinds = if obstacles == 0 { kinds.get(1..2) } else { Some(&kinds[..]) };
        let Wanted { ticks, obstacles: n, dimension, points: p, scene, .. } = self.wanted;
        let none = ticks == 0 || n.is_some_and(|n| n != obstacles) || dimension.is_some_and(|d| d != D);
        for (kind, points) in kinds.unwrap_or_default().iter().copied() {
            if none || scene.is_some_and(|scene| scene != kind) || p.is_some_and(|p| p != points) {
                continue;
            }
            let case = Case { obstacles, components, points, kind, ticks };
            for part in Part::ALL.into_iter().take(if self.wanted.parts { Part::ALL.len() } else { 1 }) {
                self.case::<S, D, CAP>(case, part)?;
            }
        }
        Ok(())
    }

    fn case<S: Number, const D: usize, const CAP: usize>(&mut self, case: Case, part: Part) -> fmt::Result {
        let figures = timing::measure::<S, D, CAP>(case, part, &mut self.clock, self.counts);
        // No number rather than a wrong one.
        let Ok(figures) = figures else { return self.overflow(part.name(), case.kind.name()) };
        let Case { obstacles, components, points, kind, ticks } = case;
        write!(self.out, r#"{{"part":"{}","obstacles":{obstacles},"points":{points},"#, part.name())?;
        write!(self.out, r#""scene":"{}","dimension":{D},"k":{components},"#, kind.name())?;
        write!(self.out, r#""scalar":"{}","core":"{}","ticks":{ticks},"#, S::NAME, self.core)?;
        let timing::Figures { median, p99, worst, worst_at, digest } = figures;
        write!(self.out, r#""median":{median},"p99":{p99},"worst":{worst},"worst_at":{worst_at},"#)?;
        writeln!(self.out, r#""digest":"{digest:016x}"}}"#)
    }

    /// Obstacles put into a full table.
    fn upserts<S: Number, const D: usize, const CAP: usize>(&mut self) -> fmt::Result {
        let Wanted { ticks, obstacles, dimension, points, scene, .. } = self.wanted;
        if ticks == 0
            || obstacles.is_some_and(|n| usize::from(n) != CAP)
            || dimension.is_some_and(|d| d != D)
            || points.is_some_and(|p| p != 0)
        {
            return Ok(());
        }
        let upserts = ticks.min(MAX_UPSERTS);
        for kind in Kind::ALL.into_iter().map(Some).chain([None]) {
            if scene.is_some() && scene != kind {
                continue;
            }
            let figures = timing::measure_upserts::<S, D, CAP>(kind, upserts, &mut self.clock, self.counts);
            let name = kind.map_or("groups", Kind::name);
            let Ok(timing::UpsertFigures { whole, longest_piece: piece }) = figures else {
                self.overflow("upsert", name)?;
                continue;
            };
            let timing::Figures { median, p99, worst, worst_at, .. } = whole;
            write!(self.out, r#"{{"part":"upsert","room":{CAP},"scene":"{name}","dimension":{D},"#)?;
            write!(self.out, r#""scalar":"{}","core":"{}","upserts":{upserts},"#, S::NAME, self.core)?;
            write!(self.out, r#""median":{median},"p99":{p99},"worst":{worst},"worst_at":{worst_at},"#)?;
            writeln!(self.out, r#""longest_piece":{piece}}}"#)?;
        }
        Ok(())
    }

    /// Something took longer than the clock can count.
    fn overflow(&mut self, part: &str, scene: &str) -> fmt::Result {
        writeln!(self.out, r#"{{"overflow":"{part}","scene":"{scene}","core":"{}"}}"#, self.core)
    }

    fn bits<S: Number>(&mut self) -> fmt::Result {
        let Wanted { bits: ticks, blocks, .. } = self.wanted;
        if ticks == 0 {
            return Ok(());
        }
        let (core, scalar) = (self.core, S::NAME);
        let mut printed = Ok(());
        let digest = bits::run::<S>(ticks, |block, digest| {
            if blocks && printed.is_ok() {
                printed = writeln!(
                    self.out,
                    r#"{{"block":{block},"scalar":"{scalar}","core":"{core}","digest":"{digest:016x}"}}"#
                );
            }
        });
        printed?;
        writeln!(self.out, r#"{{"bits":{ticks},"scalar":"{scalar}","core":"{core}","digest":"{digest:016x}"}}"#)
    }
}
