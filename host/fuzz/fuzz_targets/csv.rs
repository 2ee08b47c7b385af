//! Any bytes as a CSV file: demonstrations or an error, never a panic.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| pliant_fuzz::of_csv(bytes));
