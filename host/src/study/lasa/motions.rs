//! The motions of a folder: each file of demonstrations is one, and each folder in it with such files.

use std::fs;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::learn::read::is_readable;

/// A motion's files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The file's or folder's name, without ending.
    pub name: String,
    /// Files with its demonstrations.
    pub files: Vec<PathBuf>,
}

/// The motions of a folder by name.
///
/// # Errors
/// It cannot be read, or has none.
pub fn sources(folder: &Path) -> Result<Vec<Source>, Error> {
    let mut found = Vec::new();
    for path in entries(folder)? {
        let files = if path.is_dir() {
            entries(&path)?.into_iter().filter(|p| is_readable(p) && p.is_file()).collect()
        } else {
            vec![path.clone()].into_iter().filter(|p| is_readable(p)).collect::<Vec<_>>()
        };
        if !files.is_empty() {
            let name = if path.is_dir() { path.file_name() } else { path.file_stem() };
            found.push(Source { name: name.unwrap_or_default().to_string_lossy().into_owned(), files });
        }
    }
    if found.is_empty() {
        return Err(Error::bad_input(format!(
            "{}: no motion in it; allowed is a folder with a .mat, .npz or .csv file for each motion, or a folder of them for each",
            folder.display()
        )));
    }
    found.sort_by(|a, b| (&a.name, &a.files).cmp(&(&b.name, &b.files)));
    Ok(found)
}

/// What is in a folder, in order, but for what is hidden.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let failed = |e: std::io::Error| Error::bad_input(format!("{}: cannot be read as a folder: {e}", folder.display()));
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        if !entry.file_name().to_string_lossy().starts_with('.') {
            all.push(entry.path());
        }
    }
    all.sort();
    Ok(all)
}
