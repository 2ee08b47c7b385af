//! Demonstrations from NumPy archives (`numpy.savez`, `savez_compressed`).
//!
//! One array of positions, times for it and perhaps velocities; or numbered ones, a demonstration each (`x_0, t_0, x_1, t_1`);
//! or positions with one more dimension, a demonstration each along the first, where rows of NaN at the end fill up.

use super::npy::{self, Array};
use super::split::Splitter;
use super::zip;
use crate::learn::cleaning::Samples;
use crate::learn::demonstration::Demonstration;
use crate::learn::error::LearnError;
use crate::learn::warning::Warning;
use nalgebra::DVector;
use std::collections::BTreeMap;

const POSITIONS: [&str; 4] = ["x", "pos", "position", "positions"];
const TIMES: [&str; 3] = ["t", "time", "times"];
const VELOCITIES: [&str; 5] = ["v", "vel", "velocity", "velocities", "x_dot"];
const STEP: &str = "dt";
const LABEL: &str = "demo";

const WANTED: &str = "x (samples x 2 or 3), with t (samples) or dt, and v like x if known; or x_0, t_0, x_1, t_1, ...";

/// A quantity that an array holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Quantity {
    Positions,
    Times,
    Velocities,
    Step,
    Label,
}

/// Arrays of one number (`x_7`), or of none, with their names.
type Group = BTreeMap<Quantity, (String, Array)>;

/// Reads the demonstrations of one archive, in the unit of the file.
pub fn read(name: &str, bytes: &[u8]) -> Result<Vec<Demonstration>, LearnError> {
    let fail = |field: &str, problem: String, allowed| LearnError::Field {
        file: name.to_owned(),
        field: field.to_owned(),
        problem,
        allowed,
    };
    let members = zip::read(bytes).map_err(|reason| LearnError::NotNpz { file: name.to_owned(), reason })?;
    let mut groups: BTreeMap<Option<u32>, Group> = BTreeMap::new();
    let mut ignored = Vec::new();
    for (member, bytes) in &members {
        let key = member.strip_suffix(".npy").unwrap_or(member);
        let Some((quantity, number)) = meaning(key) else {
            ignored.push(key);
            continue;
        };
        let array = npy::read(bytes).map_err(|e| fail(key, e.to_string(), "an array of real numbers"))?;
        if let Some(other) = groups.entry(number).or_default().insert(quantity, (key.to_owned(), array)) {
            return Err(fail(key, format!("and `{}` are the same quantity", other.0), "one of them"));
        }
    }
    // What all share may be given once: times, and the step between them.
    let shared: Group = groups.remove(&None).unwrap_or_default();
    let numbered = groups.values().any(|g| g.contains_key(&Quantity::Positions));
    let found = || {
        let names: Vec<_> = members.keys().map(|m| m.strip_suffix(".npy").unwrap_or(m)).collect();
        let names: String = if names.is_empty() { "nothing".into() } else { names.join(", ") };
        names.chars().take(80).collect::<String>()
    };
    let mut all = Vec::new();
    if shared.contains_key(&Quantity::Positions) {
        if numbered {
            return Err(fail("x", "is there with and without a number".into(), WANTED));
        }
        all = group(&shared, &fail)?;
    } else if numbered {
        for mine in groups.into_values() {
            let mut whole: Group =
                shared.iter().filter(|(q, _)| **q != Quantity::Label).map(|(q, a)| (*q, a.clone())).collect();
            if mine.contains_key(&Quantity::Times) {
                whole.remove(&Quantity::Step);
            }
            whole.extend(mine);
            all.extend(group(&whole, &fail)?);
        }
    }
    if all.is_empty() {
        return Err(fail("x", format!("is missing (the file holds {})", found()), WANTED));
    }
    let count = all.len();
    let mut out = Vec::with_capacity(count);
    for (i, Samples { t, x, v }) in all.into_iter().enumerate() {
        let title = if count == 1 { name.to_owned() } else { format!("{name}, demonstration {}", i + 1) };
        out.push(Demonstration::new(title, t, x, v)?);
    }
    if let (Some(first), false) = (out.first_mut(), ignored.is_empty()) {
        let names = ignored.join(", ").chars().take(80).collect();
        first.warnings.push(Warning::Ignored { file: name.to_owned(), names });
    }
    Ok(out)
}

