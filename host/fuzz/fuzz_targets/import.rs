//! Any bytes as another tool's model: a certified model or an error, never a panic.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| pliant_fuzz::of_import(bytes));
