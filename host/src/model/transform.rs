//! A skill at another place, of another size, turned: with its certificate.
//!
//! With x' = a' + L (x - a), L = s R (a scale s > 0, a rotation R), the motion f'(x') = L f(x) is the same skill. Its parts are
//! A' = L A L^-1 = R A R', P' = R P R', mu' = a' + L (mu - a), Sigma' = L Sigma L', and A'_k' P' + P' A'_k = R (A_k' P + P A_k) R':
//! it decreases at the same rate, in the same time, over a path that is s times as long. Only rounding can break the proof, so it
//! is checked again.

use super::{ComponentFile, ModelFile, ModelFileError, rounded};
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Unit, Vector3};

/// A scale and a rotation about the attractor, and where the attractor goes.
#[derive(Debug, Clone, PartialEq)]
pub struct Similarity {
    scale: f64,
    rotation: DMatrix<f64>,
    attractor: Option<DVector<f64>>,
}

/// Why there is no such similarity.
#[derive(Debug, Clone, PartialEq, thiserror::Error, miette::Diagnostic)]
pub enum SimilarityError {
    /// A point or axis of another dimension than the skill.
    #[error("{name} has {found} numbers and the model {wanted} dimensions")]
    Dimension {
        /// What it is.
        name: &'static str,
        /// Its numbers.
        found: usize,
        /// The dimension.
        wanted: usize,
    },
    /// A number out of its range.
    #[error("{name} = {value}; allowed is {allowed}")]
    Range {
        /// What it is.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// A start that is the attractor, old or new.
    #[error("{name} lies at the attractor; a start elsewhere is needed to know size and direction")]
    AtAttractor {
        /// Which start.
        name: &'static str,
    },
    /// In space a half turn can go about any axis across.
    #[error(
        "the new start lies opposite to the old one, and in space there are many half turns; say which by turn and axis, and the scale"
    )]
    Opposite,
}

impl Similarity {
    /// Nothing changes, in `dimension` 2 or 3.
    pub fn identity(dimension: usize) -> Self {
        Self { scale: 1.0, rotation: DMatrix::identity(dimension, dimension), attractor: None }
    }

    /// The attractor goes to a place, m.
    pub fn to(mut self, attractor: &[f64]) -> Result<Self, SimilarityError> {
        self.attractor = Some(self.point("attractor", attractor)?);
        Ok(self)
    }

    /// Everything becomes larger by a factor, 0.001 to 1000.
    pub fn scaled(mut self, factor: f64) -> Result<Self, SimilarityError> {
        let value = self.scale * factor;
        if !(1e-3..=1e3).contains(&value) {
            return Err(SimilarityError::Range { name: "scale", value, allowed: "0.001 to 1000" });
        }
        self.scale = value;
        Ok(self)
    }

    /// Turned by an angle in rad about the attractor, counter-clockwise; in space about an axis, z if none is given.
    pub fn turned(mut self, angle: f64, axis: Option<&[f64]>) -> Result<Self, SimilarityError> {
        if !(angle.abs() <= 1e3) {
            return Err(SimilarityError::Range { name: "turn", value: angle, allowed: "a finite angle" });
        }
        let axis = match (axis, self.rotation.nrows()) {
            (None, _) => Vector3::z(),
            (Some(&[x, y, z]), 3) => Vector3::new(x, y, z),
            (Some(other), wanted) => {
                return Err(SimilarityError::Dimension { name: "axis", found: other.len(), wanted });
            }
        };
        let Some(axis) = Unit::try_new(axis, 1e-9) else {
            return Err(SimilarityError::Range {
                name: "axis",
                value: axis.norm(),
                allowed: "a direction, such as 0,0,1",
            });
        };
        self.turn(Rotation3::from_axis_angle(&axis, angle).matrix());
        Ok(self)
    }

