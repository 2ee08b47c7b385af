//! `pliant import`

use std::path::PathBuf;

use serde_json::json;

use super::{Finished, print_json, warn};
use crate::error::{Outcome, counted};
use crate::import::{Layout, Means, Order, Proof, import};
use crate::learn::{Unit, memory};
use crate::model::Provenance;
use crate::output;

/// Options of `pliant import`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// Model of another tool: .yml or .yaml (ds-opt), .json (lpvds).
    file: PathBuf,
    /// Where to write the model (NAME.toml in the working folder, by the file's name, if not given).
    #[arg(short, long, value_name = "MODEL.toml")]
    out: Option<PathBuf>,
    /// Unit of lengths in the file: mm, cm or m.
    #[arg(long, default_value = "m")]
    unit: Unit,
    /// How matrices lie in a flat list: rows (.json if not given) or columns (.yml if not given).
    #[arg(long)]
    order: Option<Order>,
    /// How means lie in a flat list: components (if not given) or axes (older versions of lpvds).
    #[arg(long)]
    means: Option<Means>,
}

pub(super) fn main(args: &Args, json: bool) -> Finished {
    let stem = args.file.file_stem().map_or("imported".into(), |s| s.to_string_lossy().to_lowercase());
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}.toml")));
    let mut found = import(&args.file, Layout { unit: Some(args.unit), order: args.order, means: args.means })?;
    output::spare(&out, [args.file.as_path()])?;
    output::is_model(&out)?;
    let source = args.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    found.model.learnt = Some(Provenance { imported: Some(source), ..Provenance::default() });
    memory::note(&mut found.model, &out, &[], &found.starts);
    let warnings = match found.proof {
        Proof::Replaced => vec![format!("{}: its `P` proves nothing; another P was found", args.file.display())],
        Proof::Given | Proof::Found => vec![],
    };
    warn(&warnings);
    found.model.write(&out)?;
    let k = found.model.component.len();
    if json {
        let proof = match found.proof {
            Proof::Given => "given",
            Proof::Found => "found",
            Proof::Replaced => "replaced",
        };
        print_json(&json!({
            "name": found.model.name, "model": out, "dimension": found.model.dimension, "k": k, "lyapunov": proof,
            "starts": found.starts.len(), "certified": true, "warnings": warnings,
        }));
    } else {
        let proof = match found.proof {
            Proof::Given => "with the P in the file",
            Proof::Found => "with a P that was found for it",
            Proof::Replaced => "with another P than the one in the file",
        };
        say!("{}: imported, {}, certified in f32 and f64 {proof}", found.model.name, counted(k, "component"));
        say!("  model: {}", out.display());
    }
    Ok(Outcome::Success)
}
