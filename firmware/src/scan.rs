//! A scan on its way in: too large for a frame, so it comes in pieces.

use pliant_core::Scan;
use pliant_protocol::convert;
use pliant_protocol::message::{DeviceError, Field, SCAN_MAX, ScanFault};

/// One piece: the fields of [`ToDevice::Scan`](pliant_protocol::ToDevice::Scan).
#[derive(Debug)]
pub(crate) struct Piece<'a> {
    pub stamp: u64,
    pub start: u16,
    pub total: u16,
    pub radius: f32,
    pub points: &'a [[f32; 3]],
}

/// The scan being collected, if one is.
#[derive(Debug)]
pub(crate) struct Collecting {
    points: heapless::Vec<[f32; 3], SCAN_MAX>,
    /// What every piece of it says.
    of: Option<Whole>,
}

/// Stamp, total and radius: pieces that agree on these are of one scan.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Whole {
    stamp: u64,
    total: u16,
    radius: f32,
}

impl Collecting {
    pub(crate) const fn new() -> Self {
        Self { points: heapless::Vec::new(), of: None }
    }

    /// Takes a piece; the whole scan where this completes it. A piece that is refused changes nothing, one that is there already (its
    /// answer was lost, the host sent it again) is welcome, and a first piece always begins anew.
    pub(crate) fn take<const D: usize>(&mut self, piece: &Piece) -> Result<Option<Scan<f32, D>>, DeviceError> {
        let &Piece { stamp, start, total, radius, points } = piece;
        let (from, all) = (usize::from(start), usize::from(total));
        if all > SCAN_MAX {
            return Err(DeviceError::OutOfRange(Field::Points));
        }
        let whole = Whole { stamp, total, radius };
        if start > 0 {
            self.continues(&whole)?;
        }
        let end = from.saturating_add(points.len());
        if end > all {
            return Err(DeviceError::Scan(ScanFault::Total { expected: total }));
        }
        if total == 0 {
            (self.of, self.points) = (None, heapless::Vec::new());
            return Ok(Some(Scan::default()));
        }
        // By itself, so that the piece at fault is the one refused.
        convert::scan::<D>(points, radius)?;
        if start == 0 {
            self.points.clear();
            self.of = Some(whole);
        } else if self.points.get(from..end) == Some(points) {
            return Ok(None);
        } else if from != self.points.len() {
            return Err(gap(self.points.len()));
        }
        self.points.extend_from_slice(points).map_err(|_| DeviceError::OutOfRange(Field::Points))?;
        if self.points.len() < all {
            return Ok(None);
        }
        // Only a model of another dimension that came between two pieces makes this fail; then the scan is none any more.
        convert::scan(&self.points, radius).map(Some).inspect_err(|_| self.of = None)
    }

    /// Does a piece of `whole` go with the pieces before it?
    fn continues(&self, whole: &Whole) -> Result<(), DeviceError> {
        match self.of {
            Some(of) if of == *whole => Ok(()),
            Some(of) if of.stamp == whole.stamp && of.total != whole.total => {
                Err(DeviceError::Scan(ScanFault::Total { expected: of.total }))
            }
            // Of another scan, whose first piece did not come.
            _ => Err(gap(0)),
        }
    }
}

/// The piece that begins after this many points was expected.
fn gap(points: usize) -> DeviceError {
    // At most SCAN_MAX.
    DeviceError::Scan(ScanFault::Gap { expected: u16::try_from(points).unwrap_or(u16::MAX) })
}
