//! The core's property campaigns at length: the same tests as in the suite, optimised and with many more samples.

use crate::failure::Failure;
use crate::workspace::{Workspace, run as run_command};

/// Samples of each campaign and scalar type where no number is asked for.
const SAMPLES: u64 = 100_000_000;

/// Each by its name, and where cargo finds it.
const CAMPAIGNS: [(&str, &[&str]); 8] = [
    ("penetration", &["--test", "penetration"]),
    ("finite", &["--test", "finite"]),
    ("equilibrium", &["--test", "equilibrium"]),
    ("continuity", &["--test", "continuity"]),
    ("closed-form", &["--lib", "closed_form::"]),
    ("frame", &["--test", "frame"]),
    ("order", &["--test", "order"]),
    ("original", &["--test", "original"]),
];

/// Runs those that are named, or all, one after the other.
pub fn run(workspace: &Workspace, options: &[&str]) -> Result<(), Failure> {
    let (chosen, samples) = parse(options)?;
    for (name, target) in chosen {
        eprintln!("xtask: campaign {name}, {samples} samples a scalar type");
        let mut command = workspace.cargo(&["test", "--release", "--package", "pliant-core"]);
        command.args(*target).args(["--", "--nocapture"]).env("PLIANT_SAMPLES", samples.to_string());
        run_command(&mut command)?;
    }
    Ok(())
}

type Campaign = (&'static str, &'static [&'static str]);

fn parse(options: &[&str]) -> Result<(Vec<&'static Campaign>, u64), Failure> {
    let (mut chosen, mut samples) = (Vec::new(), SAMPLES);
    let mut rest = options.iter();
    while let Some(option) = rest.next() {
        if *option == "--samples" {
            let number = rest.next().copied().unwrap_or_default();
            samples = number.parse().ok().filter(|n| *n > 0).ok_or_else(|| {
                Failure::usage(format!("`--samples {number}`: a whole number of samples, 1 or more, is wanted"))
            })?;
            continue;
        }
        chosen.push(CAMPAIGNS.iter().find(|(name, _)| name == option).ok_or_else(|| {
            let names = CAMPAIGNS.map(|(name, _)| name).join(", ");
            Failure::usage(format!("`campaign` takes `--samples N` and any of {names}, not `{option}`"))
        })?);
    }
    if chosen.is_empty() {
        chosen.extend(&CAMPAIGNS);
    }
    Ok((chosen, samples))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_samples_in_any_order() {
        let names = |options: &[&str]| {
            parse(options).map(|(chosen, samples)| (chosen.iter().map(|c| c.0).collect::<Vec<_>>(), samples))
        };
        assert_eq!(names(&["penetration", "--samples", "5"]).unwrap(), (vec!["penetration"], 5));
        assert_eq!(names(&["--samples", "7", "frame", "order"]).unwrap(), (vec!["frame", "order"], 7));
        assert_eq!(names(&[]).unwrap().0.len(), CAMPAIGNS.len());
        for wrong in [&["paint"][..], &["--samples"], &["--samples", "0"], &["--samples", "-3"]] {
            assert_eq!(names(wrong).unwrap_err().exit_code(), 2);
        }
    }
}