    /// Scale and the least rotation that bring `from` to `start`, seen from the old attractor and from the new one.
    pub fn with_start(mut self, model: &ModelFile, from: &[f64], start: &[f64]) -> Result<Self, SimilarityError> {
        let old = DVector::from_column_slice(&model.attractor);
        let new = self.attractor.clone().unwrap_or_else(|| old.clone());
        let before = self.point("the old start", from)? - old;
        let after = self.point("start", start)? - new;
        for (name, v) in [("the old start", &before), ("the new start", &after)] {
            if !(v.norm() > 1e-6) {
                return Err(SimilarityError::AtAttractor { name });
            }
        }
        let in_space = |v: &DVector<f64>| Vector3::from_fn(|i, _| v.get(i).copied().unwrap_or(0.0));
        let rotation = match Rotation3::rotation_between(&in_space(&before), &in_space(&after)) {
            Some(rotation) => rotation,
            // A half turn; in the plane there is only one.
            None if before.len() == 2 => Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI),
            None => return Err(SimilarityError::Opposite),
        };
        self.turn(rotation.matrix());
        self.scaled(after.norm() / before.norm())
    }

    fn turn(&mut self, by: &Matrix3<f64>) {
        let d = self.rotation.nrows();
        self.rotation = by.view((0, 0), (d, d)) * &self.rotation;
    }

    fn point(&self, name: &'static str, point: &[f64]) -> Result<DVector<f64>, SimilarityError> {
        let wanted = self.rotation.nrows();
        if point.len() != wanted {
            return Err(SimilarityError::Dimension { name, found: point.len(), wanted });
        }
        match point.iter().find(|c| !(c.abs() <= pliant_core::RANGE)) {
            Some(&value) => Err(SimilarityError::Range { name, value, allowed: "-1000 to 1000 m" }),
            None => Ok(DVector::from_column_slice(point)),
        }
    }

    /// The factor of lengths.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Where a point of the old skill is in the new one. The attractor is that of the old skill.
    pub fn place(&self, attractor: &[f64], point: &[f64]) -> Vec<f64> {
        let old = DVector::from_column_slice(attractor);
        let new = self.attractor.as_ref().unwrap_or(&old);
        let moved = new + &self.rotation * (DVector::from_column_slice(point) - &old) * self.scale;
        moved.iter().copied().collect()
    }
}

