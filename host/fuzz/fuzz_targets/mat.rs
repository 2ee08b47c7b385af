//! Any bytes as a MATLAB file: demonstrations or an error, never a panic.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| pliant_fuzz::of_mat(bytes));
