//! `pliant plot`

use std::path::PathBuf;

use serde_json::json;

use super::{Finished, print_json};
use crate::bridge::Device;
use crate::error::Outcome;
use crate::plot;
use crate::sim::{RunOptions, run_scene};

/// Options of `pliant plot`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// Scene file; the built-in scene if not given.
    scene: Option<PathBuf>,
    /// Where to write the figure, .svg or .png (SCENE.svg in the working folder if not given).
    #[arg(short, long, value_name = "FIG")]
    out: Option<PathBuf>,
    /// Draw the field and the obstacles only.
    #[arg(long)]
    no_trajectories: bool,
}

pub(super) fn main(args: &Args, json: bool) -> Finished {
    let scene = super::scene(args.scene.as_deref())?;
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.svg", scene.name())));
    plot::check_format(&out)?;
    let mut trajectories = Vec::new();
    if !args.no_trajectories {
        let options = RunOptions { stepped: true, ..RunOptions::default() };
        let mut session = Device::Virtual.open()?;
        trajectories = plot::trajectories(&run_scene(&mut session, &scene, &options, &mut |_, _, _| {})?);
    }
    plot::scene_figure(&scene, &trajectories, &plot::Options::default())?.save(&out)?;
    if json {
        print_json(&json!({ "scene": scene.name(), "figure": out, "trajectories": trajectories.len() }));
    } else {
        say!("{}", out.display());
    }
    Ok(Outcome::Success)
}
