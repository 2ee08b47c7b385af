//! How long the method takes: here in nanoseconds, on emulated boards in instructions.

pub mod emulated;
pub mod here;
