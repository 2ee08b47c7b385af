//! From text to tables: TOML's own complaints, put the way a scene's are.

use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::error::{SceneError, SceneErrorKind, Source};
use super::file::SceneFile;

pub(super) fn read(source: &Source<'_>) -> Result<SceneFile, SceneError> {
    toml::from_str(source.text).map_err(|error| explain(source, &error))
}

/// The largest distance of letters at which another key is suggested.
const NEAR: usize = 3;

fn explain(source: &Source<'_>, error: &toml::de::Error) -> SceneError {
    let span = error.span().unwrap_or(0..0);
    let message = error.message();
    let Ok(tables) = DeTable::parse(source.text) else {
        let problem = message.trim_end().replace('\n', "; ");
        return source
            .error(SceneErrorKind::Syntax, "", span, format!("not TOML: {problem}"))
            .allowing("a TOML file, as in scenes/sbend-foam.toml");
    };
    if let (Some((key, _)), None) = (tables.get_ref().get_key_value("lyapunov"), tables.get_ref().get("ds")) {
        return source
            .error(SceneErrorKind::Unknown, "", key.span(), "this is a model, which is only the motion of a scene")
            .allowing("a scene file with `[ds]` and `model = \"MODEL.toml\"`, a `[[start]]`, and obstacles, as in scenes/sbend-foam.toml");
    }
    let field = field_at(tables.get_ref(), &span);
    let mut quoted = message.split('`').skip(1).step_by(2);
    if message.starts_with("unknown ") {
        let name = quoted.next().unwrap_or_default();
        let known: Vec<&str> = quoted.collect();
        let place = if field.ends_with(name) {
            field.strip_suffix(name).unwrap_or_default().trim_end_matches('.')
        } else {
            &field
        };
        let within = if place.is_empty() { "a scene" } else { place };
        let list = known.iter().map(|k| format!("`{k}`")).collect::<Vec<_>>().join(", ");
        let what = if message.starts_with("unknown field") { "key" } else { "name" };
        let mut problem = format!("there is no {what} `{name}` in {within}");
        if let Some(near) = nearest(name, &known) {
            problem += &format!("; did you mean `{near}`?");
        }
        return source.error(SceneErrorKind::Unknown, &field, span, problem).allowing(list);
    }
    if message.starts_with("missing field") {
        let name = quoted.next().unwrap_or_default();
        // The whole file has an empty span, which would be in whatever comes first.
        let field = if span.is_empty() || field.is_empty() { name.to_owned() } else { format!("{field}.{name}") };
        let problem = "is missing, and there is no default for it";
        return source.error(SceneErrorKind::Missing, &field, span, problem);
    }
    let written = source.text.get(span.clone()).unwrap_or_default();
    let wants_number = ["expected f64", "expected i64", "expected a number"].iter().any(|w| message.contains(w));
    if message.contains("number overflowed") || (message.contains("as i128") && wants_number) {
        let size = if written.starts_with('-') { "small" } else { "large" };
        return source.error(SceneErrorKind::Value, &field, span.clone(), format!("{written} is too {size}"));
    }
    let mut problem = message
        .trim_end()
        .replace("expected f64", "expected a number")
        .replace("expected i64", "expected a whole number")
        .replace("expected a sequence", "expected an array");
    let number = message.contains("type: integer") || message.contains("type: floating point");
    if number && message.contains("expected a sequence") && FOR_EACH.contains(&field.as_str()) {
        problem += &format!("; did you mean [{written}, {written}] (3-D: [{written}, {written}, {written}])?");
    }
    source.error(SceneErrorKind::Type, &field, span, problem)
}

/// Keys with one number for each dimension that may well be the same for all.
const FOR_EACH: [&str; 4] = ["obstacle.margin", "obstacle.soft", "obstacle.shape.ellipsoid", "obstacle.shape.box"];

/// The known key that `name` was most likely meant to be.
fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let name = name.to_lowercase();
    known
        .iter()
        .map(|k| (strsim::damerau_levenshtein(&name, k), *k))
        .min()
        .filter(|(distance, k)| *distance <= NEAR.min(k.len() / 2 + 1))
        .map(|(_, k)| k)
}

/// The dotted name of the innermost field whose key or value holds `span`.
fn field_at(table: &DeTable<'_>, span: &Range<usize>) -> String {
    let mut names = Vec::new();
    descend(table, span, &mut names);
    names.join(".")
}

fn descend(table: &DeTable<'_>, span: &Range<usize>, names: &mut Vec<String>) {
    for (key, value) in table {
        if within(span, &key.span()) || holds(value.get_ref(), &value.span(), span) {
            names.push(key.get_ref().to_string());
            return descend_value(value.get_ref(), span, names);
        }
    }
}

fn descend_value(value: &DeValue<'_>, span: &Range<usize>, names: &mut Vec<String>) {
    match value {
        DeValue::Table(table) => descend(table, span, names),
        DeValue::Array(items) => {
            if let Some(item) = items.iter().find(|i| holds(i.get_ref(), &i.span(), span)) {
                descend_value(item.get_ref(), span, names);
            }
        }
        _ => {}
    }
}

/// A table's own span is its header, and may not reach what is in it.
fn holds(value: &DeValue<'_>, own: &Range<usize>, span: &Range<usize>) -> bool {
    within(span, own)
        || match value {
            DeValue::Table(table) => {
                table.iter().any(|(k, v)| within(span, &k.span()) || holds(v.get_ref(), &v.span(), span))
            }
            DeValue::Array(items) => items.iter().any(|i| holds(i.get_ref(), &i.span(), span)),
            _ => false,
        }
}

fn within(inner: &Range<usize>, outer: &Range<usize>) -> bool {
    outer.start <= inner.start && inner.end <= outer.end
}
