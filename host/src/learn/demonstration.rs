//! Demonstrations: checked, in metres, and ending in one attractor.

use super::error::LearnError;
use super::smoothing;
use nalgebra::DVector;

/// How far demonstrations may end from their mean end, as a part of the extent of the skill.
pub const END_TOLERANCE: f64 = 0.05;

/// The unit of lengths in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Millimetres.
    Mm,
    /// Centimetres.
    Cm,
    /// Metres.
    M,
}

impl Unit {
    /// Metres in one unit.
    pub fn metres(self) -> f64 {
        match self {
            Unit::Mm => 1e-3,
            Unit::Cm => 1e-2,
            Unit::M => 1.0,
        }
    }
}

impl std::str::FromStr for Unit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "mm" => Ok(Unit::Mm),
            "cm" => Ok(Unit::Cm),
            "m" => Ok(Unit::M),
            other => Err(format!("unit `{other}`; allowed is mm, cm or m")),
        }
    }
}

/// One recorded motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Demonstration {
    /// Where it comes from: file, and number in it.
    pub name: String,
    /// Times in seconds, strictly increasing.
    pub t: Vec<f64>,
    /// Positions in metres, of dimension 2 or 3.
    pub x: Vec<DVector<f64>>,
    /// Velocities in m/s, one a position.
    pub v: Vec<DVector<f64>>,
}

impl Demonstration {
    /// Checks one recording. Exact duplicates are dropped; velocities that are not given are computed from the positions.
    pub fn new(
        name: impl Into<String>,
        t: Vec<f64>,
        x: Vec<DVector<f64>>,
        v: Option<Vec<DVector<f64>>>,
    ) -> Result<Self, LearnError> {
        let name = name.into();
        let fail =
            |problem: String, allowed| Err(LearnError::Demonstration { demonstration: name.clone(), problem, allowed });
        let n = t.len();
        if n != x.len() || v.as_ref().is_some_and(|v| v.len() != n) {
            return fail("times, positions and velocities differ in number".into(), "one of each a sample");
        }
        let Some(first) = x.first() else {
            return fail("it is empty".into(), "2 samples or more");
        };
        let d = first.len();
        if !(2..=3).contains(&d) {
            return fail(format!("it has dimension {d}"), "2 or 3");
        }
        let vectors = || x.iter().chain(v.iter().flatten());
        if vectors().any(|p| p.len() != d) {
            return fail("its samples differ in dimension".into(), "the same dimension everywhere");
        }
        if t.iter().any(|t| !t.is_finite()) || vectors().any(|p| p.iter().any(|c| !c.is_finite())) {
            return fail("it holds a value that is not a number".into(), "finite numbers");
        }

        let mut keep = Vec::with_capacity(n);
        for i in 0..n {
            let Some(&last) = keep.last() else {
                keep.push(i);
                continue;
            };
            let last: usize = last;
            if t[i] == t[last] && x[i] == x[last] {
                continue;
            }
            if t[i] <= t[last] {
                let problem = format!("time goes from {} to {} at sample {}", t[last], t[i], i + 1);
                return fail(problem, "time that increases");
            }
            keep.push(i);
        }
        if keep.len() < 2 {
            return fail("it has one sample".into(), "2 samples or more");
        }
        if x.iter().all(|p| p == first) {
            return fail("it never moves".into(), "a motion");
        }
        let pick = |all: &[DVector<f64>]| keep.iter().map(|&i| all[i].clone()).collect::<Vec<_>>();
        let times: Vec<f64> = keep.iter().map(|&i| t[i]).collect();
        let positions = pick(&x);
        let velocities = match &v {
            Some(v) => pick(v),
            None => smoothing::velocities(&times, &positions, smoothing::half_width(times.len())),
        };
        Ok(Self { name, t: times, x: positions, v: velocities })
    }

    /// The same recording with lengths multiplied by `factor`.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.x.iter_mut().chain(&mut self.v).for_each(|p| *p *= factor);
        self
    }

    /// Seconds from the first to the last sample.
    pub fn duration(&self) -> f64 {
        self.t.last().copied().unwrap_or(0.0) - self.t.first().copied().unwrap_or(0.0)
    }
}

/// All demonstrations of one skill, shifted so that each ends at the attractor.
#[derive(Debug, Clone, PartialEq)]
pub struct Demonstrations {
    items: Vec<Demonstration>,
    attractor: DVector<f64>,
    extent: f64,
}

