//! `pliant study`

mod lasa;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Subcommand;
use indicatif::ProgressBar;

use super::{Finished, number, print_json, progress};
use crate::bridge::Device;
use crate::error::Outcome;
use crate::study::skill::Skills;
use crate::study::{Findings, column, experiments, findings, placements, trajectories};

/// Options of `pliant study`. All parts compute in this process; only `paper` and `experiments` take `--device`, for three experiments more on a
/// device.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    #[command(subcommand)]
    study: Study,
}

#[derive(Clone, Debug, Subcommand)]
enum Study {
    #[command(flatten)]
    OfPaper(OfPaper),
    /// Learn every motion of a folder, such as the LASA handwriting set: how well, how fast, beside other learners.
    Lasa(lasa::Args),
}

#[derive(Clone, Debug, Subcommand)]
enum OfPaper {
    /// Everything the paper shows, and what it does not: all of the others (takes --device and --placements).
    Paper {
        #[command(flatten)]
        common: Common,
        #[command(flatten)]
        device: OnDevice,
        #[command(flatten)]
        places: Places,
    },
    /// Motions past one and two deformable obstacles, from many places (Fig. 3); here alone, without --device.
    Trajectories {
        #[command(flatten)]
        common: Common,
    },
    /// Time against stiffness, and time saved against the original method (Fig. 4); here alone, without --device.
    Time {
        #[command(flatten)]
        common: Common,
    },
    /// The experiments A1 to D1, and the claims about speed (section V); takes --device.
    Experiments {
        #[command(flatten)]
        common: Common,
        #[command(flatten)]
        device: OnDevice,
    },
    /// Random obstacles on both sides of the path: what the method does where the paper did not look; here alone, without --device.
    Placements {
        #[command(flatten)]
        common: Common,
        #[command(flatten)]
        places: Places,
    },
}

#[derive(Clone, Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
struct Common {
    /// Folder with Sshape.mat, Angle.mat and Leaf_1.mat of the LASA handwriting set, learnt now, a unit as a centimetre; without it the
    /// project's own motions stand in.
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Where to write report.md, tables, figures, scenes and their models.
    #[arg(short, long, value_name = "DIR", default_value = "out/study")]
    out: PathBuf,
    /// Seed of all random choices.
    #[arg(long, default_value_t = 1, value_parser = number::seed)]
    seed: u64,
}

#[derive(Clone, Debug, clap::Args)]
struct OnDevice {
    /// Run A1, B1 and D1 on this device too, and compare every bit with the virtual one.
    #[arg(long)]
    device: Option<Device>,
}

#[derive(Clone, Debug, clap::Args)]
struct Places {
    /// Random obstacles on each side of the path, 1 to 1000000.
    #[arg(long, value_name = "N", default_value_t = placements::COUNT, value_parser = count)]
    placements: usize,
}

fn count(text: &str) -> Result<usize, String> {
    number::within(text, 1..=1_000_000, "a whole number from 1 to 1000000")
}

impl OfPaper {
    fn common(&self) -> &Common {
        match self {
            Self::Paper { common, .. }
            | Self::Trajectories { common }
            | Self::Time { common }
            | Self::Experiments { common, .. }
            | Self::Placements { common, .. } => common,
        }
    }
}

const WANTED: &str = "--data DIR is a folder with Sshape.mat, Angle.mat and Leaf_1.mat of the LASA handwriting set; without it the project's own \
                      motions stand in";

/// Where the bar is.
struct Stage<'a> {
    bar: &'a ProgressBar,
}

impl Stage<'_> {
    /// Runs a part with a bar that fills as it goes on.
    fn run<R>(&self, name: &'static str, part: impl FnOnce(&(dyn Fn(usize) + Sync)) -> R) -> R {
        self.bar.set_message(name);
        self.bar.set_position(0);
        // How many steps there are is up to the part: the bar nears its end as they go on.
        part(&|done| self.bar.set_position(1000 * done as u64 / (done as u64 + 40)))
    }
}

pub(super) fn main(args: &Args, json: bool) -> Finished {
    match &args.study {
        Study::OfPaper(study) => of_paper(study, json),
        Study::Lasa(args) => lasa::main(args, json),
    }
}

fn of_paper(study: &OfPaper, json: bool) -> Finished {
    let common = study.common();
    findings::check_writable(&common.out)?;
    let bar = progress::bar(json);
    let stage = Stage { bar: &bar };
    let skills =
        stage.run("motions", |done| Skills::new(common.data.as_deref(), done)).map_err(|e| match common.data {
            Some(_) => e.with_help(WANTED),
            None => e,
        })?;
    let seed = common.seed;
    let trajectories = || stage.run("trajectories", |done| trajectories::study(&skills, seed, done));
    let time = || stage.run("times", |done| crate::study::time(&skills, done));
    let experiments =
        |on: &OnDevice| stage.run("experiments", |done| experiments::study(&skills, on.device.as_ref(), seed, done));
    let placements =
        |places: &Places| stage.run("placements", |done| placements::study(&skills, places.placements, seed, done));
    let found = match study {
        OfPaper::Trajectories { .. } => trajectories()?,
        OfPaper::Time { .. } => time()?,
        OfPaper::Experiments { device, .. } => experiments(device)?,
        OfPaper::Placements { places, .. } => placements(places)?,
        OfPaper::Paper { device, places, .. } => {
            let mut all = trajectories()?;
            all.append(time()?);
            all.append(experiments(device)?);
            all.append(placements(places)?);
            all
        }
    };
    bar.set_message("figures");
    let introduction = introduction(&skills, common);
    found.write(&common.out, &introduction)?;
    bar.finish_and_clear();
    report(&found, &skills, common, &introduction, json)
}

/// What was studied, and with what.
fn introduction(skills: &Skills, common: &Common) -> String {
    let mut text = String::from("# The paper's studies, run again\n\nMotions: ");
    for skill in skills.three().into_iter().chain([&skills.recorded]) {
        let _ = write!(text, "{} ({}), ", skill.name, skill.origin);
    }
    if !skills.lasa {
        text += "the project's own in the place of LASA handwriting (`--data DIR` names a folder of it), ";
    }
    let _ = writeln!(
        text,
        "c = {} m/s in all, theta_2 = {:.0} degrees where the paper is followed to the letter, seed {}.",
        column::GAIN,
        column::THETA.to_degrees(),
        common.seed
    );
    text
}

fn report(found: &Findings, skills: &Skills, common: &Common, introduction: &str, json: bool) -> Finished {
    if json {
        let mut all = found.to_json();
        if let Some(all) = all.as_object_mut() {
            all.insert("data".into(), if skills.lasa { "lasa" } else { "own" }.into());
            all.insert("c".into(), column::GAIN.into());
            all.insert("seed".into(), common.seed.into());
            all.insert("folder".into(), common.out.display().to_string().into());
        }
        print_json(&all);
    } else {
        say!("{introduction}");
        for v in &found.verdicts {
            let holds = match (v.holds, v.vital) {
                (Some(true), _) => "holds",
                (Some(false), true) => "FAILS",
                (Some(false), false) => "fails",
                (None, _) => "-",
            };
            say!("  {holds:6}  {}", v.claim);
            say!("          paper: {}; measured: {}", v.paper, v.measured);
        }
        say!("\n  tables, figures, scenes and their models: {}", shown(&common.out));
        say!("  {}", found.conclusion());
    }
    Ok(if found.is_well() { Outcome::Success } else { Outcome::Failed })
}

fn shown(folder: &Path) -> String {
    folder.join("report.md").display().to_string()
}
