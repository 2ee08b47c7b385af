//! Finds the text of a field, so that an error can point at it.

use super::FieldError;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ops::Range;
use toml::{Spanned, Value};

#[derive(Deserialize)]
struct Located {
    #[serde(default)]
    component: Vec<BTreeMap<String, Spanned<Value>>>,
}

/// The bytes of the field's value.
pub fn span(text: &str, fault: &FieldError) -> Option<Range<usize>> {
    match fault.component {
        Some(k) => {
            let located: Located = toml::from_str(text).ok()?;
            Some(located.component.get(k)?.get(fault.name)?.span())
        }
        None => {
            let fields: BTreeMap<String, Spanned<Value>> = toml::from_str(text).ok()?;
            Some(fields.get(fault.name)?.span())
        }
    }
}
