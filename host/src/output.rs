//! Files that a command writes: every one of them makes the folders it needs, and replaces what is there.

use crate::error::Error;
use std::fs;
use std::io;
use std::path::Path;

/// Writes a file, and makes the folder it is in if there is none.
///
/// # Errors
/// What the system says: no permission, a folder of that name, no room.
pub fn write(path: &Path, bytes: impl AsRef<[u8]>) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(path, bytes)
}

/// Refuses to write over a file that is read, such as a demonstration; to be asked before long work.
///
/// # Errors
/// The output is one of the inputs.
pub fn spare<'a>(out: &Path, inputs: impl IntoIterator<Item = &'a Path>) -> Result<(), Error> {
    // What is not there yet cannot be written over.
    let Ok(target) = out.canonicalize() else { return Ok(()) };
    if inputs.into_iter().any(|input| input.canonicalize().is_ok_and(|input| input == target)) {
        return Err(Error::bad_input(format!(
            "{}: it is read here, and would be written over; give another -o",
            out.display()
        )));
    }
    Ok(())
}

/// Refuses to write a model, which is TOML, into a file whose ending says that it is something else; to be asked before long work.
///
/// # Errors
/// Its ending is that of another kind of file.
pub fn is_model(out: &Path) -> Result<(), Error> {
    let ending = out.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if ["json", "yaml", "yml", "csv", "npz", "mat", "mcap", "svg", "png"].contains(&ending.as_str()) {
        return Err(Error::bad_input(format!("{}: a model is TOML; give it the ending .toml", out.display())));
    }
    Ok(())
}
