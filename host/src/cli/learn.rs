//! `pliant learn`

use std::path::{Path, PathBuf};
use std::time::Instant;

use pliant_core::ds::MAX_COMPONENTS;
use serde_json::json;

use super::check::per_second;
use super::{Finished, number, print_json, progress, warn};
use crate::error::{Error, Outcome, counted};
use crate::learn::{
    Demonstration, Demonstrations, LearnError, Learnt, Options, Unit, Warning, learn_from, memory, read,
};
use crate::model::ModelFile;
use crate::output;
use crate::plot::{self, Portrait};

/// Options of `pliant learn`.
#[derive(Clone, Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct Args {
    /// Demonstrations of one skill: .mat (LASA), .npz, .csv with header t,x,y[,z], folders of them.
    #[arg(required = true, value_name = "DEMO")]
    demos: Vec<PathBuf>,
    /// Add them to those this model was learnt from, and learn it anew.
    #[arg(long, value_name = "MODEL.toml")]
    add_to: Option<PathBuf>,
    /// Where to write the model (if not given: the model that is added to, or else NAME.toml in the working folder, by the first
    /// demonstration's name).
    #[arg(short, long, value_name = "MODEL.toml")]
    out: Option<PathBuf>,
    /// Where to draw it beside its demonstrations, .svg or .png (MODEL.svg beside the model if not given).
    #[arg(long, value_name = "FIG")]
    figure: Option<PathBuf>,
    /// Draw nothing.
    #[arg(long, conflicts_with = "figure")]
    no_figure: bool,
    /// Unit of lengths in the files: mm, cm or m (.mat: cm, so that LASA handwriting is ten times its size; .csv, .npz: m).
    #[arg(long)]
    unit: Option<Unit>,
    /// Number of components, 1 to 16 (chosen if not given).
    #[arg(long, value_name = "K", value_parser = components)]
    components: Option<usize>,
    /// Seed of all random choices (if not given: that of the model that is added to, or else 1).
    #[arg(long, value_parser = number::seed)]
    seed: Option<u64>,
    /// Guaranteed rate of convergence, 0 to 10 1/s (if not given: that of the model that is added to, or else 0.01).
    #[arg(long, value_parser = sigma)]
    sigma: Option<f64>,
    /// Weight of being on time on the path against being on it, 0 to 10.
    #[arg(long, default_value_t = Options::default().pace, value_parser = pace)]
    pace: f64,
}

fn components(text: &str) -> Result<usize, String> {
    number::within(text, 1..=MAX_COMPONENTS, format_args!("a whole number from 1 to {MAX_COMPONENTS}"))
}

fn sigma(text: &str) -> Result<f64, String> {
    number::within(text, 0.0..=10.0, "0 to 10 1/s")
}

fn pace(text: &str) -> Result<f64, String> {
    number::within(text, 0.0..=10.0, "0 to 10")
}

/// Part of the extent up to which a path error is small, or too large.
const CLOSE: f64 = 0.02;
const ROUGH: f64 = 0.05;
/// Part of the extent by which a rollout may leave the demonstrations' box without a word.
const WIDE: f64 = 0.1;
/// The rate sigma times a demonstration's duration from which on the certificate may be what a motion cannot follow, and what to ask for in its place.
const HURRIED: f64 = 0.5;
const UNHURRIED: f64 = 0.05;
/// A pace that far from the demonstrators' is worth a word.
const OFF_PACE: f64 = 0.15;

fn longest(demonstrations: &Demonstrations) -> f64 {
    demonstrations.items().iter().map(Demonstration::duration).fold(0.0, f64::max)
}

