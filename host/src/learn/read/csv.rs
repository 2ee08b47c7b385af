//! Demonstrations from CSV: a header `t,x,y` or `t,x,y,z`, with optional columns `vx,vy[,vz]` and `demo`.
//!
//! With a `demo` column, a new demonstration starts where its value changes. Without one, it starts where time returns
//! to the file's first time or before it. Any other step back in time is an error.

use super::split::Splitter;
use crate::error::counted;
use crate::learn::demonstration::Demonstration;
use crate::learn::error::LearnError;
use nalgebra::DVector;

const HEADER: &str =
    "a header t,x,y or t,x,y,z, separated by commas, in any order, with vx,vy[,vz] and demo if there are any";

/// Reads the demonstrations of one file. `name` is used in messages and in [`Demonstration::name`].
pub fn read(name: &str, bytes: &[u8]) -> Result<Vec<Demonstration>, LearnError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).flexible(true).from_reader(bytes);
    let fail = |line: u64, problem: String, allowed| LearnError::Line { file: name.to_owned(), line, problem, allowed };
    let broken = |e: csv::Error| {
        let line = e.position().map_or(1, csv::Position::line);
        fail(line, "the line is not UTF-8 text".into(), "comma-separated numbers")
    };

    let header = reader.headers().map_err(broken)?.clone();
    if header.iter().all(str::is_empty) {
        return Err(fail(1, "the file is empty".into(), HEADER));
    }
    let columns =
        Columns::find(&header).ok_or_else(|| fail(1, format!("the header is `{}`", join(&header)), HEADER))?;

    let mut splitter = Splitter::default();
    for record in reader.records() {
        let record = record.map_err(broken)?;
        let line = record.position().map_or(0, csv::Position::line);
        if record.len() != header.len() {
            let problem = format!("it has {} and the header {}", counted(record.len(), "field"), header.len());
            return Err(fail(line, problem, "one field a column"));
        }
        let number = |i: usize| -> Result<f64, LearnError> {
            let text = &record[i];
            let column = &header[i];
            let value: f64 = text
                .parse()
                .map_err(|_| fail(line, format!("column {column}: `{text}` is not a number"), "a decimal number"))?;
            if !value.is_finite() {
                return Err(fail(line, format!("column {column} is {text}"), "a finite number"));
            }
            Ok(value)
        };
        let vector = |columns: &[usize]| -> Result<DVector<f64>, LearnError> {
            let mut v = DVector::zeros(columns.len());
            for (c, &i) in v.iter_mut().zip(columns) {
                *c = number(i)?;
            }
            Ok(v)
        };
        let (t, x) = (number(columns.t)?, vector(&columns.axes)?);
        let v = columns.velocity.as_deref().map(vector).transpose()?;
        splitter
            .push(t, x, v, columns.demo.map(|i| &record[i]))
            .map_err(|fault| fail(line, fault.problem(), fault.allowed()))?;
    }

    let all = splitter.finish();
    let count = all.len();
    all.into_iter()
        .enumerate()
        .map(|(i, rows)| {
            let title = if count == 1 { name.to_owned() } else { format!("{name}, demonstration {}", i + 1) };
            Demonstration::new(title, rows.t, rows.x, rows.v)
        })
        .collect()
}

/// Where each quantity is.
struct Columns {
    t: usize,
    axes: Vec<usize>,
    velocity: Option<Vec<usize>>,
    demo: Option<usize>,
}

impl Columns {
    fn find(header: &csv::StringRecord) -> Option<Self> {
        let at = |name: &str| header.iter().position(|h| h == name);
        let mut axes = vec![at("x")?, at("y")?];
        axes.extend(at("z"));
        let velocities: Vec<_> = ["vx", "vy", "vz"].into_iter().filter_map(at).collect();
        let (t, demo) = (at("t")?, at("demo"));
        // Nothing else: an unknown column is more likely a misspelt one than one to ignore.
        let known = 1 + axes.len() + velocities.len() + usize::from(demo.is_some());
        let complete = velocities.is_empty() || velocities.len() == axes.len();
        let velocity = (!velocities.is_empty()).then_some(velocities);
        (header.len() == known && complete).then_some(Self { t, axes, velocity, demo })
    }
}

