//! Range points.

use super::{finite, flat, vector};
use crate::message::{DeviceError, Field, SCAN_MAX};
use heapless::Vec;
use pliant_core::{Scan, ScanError};

/// A scan that was checked, from the points of all [`ToDevice::Scan`](crate::ToDevice::Scan)s that belong to it; or one
/// of these, to be checked by itself.
///
/// ```
/// use pliant_protocol::convert::scan;
/// use pliant_protocol::message::{DeviceError, Field};
///
/// let wall: Vec<_> = (0..20).map(|i| [0.5, 0.02 * i as f32, 0.0]).collect();
/// assert_eq!(scan::<2>(&wall, 0.03).unwrap().points().len(), 20);
/// assert_eq!(scan::<2>(&[[0.5, 0.0, 0.1]], 0.03), Err(DeviceError::Dimension));
/// assert_eq!(scan::<3>(&[[0.5, f32::NAN, 0.1]], 0.03), Err(DeviceError::NotFinite(Field::Points)));
/// assert_eq!(scan::<3>(&[[0.5, 0.0, 0.1]], 0.0), Err(DeviceError::OutOfRange(Field::Radius)));
/// ```
///
/// # Errors
///
/// A number is not finite, there is a z in two dimensions, there are too many points, or one of them or the radius is out
/// of the range that [`ScanError`] states.
pub fn scan<const D: usize>(points: &[[f32; 3]], radius: f32) -> Result<Scan<f32, D>, DeviceError> {
    finite(points.as_flattened(), Field::Points)?;
    finite(&[radius], Field::Radius)?;
    let mut checked: Vec<_, SCAN_MAX> = Vec::new();
    for point in points {
        flat::<D>(point)?;
        checked.push(vector(point)).map_err(|_| DeviceError::OutOfRange(Field::Points))?;
    }
    Ok(Scan::new(&checked, radius)?)
}

impl From<ScanError> for DeviceError {
    fn from(error: ScanError) -> Self {
        Self::OutOfRange(match error {
            ScanError::Points | ScanError::Point(_) => Field::Points,
            ScanError::Radius => Field::Radius,
        })
    }
}
