//! Demonstrations in the layout of the LASA handwriting set: a cell `demos` of structs with `pos`, `t` and `vel`.

use super::mat::{self, Mat};
use crate::learn::demonstration::Demonstration;
use crate::learn::error::LearnError;
use nalgebra::DVector;
use std::collections::BTreeMap;

const DEMOS: &str =
    "a cell array (or struct array) of demonstrations, each with pos (2 or 3 rows), t and, if known, vel";
const POS: &str = "a real array of 2 or 3 rows, one column a sample";
const T: &str = "a real vector of times in seconds, one a column of pos";

/// Reads the demonstrations of one MATLAB file, in the unit of the file.
pub fn read(name: &str, bytes: &[u8]) -> Result<Vec<Demonstration>, LearnError> {
    let mut variables = mat::read(bytes).map_err(|reason| LearnError::NotMat { file: name.to_owned(), reason })?;
    let fail =
        |field: String, problem: String, allowed| LearnError::Field { file: name.to_owned(), field, problem, allowed };
    let demos = match variables.remove("demos") {
        Some(Mat::Cell(cells)) => cells
            .into_iter()
            .enumerate()
            .map(|(i, cell)| match cell {
                Mat::Struct(mut one) if one.len() == 1 => Ok(one.remove(0)),
                _ => Err(fail(format!("demos{{{}}}", i + 1), "is not a struct".into(), DEMOS)),
            })
            .collect::<Result<Vec<_>, _>>()?,
        Some(Mat::Struct(all)) => all,
        Some(_) => return Err(fail("demos".into(), "is neither a cell nor a struct".into(), DEMOS)),
        None => {
            let found: Vec<_> = variables.keys().map(String::as_str).collect();
            let found = if found.is_empty() { "nothing".into() } else { found.join(", ") };
            let found: String = found.chars().take(80).collect();
            return Err(fail("demos".into(), format!("is missing (the file holds {found})"), DEMOS));
        }
    };
    if demos.is_empty() {
        return Err(fail("demos".into(), "is empty".into(), DEMOS));
    }
    demos
        .iter()
        .enumerate()
        .map(|(i, fields)| {
            let number = i + 1;
            let field = |key: &str| format!("demos{{{number}}}.{key}");
            let array =
                |key: &str, allowed| array(fields, key).map_err(|problem| fail(field(key), problem.into(), allowed));
            let (size, pos) = array("pos", POS)?;
            let &[d, n] = size else {
                return Err(fail(field("pos"), "has more than two dimensions".into(), POS));
            };
            if n > 0 && !(2..=3).contains(&d) {
                return Err(fail(field("pos"), format!("has {d} rows"), POS));
            }
            let (_, t) = array("t", T)?;
            if t.len() != n {
                return Err(fail(field("t"), format!("has {} elements for {n} columns of pos", t.len()), T));
            }
            let v = if fields.contains_key("vel") {
                let (size, vel) = array("vel", "an array of the size of pos")?;
                if *size != [d, n] {
                    return Err(fail(field("vel"), "has another size than pos".into(), "the size of pos"));
                }
                Some(columns(vel, d))
            } else {
                None
            };
            Demonstration::new(format!("{name}, demonstration {number}"), t.to_vec(), columns(pos, d), v)
        })
        .collect()
}

fn array<'a>(fields: &'a BTreeMap<String, Mat>, key: &str) -> Result<(&'a [usize], &'a [f64]), &'static str> {
    match fields.get(key) {
        Some(Mat::Numeric { size, data }) => Ok((size, data)),
        Some(_) => Err("is not a real array"),
        None => Err("is missing"),
    }
}

fn columns(data: &[f64], rows: usize) -> Vec<DVector<f64>> {
    if rows == 0 {
        return Vec::new();
    }
    data.chunks_exact(rows).map(DVector::from_column_slice).collect()
}

#[cfg(test)]
mod tests {
    use super::super::mat_writer as writer;
    use super::*;

    fn refused(variables: &[Vec<u8>]) -> String {
        read("a.mat", &writer::file(variables, true)).expect_err("must be refused").to_string()
    }

    #[test]
    fn reads_demonstrations_with_and_without_velocity() {
        for with_velocity in [true, false] {
            let all = read("a.mat", &writer::file(&writer::demos(&[2, 2], 11, with_velocity), true)).expect("valid");
            assert_eq!(all.len(), 2);
            assert_eq!(all[1].x[0].as_slice(), [11.0, 11.0]);
            assert!((all[1].v[5][0] + 1.1).abs() < 1e-9);
        }
    }

    #[test]
    fn what_is_missing_is_named() {
        let text = refused(&[writer::numeric("data", &[1, 1], &[1.0])]);
        assert!(text.contains("`demos` is missing (the file holds data)"), "{text}");
        let one = |fields: &[(&str, Vec<u8>)]| {
            refused(&[writer::matrix("demos", 1, &[1, 1], &writer::structure("", fields))])
        };
        let pos = || ("pos", writer::numeric("", &[2, 2], &[1.0, 1.0, 0.0, 0.0]));
        assert!(one(&[("x", pos().1)]).contains("`demos{1}.pos` is missing"));
        assert!(one(&[pos()]).contains("`demos{1}.t` is missing"));
        assert!(one(&[pos(), ("t", writer::numeric("", &[1, 1], &[1.0]))]).contains("has 1 elements for 2 columns"));
        let tall = ("pos", writer::numeric("", &[5, 1], &[1.0; 5]));
        assert!(one(&[tall]).contains("has 5 rows"));
        let empty = one(&[("pos", writer::numeric("", &[2, 0], &[])), ("t", writer::numeric("", &[1, 0], &[]))]);
        assert!(empty.contains("demonstration 1: it is empty"), "{empty}");
    }

    #[test]
    fn bytes_of_another_kind_are_named() {
        let text = read("a.mat", b"t,x,y\n0,1,2\n").expect_err("no .mat").to_string();
        assert_eq!(text, "a.mat: not a readable MATLAB file: it has no MATLAB v5 header");
    }
}
