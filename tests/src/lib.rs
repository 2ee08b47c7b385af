//! Tests of the whole from outside, and the independent evaluation they compare against.
#![forbid(unsafe_code)]

pub mod oracle;
pub mod programs;
pub mod scene_file;

pub use oracle::random_scene;
