//! Any bytes as another tool's model: a certified model or an error, never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pliant::import::{Layout, Order, parse};

fuzz_target!(|bytes: &[u8]| {
    for order in [Order::Rows, Order::Columns] {
        if let Ok(found) = parse("fuzz.yml", bytes, Layout { order: Some(order), ..Layout::default() }) {
            assert!(found.model.certified::<f32>() && found.model.certified::<f64>());
        }
    }
});
