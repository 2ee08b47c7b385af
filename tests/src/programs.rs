//! The built programs that tests run, and how to run them.

use std::env;
use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// How a program ended.
#[derive(Debug, Clone)]
pub struct Ended {
    /// Its exit code; none if a signal ended it.
    pub code: Option<i32>,
    /// What it printed.
    pub stdout: String,
    /// What it said besides.
    pub stderr: String,
}

impl Ended {
    /// Standard output as JSON; null if it is none.
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).unwrap_or_default()
    }
}

/// The root of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new(".")).to_path_buf()
}

/// The `pliant` binary: the one `PLIANT_BIN` names, or the one beside this test, built now if need be.
///
/// # Errors
/// There is none and it cannot be built.
pub fn pliant() -> io::Result<PathBuf> {
    if let Some(path) = env::var_os("PLIANT_BIN") {
        return Ok(path.into());
    }
    let test = env::current_exe()?;
    let folder = test.parent().and_then(Path::parent).ok_or(io::ErrorKind::NotFound)?;
    let mut build = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    build.current_dir(root()).args(["build", "--quiet", "--package", "pliant"]);
    if folder.ends_with("release") {
        build.arg("--release");
    }
    if !build.status()?.success() {
        return Err(io::Error::other("pliant does not build"));
    }
    Ok(folder.join("pliant"))
}

/// Runs `pliant` in a folder.
///
/// # Errors
/// It cannot be run.
pub fn run<A: AsRef<OsStr>>(folder: &Path, arguments: impl IntoIterator<Item = A>) -> io::Result<Ended> {
    run_with(folder, arguments, &[])
}

/// Runs `pliant` in a folder with environment variables set.
///
/// # Errors
/// It cannot be run.
pub fn run_with<A: AsRef<OsStr>>(
    folder: &Path,
    arguments: impl IntoIterator<Item = A>,
    environment: &[(&str, &str)],
) -> io::Result<Ended> {
    let output =
        Command::new(pliant()?).current_dir(folder).args(arguments).envs(environment.iter().copied()).output()?;
    Ok(Ended {
        code: output.status.code(),
        stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
    })
}

/// The LASA motions, if this machine has them: the folder `PLIANT_LASA`, or `shared/data/lasa` beside the repository.
pub fn lasa() -> Option<PathBuf> {
    let beside = || root().join("../shared/data/lasa");
    let folder = env::var_os("PLIANT_LASA").map_or_else(beside, PathBuf::from);
    folder.join("Sshape.mat").is_file().then_some(folder)
}
