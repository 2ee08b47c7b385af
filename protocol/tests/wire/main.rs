//! The wire format, from outside: what the bytes are, that they come back, and that no others do harm.
// What clippy.toml allows in tests, it does not allow in their helpers.
#![allow(clippy::unwrap_used)]

mod collecting;
mod conversion;
mod examples;
mod generate;
mod golden;
mod limits;
mod obstacles;
mod round_trip;
