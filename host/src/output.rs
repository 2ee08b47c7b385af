//! Files that a command writes: every one of them makes the folders it needs, and replaces what is there.

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
