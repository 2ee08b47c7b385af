//! Any text as a model file: a model that reads back the same, or an error, never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pliant::model::ModelFile;

fuzz_target!(|text: &str| {
    if let Ok(model) = ModelFile::parse("fuzz.toml", text) {
        let _ = model.skill::<f32>();
        if let Ok(written) = model.to_toml() {
            assert_eq!(ModelFile::parse("again.toml", &written).ok().as_ref(), Some(&model));
        }
    }
});
