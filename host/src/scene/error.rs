//! What is wrong with a scene, and where.

use std::fmt;
use std::ops::Range;

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};

/// Of what kind a [`SceneError`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneErrorKind {
    /// The file cannot be read.
    Unreadable,
    /// It is not TOML.
    Syntax,
    /// A key or a name that is not known.
    Unknown,
    /// Something that has to be there is not.
    Missing,
    /// A text where a number belongs, and the like.
    Type,
    /// A number out of its range, or a name twice.
    Value,
    /// Fields that exclude each other.
    Conflict,
    /// As many numbers as another dimension would have.
    Dimension,
    /// A hard core where a start or the attractor is, or a reference point outside its own.
    Geometry,
    /// The model cannot be read or is not stable.
    Model,
}

/// A scene that cannot be used: which field, on which line, why, and what would be right.
pub struct SceneError(Box<Details>);

struct Details {
    kind: SceneErrorKind,
    file: String,
    /// Counted from 1; none if there is no text to point at.
    line: Option<usize>,
    field: String,
    problem: String,
    allowed: Option<String>,
    source: NamedSource<String>,
    span: Range<usize>,
    cause: Option<Box<dyn Diagnostic + Send + Sync>>,
}

impl SceneError {
    pub(super) fn unreadable(file: &str, problem: &std::io::Error) -> Self {
        Self(Box::new(Details {
            kind: SceneErrorKind::Unreadable,
            file: file.to_owned(),
            line: None,
            field: String::new(),
            problem: format!("cannot be read: {problem}"),
            allowed: Some(
                "give the path of a scene file, such as scenes/sbend-foam.toml; without one, the built-in scene is used".to_owned(),
            ),
            source: NamedSource::new(file, String::new()),
            span: 0..0,
            cause: None,
        }))
    }

    /// Which kind of error.
    pub fn kind(&self) -> SceneErrorKind {
        self.0.kind
    }
    /// The scene file's name as it was given.
    pub fn file(&self) -> &str {
        &self.0.file
    }
    /// The line at fault, from 1; none if the file could not be read at all.
    pub fn line(&self) -> Option<usize> {
        self.0.line
    }
    /// The field at fault, such as `obstacle.center`; empty if it is no single field.
    pub fn field(&self) -> &str {
        &self.0.field
    }
    /// What is wrong, without file, line and field.
    pub fn problem(&self) -> &str {
        &self.0.problem
    }
    /// What would be right.
    pub fn allowed(&self) -> Option<&str> {
        self.0.allowed.as_deref()
    }

    pub(super) fn allowing(mut self, what: impl Into<String>) -> Self {
        self.0.allowed = Some(what.into());
        self
    }

    /// What is wrong is in another file, which this one names: a person is told as if that one had been read alone, and where it is named.
    pub(super) fn because(mut self, cause: impl Diagnostic + Send + Sync + 'static) -> Self {
        self.0.cause = Some(Box::new(cause));
        self
    }
}

/// The text of a scene, which knows how to point into itself.
pub(super) struct Source<'a> {
    pub name: &'a str,
    pub text: &'a str,
}

impl Source<'_> {
    /// An error about `field` that points at `span`; the help text is what the field's description says.
    pub fn error(
        &self,
        kind: SceneErrorKind,
        field: &str,
        span: Range<usize>,
        problem: impl Into<String>,
    ) -> SceneError {
        let span = self.first_line(span);
        let line = self.text.get(..span.start).map(|before| before.matches('\n').count() + 1);
        SceneError(Box::new(Details {
            kind,
            file: self.name.to_owned(),
            line,
            field: field.to_owned(),
            problem: problem.into(),
            allowed: super::fields::allowed(field).map(str::to_owned),
            source: NamedSource::new(self.name, self.text.to_owned()).with_language("toml"),
            span,
            cause: None,
        }))
    }

    /// The part of a span on its first line: a table is pointed at by its header.
    fn first_line(&self, span: Range<usize>) -> Range<usize> {
        let end = span.end.min(self.text.len());
        let start = span.start.min(end);
        let length = self.text.get(start..end).and_then(|text| text.find('\n')).unwrap_or(end - start);
        start..start + length
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let d = &*self.0;
        if let Some(cause) = &d.cause {
            return cause.fmt(f);
        }
        f.write_str(&d.file)?;
        if let Some(line) = d.line {
            write!(f, ", line {line}")?;
        }
        f.write_str(": ")?;
        if !d.field.is_empty() {
            write!(f, "{}: ", d.field)?;
        }
        f.write_str(&d.problem)
    }
}

impl fmt::Debug for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SceneError({:?}: {self})", self.0.kind)
    }
}

impl std::error::Error for SceneError {}

impl Diagnostic for SceneError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        if let (Some(_), Some(line)) = (&self.0.cause, self.0.line) {
            return Some(Box::new(format!("it is named by {}, line {line}: {}", self.0.file, self.0.field)));
        }
        // Of a file that cannot be read nothing is known that could be allowed or not: what is said is what to do.
        let lead = if self.0.kind == SceneErrorKind::Unreadable { "" } else { "allowed: " };
        self.0.allowed.as_ref().map(|what| Box::new(format!("{lead}{what}")) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        match &self.0.cause {
            Some(cause) => cause.source_code(),
            None => self.0.line.map(|_| &self.0.source as &dyn SourceCode),
        }
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        if let Some(cause) = &self.0.cause {
            return cause.labels();
        }
        self.0.line?;
        let label = LabeledSpan::at(self.0.span.clone(), "here");
        Some(Box::new(std::iter::once(label)))
    }
}
