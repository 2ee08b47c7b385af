//! `pliant study lasa`

use std::io::Write as _;
use std::path::PathBuf;

use super::super::{Finished, number, print_json, progress};
use crate::error::{Error, Outcome};
use crate::learn::{Options, Unit};
use crate::study::findings;
use crate::study::lasa::{Found, Task, study};

/// Options of `pliant study lasa`.
#[derive(Clone, Debug, clap::Args)]
#[command(allow_negative_numbers = true, override_usage = "pliant study lasa [OPTIONS] --data <DIR>")]
pub struct Args {
    /// Folder with a file of demonstrations for each motion (.mat, .npz, .csv), or a folder of files for each; it has to be given.
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Where to write report.md, the tables and the contact sheet.
    #[arg(short, long, value_name = "DIR", default_value = "out/study/lasa")]
    out: PathBuf,
    /// Also learn each motion without one of its demonstrations and measure on that one, for each of them.
    #[arg(long)]
    held_out: bool,
    /// Unit of lengths in the files: mm, cm or m (.mat: mm, as LASA handwriting is recorded; .csv, .npz: m).
    #[arg(long)]
    unit: Option<Unit>,
    /// Seed of all random choices.
    #[arg(long, default_value_t = Options::default().seed, value_parser = number::seed)]
    seed: u64,
}

const WHERE: &str = "LASA handwriting may not be passed on with this tool: it is at https://bitbucket.org/khansari/lasahandwritingdataset \
                     (its folder `DataSet`). `--data demos` learns the project's own motions";

pub(super) fn main(args: &Args, json: bool) -> Finished {
    let Some(folder) = &args.data else {
        return Err(Error::bad_input("--data DIR is missing: the folder of the motions").with_help(WHERE));
    };
    let task = Task { folder, unit: args.unit, seed: args.seed, held_out: args.held_out };
    findings::check_writable(&args.out)?;
    let bar = progress::bar(json);
    let found = study(&task, &|what, done, of| {
        bar.set_message(format!("{what} {done} of {of}"));
        bar.set_position((1000 * done / of.max(1)) as u64);
    });
    bar.finish_and_clear();
    let found = found?;
    for f in &found.failed {
        let _ = writeln!(std::io::stderr(), "error: {}", f.reason);
    }
    found.findings.write(&args.out, &introduction(&found, args))?;
    report(&found, args, json);
    Ok(if found.is_well() { Outcome::Success } else { Outcome::Failed })
}

fn introduction(found: &Found, args: &Args) -> String {
    let what = if found.lasa { "LASA handwriting" } else { "Motions" };
    let mut text = format!(
        "# {what}, learnt\n\n{} motions at their recorded size, seed {}. Seconds are processor time of one core.\n",
        found.measured.len(),
        args.seed
    );
    for f in &found.failed {
        text += &format!("\nFailed: {}\n", f.reason);
    }
    text
}

fn report(found: &Found, args: &Args, json: bool) {
    if json {
        let mut all = found.findings.to_json();
        all["data"] = if found.lasa { "lasa" } else { "own" }.into();
        all["seed"] = args.seed.into();
        all["folder"] = args.out.display().to_string().into();
        print_json(&all);
        return;
    }
    say!("{:20} {:>2}  {:>9} {:>7} {:>8} {:>6}  arrive", "motion", "K", "RMSE mm/s", "e_dot", "DTWD mm", "CPU s");
    for m in &found.measured {
        let q = &m.quality;
        say!(
            "{:20} {:2}  {:9.2} {:7.4} {:8.0} {:6.2}  {} of {}{}",
            m.name,
            m.k,
            q.rmse * 1e3,
            q.e_dot,
            q.dtwd * 1e3,
            m.seconds,
            q.converged,
            q.rollouts,
            if m.certified { "" } else { ", NOT CERTIFIED" }
        );
    }
    for (title, middle) in
        [("median", &found.findings.json["medians"]), ("median, held out", &found.findings.json["medians"]["held_out"])]
    {
        let number = |key: &str| middle[key].as_f64();
        if let (Some(rmse), Some(e_dot), Some(dtwd)) = (number("rmse_mm_s"), number("e_dot"), number("dtwd_mm")) {
            let seconds = number("seconds").map_or_else(|| "     -".into(), |s| format!("{s:6.2}"));
            let (arrived, all) = (&middle["converged"], &middle["rollouts"]);
            say!(
                "{title:20} {:>2}  {rmse:9.2} {e_dot:7.4} {dtwd:8.0} {seconds}  {arrived} of {all}",
                number("k").map_or_else(|| "-".into(), |k| format!("{k:.0}"))
            );
        }
    }
    say!("\n  tables and contact sheet: {}", args.out.join("report.md").display());
}
