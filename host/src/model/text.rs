//! The text of a model file, which errors can point into.

use super::{ModelFile, ModelFileError, locate};
use std::fs;
use std::path::Path;

/// A model file as it is on disk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Text {
    file: String,
    text: String,
}

impl Text {
    /// Reads a file.
    ///
    /// # Errors
    /// It cannot be read, or is not text.
    pub fn read(path: &Path) -> Result<Self, ModelFileError> {
        let file = path.display().to_string();
        match fs::read_to_string(path) {
            Ok(text) => Ok(Self { file, text }),
            Err(problem) => Err(ModelFileError::Unreadable { file, problem }),
        }
    }

    /// Text that was read elsewhere; `file` is named in errors.
    pub fn new(file: impl Into<String>, text: impl Into<String>) -> Self {
        Self { file: file.into(), text: text.into() }
    }

    /// The model in it, its certificate not checked.
    ///
    /// # Errors
    /// What is wrong, and where.
    pub fn model(&self) -> Result<ModelFile, ModelFileError> {
        ModelFile::parse(&self.file, &self.text)
    }

    /// The same error with its place in this file, if it is about something in it.
    pub fn locate(&self, error: ModelFileError) -> ModelFileError {
        let (component, name, problem) = match &error {
            ModelFileError::Certificate { component, .. } => {
                (*component, if component.is_some() { "a" } else { "lyapunov" }, error.to_string())
            }
            ModelFileError::Field(fault) => (fault.component, fault.name, fault.to_string()),
            _ => return error,
        };
        locate::fault(&self.file, &self.text, component, name, problem)
    }
}