/// How good the skill is, and what to do if it is not: a sentence each.
fn verdict(learnt: &Learnt, sigma: f64) -> Vec<String> {
    let (q, extent) = (&learnt.quality, learnt.demonstrations.extent());
    let longest = longest(&learnt.demonstrations);
    let hurried = sigma * longest > HURRIED;
    let percent = |length: f64| format!("{:.1} % of its size", 100.0 * length / extent);
    let mut says = vec![match q.path_error / extent {
        error if error <= CLOSE => "it follows the demonstrations closely".into(),
        error if error <= ROUGH => {
            format!("it follows the demonstrations roughly, {} beside them", percent(q.path_error))
        }
        _ => format!("it strays from the demonstrations by {}", percent(q.path_error)),
    }];
    if q.robust < q.beside {
        says.push(format!(
            "from {} of {} places beside the demonstrations it takes more than twice their time: demonstrate from there as well, \
             or raise --sigma",
            q.beside - q.robust,
            q.beside
        ));
    }
    // With a rate far too high it is the numbers that leave.
    if let Some(from) = q.excursion_from
        && q.excursion > WIDE * extent
        && !hurried
    {
        says.push(format!(
            "from {} it leaves the demonstrations' box by {} on the way: demonstrate from there as well",
            place(&from[..learnt.model.dimension]),
            percent(q.excursion)
        ));
    }
    let strays = learnt.gives_way > CLOSE * extent || q.path_error > CLOSE * extent;
    if hurried && strays {
        says.push(format!(
            "--sigma {sigma} asks it to come nearer its goal all the time, in the {longest:.3} s it takes by e to the {}: lower it, --sigma {} asks for \
             little",
            significant(sigma * longest),
            significant(UNHURRIED / longest)
        ));
    } else if learnt.gives_way > CLOSE * extent {
        says.push(format!(
            "the demonstrations move away from their goal on the way, by {} more than a certificate allows: demonstrate a more direct way, \
             or two skills with a goal in between",
            percent(learnt.gives_way)
        ));
    } else if q.path_error > ROUGH * extent {
        says.push("look at the figure: do the demonstrations cross themselves, or show two different motions?".into());
        if learnt.demonstrations.items().len() < 3 {
            says.push("more demonstrations allow more components".into());
        }
    }
    if (q.pace - 1.0).abs() > OFF_PACE && !hurried {
        let word = if q.pace > 1.0 { "longer" } else { "shorter" };
        says.push(format!(
            "it takes {:.2} times as long as the demonstrator, so {word}: raise --pace to keep time",
            q.pace
        ));
    }
    says
}

fn place(x: &[f64]) -> String {
    let coordinates: Vec<_> = x.iter().map(|x| format!("{x:.4}")).collect();
    format!("({})", coordinates.join(", "))
}

/// To two significant digits.
fn significant(number: f64) -> String {
    let text = format!("{number:.1e}");
    text.parse::<f64>().map_or(text, |rounded| rounded.to_string())
}

/// A skill that does not come to its end from where it was shown is none: nothing is written.
fn arrives(learnt: &Learnt, options: &Options) -> Result<(), Error> {
    let stranded = learnt.stranded();
    let Some(first) = stranded.first() else { return Ok(()) };
    let others = match stranded.len() - 1 {
        0 => String::new(),
        n => format!(", and neither from {}", counted(n, "other")),
    };
    let wrong = learnt.demonstrations.warnings().iter().find(|w| matches!(w, Warning::Velocity { .. }));
    let help = if let Some(wrong) = wrong {
        format!("its velocities may be why: {wrong}")
    } else {
        // A little above, for the start of a recording is left out.
        let rate = (110.0 * learnt.arriving_rate()).ceil() / 100.0;
        format!(
            "with --sigma {rate} (now {}) the certificate itself promises that it is; better still, demonstrate a more direct way, in more samples",
            options.sigma
        )
    };
    Err(Error::failed(format!(
        "nothing is written: from the start of {first} the learnt motion is not at its goal after ten times the demonstration's time{others}"
    ))
    .with_help(help))
}

/// A skill as small or as short as this is learnt and certified; one far below is not, for want of digits.
const SMALL: f64 = 5e-4;
const SHORT: f64 = 2e-3;

/// With the line of a CSV file that is at fault.
fn unread(error: LearnError) -> Error {
    let at = if let LearnError::Line { file, line, .. } = &error { Some((file.clone(), *line)) } else { None };
    let error = Error::from(error);
    at.into_iter().fold(error, |error, (file, line)| error.at_line(file, line))
}

/// Where no motion is found: the rate that was asked for, or the unit of what was given.
fn unfitted(error: LearnError, sigma: f64, extent: f64, longest: f64) -> Error {
    match error {
        LearnError::Fit { .. } if extent < SMALL || longest < SHORT => Error::from(error).with_help(format!(
            "the demonstrations are {extent:.1e} m large and {longest:.1e} s long: are positions in metres (--unit mm, cm or m says what they are), and \
             times in seconds?"
        )),
        LearnError::Fit { .. } if sigma * longest > HURRIED => Error::from(error).with_help(format!(
            "--sigma {sigma} asks for too fast an approach over the {longest:.3} s of a demonstration: try --sigma {}",
            significant(UNHURRIED / longest)
        )),
        error => error.into(),
    }
}

/// The skill beside its demonstrations.
fn draw(learnt: &Learnt, figure: &Path) -> Result<(), Error> {
    let (model, shown) = (&learnt.model, &learnt.demonstrations);
    let note = format!(
        "{}, path error {:.1} mm",
        counted(model.component.len(), "component"),
        learnt.quality.path_error * 1e3
    );
    if let Some(portrait) = Portrait::new(&*model.name, note, model, shown, Unit::M) {
        plot::portrait(&portrait, plot::Options::default().width).save(figure)?;
    }
    Ok(())
}

