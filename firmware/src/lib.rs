#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

mod control;
mod desk;
mod device;
mod scan;
mod space;
mod upload;

pub use control::{Control, LATE_TICKS, LOST_STEPPED_TICKS, LOST_TICKS};
pub use desk::{Desk, Gauges, Identity, Locked};
pub use device::Device;
pub use space::{InSpace, Space};

/// Obstacles a device has room for.
pub const OBSTACLES: usize = 64;
/// Ticks a second.
pub const TICK_HZ: u16 = 1000;
/// The time step of a tick, s.
pub const TICK: f32 = 1.0 / TICK_HZ as f32;
