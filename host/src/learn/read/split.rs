//! Where one recording ends and the next begins, in samples that come one after the other.

use crate::learn::cleaning::Samples;
use nalgebra::DVector;

/// Why a sample cannot follow the one before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    /// Time goes back, and not to the start.
    Back { from: f64, to: f64 },
    /// One time, two positions.
    Twice { t: f64 },
}

impl Fault {
    /// What is wrong.
    pub fn problem(self) -> String {
        match self {
            Fault::Back { from, to } => format!("time goes back from {from} to {to}"),
            Fault::Twice { t } => format!("a second position at time {t}"),
        }
    }

    /// What is right.
    pub fn allowed(self) -> &'static str {
        match self {
            Fault::Back { .. } => "time that increases",
            Fault::Twice { .. } => "one position a time",
        }
    }
}

/// Takes samples and keeps recordings apart: by label where there are labels, otherwise where time returns to the first time
/// of all or before it.
#[derive(Default)]
pub struct Splitter {
    done: Vec<Samples>,
    current: Samples,
    label: Option<String>,
    start: f64,
}

impl Splitter {
    /// The next sample.
    pub fn push(&mut self, t: f64, x: DVector<f64>, v: Option<DVector<f64>>, label: Option<&str>) -> Result<(), Fault> {
        let begins = match (label, self.current.t.last()) {
            (Some(_), _) => self.label.as_deref() != label,
            (None, Some(&last)) => t < last && t <= self.start,
            (None, None) => false,
        };
        if begins {
            // One sample is no recording: time runs backwards.
            if let (None, [from]) = (label, self.current.t.as_slice()) {
                return Err(Fault::Back { from: *from, to: t });
            }
            self.label = label.map(str::to_owned);
            if !self.current.t.is_empty() {
                self.done.push(std::mem::take(&mut self.current));
            }
        }
        if self.done.is_empty() && self.current.t.is_empty() {
            self.start = t;
        }
        if let (Some(&last), Some(before)) = (self.current.t.last(), self.current.x.last()) {
            if t < last {
                return Err(Fault::Back { from: last, to: t });
            }
            if t == last && *before != x {
                return Err(Fault::Twice { t });
            }
        }
        self.current.t.push(t);
        self.current.x.push(x);
        if let Some(v) = v {
            self.current.v.get_or_insert_default().push(v);
        }
        Ok(())
    }

    /// All recordings; one, and empty, if there was no sample.
    pub fn finish(mut self) -> Vec<Samples> {
        self.done.push(self.current);
        self.done
    }
}
