//! Demonstrations from files, a module each format.
//!
//! Readers are written for files from anywhere: none panics, and the file bounds time and memory.

pub mod csv;
pub mod lasa;
pub mod mat;
#[cfg(test)]
pub(super) mod mat_writer;
pub mod npy;
pub mod npz;
#[cfg(test)]
pub(super) mod npz_writer;
mod split;
pub mod zip;

use super::demonstration::{Demonstration, Demonstrations, Unit};
use super::error::LearnError;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Bytes in one file.
const MOST_BYTES: u64 = 512 << 20;

/// Reads the demonstrations of one skill from files and folders of them, in metres.
pub fn read(paths: &[PathBuf], unit: Option<Unit>) -> Result<Demonstrations, LearnError> {
    Demonstrations::new(recordings(paths, unit)?)
}

/// Reads recordings from files and folders of them, in metres; whether they are of one skill is not checked.
pub fn recordings(paths: &[PathBuf], unit: Option<Unit>) -> Result<Vec<Demonstration>, LearnError> {
    let mut items = Vec::new();
    for path in paths {
        let file = path.display().to_string();
        let unreadable = |problem| LearnError::Unreadable { file: file.clone(), problem };
        if fs::metadata(path).map_err(unreadable)?.is_dir() {
            let mut inside = Vec::new();
            for entry in fs::read_dir(path).map_err(unreadable)? {
                let entry = entry.map_err(unreadable)?.path();
                if is_readable(&entry) {
                    inside.push(entry);
                }
            }
            if inside.is_empty() {
                return Err(LearnError::NoDemonstrations { file });
            }
            inside.sort();
            for entry in inside {
                items.extend(read_file(&entry, unit)?);
            }
        } else {
            items.extend(read_file(path, unit)?);
        }
    }
    Ok(items)
}

type Reader = fn(&str, &[u8]) -> Result<Vec<Demonstration>, LearnError>;

/// Is this, by its name, a file of demonstrations?
pub fn is_readable(path: &Path) -> bool {
    format_of(path).is_some()
}

/// How a file is read and the unit it has where none is declared, by its name.
fn format_of(path: &Path) -> Option<(Reader, Unit)> {
    match path.extension()?.to_string_lossy().to_ascii_lowercase().as_str() {
        "mat" => Some((lasa::read, Unit::Cm)),
        "csv" => Some((csv::read, Unit::M)),
        "npz" => Some((npz::read, Unit::M)),
        _ => None,
    }
}

fn read_file(path: &Path, unit: Option<Unit>) -> Result<Vec<Demonstration>, LearnError> {
    let file = path.display().to_string();
    let Some((reader, default)) = format_of(path) else { return Err(LearnError::UnknownFormat { file }) };
    let bytes = bytes_of(path)?;
    let factor = unit.unwrap_or(default).metres();
    Ok(reader(&file, &bytes)?.into_iter().map(|d| d.scaled(factor)).collect())
}

/// All bytes of a file, where they are not more than any file of this kind has.
pub fn bytes_of(path: &Path) -> Result<Vec<u8>, LearnError> {
    let file = path.display().to_string();
    let unreadable = |problem| LearnError::Unreadable { file: file.clone(), problem };
    let mut bytes = Vec::new();
    // Not the size that the system tells: a device has none.
    File::open(path).and_then(|f| f.take(MOST_BYTES + 1).read_to_end(&mut bytes)).map_err(unreadable)?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(LearnError::TooLarge { file });
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests;
