//! What a study ends with: tables, figures, numbers, and whether what should hold does.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::{Map, Value, json};

use super::table::Table;
use crate::error::Error;
use crate::plot::Figure;

/// Something that should hold, and whether it does.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// What should hold.
    pub claim: String,
    /// What the paper says.
    pub paper: String,
    /// What was measured.
    pub measured: String,
    /// Does it hold?
    pub holds: bool,
    /// Is it about arriving, keeping out of cores, or the same bits? A study fails where one of these does not hold; another that does not is what
    /// it found.
    pub vital: bool,
}

/// What a study found.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// Tables, in order.
    pub tables: Vec<Table>,
    /// Figures by the names of their files, without endings, each with what it shows.
    pub figures: Vec<(&'static str, String, Figure)>,
    /// Scene files and models by name.
    pub files: Vec<(String, String)>,
    /// What should hold.
    pub verdicts: Vec<Verdict>,
    /// Numbers for programs.
    pub json: Map<String, Value>,
}

impl Findings {
    /// Puts the findings of another part behind these.
    pub fn append(&mut self, other: Self) {
        self.tables.extend(other.tables);
        self.figures.extend(other.figures);
        self.files.extend(other.files);
        self.verdicts.extend(other.verdicts);
        for (key, value) in other.json {
            match (self.json.get_mut(&key), value) {
                (Some(Value::Object(mine)), Value::Object(theirs)) => mine.extend(theirs),
                (_, value) => {
                    self.json.insert(key, value);
                }
            }
        }
    }

    /// Does all hold that is vital?
    pub fn is_well(&self) -> bool {
        self.verdicts.iter().all(|v| v.holds || !v.vital)
    }

    /// The verdicts as a table.
    pub fn verdict_table(&self) -> Table {
        let mut table = Table::new("claims", "What should hold", &["claim", "paper", "measured", "holds"]);
        for v in &self.verdicts {
            table.push([v.claim.clone(), v.paper.clone(), v.measured.clone(), super::table::yes(v.holds)]);
        }
        table
    }

    /// All numbers, and the verdicts if there are any.
    pub fn to_json(&self) -> Value {
        let verdict =
            |v: &Verdict| json!({"claim": v.claim, "paper": v.paper, "measured": v.measured, "holds": v.holds});
        let mut all = self.json.clone();
        if !self.verdicts.is_empty() {
            all.insert("verdicts".into(), self.verdicts.iter().map(verdict).collect());
        }
        Value::Object(all)
    }

    /// Writes `report.md`, a CSV file a table, an SVG and a PNG file a figure, and the scenes.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, folder: &Path, introduction: &str) -> Result<(), Error> {
        let mut report = format!("{introduction}\n");
        let verdicts = (!self.verdicts.is_empty()).then(|| self.verdict_table());
        for table in verdicts.iter().chain(&self.tables) {
            put(&folder.join(table.name).with_extension("csv"), &table.csv())?;
            let _ = writeln!(report, "{}", table.markdown());
        }
        for (name, caption, figure) in &self.figures {
            let file = folder.join(name);
            figure.save(&file.with_extension("svg"))?;
            figure.save(&file.with_extension("png"))?;
            let _ = writeln!(report, "![{caption}]({name}.png)\n\n{caption}\n");
        }
        for (name, text) in &self.files {
            put(&folder.join("scenes").join(name), text)?;
        }
        put(&folder.join("report.md"), &report)
    }
}

/// Makes the folder, and sees that a file can be written into it, before anything is computed for it.
///
/// # Errors
/// It cannot.
pub fn prepare(folder: &Path) -> Result<(), Error> {
    let failed = |e: std::io::Error| Error::bad_input(format!("{}: cannot be written to: {e}", folder.display()));
    fs::create_dir_all(folder).map_err(failed)?;
    let probe = folder.join(".pliant-can-write");
    fs::write(&probe, "").and_then(|()| fs::remove_file(&probe)).map_err(failed)
}

fn put(path: &Path, text: &str) -> Result<(), Error> {
    let failed = |e: std::io::Error| Error::failed(format!("{}: cannot be written: {e}", path.display()));
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(failed)?;
    }
    fs::write(path, text).map_err(failed)
}
