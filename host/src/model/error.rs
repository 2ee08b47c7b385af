//! What can be wrong with a model file.

use miette::{NamedSource, SourceSpan};
use std::io;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// Why a model file could not be read, written or used.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ModelFileError {
    /// The file cannot be opened or is not text.
    #[error("{file}: cannot be read: {problem}")]
    Unreadable {
        /// Path as given.
        file: String,
        /// What the system said.
        problem: io::Error,
    },
    /// The file cannot be written.
    #[error("{file}: cannot be written: {problem}")]
    Unwritable {
        /// Path as given.
        file: String,
        /// What the system said.
        problem: io::Error,
    },
    /// Something in the file is wrong, at a known place.
    #[error("{file}, line {line}: {problem}")]
    Content {
        /// Path as given.
        file: String,
        /// Line, from 1.
        line: usize,
        /// What is wrong and what is allowed.
        problem: String,
        /// The text of the file.
        #[source_code]
        text: Arc<NamedSource<String>>,
        /// The place.
        #[label("here")]
        at: SourceSpan,
        /// What to do, where there is more to say.
        #[help]
        help: Option<String>,
    },
    /// A field of a model that is not from a file is wrong.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// The model is of another dimension than asked for.
    #[error("model `{name}` has dimension {found}; {wanted} is needed here")]
    Dimension {
        /// Name of the model.
        name: String,
        /// Its dimension.
        found: usize,
        /// The dimension needed.
        wanted: usize,
    },
    /// The certificate does not hold.
    #[error("model `{name}` has no valid certificate: {problem}")]
    Certificate {
        /// Name of the model.
        name: String,
        /// The component at fault, from 0; none if it is `lyapunov`.
        component: Option<usize>,
        /// Which part fails.
        problem: String,
    },
}

impl ModelFileError {
    pub(super) fn located(file: &str, text: &str, span: Range<usize>, problem: String) -> Self {
        let line = 1 + text.bytes().take(span.start).filter(|&b| b == b'\n').count();
        Self::Content {
            file: file.to_owned(),
            line,
            problem,
            text: Arc::new(NamedSource::new(file, text.to_owned()).with_language("toml")),
            at: span.into(),
            help: None,
        }
    }

    /// A scene where a model is wanted; `model` is what it names as its own, relative to itself.
    pub(super) fn scene(file: &str, text: &str, span: Range<usize>, model: Option<&str>) -> Self {
        let header = text.get(span.clone()).and_then(|table| table.find('\n')).unwrap_or(span.len());
        let problem = "this is a scene, not a model, which is only the motion of one".to_owned();
        let mut error = Self::located(file, text, span.start..span.start + header, problem);
        if let Self::Content { help, .. } = &mut error {
            let its_own = model.map_or(String::new(), |m| {
                let path = Path::new(file).parent().unwrap_or(Path::new("")).join(m);
                format!(", here `{}`", path.display())
            });
            *help = Some(format!(
                "give a model file, as `pliant learn` writes one and a scene names it by `model`{its_own}; \
                 a scene is checked whole by `pliant plot {file}` and `pliant run {file} --stepped`"
            ));
        }
        error
    }
}

/// A field that is out of its range.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}`{name}` {problem}; allowed is {allowed}", place(*component))]
pub struct FieldError {
    /// The component it belongs to, from 0.
    pub component: Option<usize>,
    /// Name of the field.
    pub name: &'static str,
    /// What is wrong.
    pub problem: String,
    /// What it should be.
    pub allowed: &'static str,
}

fn place(component: Option<usize>) -> String {
    component.map_or_else(String::new, |k| format!("component {}: ", k + 1))
}
