//! How a command ends, and what is said when it could not run.
//!
//! Exit 0: it did what it was asked. Exit 1: what it ran failed (goal missed, core touched). Exit 2: what it was given is
//! wrong, or the device it names cannot be used. People read stderr; with `--json` stdout still has exactly one JSON object, which then says what went wrong.

use std::fmt;
use std::io::{self, IsTerminal, Write};
use std::process::ExitCode;

use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, SourceSpan};
use serde_json::{Value, json};

use crate::bridge::BridgeError;

/// How a command that could run has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// As it should: exit 0.
    Success,
    /// Not as it should, as the command itself has said: exit 1.
    Failed,
}

/// Why a command could not run, or not to its end.
///
/// Any [`Diagnostic`] becomes one by `?`, as bad input; so where a place in a file is known, it is shown.
pub struct Error {
    exit: u8,
    diagnostic: Box<dyn Diagnostic + Send + Sync>,
    /// File and line, from 1, where there is no picture of the place.
    at: Option<(String, u64)>,
}

const FAILED: u8 = 1;
const BAD_INPUT: u8 = 2;

/// An error that is only a sentence.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
struct Plain {
    message: String,
    help: Option<String>,
}

impl Diagnostic for Plain {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }
}

impl Error {
    /// What the command was given is wrong: exit 2. The message names the file, line and field, and what is allowed.
    pub fn bad_input(message: impl Into<String>) -> Self {
        Self { exit: BAD_INPUT, diagnostic: Box::new(Plain { message: message.into(), help: None }), at: None }
    }

    /// What the command ran has failed, and it has printed nothing about it: exit 1.
    pub fn failed(message: impl Into<String>) -> Self {
        Self { exit: FAILED, diagnostic: Box::new(Plain { message: message.into(), help: None }), at: None }
    }

    /// The same error, of one line of a file, from 1, which its message names.
    pub fn at_line(self, file: impl Into<String>, line: u64) -> Self {
        Self { at: Some((file.into(), line)), ..self }
    }

    /// The same error, with a hint of what to do.
    pub fn with_help(self, help: impl Into<String>) -> Self {
        let plain = Plain { message: self.to_string(), help: Some(help.into()) };
        Self { diagnostic: Box::new(plain), ..self }
    }

    /// 1 or 2.
    pub fn exit(&self) -> u8 {
        self.exit
    }

    /// `{"error": {"exit", "message", "help", "file", "line", "column", "causes"}}`; what is not known is left out, as file, line and column
    /// are where no place in a file is at fault.
    pub fn to_json(&self) -> Value {
        let mut causes = Vec::new();
        let mut next: Option<&dyn std::error::Error> = self.diagnostic.source();
        if let Some(cause) = self.diagnostic.diagnostic_source() {
            causes.push(cause.to_string());
            next = cause.source();
        }
        while let Some(cause) = next {
            causes.push(cause.to_string());
            next = cause.source();
        }
        let mut error = json!({ "exit": self.exit, "message": self.diagnostic.to_string(), "causes": causes });
        let mut known = |key: &str, value: Option<Value>| {
            if let (Some(value), Some(object)) = (value, error.as_object_mut()) {
                object.insert(key.into(), value);
            }
        };
        known("help", self.diagnostic.help().map(|help| help.to_string().into()));
        if let Some((file, line, column)) = place(&*self.diagnostic) {
            known("file", file.map(Value::from));
            known("line", Some(line.into()));
            known("column", Some(column.into()));
        } else if let Some((file, line)) = &self.at {
            known("file", Some(file.as_str().into()));
            known("line", Some((*line).into()));
        }
        json!({ "error": error })
    }

