//! `pliant move`

use std::path::PathBuf;

use serde_json::json;

use super::{Finished, Point, number, print_json};
use crate::error::{Error, Outcome};
use crate::learn::memory;
use crate::model::{Provenance, Similarity, SimilarityError, Text};
use crate::output;

/// Options of `pliant move`.
#[derive(Clone, Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct Args {
    /// Model file.
    model: PathBuf,
    /// Where to write the moved model.
    #[arg(short, long, value_name = "NEW.toml")]
    out: PathBuf,
    /// Where the motion is to end, m.
    #[arg(long, value_name = "X,Y[,Z]", allow_hyphen_values = true)]
    attractor: Option<Point>,
    /// Where the motion is to begin, m: it is scaled and turned so that the old start comes to lie there.
    #[arg(long, value_name = "X,Y[,Z]", allow_hyphen_values = true, conflicts_with_all = ["scale", "turn"])]
    start: Option<Point>,
    /// The old start, m (if not given: the mean of the demonstrations' starts, which the model remembers).
    #[arg(long, value_name = "X,Y[,Z]", allow_hyphen_values = true, requires = "start")]
    from: Option<Point>,
    /// How many times as large it is to be, 0.001 to 1000.
    #[arg(long, value_name = "FACTOR", value_parser = factor)]
    scale: Option<f64>,
    /// Turn it about the attractor, counter-clockwise, degrees.
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true, value_parser = degrees)]
    turn: Option<f64>,
    /// In space, the axis to turn about (z if not given).
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "turn")]
    axis: Option<Point>,
}

fn degrees(text: &str) -> Result<f64, String> {
    number::within(text, -1e6..=1e6, "a number of degrees, such as 90 or -45")
}

fn factor(text: &str) -> Result<f64, String> {
    number::within(text, 1e-3..=1e3, "0.001 to 1000")
}

/// An error that names the option at fault.
fn of(option: &'static str) -> impl Fn(SimilarityError) -> Error {
    move |e| Error::bad_input(format!("{option}: {e}"))
}

pub(super) fn main(args: &Args, json: bool) -> Finished {
    if args.attractor.is_none() && args.start.is_none() && args.scale.is_none() && args.turn.is_none() {
        let help = "say where to by --attractor or --start, how large by --scale, which way by --turn";
        return Err(Error::bad_input(format!("{}: nothing to change", args.model.display())).with_help(help));
    }
    output::is_model(&args.out)?;
    let text = Text::read(&args.model)?;
    let model = text.model()?;
    let mut by = Similarity::identity(model.dimension);
    if let Some(Point(attractor)) = &args.attractor {
        by = by.to(attractor).map_err(of("--attractor"))?;
    }
    if let Some(Point(start)) = &args.start {
        let from = args.from.clone().map(|p| p.0).or_else(|| memory::mean_start(&model)).ok_or_else(|| {
            let message = format!("{}: it does not say where its motions begin", args.model.display());
            Error::bad_input(message).with_help("give the old start by --from X,Y[,Z]")
        })?;
        by = by.with_start(&model, &from, start).map_err(of("--start"))?;
    }
    if let Some(factor) = args.scale {
        by = by.scaled(factor).map_err(of("--scale"))?;
    }
    if let Some(turn) = args.turn {
        by = by.turned(turn.to_radians(), args.axis.as_ref().map(|p| p.0.as_slice())).map_err(of("--turn"))?;
    }
    // A fault of the model as it is has a place in its file.
    model.is_certified().map_err(|e| text.locate(e))?;
    let mut moved = model.placed(&by)?;
    let starts: Vec<_> = memory::starts(&model).iter().map(|p| by.place(&model.attractor, p)).collect();
    let source = args.model.file_name().unwrap_or_default().to_string_lossy().into_owned();
    moved.learnt = Some(Provenance { moved: Some(source), ..Provenance::default() });
    memory::note(&mut moved, &args.out, &[], &starts);
    moved.name = args.out.file_stem().map_or(model.name, |s| s.to_string_lossy().into_owned());
    moved.write(&args.out)?;
    if json {
        print_json(&json!({
            "name": moved.name, "model": args.out, "attractor": moved.attractor, "starts": starts, "scale": by.scale(),
            "certified": true,
        }));
    } else {
        let place = moved.attractor.iter().map(|c| format!("{c:.4}")).collect::<Vec<_>>().join(", ");
        say!("{}: ends at ({place}), {:.4} times as large, certified in f32 and f64", moved.name, by.scale());
        say!("  model: {}", args.out.display());
    }
    Ok(Outcome::Success)
}
