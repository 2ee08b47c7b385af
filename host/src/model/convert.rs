//! From a model file to what the core runs.

use super::{ModelFile, ModelFileError};
use crate::learn::gmm::whitening;
use crate::proof::{Proof, prove};
use nalgebra::{SMatrix, SVector};
use pliant_core::Scalar;
use pliant_core::ds::{CertificateError, Certified, Component, LpvDs, ModelError, ModelField};

/// A certified skill of either dimension.
#[derive(Debug, Clone)]
pub enum Skill<S: Scalar> {
    /// In the plane.
    Planar(Certified<LpvDs<S, 2>>),
    /// In space.
    Spatial(Certified<LpvDs<S, 3>>),
}

impl ModelFile {
    /// The model in the precision S, for its dimension D; its certificate is not checked yet.
    pub fn lpv_ds<S: Scalar, const D: usize>(&self) -> Result<LpvDs<S, D>, ModelFileError> {
        self.validate()?;
        if self.dimension != D {
            return Err(ModelFileError::Dimension { name: self.name.clone(), found: self.dimension, wanted: D });
        }
        let vector = |v: &[f64]| SVector::<S, D>::from_fn(|r, _| S::from_f64(v[r]));
        let matrix = |m: &[Vec<f64>]| SMatrix::<S, D, D>::from_fn(|r, c| S::from_f64(m[r][c]));
        let mut components = Vec::with_capacity(self.component.len());
        for (k, c) in self.component.iter().enumerate() {
            let covariance = SMatrix::<f64, D, D>::from_fn(|r, c_| c.covariance[r][c_]);
            let (w, log_det) = whitening(&covariance).ok_or_else(|| super::FieldError {
                component: Some(k),
                name: "covariance",
                problem: "is too small or too flat to invert".into(),
                allowed: "a symmetric positive definite matrix",
            })?;
            components.push(Component {
                log_weight: S::from_f64(c.prior.ln() - 0.5 * log_det),
                mean: vector(&c.mean),
                whitening: w.map(S::from_f64),
                a: matrix(&c.a),
            });
        }
        LpvDs::new(vector(&self.attractor), matrix(&self.lyapunov), &components).map_err(|e| field_error(e).into())
    }

    /// The model in the precision S with its certificate checked in that precision.
    pub fn certify<S: Scalar, const D: usize>(&self) -> Result<Certified<LpvDs<S, D>>, ModelFileError> {
        let model = self.lpv_ds::<S, D>()?;
        model.clone().certify().map_err(|e| {
            // Does it not hold, or is it only closer to the edge than rounding lets the device see?
            let doubt = if prove(&model).is_ok() { ", as far as its rounding lets a device see" } else { "" };
            self.refused(e, doubt)
        })
    }

    /// The certificate of the numbers in the precision S, proved without rounding.
    pub fn proof<S: Scalar>(&self) -> Result<Proof, ModelFileError> {
        let proof = match self.dimension {
            3 => prove(&self.lpv_ds::<S, 3>()?),
            _ => prove(&self.lpv_ds::<S, 2>()?),
        };
        proof.map_err(|e| self.refused(e, ""))
    }

    fn refused(&self, e: CertificateError, doubt: &str) -> ModelFileError {
        let (component, problem) = match e {
            CertificateError::Lyapunov => (None, format!("lyapunov is not positive definite{doubt}")),
            CertificateError::Component(k) => {
                (Some(k), format!("component {}: a' P + P a is not negative definite{doubt}", k + 1))
            }
        };
        ModelFileError::Certificate { name: self.name.clone(), component, problem }
    }

    /// The certified skill in its own dimension.
    pub fn skill<S: Scalar>(&self) -> Result<Skill<S>, ModelFileError> {
        match self.dimension {
            3 => self.certify::<S, 3>().map(Skill::Spatial),
            _ => self.certify::<S, 2>().map(Skill::Planar),
        }
    }

    /// Checks the certificate in f32 and f64.
    ///
    /// # Errors
    /// It does not hold, or the numbers do not fit.
    pub fn is_certified(&self) -> Result<(), ModelFileError> {
        self.skill::<f64>()?;
        self.skill::<f32>().map(|_| ())
    }

    /// Does the certificate hold in the precision S?
    pub fn certified<S: Scalar>(&self) -> bool {
        self.skill::<S>().is_ok()
    }
}

fn field_error(e: ModelError) -> super::FieldError {
    let (name, allowed) = match e.field {
        ModelField::Attractor | ModelField::Gain => ("attractor", "-1000 to 1000 m"),
        ModelField::Lyapunov => ("lyapunov", "entries up to 1e6"),
        ModelField::Components => ("component", "1 to 16 components"),
        ModelField::Weight => ("prior", "a prior and a covariance of ordinary size"),
        ModelField::Mean => ("mean", "-1000 to 1000 m"),
        ModelField::Whitening => ("covariance", "standard deviations of a micrometre or more"),
        ModelField::A => ("a", "entries up to 1e4 1/s"),
    };
    super::FieldError { component: e.component, name, problem: "is out of range".into(), allowed }
}