/// What an array of this name holds, and the number behind its name.
fn meaning(key: &str) -> Option<(Quantity, Option<u32>)> {
    let stem = key.trim_end_matches(|c: char| c.is_ascii_digit());
    let number = &key[stem.len()..];
    let stem = if number.is_empty() { key } else { stem.strip_suffix('_').unwrap_or(stem) };
    let number = if number.is_empty() { None } else { Some(number.parse().ok()?) };
    let quantity = match stem {
        s if POSITIONS.contains(&s) => Quantity::Positions,
        s if TIMES.contains(&s) => Quantity::Times,
        s if VELOCITIES.contains(&s) => Quantity::Velocities,
        STEP => Quantity::Step,
        LABEL => Quantity::Label,
        _ => return None,
    };
    Some((quantity, number))
}

type Fail<'a> = dyn Fn(&str, String, &'static str) -> LearnError + 'a;

/// The recordings in the arrays of one number.
fn group(group: &Group, fail: &Fail) -> Result<Vec<Samples>, LearnError> {
    let get = |q| group.get(&q).map(|(name, array)| (name.as_str(), array));
    let Some((key, positions)) = get(Quantity::Positions) else {
        let name = group.values().next().map_or("x", |(name, _)| name);
        return Err(fail(name, "has no positions beside it".into(), WANTED));
    };
    let all = trajectories(positions).map_err(|problem| fail(key, problem, WANTED))?;
    let count = all.len();
    let velocities = match get(Quantity::Velocities) {
        None => None,
        Some((key, array)) if array.shape == positions.shape => {
            Some(trajectories(array).map_err(|problem| fail(key, problem, "the shape of the positions"))?)
        }
        Some((key, array)) => {
            let problem = format!("has the shape {:?} and the positions {:?}", array.shape, positions.shape);
            return Err(fail(key, problem, "the shape of the positions"));
        }
    };
    let mut splitters = Vec::new();
    for (i, x) in all.iter().enumerate() {
        // Rows of NaN at the end are no samples: demonstrations of one array differ in length.
        let n = if count == 1 { x.len() } else { filled(x) };
        let t = times(group, i, count, x.len(), fail)?;
        let labels = match get(Quantity::Label) {
            Some((key, array)) if array.data.len() != x.len() || count != 1 => {
                return Err(fail(key, format!("has the shape {:?}", array.shape), "one number a sample of x"));
            }
            other => other.map(|(_, array)| array.data.as_slice()),
        };
        let mut splitter = Splitter::default();
        for j in 0..n {
            let v = velocities.as_ref().map(|v| v[i][j].clone());
            if let Some(bad) = [(key, Some(&x[j])), ("v", v.as_ref())].iter().find_map(|(key, p)| {
                let p = (*p)?;
                p.iter().find(|c| !c.is_finite()).map(|c| (*key, *c))
            }) {
                return Err(fail(bad.0, format!("holds {} at sample {}", bad.1, j + 1), "finite numbers"));
            }
            if !t[j].is_finite() {
                return Err(fail("t", format!("holds {} at sample {}", t[j], j + 1), "finite numbers"));
            }
            let label = labels.map(|l| l[j].to_string());
            splitter
                .push(t[j], x[j].clone(), v, label.as_deref())
                .map_err(|fault| fail("t", format!("{} at sample {}", fault.problem(), j + 1), fault.allowed()))?;
        }
        splitters.extend(splitter.finish());
    }
    Ok(splitters)
}

/// Number of samples before the rows of NaN at the end.
fn filled(x: &[DVector<f64>]) -> usize {
    x.iter().rposition(|p| !p.iter().all(|c| c.is_nan())).map_or(0, |last| last + 1)
}

