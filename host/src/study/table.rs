//! Tables, as CSV for programs and as Markdown for people.

/// A table with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The name of its file, without its ending.
    pub name: &'static str,
    /// What it shows, with its units.
    pub title: String,
    /// The names of its columns.
    pub header: Vec<String>,
    /// Its rows, each as long as the header.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// One without rows.
    pub fn new(name: &'static str, title: impl Into<String>, header: &[&str]) -> Self {
        let header = header.iter().map(|h| (*h).to_owned()).collect();
        Self { name, title: title.into(), header, rows: Vec::new() }
    }

    /// One more row.
    pub fn push(&mut self, row: impl IntoIterator<Item = String>) {
        self.rows.push(row.into_iter().collect());
    }

    /// Comma-separated, with quotes where needed.
    pub fn csv(&self) -> String {
        let field = |f: &String| {
            if f.contains([',', '"', '\n']) { format!("\"{}\"", f.replace('"', "\"\"")) } else { f.clone() }
        };
        let lines = std::iter::once(&self.header).chain(&self.rows);
        lines.map(|row| row.iter().map(field).collect::<Vec<_>>().join(",") + "\n").collect()
    }

    /// A heading and the table.
    pub fn markdown(&self) -> String {
        let line = |row: &Vec<String>| format!("| {} |\n", row.join(" | "));
        let rule = format!("|{}\n", "---|".repeat(self.header.len()));
        let rows: String = self.rows.iter().map(line).collect();
        format!("{}\n\n{}{rule}{rows}", self.title, line(&self.header))
    }
}

/// A number with so many decimals; a dash for none.
pub fn number(x: impl Into<Option<f64>>, decimals: usize) -> String {
    match x.into() {
        Some(x) if x.is_finite() => format!("{x:.decimals$}"),
        _ => "-".into(),
    }
}

/// The same with its sign.
pub fn signed(x: impl Into<Option<f64>>, decimals: usize) -> String {
    match x.into() {
        Some(x) if x.is_finite() => format!("{x:+.decimals$}"),
        _ => "-".into(),
    }
}

/// yes or NO
pub fn yes(x: bool) -> String {
    if x { "yes".into() } else { "NO".into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_hold_every_field() {
        let mut table = Table::new("t", "A title (m)", &["case", "x"]);
        table.push(["a, b".into(), number(1.25, 1)]);
        table.push(["\"q\"".into(), signed(None, 1)]);
        assert_eq!(table.csv(), "case,x\n\"a, b\",1.2\n\"\"\"q\"\"\",-\n");
        assert_eq!(table.markdown(), "A title (m)\n\n| case | x |\n|---|---|\n| a, b | 1.2 |\n| \"q\" | - |\n");
    }
}
