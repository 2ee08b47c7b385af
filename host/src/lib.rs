//! The host side of Pliant, as a library: what a user does, a module each.
#![forbid(unsafe_code)]

pub mod bench;
pub mod bridge;
pub mod cli;
pub mod error;
pub mod eval;
pub mod import;
pub mod learn;
pub mod model;
mod output;
pub mod plot;
pub mod proof;
pub mod scene;
pub mod sim;
pub mod study;