/// The times of demonstration `i` of `count`, of `n` samples.
fn times(group: &Group, i: usize, count: usize, n: usize, fail: &Fail) -> Result<Vec<f64>, LearnError> {
    const T: &str = "one time in seconds a sample, for all demonstrations or for each";
    if let Some((key, array)) = group.get(&Quantity::Times) {
        let each = match array.shape.as_slice() {
            [m] | [1, m] | [m, 1] if *m == n => &array.data[..],
            [k, m] | [k, m, 1] if *k == count && *m == n => &array.data[i * n..(i + 1) * n],
            other => return Err(fail(key, format!("has the shape {other:?} for {n} samples"), T)),
        };
        return Ok(each.to_vec());
    }
    match group.get(&Quantity::Step) {
        Some((_, array)) if array.data.len() == 1 && array.data[0] > 0.0 && array.data[0].is_finite() => {
            Ok((0..n).map(|j| j as f64 * array.data[0]).collect())
        }
        Some((key, _)) => Err(fail(key, "is not one positive number".into(), "the time between samples in seconds")),
        None => Err(fail("t", "is missing, and so is `dt`".into(), WANTED)),
    }
}

/// Points of each demonstration. The axis of length 2 or 3 is that of space; the last one where both could be.
fn trajectories(array: &Array) -> Result<Vec<Vec<DVector<f64>>>, String> {
    let bad = || format!("has the shape {:?}", array.shape);
    let spatial = |n: usize| (2..=3).contains(&n);
    let (count, n, d, by_rows) = match *array.shape.as_slice() {
        [n, d] if spatial(d) => (1, n, d, true),
        [d, n] if spatial(d) => (1, n, d, false),
        [m, n, d] if spatial(d) => (m, n, d, true),
        [m, d, n] if spatial(d) => (m, n, d, false),
        _ => return Err(bad()),
    };
    if count == 0 || n == 0 {
        return Err(bad());
    }
    let at = |i: usize, j: usize, c: usize| if by_rows { (i * n + j) * d + c } else { (i * d + c) * n + j };
    Ok((0..count).map(|i| (0..n).map(|j| DVector::from_fn(d, |c, _| array.data[at(i, j, c)])).collect()).collect())
}

#[cfg(test)]
mod tests {
    use super::super::npz_writer as writer;
    use super::*;
    use proptest::prelude::*;

    const T: [f64; 3] = [0.0, 0.5, 1.0];
    const X: [f64; 6] = [2.0, 1.0, 1.5, 0.5, 0.0, 0.0];

