#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

pub mod adaptive;
pub mod controller;
pub mod ds;
pub mod guard;
pub mod limits;
pub mod modulation;
pub mod obstacle;
mod overlap;
pub mod passive;
pub mod rotation;
pub mod scalar;
pub mod scan;
pub mod settings;
pub mod shape;
pub mod status;
mod surroundings;
pub mod table;

pub use adaptive::SteeringPolicy;
pub use controller::{Command, Controller, RobotState, Stages};
pub use ds::{Certified, Component, LpvDs, Motion};
pub use guard::Guard;
pub use limits::Limits;
/// Its vectors and matrices are this crate's: [`Vector`] and [`Matrix`] are short names for them.
pub use nalgebra;
pub use obstacle::{Obstacle, ObstacleError, ObstacleSpec};
pub use scalar::{Fixed, Scalar};
pub use scan::{Scan, ScanError};
pub use settings::{Settings, SettingsError};
pub use shape::Shape;
pub use status::{Region, Status};
pub use table::{Ageing, Table, TableFull};

/// A position, velocity or direction in d = 2 or 3 dimensions.
pub type Vector<S, const D: usize> = nalgebra::SVector<S, D>;
/// A d x d matrix.
pub type Matrix<S, const D: usize> = nalgebra::SMatrix<S, D, D>;

/// Largest coordinate, in metres, of anything the method takes in (in both directions). Beyond it f32 has no
/// millimetres left, and squares of squares would leave its range.
pub const RANGE: f64 = 1000.0;

/// Is every entry finite and within [`RANGE`]?
pub(crate) fn in_range<S: Scalar, const D: usize>(v: &Vector<S, D>) -> bool {
    v.iter().all(|x| x.abs() <= S::from_f64(RANGE))
}

/// Is every entry zero?
pub(crate) fn is_zero<S: Scalar, const R: usize, const C: usize>(m: &nalgebra::SMatrix<S, R, C>) -> bool {
    m.iter().all(|x| *x == S::zero())
}

/// Euclidean length, by this crate's own square root rather than nalgebra's, so that host and board agree.
pub(crate) fn norm<S: Scalar, const D: usize>(v: &Vector<S, D>) -> S {
    S::norm(v.as_slice())
}

/// m v by scalar products, which fixed point rounds once; the order of sums is nalgebra's.
#[inline(always)]
pub(crate) fn times<S: Scalar, const D: usize>(m: &Matrix<S, D>, v: &Vector<S, D>) -> Vector<S, D> {
    Vector::from_fn(|i, _| {
        let row: [S; D] = core::array::from_fn(|j| m[(i, j)]);
        S::dot(&row, v.as_slice())
    })
}

/// m' v, likewise.
#[inline(always)]
pub(crate) fn transposed_times<S: Scalar, const D: usize>(m: &Matrix<S, D>, v: &Vector<S, D>) -> Vector<S, D> {
    Vector::from_fn(|j, _| {
        let column: [S; D] = core::array::from_fn(|i| m[(i, j)]);
        S::dot(&column, v.as_slice())
    })
}

/// The length of v, and v/|v|, or zero.
#[inline(always)]
pub(crate) fn unit<S: Scalar, const D: usize>(v: &Vector<S, D>) -> (S, Vector<S, D>) {
    let (length, unit) = S::unit(v.data.0[0]);
    (length, unit.into())
}
