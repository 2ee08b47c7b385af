//! Any bytes as a CSV file: demonstrations or an error, never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(items) = pliant::learn::read::csv::read("fuzz.csv", bytes) {
        for item in &items {
            assert!(item.t.is_sorted() && item.t.len() >= 2);
            assert!(item.x.iter().flatten().all(|c| c.is_finite()));
        }
        let _ = pliant::learn::Demonstrations::new(items);
    }
});
