//! Finds the text of a field, so that an error can point at it.

use super::ModelFileError;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ops::Range;
use toml::{Spanned, Value};

type Fields = BTreeMap<String, Spanned<Value>>;

#[derive(Deserialize)]
struct Located {
    #[serde(default)]
    component: Vec<Fields>,
    #[serde(default)]
    learnt: Fields,
}

/// The error about a field of the model, or of one of its components, at the field's place.
pub fn fault(file: &str, text: &str, component: Option<usize>, name: &str, problem: String) -> ModelFileError {
    ModelFileError::located(file, text, span(text, component, name).unwrap_or(0..0), problem)
}

/// The error of a scene that is given as a model, if it is one.
pub fn scene(file: &str, text: &str) -> Option<ModelFileError> {
    let fields: Fields = toml::from_str(text).ok()?;
    let ds = fields.get("ds").filter(|_| !fields.contains_key("lyapunov"))?;
    let model = ds.get_ref().get("model").and_then(Value::as_str);
    Some(ModelFileError::scene(file, text, ds.span(), model))
}

/// The bytes of the field's value.
fn span(text: &str, component: Option<usize>, name: &str) -> Option<Range<usize>> {
    let located = || toml::from_str::<Located>(text).ok();
    match (component, name.strip_prefix("learnt.")) {
        (Some(k), _) => Some(located()?.component.get(k)?.get(name)?.span()),
        (None, Some(name)) => Some(located()?.learnt.get(name)?.span()),
        (None, None) => Some(toml::from_str::<Fields>(text).ok()?.get(name)?.span()),
    }
}
