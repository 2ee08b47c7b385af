//! Any bytes as a NumPy archive, and as an array of one: demonstrations or an error, never a panic.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| pliant_fuzz::of_npz(bytes));
