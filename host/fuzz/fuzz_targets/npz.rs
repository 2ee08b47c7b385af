//! Any bytes as a NumPy archive, and as an array of one (which a checksum guards there): demonstrations or an error, never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pliant::learn::read::{npy, npz, zip};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(items) = npz::read("fuzz.npz", bytes) {
        for item in &items {
            assert!(item.t.is_sorted() && item.t.len() >= 2);
            assert!(item.x.iter().flatten().all(|c| c.is_finite()));
        }
        let _ = pliant::learn::Demonstrations::new(items);
    }
    if let Ok(members) = zip::read(bytes) {
        assert!(members.values().map(Vec::len).sum::<usize>() <= zip::MAX_UNPACKED);
    }
    if let Ok(array) = npy::read(bytes) {
        assert_eq!(array.shape.iter().product::<usize>(), array.data.len());
    }
});
