//! The fields of a model file of another tool, YAML or JSON, each with its line.
//!
//! JSON is YAML, so one parser reads both. What comes out is a flat table: numbers in the order they are written, nested or
//! not, and texts.

use saphyr_parser::{Event, Parser};
use std::collections::BTreeMap;

/// Lists in lists: deeper is no matrix.
const MAX_DEPTH: usize = 8;
/// Numbers in one file: 16 components in space have some 400.
const MAX_NUMBERS: usize = 1 << 20;

/// One value.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number, or a list of them; `nested` where there are lists in the list.
    Numbers { values: Vec<f64>, nested: bool },
    /// Anything else that is a word.
    Text(String),
}

/// A value and its line, from 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    pub line: usize,
    pub value: Value,
}

/// What is wrong at a line.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    pub line: usize,
    pub problem: String,
}

/// The fields of a mapping. Mappings inside it are skipped.
pub fn parse(text: &str) -> Result<BTreeMap<String, Field>, Fault> {
    let mut fields = BTreeMap::new();
    let mut parser = Parser::new_from_str(text);
    let mut next = || match parser.next() {
        None => Ok((Event::StreamEnd, 1)),
        Some(Ok((event, span))) => Ok((event, span.start.line())),
        Some(Err(e)) => {
            Err(Fault { line: e.marker().line(), problem: format!("it is neither YAML nor JSON: {}", e.info()) })
        }
    };
    let begin = loop {
        match next()? {
            (Event::StreamStart | Event::DocumentStart(_) | Event::Nothing, _) => {}
            other => break other,
        }
    };
    if !matches!(begin.0, Event::MappingStart(..)) {
        return Err(Fault {
            line: begin.1,
            problem: "it is no table of fields, such as `K: 3`; a model has K, M, Priors, Mu, Sigma, A and attractor"
                .into(),
        });
    }
    let mut numbers = 0;
    loop {
        let key = match next()? {
            (Event::Scalar(key, ..), _) => key.into_owned(),
            (Event::MappingEnd, _) => return Ok(fields),
            (_, line) => return Err(Fault { line, problem: "a name of a field is no word".into() }),
        };
        let (event, line) = next()?;
        let value = match event {
            Event::Scalar(text, ..) => match number(&text) {
                Some(value) => Some(Value::Numbers { values: vec![value], nested: false }),
                None => Some(Value::Text(text.into_owned())),
            },
            Event::SequenceStart(..) => {
                let (mut depth, mut nested, mut values, mut word) = (1, false, vec![], None);
                while depth > 0 {
                    match next()? {
                        (Event::Scalar(text, ..), line) => {
                            values.extend(number(&text));
                            numbers += 1;
                            if number(&text).is_none() && word.is_none() {
                                word = Some((line, text.chars().take(40).collect::<String>()));
                            }
                            if numbers > MAX_NUMBERS {
                                return Err(Fault { line, problem: "it holds more than a million numbers".into() });
                            }
                        }
                        (Event::SequenceStart(..), line) => {
                            (depth, nested) = (depth + 1, true);
                            if depth > MAX_DEPTH {
                                return Err(Fault { line, problem: "lists are nested too deeply".into() });
                            }
                        }
                        (Event::SequenceEnd, _) => depth -= 1,
                        (Event::StreamEnd, line) => return Err(Fault { line, problem: "it ends early".into() }),
                        (_, line) => {
                            return Err(Fault { line, problem: format!("`{key}` is no list of numbers") });
                        }
                    }
                }
                match word {
                    // A list of words may be anything; a number that is none is a mistake.
                    Some((line, word)) if !values.is_empty() => {
                        return Err(Fault { line, problem: format!("`{key}` holds `{word}`, which is no number") });
                    }
                    Some(_) => None,
                    None => Some(Value::Numbers { values, nested }),
                }
            }
            Event::MappingStart(..) => {
                let mut depth = 1_usize;
                while depth > 0 {
                    match next()?.0 {
                        Event::MappingStart(..) | Event::SequenceStart(..) => depth += 1,
                        Event::MappingEnd | Event::SequenceEnd => depth -= 1,
                        Event::StreamEnd => return Err(Fault { line, problem: "it ends early".into() }),
                        _ => {}
                    }
                }
                None
            }
            Event::Alias(_) => return Err(Fault { line, problem: format!("`{key}` is an alias, which is not read") }),
            _ => return Err(Fault { line, problem: "it ends early".into() }),
        };
        if let Some(value) = value
            && fields.insert(key.clone(), Field { line, value }).is_some()
        {
            return Err(Fault { line, problem: format!("`{key}` is there twice") });
        }
    }
}

/// As YAML, JSON and Python write numbers; not-a-number is a number here, and refused where it is used.
fn number(text: &str) -> Option<f64> {
    match text {
        ".nan" | ".NaN" | ".NAN" => Some(f64::NAN),
        ".inf" | ".Inf" | "+.inf" => Some(f64::INFINITY),
        "-.inf" | "-.Inf" => Some(f64::NEG_INFINITY),
        other => other.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn numbers(values: &[f64], nested: bool) -> Value {
        Value::Numbers { values: values.to_vec(), nested }
    }

    #[test]
    fn yaml_and_json_say_the_same() {
        let yaml = "name: a b\nK: 2.0\nMu: [1.0, -2.5E-4,\n  3]\nA:\n- - 1\n  - 2\n- [3, 4]\nother: {x: [1]}\n";
        let json = "{\n\t\"name\": \"a b\", \"K\": 2,\n\"Mu\": [1.0, -2.5e-4, 3],\n\n\"A\": [[1, 2], [3, 4]], \"other\": {\"x\": [1]}}";
        let (from_yaml, from_json) = (parse(yaml).expect("valid"), parse(json).expect("valid"));
        for fields in [&from_yaml, &from_json] {
            assert_eq!(fields["name"].value, Value::Text("a b".into()));
            assert_eq!(fields["K"].value, numbers(&[2.0], false));
            assert_eq!(fields["Mu"].value, numbers(&[1.0, -2.5e-4, 3.0], false));
            assert_eq!(fields["A"].value, numbers(&[1.0, 2.0, 3.0, 4.0], true));
            assert!(!fields.contains_key("other"));
        }
        assert_eq!((from_yaml["Mu"].line, from_json["A"].line), (3, 5));
    }

    #[test]
    fn mistakes_have_their_lines() {
        let fault = |text: &str| parse(text).expect_err("must be refused");
        assert_eq!(
            fault("K: 1\nA: [1,\n two]\n"),
            Fault { line: 3, problem: "`A` holds `two`, which is no number".into() }
        );
        assert_eq!(fault("K: 1\nK: 2\n"), Fault { line: 2, problem: "`K` is there twice".into() });
        assert!(fault("- 1\n").problem.contains("no table of fields"));
        assert!(fault("").problem.contains("no table of fields"));
        assert!(fault("A: [1, 2").problem.contains("neither YAML nor JSON"));
        assert!(fault("A: &a [1]\nB: *a\n").problem.contains("`B` is an alias"));
        assert!(fault(&format!("A: {}1{}", "[".repeat(20), "]".repeat(20))).problem.contains("too deeply"));
    }

    proptest! {
        #[test]
        fn never_panics(text in "[\\[\\]{}:,\n \"'&*A-C0-9.-]{0,80}", bytes in proptest::collection::vec(any::<u8>(), 0..80)) {
            let _ = parse(&text);
            let _ = parse(&String::from_utf8_lossy(&bytes));
        }
    }
}