impl ModelFile {
    /// The same skill elsewhere, rounded to f32 and certified anew in f32 and f64. Its `learnt` table is left out.
    ///
    /// # Errors
    /// Where what results is no model (too far, too large), or the certificate does not survive rounding.
    pub fn placed(&self, by: &Similarity) -> Result<Self, ModelFileError> {
        let d = self.dimension;
        let r = &by.rotation;
        if r.nrows() != d {
            return Err(ModelFileError::Dimension { name: self.name.clone(), found: d, wanted: r.nrows() });
        }
        // Where nothing turns the numbers stay as they are, to the bit.
        let turns = *r != DMatrix::identity(d, d);
        let matrix = |m: &[Vec<f64>], factor: f64| {
            let m = DMatrix::from_fn(d, d, |i, j| m[i][j]);
            let m = if turns { r * &m * r.transpose() } else { m } * factor;
            (0..d).map(|i| (0..d).map(|j| rounded(m[(i, j)])).collect()).collect::<Vec<Vec<f64>>>()
        };
        let symmetric = |m: &[Vec<f64>], factor: f64| {
            let m = matrix(m, factor);
            (0..d).map(|i| (0..d).map(|j| m[i.max(j)][i.min(j)]).collect()).collect::<Vec<Vec<f64>>>()
        };
        let point = |p: &[f64]| by.place(&self.attractor, p).into_iter().map(rounded).collect::<Vec<f64>>();
        let moved = Self {
            format: self.format,
            name: self.name.clone(),
            dimension: d,
            attractor: point(&self.attractor),
            lyapunov: symmetric(&self.lyapunov, 1.0),
            component: self
                .component
                .iter()
                .map(|c| ComponentFile {
                    prior: c.prior,
                    mean: point(&c.mean),
                    covariance: symmetric(&c.covariance, by.scale * by.scale),
                    a: matrix(&c.a, 1.0),
                })
                .collect(),
            learnt: None,
        };
        moved.skill::<f32>()?;
        moved.skill::<f64>()?;
        Ok(moved)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn planar() -> ModelFile {
        ModelFile {
            format: 1,
            name: "test".into(),
            dimension: 2,
            attractor: vec![0.1, -0.2],
            lyapunov: vec![vec![1.5, 0.25], vec![0.25, 0.5]],
            component: vec![
                ComponentFile {
                    prior: 0.25,
                    mean: vec![0.3, 0.1],
                    covariance: vec![vec![0.01, 0.004], vec![0.004, 0.02]],
                    a: vec![vec![-1.0, 0.5], vec![-1.5, -1.0]],
                },
                ComponentFile {
                    prior: 0.75,
                    mean: vec![0.0, 0.2],
                    covariance: vec![vec![0.02, 0.0], vec![0.0, 0.01]],
                    a: vec![vec![-2.0, 0.5], vec![0.0, -1.0]],
                },
            ],
            learnt: None,
        }
    }

    fn velocity(model: &ModelFile, x: &[f64]) -> DVector<f64> {
        let motion = crate::learn::motion_of::<2>(model).expect("planar");
        let v = motion.velocity(&nalgebra::Vector2::new(x[0], x[1]));
        DVector::from_column_slice(v.as_slice())
    }

    proptest! {
        /// The moved skill does at the moved point what the old one does at the old point, and is certified at the same rate.
        #[test]
        fn the_motion_moves_along(
            to in proptest::array::uniform2(-5.0..5.0f64), scale in 0.05..20.0f64, turn in -7.0..7.0f64,
            at in proptest::array::uniform2(-1.0..1.0f64),
        ) {
            let model = planar();
            let by = Similarity::identity(2).to(&to).and_then(|s| s.scaled(scale)).and_then(|s| s.turned(turn, None)).expect("valid");
            let moved = model.placed(&by).expect("certified");
            let expected = &by.rotation * velocity(&model, &at) * scale;
            let found = velocity(&moved, &by.place(&model.attractor, &at));
            // f32 keeps 24 bits of each number; the attractor may lie 100 times as far away as the skill is large.
            prop_assert!((&expected - &found).norm() <= 2e-4 * (scale + 1.0), "{expected} {found}");
            let rate = |m: &ModelFile| m.certify::<f64, 2>().expect("certified").certificate().rate;
            prop_assert!((rate(&moved) / rate(&model) - 1.0).abs() < 1e-4);
        }

        /// A new start is where the old one goes, and the attractor where it is told to.
        #[test]
        fn a_new_start_is_met(
            to in proptest::array::uniform3(-5.0..5.0f64), from in proptest::array::uniform3(-1.0..1.0f64),
            start in proptest::array::uniform3(-5.0..5.0f64),
        ) {
            let mut model = planar();
            model.dimension = 3;
            model.attractor.push(0.3);
            let far = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() > 0.01;
            prop_assume!(far(&from, &model.attractor) && far(&start, &to));
            let by = Similarity::identity(3).to(&to).and_then(|s| s.with_start(&model, &from, &start)).expect("generic");
            let moved = by.place(&model.attractor, &from);
            prop_assert!(moved.iter().zip(&start).all(|(a, b)| (a - b).abs() < 1e-6), "{moved:?} {start:?}");
            let end = by.place(&model.attractor, &model.attractor);
            prop_assert!(end.iter().zip(&to).all(|(a, b)| (a - b).abs() < 1e-9));
            prop_assert!((by.rotation.clone() * by.rotation.transpose() - DMatrix::identity(3, 3)).norm() < 1e-9);
            prop_assert!(by.rotation.determinant() > 0.0);
        }
    }

    #[test]
    fn a_shift_changes_no_other_number() {
        let model = planar();
        let moved = model.placed(&Similarity::identity(2).to(&[1.0, 2.0]).expect("valid")).expect("certified");
        assert_eq!(moved.attractor, [1.0, 2.0]);
        assert_eq!(moved.lyapunov, model.lyapunov);
        for (a, b) in moved.component.iter().zip(&model.component) {
            assert_eq!((&a.a, a.prior), (&b.a, b.prior));
        }
    }

    #[test]
    fn what_cannot_be_is_named() {
        let text = |r: Result<Similarity, SimilarityError>| r.expect_err("must be refused").to_string();
        let (two, three) = (Similarity::identity(2), Similarity::identity(3));
        assert!(text(two.clone().to(&[1.0, 2.0, 3.0])).contains("attractor has 3 numbers and the model 2"));
        assert!(text(two.clone().to(&[1.0, f64::NAN])).contains("attractor = NaN"));
        assert!(text(two.clone().scaled(0.0)).contains("scale = 0"));
        assert!(text(two.clone().turned(f64::INFINITY, None)).contains("turn = inf"));
        assert!(text(two.clone().turned(1.0, Some(&[0.0, 0.0, 1.0]))).contains("axis has 3 numbers"));
        assert!(text(three.clone().turned(1.0, Some(&[0.0; 3]))).contains("axis = 0"));
        let model = planar();
        assert!(text(two.clone().with_start(&model, &[0.1, -0.2], &[1.0, 1.0])).contains("the old start lies at"));
        let by = two.with_start(&model, &[1.1, -0.2], &[-0.9, -0.2]).expect("a half turn");
        assert!((by.place(&model.attractor, &[0.1, 0.8])[1] + 1.2).abs() < 1e-9);
        let mut model = planar();
        model.attractor = vec![0.0; 3];
        assert_eq!(three.with_start(&model, &[1.0, 0.0, 0.0], &[-2.0, 0.0, 0.0]), Err(SimilarityError::Opposite));
    }
}