impl Demonstrations {
    /// Checks that the recordings are of one skill: one dimension, and one end within [`END_TOLERANCE`].
    pub fn new(mut items: Vec<Demonstration>) -> Result<Self, LearnError> {
        let Some(first) = items.first() else {
            return Err(LearnError::NoDemonstrations { file: "input".into() });
        };
        let d = first.x[0].len();
        if let Some(other) = items.iter().find(|i| i.x[0].len() != d) {
            return Err(LearnError::Demonstration {
                demonstration: other.name.clone(),
                problem: format!("it has dimension {}, and {} has {d}", other.x[0].len(), first.name),
                allowed: "one dimension for all demonstrations",
            });
        }
        let ends: Vec<_> = items.iter().map(|i| i.x[i.x.len() - 1].clone()).collect();
        let mean = ends.iter().fold(DVector::zeros(d), |sum, e| sum + e) / ends.len() as f64;
        // To the nanometre: an attractor of -3e-17 helps nobody who reads the file.
        let attractor = mean.map(|c| (c * 1e9).round() / 1e9 + 0.0);

        let points = || items.iter().flat_map(|i| &i.x);
        let bound = |pick: fn(f64, f64) -> f64, start: f64| {
            points().fold(DVector::from_element(d, start), |b, p| b.zip_map(p, pick))
        };
        let extent = (bound(f64::max, f64::MIN) - bound(f64::min, f64::MAX)).norm();
        if !extent.is_finite() {
            return Err(LearnError::Demonstration {
                demonstration: first.name.clone(),
                problem: "positions overflow".into(),
                allowed: "positions of a robot, in metres",
            });
        }
        let allowed = END_TOLERANCE * extent;
        let farthest = ends.iter().map(|e| (e - &mean).norm()).enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((i, distance)) = farthest
            && distance > allowed
        {
            let demonstration = items[i].name.clone();
            return Err(LearnError::EndsApart { demonstration, distance, allowed });
        }
        for (item, end) in items.iter_mut().zip(&ends) {
            let shift = &attractor - end;
            item.x.iter_mut().for_each(|p| *p += &shift);
        }
        Ok(Self { items, attractor, extent })
    }

    /// The recordings.
    pub fn items(&self) -> &[Demonstration] {
        &self.items
    }

    /// Where they all end.
    pub fn attractor(&self) -> &DVector<f64> {
        &self.attractor
    }

    /// 2 or 3.
    pub fn dimension(&self) -> usize {
        self.attractor.len()
    }

    /// Diagonal of the box around all positions, in metres.
    pub fn extent(&self) -> f64 {
        self.extent
    }

    /// Number of samples in all recordings.
    pub fn samples(&self) -> usize {
        self.items.iter().map(|i| i.t.len()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(flat: &[[f64; 2]]) -> Vec<DVector<f64>> {
        flat.iter().map(|p| DVector::from_row_slice(p)).collect()
    }

    fn message<T: std::fmt::Debug>(result: Result<T, LearnError>) -> String {
        result.expect_err("must be refused").to_string()
    }

    #[test]
    fn duplicates_are_dropped_and_velocity_is_computed() {
        let x = points(&[[0.0, 0.0], [0.0, 0.0], [1.0, 2.0]]);
        let d = Demonstration::new("a", vec![0.0, 0.0, 1.0], x, None).expect("valid");
        assert_eq!(d.t, [0.0, 1.0]);
        assert_eq!(d.v[0].as_slice(), [1.0, 2.0]);
    }

    #[test]
    fn what_is_not_a_motion_is_refused() {
        assert!(message(Demonstration::new("a", vec![], vec![], None)).contains("empty"));
        let one = Demonstration::new("a", vec![0.0], points(&[[1.0, 1.0]]), None);
        assert!(message(one).contains("one sample"));
        let still = points(&[[1.0, 1.0], [1.0, 1.0], [1.0, 1.0]]);
        assert!(message(Demonstration::new("a", vec![0.0, 1.0, 2.0], still, None)).contains("never moves"));
        let nan = points(&[[1.0, f64::NAN], [1.0, 1.0]]);
        assert!(message(Demonstration::new("a", vec![0.0, 1.0], nan, None)).contains("not a number"));
        let back = points(&[[1.0, 0.0], [1.0, 1.0], [2.0, 2.0]]);
        assert!(message(Demonstration::new("a", vec![0.0, 1.0, 0.5], back, None)).contains("from 1 to 0.5"));
        let flat = vec![DVector::from_element(4, 1.0), DVector::from_element(4, 2.0)];
        assert!(message(Demonstration::new("a", vec![0.0, 1.0], flat, None)).contains("dimension 4"));
    }

    #[test]
    fn all_end_at_the_attractor() {
        let make =
            |end: f64| Demonstration::new("a", vec![0.0, 1.0], points(&[[1.0, 1.0], [end, 0.0]]), None).expect("valid");
        let all = Demonstrations::new(vec![make(0.02), make(-0.01)]).expect("ends agree");
        assert_eq!(all.attractor().as_slice(), [0.005, 0.0]);
        for item in all.items() {
            assert!((item.x.last().expect("two") - all.attractor()).norm() < 1e-12);
        }
        let apart = Demonstrations::new(vec![make(0.0), make(0.5)]);
        assert!(message(apart).contains("from the mean end point"));
    }

    #[test]
    fn dimensions_must_agree() {
        let flat = Demonstration::new("a", vec![0.0, 1.0], points(&[[1.0, 1.0], [0.0, 0.0]]), None);
        let solid = vec![DVector::from_element(3, 1.0), DVector::from_element(3, 0.0)];
        let solid = Demonstration::new("b", vec![0.0, 1.0], solid, None).expect("valid");
        let text = message(Demonstrations::new(vec![flat.expect("valid"), solid]));
        assert!(text.contains("b: it has dimension 3, and a has 2"), "{text}");
    }
}