fn join(header: &csv::StringRecord) -> String {
    let text = header.iter().collect::<Vec<_>>().join(",");
    text.chars().take(60).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn refused(text: &str) -> String {
        read("a.csv", text.as_bytes()).expect_err("must be refused").to_string()
    }

    #[test]
    fn one_file_one_demonstration() {
        let all = read("a.csv", b"t,x,y\r\n0,1,2\r\n0.1, 1.5,3\n\n0.2,2,4\n").expect("valid");
        assert_eq!(all.len(), 1);
        assert_eq!(all[0].t, [0.0, 0.1, 0.2]);
        assert_eq!(all[0].x[1].as_slice(), [1.5, 3.0]);
        assert!((all[0].v[1][0] - 5.0).abs() < 1e-9);
    }

    #[test]
    fn three_dimensions_in_any_order_with_a_byte_order_mark() {
        let all = read("a.csv", "\u{feff}z,y,x,t\n3,2,1,0\n4,2,1,1\n".as_bytes()).expect("valid");
        assert_eq!(all[0].x[0].as_slice(), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn velocities_are_taken_where_they_are_given() {
        let all = read("a.csv", b"t,x,y,vy,vx\n0,1,2,7,8\n1,3,4,5,6\n").expect("valid");
        assert_eq!(all[0].v[0].as_slice(), [8.0, 7.0]);
        assert!(refused("t,x,y,vx\n0,1,2,3\n").contains("line 1: the header"));
        assert!(refused("t,x,y,vx,vy\n0,1,2,3,inf\n").contains("line 2: column vy is inf"));
    }

    #[test]
    fn time_that_returns_to_the_start_begins_a_demonstration() {
        let all = read("a.csv", b"t,x,y\n0,1,0\n1,0,0\n0,2,0\n1,0,0\n").expect("valid");
        assert_eq!(all.len(), 2);
        assert_eq!(all[1].name, "a.csv, demonstration 2");
        assert!(refused("t,x,y\n0,1,0\n1,0,0\n0.5,2,0\n").contains("line 4: time goes back from 1 to 0.5"));
    }

    #[test]
    fn demo_column_separates() {
        let all = read("a.csv", b"demo,t,x,y\na,0,1,0\na,1,0,0\nb,5,2,0\nb,6,0,0\n").expect("valid");
        assert_eq!(all.len(), 2);
        assert!(refused("demo,t,x,y\na,1,1,0\na,0,0,0\n").contains("line 3: time goes back"));
    }

    #[test]
    fn each_mistake_has_its_sentence() {
        assert!(refused("a,b\n1,2\n").starts_with("a.csv, line 1: the header is `a,b`"));
        assert!(refused("t,x,y,speed\n1,2,3,4\n").contains("line 1: the header"));
        assert!(refused("").contains("line 1: the file is empty; allowed is a header t,x,y or"));
        assert!(refused("\n\n").contains("line 1: the file is empty"));
        assert!(refused("t,x,y\n").contains("a.csv: it is empty"));
        assert!(refused("t,x,y\n0,1,2\n").contains("one sample"));
        assert!(refused("t,x,y\n2,1,2\n1,2,2\n0,3,2\n").contains("line 3: time goes back from 2 to 1"));
        assert!(refused("t,x,y\n0,1,2\n1,one,2\n").contains("line 3: column x: `one` is not a number"));
        assert!(refused("t,x,y\n0,1,2\n1,NaN,2\n").contains("line 3: column x is NaN"));
        assert!(refused("t,x,y\n0,1,2\n1,2\n").contains("line 3: it has 2 fields and the header 3"));
        assert!(refused("t,x,y\n0,1,2\n0,2,2\n").contains("line 3: a second position at time 0"));
    }

    proptest! {
        #[test]
        fn never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
            let _ = read("a.csv", &bytes);
            let mut with_header = b"t,x,y\n0,0,0\n".to_vec();
            with_header.extend(&bytes);
            let _ = read("a.csv", &with_header);
        }

        #[test]
        fn never_panics_on_nearly_right_text(text in "([0-9.eE+-]{0,6}[,\n]?){0,40}") {
            let _ = read("a.csv", format!("t,x,y\n{text}").as_bytes());
        }
    }
}
