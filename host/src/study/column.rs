//! What is compared: the paper to the letter, Pliant's default, and the method the paper builds on.

use std::fmt;

/// c of eqs. 15 and 27 in every study, m/s. The paper gives none; this one, together with where the obstacles of A and B stand, was chosen so that
/// both of its figures for speed come out. (The tool's own default is 0.03, for a gentler push.)
pub const GAIN: f64 = 0.05;

/// theta_2 where the paper is followed to the letter, rad (40 degrees). It gives none: of both of its figures for speed 50 and 60 degrees give the
/// first a little nearer, and none the sign of the second. See [`super::placements`] for what others do.
pub const THETA: f64 = 2.0 * std::f64::consts::PI / 9.0;

/// A way to compute the velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Column {
    /// Eqs. 15 and 27 as they are printed, with a fixed theta_2 (rad), and nothing that keeps out of a core but the modulation.
    Letter(f64),
    /// The push along the flow, and the guard.
    Pliant,
    /// Huber, Billard & Slotine 2019: soft layers are not there. No guard, as theirs has none.
    Original,
}

impl Column {
    /// The three of every table.
    pub const ALL: [Self; 3] = [Self::Letter(THETA), Self::Pliant, Self::Original];

    /// What JSON and CSV call it.
    pub fn key(self) -> &'static str {
        match self {
            Self::Letter(_) => "letter",
            Self::Pliant => "pliant",
            Self::Original => "original",
        }
    }

    /// What tables and figures call it.
    pub fn title(self) -> &'static str {
        match self {
            Self::Letter(_) => "paper to the letter",
            Self::Pliant => "Pliant's default",
            Self::Original => "original (Huber 2019)",
        }
    }

    /// The same where there is little room.
    pub fn short_title(self) -> &'static str {
        match self {
            Self::Original => "original",
            Self::Letter(_) | Self::Pliant => self.title(),
        }
    }
}

/// A column's velocity with or without the guard, whichever it has by itself: what tells the part of the one from that of the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// How the velocity is computed.
    pub column: Column,
    /// Is it guarded?
    pub guard: bool,
}

impl Way {
    /// A column with the guard if it has none, and without if it has one.
    pub fn other(column: Column) -> Self {
        Self { guard: !Self::from(column).guard, column }
    }

    /// The part of a scene file that says so.
    pub fn toml(self) -> String {
        let modulation = match self.column {
            Column::Letter(theta) => format!("c = {GAIN:?}\nsteering = {{ fixed = {theta:?} }}\n"),
            Column::Pliant => format!("c = {GAIN:?}\n"),
            Column::Original => "method = \"original\"\n".into(),
        };
        format!("[modulation]\n{modulation}{}", if self.guard { "" } else { "[guard]\nenabled = false\n" })
    }
}

impl From<Column> for Way {
    /// As the column is: only Pliant's has a guard.
    fn from(column: Column) -> Self {
        Self { column, guard: column == Column::Pliant }
    }
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.title())
    }
}