    type Arrays<'a> = [(&'a str, &'a [usize], &'a [f64])];

    fn read_arrays(arrays: &Arrays) -> Result<Vec<Demonstration>, LearnError> {
        read("a.npz", &writer::file(arrays, true))
    }

    fn refused(arrays: &Arrays) -> String {
        read_arrays(arrays).expect_err("must be refused").to_string()
    }

    #[test]
    fn every_layout_of_one_motion_is_the_same_demonstration() {
        let one = read_arrays(&[("x", &[3, 2], &X), ("t", &[3], &T)]).expect("valid");
        assert_eq!(one.len(), 1);
        assert_eq!(one[0].x[1].as_slice(), [1.5, 0.5]);
        let layouts: [&Arrays; 5] = [
            &[("positions", &[3, 2], &X), ("times", &[3, 1], &T)],
            &[("pos", &[3, 2], &X), ("time", &[1, 3], &T)],
            &[("x", &[1, 3, 2], &X), ("t", &[1, 3], &T)],
            &[("x_0", &[3, 2], &X), ("t_0", &[3], &T)],
            &[("x7", &[3, 2], &X), ("dt", &[], &[0.5])],
        ];
        for layout in layouts {
            assert_eq!(read_arrays(layout).expect("valid"), one);
        }
    }

    #[test]
    fn axes_may_come_first() {
        let rows = [3.0, 4.0, 2.0, 3.0, 1.0, 1.0, 0.0, 0.0];
        let columns = [3.0, 2.0, 1.0, 0.0, 4.0, 3.0, 1.0, 0.0];
        let dt: (&str, &[usize], &[f64]) = ("dt", &[1], &[0.1]);
        let by_rows = read_arrays(&[("x", &[4, 2], &rows), dt]).expect("valid");
        assert_eq!(read_arrays(&[("x", &[2, 4], &columns), dt]).expect("valid"), by_rows);
        assert_eq!(read_arrays(&[("x", &[1, 2, 4], &columns), dt]).expect("valid"), by_rows);
    }

    #[test]
    fn several_demonstrations_differ_in_length() {
        let nan = f64::NAN;
        let both: Vec<f64> = X.iter().copied().chain([1.0, 1.0, 0.0, 0.0, nan, nan]).collect();
        let all = read_arrays(&[("x", &[2, 3, 2], &both), ("t", &[3], &T)]).expect("valid");
        assert_eq!(all.iter().map(|d| d.t.len()).collect::<Vec<_>>(), [3, 2]);
        assert_eq!(all[1].name, "a.npz, demonstration 2");
        let parts: [(&str, &[usize], &[f64]); 4] =
            [("x_1", &[3, 2], &X), ("t_1", &[3], &T), ("x_2", &[2, 2], &both[6..10]), ("t_2", &[2], &T[..2])];
        assert_eq!(read_arrays(&parts).expect("valid"), all);
        let stacked: [f64; 10] = std::array::from_fn(|i| both[i]);
        let labelled = read_arrays(&[
            ("x", &[5, 2], &stacked),
            ("t", &[5], &[0.0, 0.5, 1.0, 0.0, 0.5]),
            ("demo", &[5], &[1.0, 1.0, 1.0, 2.0, 2.0]),
        ]);
        assert_eq!(labelled.expect("valid"), all);
    }

    #[test]
    fn velocities_are_taken_and_others_are_named() {
        let v = [-1.0; 6];
        let all = read_arrays(&[("x", &[3, 2], &X), ("t", &[3], &T), ("x_dot", &[3, 2], &v), ("force", &[1], &[0.0])]);
        let all = all.expect("valid");
        assert_eq!(all[0].v[2].as_slice(), [-1.0, -1.0]);
        assert!(
            all[0].warnings.iter().any(|w| w.to_string().contains("a.npz: force not used")),
            "{:?}",
            all[0].warnings
        );
    }

    #[test]
    fn what_is_wrong_is_named() {
        assert!(refused(&[("a", &[1], &[1.0])]).contains("`x` is missing (the file holds a)"));
        assert!(refused(&[("x", &[3, 2], &X)]).contains("`t` is missing, and so is `dt`"));
        assert!(refused(&[("x", &[6], &X), ("dt", &[], &[1.0])]).contains("`x` has the shape [6]"));
        assert!(refused(&[("x", &[3, 2], &X), ("t", &[2], &T[..2])]).contains("`t` has the shape [2] for 3 samples"));
        assert!(
            refused(&[("x", &[3, 2], &X), ("t", &[3], &[0.0, 1.0, 0.5])])
                .contains("goes back from 1 to 0.5 at sample 3")
        );
        assert!(
            refused(&[("x", &[3, 2], &X), ("t", &[3], &[0.0, f64::NAN, 1.0])]).contains("`t` holds NaN at sample 2")
        );
        let hole = [2.0, 1.0, f64::INFINITY, 0.5, 0.0, 0.0];
        assert!(refused(&[("x", &[3, 2], &hole), ("t", &[3], &T)]).contains("`x` holds inf at sample 2"));
        assert!(
            refused(&[("x", &[3, 2], &X), ("v", &[2, 2], &X[..4]), ("t", &[3], &T)])
                .contains("`v` has the shape [2, 2]")
        );
        assert!(refused(&[("x", &[3, 2], &X), ("pos", &[3, 2], &X), ("t", &[3], &T)]).contains("the same quantity"));
        assert!(refused(&[("x", &[3, 2], &X), ("dt", &[], &[-1.0])]).contains("`dt` is not one positive number"));
        assert!(refused(&[("t_3", &[3], &T)]).contains("`x` is missing"));
        let text = read("a.npz", b"PK").expect_err("no archive").to_string();
        assert_eq!(text, "a.npz: not a readable .npz archive: it is no ZIP archive, or it is cut off");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn corrupted_files_never_panic(
            deflated: bool,
            hits in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
            cut in proptest::option::of(any::<prop::sample::Index>()),
        ) {
            let mut bytes = writer::file(&[("x_0", &[3, 2], &X), ("t_0", &[3], &T), ("v_0", &[3, 2], &X)], deflated);
            for (at, value) in hits {
                let at = at.index(bytes.len());
                bytes[at] = value;
            }
            if let Some(cut) = cut {
                bytes.truncate(cut.index(bytes.len()));
            }
            let _ = read("a.npz", &bytes);
        }
    }
}
