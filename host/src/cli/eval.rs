//! `pliant eval`

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use serde_json::json;

use super::{Finished, print, print_json};
use crate::bridge::Device;
use crate::error::{Error, Outcome};
use crate::eval::{Evaluation, Points, Stage, evaluate, evaluate_on};
use crate::output;

/// Options of `pliant eval`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// Scene file.
    scene: PathBuf,
    /// CSV file with header x,y[,z]: points, m.
    #[arg(long, value_name = "P.csv")]
    points: PathBuf,
    /// Where to write x,y[,z],vx,vy[,vz],gamma,region,status (standard output if not given).
    #[arg(short, long, value_name = "V.csv")]
    out: Option<PathBuf>,
    /// Evaluate on a device, in f32; without it here, in f64.
    #[arg(long)]
    device: Option<Device>,
    /// Which stage of the tick.
    #[arg(long, value_enum, default_value = "final")]
    stage: StageName,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum StageName {
    /// The learnt motion alone.
    Nominal,
    /// Round the hard cores.
    Modulated,
    /// Faster or slower in soft layers.
    Adapted,
    /// Within the speed limit and guarded: what the robot would get, from a steady state.
    Final,
}

impl StageName {
    fn stage(self) -> Stage {
        match self {
            Self::Nominal => Stage::Nominal,
            Self::Modulated => Stage::Modulated,
            Self::Adapted => Stage::Adapted,
            Self::Final => Stage::Final,
        }
    }
}

pub(super) fn main(args: &Args, json: bool) -> Finished {
    let scene = super::scene(Some(&args.scene))?;
    if let Some(out) = &args.out {
        output::spare(out, [args.scene.as_path(), args.points.as_path()])?;
    }
    let points = Points::read(&args.points, scene.dimension())?;
    let rows = match &args.device {
        None => evaluate(&scene, &points, args.stage.stage())?,
        Some(_) if !matches!(args.stage, StageName::Final) => {
            return Err(Error::bad_input(
                "--stage: a device gives only its final velocity; leave out --device for the other stages",
            ));
        }
        Some(device) => evaluate_on(&mut device.open()?, &scene, &points)?,
    };
    if let Some(out) = &args.out {
        write(out, &to_csv(&rows, scene.dimension()))?;
    }
    if json {
        let rows: Vec<_> = rows.iter().map(|r| row_json(r, scene.dimension())).collect();
        print_json(&json!({ "scene": scene.name(), "points": rows.len(), "out": args.out, "rows": rows }));
    } else if args.out.is_none() {
        print(&to_csv(&rows, scene.dimension()));
    }
    Ok(Outcome::Success)
}

fn write(path: &Path, text: &str) -> Result<(), Error> {
    output::write(path, text).map_err(|e| Error::bad_input(format!("{}: cannot be written: {e}", path.display())))
}

fn row_json(row: &Evaluation, dimension: usize) -> serde_json::Value {
    json!({
        "position": row.position.as_slice()[..dimension],
        "velocity": row.velocity.as_slice()[..dimension],
        "gamma": row.gamma,
        "region": row.region,
        "status": row.status,
    })
}

/// Every number in full, so that reading it back gives the same bits.
fn to_csv(rows: &[Evaluation], dimension: usize) -> String {
    let axes = &["x", "y", "z"][..dimension];
    let mut text = format!(
        "{},{},gamma,region,status\n",
        axes.join(","),
        axes.iter().map(|a| format!("v{a}")).collect::<Vec<_>>().join(",")
    );
    for row in rows {
        for x in row.position.iter().take(dimension).chain(row.velocity.iter().take(dimension)) {
            text += &format!("{x},");
        }
        let gamma = row.gamma.map_or("inf".into(), |g| g.to_string());
        text += &format!("{gamma},{},{}\n", row.region, row.status);
    }
    text
}
