//! A device that says anything.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pliant_protocol::ToHost;
use pliant_protocol_fuzz::understood;

fuzz_target!(|data: &[u8]| {
    if let Some(ToHost::Refused { error, .. }) = understood(data) {
        assert!(!error.to_string().is_empty());
    }
});