    /// For people, with a picture of the place if there is one.
    pub fn render(&self, colour: bool) -> String {
        let theme = if colour { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
        let mut text = String::new();
        match GraphicalReportHandler::new_themed(theme).render_report(&mut text, &*self.diagnostic) {
            Ok(()) => text,
            Err(fmt::Error) => format!("error: {self}\n"),
        }
    }
}

/// File, line and column of the first label, from 1.
fn place(diagnostic: &dyn Diagnostic) -> Option<(Option<String>, usize, usize)> {
    let label: LabeledSpan = diagnostic.labels()?.next()?;
    let span: SourceSpan = *label.inner();
    let contents = diagnostic.source_code()?.read_span(&span, 0, 0).ok()?;
    Some((contents.name().map(str::to_owned), contents.line() + 1, contents.column() + 1))
}

/// Says why, if there is something to say, and gives the exit code.
pub fn report(result: Result<Outcome, Error>, json: bool) -> ExitCode {
    let colour = io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    ExitCode::from(write_report(&result, json, colour, &mut io::stdout(), &mut io::stderr()))
}

fn write_report(
    result: &Result<Outcome, Error>,
    json: bool,
    colour: bool,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> u8 {
    match result {
        Ok(Outcome::Success) => 0,
        Ok(Outcome::Failed) => FAILED,
        Err(error) => {
            // Whoever has closed these streams does not want to know.
            let _ = write!(err, "{}", error.render(colour));
            if json {
                let _ = writeln!(out, "{:#}", error.to_json());
            }
            error.exit
        }
    }
}

/// A number of things: `1 field`, `2 fields`.
pub fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

impl<E: Diagnostic + Send + Sync + 'static> From<E> for Error {
    fn from(diagnostic: E) -> Self {
        Self { exit: BAD_INPUT, diagnostic: Box::new(diagnostic), at: None }
    }
}

impl From<BridgeError> for Error {
    /// The device that was named cannot be used, or not with this scene.
    fn from(error: BridgeError) -> Self {
        Self::bad_input(error.to_string())
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.diagnostic, f)
    }
}

impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Error(exit {}: {self})", self.exit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn written(result: Result<Outcome, Error>, json: bool) -> (u8, String, String) {
        let (mut out, mut err) = (Vec::new(), Vec::new());
        let exit = write_report(&result, json, false, &mut out, &mut err);
        (exit, String::from_utf8(out).unwrap(), String::from_utf8(err).unwrap())
    }

    #[test]
    fn a_scene_with_a_fault_is_exit_2_and_points_at_it() {
        let bad = || -> Result<Outcome, Error> {
            Scene::parse("s.toml", "[ds]\nlinear = { attractor = [0, 0], gain = -1 }", "".as_ref())?;
            Ok(Outcome::Success)
        };
        let (exit, out, err) = written(bad(), false);
        assert_eq!((exit, out.as_str()), (2, ""));
        assert!(
            err.contains("s.toml, line 2: ds.linear.gain: -1 is too small")
                && err.contains("allowed: a number above 0"),
            "{err}"
        );
        let (exit, out, err) = written(bad(), true);
        assert_eq!(exit, 2);
        assert!(!err.is_empty());
        let object: Value = serde_json::from_str(&out).unwrap();
        let error = &object["error"];
        assert_eq!((&error["file"], &error["line"], &error["column"]), (&json!("s.toml"), &json!(2), &json!(39)));
    }

    #[test]
    fn sentences_have_their_exit_codes_and_no_place() {
        assert_eq!(written(Ok(Outcome::Success), true), (0, String::new(), String::new()));
        assert_eq!(written(Ok(Outcome::Failed), true).0, 1);
        let (exit, out, err) = written(Err(Error::failed("the device is gone").with_help("is it plugged in?")), true);
        assert_eq!(exit, 1);
        assert!(err.contains("the device is gone") && err.contains("plugged in"));
        let object: Value = serde_json::from_str(&out).unwrap();
        let keys: Vec<&String> = object["error"].as_object().unwrap().keys().collect();
        assert_eq!(keys, ["causes", "exit", "help", "message"]);
        assert_eq!(written(Err(Error::bad_input("no")), false).0, 2);
        let of_line = Error::bad_input("h.csv, line 2: no number").at_line("h.csv", 2).to_json();
        assert_eq!((&of_line["error"]["file"], &of_line["error"]["line"]), (&json!("h.csv"), &json!(2)));
    }
}
