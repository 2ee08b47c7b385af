//! The project's own tasks, run as `cargo xtask <task>`.
//!
//! One module a task or a concept: [`setup`] (what the machine must have), [`checks`] (the steps of
//! `test`), [`tally`] (test counts out of cargo's output), [`size`] over [`image`] (what the firmware
//! takes), [`no_panic`] over [`callers`] (that the tick cannot panic), [`campaign`], [`speed`] (its task is `bench`), [`fuzz`],
//! [`models`]; beneath them [`workspace`] starts commands and [`failure`] is what goes wrong, as one sentence.

#![forbid(unsafe_code)]

mod callers;
mod campaign;
mod checks;
mod deny;
mod failure;
mod fuzz;
mod image;
mod models;
mod no_panic;
mod setup;
mod size;
mod speed;
mod tally;
mod workspace;

use std::process::ExitCode;

use failure::Failure;
use workspace::Workspace;

const USAGE: &str = "\
Usage: cargo xtask <task>

Tasks:
  test                    set up, then run every check and every test; what CI runs
  setup                   install what the project needs and this machine lacks
  campaign [NAME ...] [--samples N]
                          the core's property campaigns, or those named, N samples for each scalar type (10^8 by default; hours)
  bench                   time one velocity and count its instructions; installs Callgrind's parts if missing
  no-panic                show that the tick cannot panic, on either core
  size [--json]           text, data, bss and stack of the firmware
  fuzz [--seconds N]      run every fuzz target, N seconds each (600 by default)
  deny                    check licences, bans and sources; installs cargo-deny if missing
  models                  learn models/ anew from demos/
  help                    this text
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("xtask: {failure}");
            ExitCode::from(failure.exit_code())
        }
    }
}

fn run(arguments: &[String]) -> Result<(), Failure> {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["test"] => checks::run(&Workspace::locate()?),
        ["setup"] => setup::run(&Workspace::locate()?),
        ["size"] => size::run(&Workspace::locate()?, size::Format::Table),
        ["size", "--json"] => size::run(&Workspace::locate()?, size::Format::Json),
        ["campaign", options @ ..] => campaign::run(&Workspace::locate()?, options),
        ["bench"] => speed::run(&Workspace::locate()?),
        ["no-panic"] => no_panic::run(&Workspace::locate()?),
        ["fuzz", options @ ..] => fuzz::run(&Workspace::locate()?, fuzz::seconds(options)?),
        ["deny"] => deny::install_and_check(&Workspace::locate()?),
        ["models"] => models::run(&Workspace::locate()?),
        [] | ["help" | "--help" | "-h"] => {
            print!("{USAGE}");
            Ok(())
        }
        _ => Err(Failure::usage(format!("`{}` is no task: `cargo xtask help` lists them", words.join(" ")))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_task_is_bad_usage() {
        let failure = run(&["paint".to_owned()]).unwrap_err();
        assert_eq!(failure.exit_code(), 2);
        assert!(failure.to_string().contains("paint"));
    }
}
