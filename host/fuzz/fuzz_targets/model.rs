//! Any bytes as a model file: a model that reads back the same, or an error, never a panic.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| pliant_fuzz::of_model(bytes));