pub(super) fn main(args: &Args, json: bool) -> Finished {
    let stem =
        args.demos.first().and_then(|p| p.file_stem()).map_or("skill".into(), |s| s.to_string_lossy().to_lowercase());
    let out = args.out.clone().or(args.add_to.clone()).unwrap_or_else(|| PathBuf::from(format!("{stem}.toml")));
    let name = out.file_stem().map_or(stem, |s| s.to_string_lossy().into_owned());
    let figure = (!args.no_figure).then(|| args.figure.clone().unwrap_or_else(|| out.with_extension("svg")));
    if let Some(figure) = &figure {
        plot::check_format(figure)?;
    }
    output::spare(&out, args.demos.iter().map(PathBuf::as_path))?;
    output::is_model(&out)?;
    let new = read::recordings(&args.demos, args.unit).map_err(unread)?;
    let old = args.add_to.as_ref().map(|path| ModelFile::read(path).map(|model| (path, model))).transpose()?;
    let learnt_with = old.as_ref().and_then(|(_, model)| model.learnt.as_ref());
    let usual = Options::default();
    let options = Options {
        name,
        unit: args.unit,
        components: args.components,
        seed: args.seed.or(learnt_with.and_then(|l| l.seed.map(i64::cast_unsigned))).unwrap_or(usual.seed),
        sigma: args.sigma.or(learnt_with.and_then(|l| l.sigma)).unwrap_or(usual.sigma),
        pace: args.pace,
        ..usual
    };
    let (demonstrations, mut sources) = match &old {
        None => (Demonstrations::new(new)?, vec![]),
        Some((path, model)) => memory::with(model, path, new)?,
    };
    let complete = args.add_to.is_none() || !sources.is_empty();
    sources.extend(args.demos.iter().map(|path| memory::Source { path: path.clone(), unit: args.unit }));
    warn(demonstrations.warnings());
    let bar = progress::bar(json);
    bar.set_message("learning");
    let begin = Instant::now();
    let (extent, longest) = (demonstrations.extent(), longest(&demonstrations));
    let mut learnt = learn_from(demonstrations, &options, &|done| bar.set_position((done * 1000.0) as u64))
        .map_err(|error| unfitted(error, options.sigma, extent, longest))?;
    let seconds = begin.elapsed().as_secs_f64();
    bar.finish_and_clear();
    arrives(&learnt, &options)?;
    // Where the old demonstrations are gone, the new files alone are not what it was learnt from.
    let sources = if complete { &sources[..] } else { &[] };
    memory::note(&mut learnt.model, &out, sources, &learnt.demonstrations.starts());
    learnt.model.write(&out)?;
    if let Some(figure) = &figure {
        draw(&learnt, figure)?;
    }
    let warnings: Vec<_> = learnt.demonstrations.warnings().iter().map(ToString::to_string).collect();
    let margin = learnt.model.proof::<f32>()?.margin;
    let (k, q, demonstrations) = (learnt.model.component.len(), &learnt.quality, learnt.demonstrations.items().len());
    if json {
        print_json(&json!({
            "name": learnt.model.name, "model": out, "figure": figure, "dimension": learnt.model.dimension, "k": k, "demonstrations": demonstrations,
            "rmse_m_s": q.rmse, "e_dot": q.e_dot, "dtwd_m": q.dtwd, "path_error_m": q.path_error, "pace": q.pace, "margin": margin, "verdict": verdict(&learnt, options.sigma),
            "converged": q.converged, "rollouts": q.rollouts, "robust": q.robust, "beside": q.beside, "excursion_m": q.excursion,
            "excursion_from": q.excursion_from.as_ref().map(|x| &x[..learnt.model.dimension]), "certified": true, "seconds": seconds, "warnings": warnings,
        }));
    } else {
        say!(
            "{}: learnt from {} in {seconds:.2} s, {}, certified in f32 and f64",
            learnt.model.name,
            counted(demonstrations, "demonstration"),
            counted(k, "component")
        );
        say!(
            "  velocity error {:.4} m/s, direction error {:.4}, path error {:.1} mm",
            q.rmse,
            q.e_dot,
            q.path_error * 1e3
        );
        say!(
            "  proved rate {} on the rounded numbers; {:.2} times the demonstrators' time",
            per_second(margin),
            q.pace
        );
        say!(
            "  {} of {} rollouts from the demonstrations' starts arrive; from beside the demonstrations {} of {} in twice their time",
            q.converged,
            q.rollouts,
            q.robust,
            q.beside
        );
        say!("  the farthest any of these leaves the box about the demonstrations: {:.1} mm", q.excursion * 1e3);
        for sentence in verdict(&learnt, options.sigma) {
            say!("  {sentence}");
        }
        say!("  model: {}", out.display());
        if let Some(figure) = &figure {
            say!("  figure: {}", figure.display());
        }
    }
    Ok(Outcome::Success)
}
