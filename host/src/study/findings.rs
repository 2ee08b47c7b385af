//! What a study ends with: tables, figures, numbers, and whether what should hold does.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::{Map, Value, json};

use super::table::{Table, yes};
use crate::error::{Error, counted};
use crate::output;
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
    /// Does it hold? None where nothing was measured that could say.
    pub holds: Option<bool>,
    /// Is it about keeping out of cores, the same bits, or arriving in what the paper shows? A study fails where one of these does not
    /// hold; another that does not is what it found.
    pub vital: bool,
}

impl Verdict {
    /// Was it measured not to hold?
    pub fn fails(&self) -> bool {
        self.holds == Some(false)
    }
}

/// What a study found.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// Tables, in order.
    pub tables: Vec<Table>,
    /// Figures by the names of their files, without endings, each with what it shows.
    pub figures: Vec<(&'static str, String, Figure)>,
    /// Scene files and models by their paths in the study's folder.
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

    /// Does nothing fail that is vital?
    pub fn is_well(&self) -> bool {
        !self.verdicts.iter().any(|v| v.fails() && v.vital)
    }

    /// How many claims fail, and whether that decides the exit code: a sentence.
    pub fn conclusion(&self) -> String {
        let claims = |of: &dyn Fn(&Verdict) -> bool| counted(self.verdicts.iter().filter(|v| of(v)).count(), "claim");
        let code = u8::from(!self.is_well());
        if !self.verdicts.iter().any(Verdict::fails) {
            let open = self.verdicts.iter().filter(|v| v.holds.is_none()).count();
            let but = if open > 0 { format!(" but {open} of which nothing was measured") } else { String::new() };
            return format!("every claim holds{but}: exit code {code}");
        }
        let vital = claims(&|v| v.fails() && v.vital);
        let other = claims(&|v| v.fails() && !v.vital);
        format!(
            "failing: {vital} about cores, bits, or arriving in what the paper shows, which alone decide the exit code ({code}); \
             {other} about anything else, without effect on it"
        )
    }

    /// The verdicts as a table.
    pub fn verdict_table(&self) -> Table {
        let mut table =
            Table::new("claims", "What should hold", &["claim", "paper", "measured", "holds", "decides the exit code"]);
        for v in &self.verdicts {
            table.push([v.claim.clone(), v.paper.clone(), v.measured.clone(), held(v.holds), decides(v.vital)]);
        }
        table
    }

    /// All numbers, and the verdicts if there are any.
    pub fn to_json(&self) -> Value {
        let verdict = |v: &Verdict| json!({"claim": v.claim, "paper": v.paper, "measured": v.measured, "holds": v.holds, "vital": v.vital});
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
            put(&folder.join(name), text)?;
        }
        put(&folder.join("report.md"), &report)
    }
}

/// yes or NO; a dash where nothing was measured.
fn held(holds: Option<bool>) -> String {
    holds.map_or_else(|| "-".into(), yes)
}

fn decides(vital: bool) -> String {
    if vital { "yes" } else { "no" }.into()
}

/// Sees that files can be written into a folder, before anything is computed for it. What it makes for that it removes again: a study that fails
/// leaves nothing behind.
///
/// # Errors
/// They cannot.
pub fn check_writable(folder: &Path) -> Result<(), Error> {
    let failed = |e: std::io::Error| Error::bad_input(format!("{}: cannot be written to: {e}", folder.display()));
    let missing: Vec<&Path> = folder.ancestors().take_while(|f| !f.as_os_str().is_empty() && !f.exists()).collect();
    let probe = folder.join(".pliant-can-write");
    let written =
        fs::create_dir_all(folder).and_then(|()| fs::write(&probe, "")).and_then(|()| fs::remove_file(&probe));
    for made in missing {
        // One that was not made, or that another program has since put something into, stays.
        let _ = fs::remove_dir(made);
    }
    written.map_err(failed)
}

fn put(path: &Path, text: &str) -> Result<(), Error> {
    let failed = |e: std::io::Error| Error::failed(format!("{}: cannot be written: {e}", path.display()));
    output::write(path, text).map_err(failed)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(verdicts: &[(Option<bool>, bool)]) -> Findings {
        let verdict = |(holds, vital): &(Option<bool>, bool)| Verdict {
            claim: "a claim".into(),
            paper: "-".into(),
            measured: "-".into(),
            holds: *holds,
            vital: *vital,
        };
        Findings { verdicts: verdicts.iter().map(verdict).collect(), ..Findings::default() }
    }

    #[test]
    fn looking_whether_a_folder_can_be_written_to_leaves_no_trace() {
        let folder = std::env::temp_dir().join(format!("pliant-writable-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        check_writable(&folder).unwrap();
        check_writable(&folder.join("new/out")).unwrap();
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 0, "what was there stays, what was not is not");
        fs::write(folder.join("file"), "").unwrap();
        assert!(check_writable(&folder.join("file/out")).is_err());
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn what_was_not_measured_neither_holds_nor_fails() {
        let open = found(&[(None, true), (Some(true), false)]);
        assert!(open.is_well());
        assert_eq!(open.verdict_table().rows[0][3], "-");
        assert_eq!(open.to_json()["verdicts"][0]["holds"], Value::Null);
        assert_eq!(open.conclusion(), "every claim holds but 1 of which nothing was measured: exit code 0");
    }

    #[test]
    fn only_what_is_vital_decides_the_exit_code() {
        let other = found(&[(Some(true), true), (Some(false), false), (Some(false), false)]);
        assert!(other.is_well());
        let says = other.conclusion();
        assert!(
            says.contains("0 claims about cores") && says.contains("(0)") && says.contains("2 claims about anything")
        );
        let vital = found(&[(Some(false), true), (Some(true), false)]);
        assert!(!vital.is_well());
        assert!(vital.conclusion().contains("1 claim about cores") && vital.conclusion().contains("(1)"));
        assert_eq!(found(&[(Some(true), true)]).conclusion(), "every claim holds: exit code 0");
    }
}
