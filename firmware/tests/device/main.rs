//! The whole device, byte by byte: what it answers, how its modes change, and what it never lets through.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod aim;
mod guard;
mod host;
mod input;
mod modes;
mod obstacles;
mod overlaps;
mod peers;
mod scan;
mod skills;
