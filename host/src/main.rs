//! The `pliant` command. Everything it does is in the library; see `pliant --help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    pliant::cli::main()
}
