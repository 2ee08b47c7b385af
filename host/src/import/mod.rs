//! Models that other tools have learnt: ds-opt's YAML and lpvds' JSON.
//!
//! Both hold a Gaussian mixture over positions (`Priors`, `Mu`, `Sigma`), a linear system a component (`A`) and the attractor; neither
//! keeps the P that it was learnt with. Where a file has one (`P`) it is checked; where it has none, or one that does not prove
//! it, P is searched, and a model without is refused.

mod fields;
mod lyapunov;

use crate::error::counted;
use crate::learn::{LearnError, Unit, read::bytes_of};
use crate::model::{ComponentFile, FORMAT, FieldError, ModelFile, rounded};
use fields::{Field, Value};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;
use std::path::Path;

/// By so much more the other order of A must follow the components before a person is asked.
const ORDER_DOUBTED: f64 = 0.25;

/// Why a file of another tool is no model here.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ImportError {
    /// The file cannot be read.
    #[error(transparent)]
    Unreadable(#[from] LearnError),
    /// The name of the file says nothing about its format.
    #[error("{file}: unknown format; models to import are .yml or .yaml (ds-opt) or .json (lpvds)")]
    UnknownFormat {
        /// Path as given.
        file: String,
    },
    /// The text is neither YAML nor JSON.
    #[error("{file}, line {line}: {problem}")]
    Syntax {
        /// Path as given.
        file: String,
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        problem: String,
    },
    /// A field is missing.
    #[error("{file}: `{field}` is missing; needed: {allowed}")]
    Missing {
        /// Path as given.
        file: String,
        /// Name of the field.
        field: &'static str,
        /// What it should be.
        allowed: String,
    },
    /// A field is wrong.
    #[error("{file}, line {line}: `{field}` {problem}; allowed is {allowed}")]
    Field {
        /// Path as given.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Name of the field.
        field: String,
        /// What is wrong with it.
        problem: String,
        /// What it should be.
        allowed: String,
    },
    /// A model of SEDS, which is of another kind.
    #[error(
        "{file}: it is a SEDS model, a mixture over positions and velocities without `A`; learn the skill anew from its demonstrations"
    )]
    Seds {
        /// Path as given.
        file: String,
    },
    /// The numbers do not make a model.
    #[error("{file}: the model in it is not usable: {reason}")]
    Model {
        /// Path as given.
        file: String,
        /// What is wrong.
        reason: FieldError,
    },
    /// Nothing proves that the motion ends at its attractor.
    #[error("{file}: it cannot be certified: {problem}")]
    #[diagnostic(help("learn the skill anew from its demonstrations: `pliant learn` gives each component a proof"))]
    Unproven {
        /// Path as given.
        file: String,
        /// Why.
        problem: String,
    },
}

/// How the matrices of a file are written where they are flat lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Row by row, as NumPy does.
    Rows,
    /// Column by column, as MATLAB does.
    Columns,
}

impl std::str::FromStr for Order {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "rows" => Ok(Order::Rows),
            "columns" => Ok(Order::Columns),
            _ => Err("allowed is rows or columns".into()),
        }
    }
}

/// How the means of a file lie in a flat list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Means {
    /// One component after the other, as both tools write them now.
    Components,
    /// The first coordinate of all, then the second, as older versions of lpvds did.
    Axes,
}

impl std::str::FromStr for Means {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "components" => Ok(Means::Components),
            "axes" => Ok(Means::Axes),
            _ => Err("allowed is components or axes".into()),
        }
    }
}

/// What a file does not say about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Layout {
    /// The unit of lengths; m where it is not declared.
    pub unit: Option<Unit>,
    /// The order of matrices; by the name of the file where it is not declared (rows in .json, columns in .yml), unless only the other
    /// can be meant.
    pub order: Option<Order>,
    /// The order of means; component by component where it is not declared, unless only the other can be meant.
    pub means: Option<Means>,
}

/// Where the P of an imported model is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Proof {
    /// The file had it.
    Given,
    /// The file had none, and one was found.
    Found,
    /// The file's own does not prove it, and another was found.
    Replaced,
}

/// An imported and certified model.
#[derive(Debug, Clone)]
pub struct Imported {
    /// The model, certified in f32 and f64.
    pub model: ModelFile,
    /// Where its P is from.
    pub proof: Proof,
    /// Where its demonstrations began, m, if the file says so.
    pub starts: Vec<Vec<f64>>,
}

/// Reads a model of another tool, in metres, and certifies it.
pub fn import(path: &Path, layout: Layout) -> Result<Imported, ImportError> {
    parse(&path.display().to_string(), &bytes_of(path)?, layout)
}

/// The same from the bytes of a file; `file` is its name.
pub fn parse(file: &str, bytes: &[u8], layout: Layout) -> Result<Imported, ImportError> {
    let extension = Path::new(file).extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let order = match extension.as_str() {
        "json" => Order::Rows,
        "yml" | "yaml" => Order::Columns,
        _ => return Err(ImportError::UnknownFormat { file: file.into() }),
    };
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let line = 1 + bytes[..e.valid_up_to()].iter().filter(|b| **b == b'\n').count();
        ImportError::Syntax { file: file.into(), line, problem: "it is not UTF-8 text".into() }
    })?;
    let fields = fields::parse(text).map_err(|fault| ImportError::Syntax {
        file: file.into(),
        line: fault.line,
        problem: fault.problem,
    })?;
    Table { file, fields }.imported(layout, order)
}

struct Table<'a> {
    file: &'a str,
    fields: BTreeMap<String, Field>,
}

impl Table<'_> {
    fn find(&self, names: &[&'static str]) -> Option<(&'static str, &Field)> {
        names.iter().find_map(|name| self.fields.get(*name).map(|field| (*name, field)))
    }

    /// The numbers of a field, which has one of several names, and whether they are nested.
    fn numbers(&self, names: &[&'static str], count: usize, what: &str) -> Result<(&[f64], bool), ImportError> {
        let allowed = format!("{}, {what}", counted(count, "number"));
        let Some((name, field)) = self.find(names) else {
            return Err(ImportError::Missing { file: self.file.into(), field: names[0], allowed });
        };
        match &field.value {
            Value::Numbers { values, nested } if values.len() == count => {
                match values.iter().find(|v| !v.is_finite()) {
                    None => Ok((values, *nested)),
                    Some(bad) => Err(self.fault(name, field, format!("holds {bad}"), "finite numbers".into())),
                }
            }
            Value::Numbers { values, .. } => {
                Err(self.fault(name, field, format!("has {}", counted(values.len(), "number")), allowed))
            }
            Value::Text(text) => {
                let text: String = text.chars().take(40).collect();
                Err(self.fault(name, field, format!("is `{text}`"), allowed))
            }
        }
    }

    fn fault(&self, name: &str, field: &Field, problem: String, allowed: String) -> ImportError {
        ImportError::Field { file: self.file.into(), line: field.line, field: name.to_owned(), problem, allowed }
    }

    /// A whole number in a range.
    fn size(
        &self,
        name: &'static str,
        range: std::ops::RangeInclusive<usize>,
        what: &str,
    ) -> Result<usize, ImportError> {
        let (values, _) = self.numbers(&[name], 1, what)?;
        let value = values[0];
        if value.fract() == 0.0 && range.contains(&(value as usize)) {
            return Ok(value as usize);
        }
        let (_, field) = self.find(&[name]).unwrap_or((name, &self.fields[name]));
        Err(self.fault(name, field, format!("is {value}"), format!("{} to {}", range.start(), range.end())))
    }

    fn imported(&self, layout: Layout, usual: Order) -> Result<Imported, ImportError> {
        if self.find(&["A"]).is_none() && self.find(&["dim", "Mu_scale"]).is_some() {
            return Err(ImportError::Seds { file: self.file.into() });
        }
        let k = self.size("K", 1..=pliant_core::ds::MAX_COMPONENTS, "the number of components")?;
        let d = self.size("M", 2..=3, "the dimension")?;
        let length = layout.unit.unwrap_or(Unit::M).metres();
        let matrices = |names: &[&'static str], what: &str| -> Result<Vec<DMatrix<f64>>, ImportError> {
            let (values, nested) = self.numbers(names, k * d * d, what)?;
            let by_columns = layout.order.unwrap_or(usual) == Order::Columns && !nested;
            let block = |m: &[f64]| {
                if by_columns { DMatrix::from_column_slice(d, d, m) } else { DMatrix::from_row_slice(d, d, m) }
            };
            Ok(values.chunks_exact(d * d).map(block).collect())
        };
        let (priors, _) = self.numbers(&["Priors", "Prior"], k, "one a component")?;
        if let (Some(_), Some((name, other))) = (self.find(&["Priors"]), self.find(&["Prior"]))
            && self.numbers(&[name], k, "one a component")?.0 != priors
        {
            let problem = "is there beside `Priors`, and differs".into();
            return Err(self.fault(name, other, problem, "one of them, in the order of Mu, Sigma and A".into()));
        }
        let covariances = matrices(&["Sigma"], "component by component")?;
        let a = matrices(&["A"], "component by component")?;
        let (_, a_is_nested) = self.numbers(&["A"], k * d * d, "component by component")?;
        let (attractor, _) = self.numbers(&["attractor"], d, "the place where the motion ends")?;

        let means = self.means(k, d, &covariances, attractor, layout.means)?;
        if layout.order.is_none() && !a_is_nested {
            self.check_order(&a, &means, &covariances, attractor)?;
        }
        let rows =
            |m: &DMatrix<f64>| (0..d).map(|r| (0..d).map(|c| rounded(m[(r, c)])).collect()).collect::<Vec<Vec<f64>>>();
        let component = (0..k)
            .map(|i| ComponentFile {
                prior: rounded(priors[i]),
                mean: means[i].iter().map(|c| rounded(c * length)).collect(),
                // Other tools' last digits are not always symmetric.
                covariance: rows(&((&covariances[i] + covariances[i].transpose()) * (0.5 * length * length))),
                a: rows(&a[i]),
            })
            .collect();
        let mut model = ModelFile {
            format: FORMAT,
            name: self.name(),
            dimension: d,
            attractor: attractor.iter().map(|c| rounded(c * length)).collect(),
            lyapunov: rows(&DMatrix::identity(d, d)),
            component,
            learnt: None,
        };
        model.validate().map_err(|reason| ImportError::Model { file: self.file.into(), reason })?;
        let given = match self.find(&["P"]) {
            None => None,
            Some((name, _)) => {
                let (values, _) =
                    self.numbers(&[name], d * d, "the matrix of V = (x - attractor)' P (x - attractor)")?;
                Some(DMatrix::from_row_slice(d, d, values))
            }
        };
        let proof = self.prove(&mut model, given, &a)?;
        Ok(Imported { model, proof, starts: self.starts(d, length) })
    }

    /// The means. Not every version of lpvds has written them in one order, and in the wrong one the attractor lies far from every
    /// component; but that is no proof, so a person has to say it.
    fn means(
        &self,
        k: usize,
        d: usize,
        covariances: &[DMatrix<f64>],
        attractor: &[f64],
        declared: Option<Means>,
    ) -> Result<Vec<DVector<f64>>, ImportError> {
        let (values, nested) = self.numbers(&["Mu"], k * d, "component by component")?;
        let by = |means: Means| -> Vec<DVector<f64>> {
            let at = |i: usize, c: usize| if means == Means::Axes { c * k + i } else { i * d + c };
            (0..k).map(|i| DVector::from_fn(d, |c, _| values[at(i, c)])).collect()
        };
        // Standard deviations from the attractor to the component nearest in them.
        let nearest = |means: &[DVector<f64>]| {
            let attractor = DVector::from_column_slice(attractor);
            let distance = |(mean, covariance): (&DVector<f64>, &DMatrix<f64>)| {
                let e = &attractor - mean;
                Some(e.dot(&covariance.clone().cholesky()?.solve(&e)).sqrt())
            };
            means.iter().zip(covariances).filter_map(distance).fold(f64::INFINITY, f64::min)
        };
        let usual = by(declared.unwrap_or(Means::Components));
        let (near, other) = (nearest(&usual), nearest(&by(Means::Axes)));
        match self.find(&["Mu"]) {
            Some((name, field)) if declared.is_none() && !nested && k > 1 && near > 3.0 && other < 1.0 => {
                let problem = format!(
                    "read component by component lies {near:.1} standard deviations from the attractor, and read axis by axis {other:.1}"
                );
                Err(self.fault(name, field, problem, "either, if --means axes or --means components says which".into()))
            }
            _ => Ok(usual),
        }
    }

    /// The transposed A_k have a proof too (P^-1), but another motion. Where demonstrations went, components are long; a motion that goes
    /// across them in the order read, and along them in the other, was written in the other.
    fn check_order(
        &self,
        a: &[DMatrix<f64>],
        means: &[DVector<f64>],
        covariances: &[DMatrix<f64>],
        attractor: &[f64],
    ) -> Result<(), ImportError> {
        let attractor = DVector::from_column_slice(attractor);
        let along = |transposed: bool| {
            let cosines = a.iter().zip(means).zip(covariances).map(|((a, mean), covariance)| {
                let offset = mean - &attractor;
                let v = if transposed { a.tr_mul(&offset) } else { a * offset };
                let eigen = covariance.clone().symmetric_eigen();
                let axis = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
                (axis.dot(&v) / v.norm().max(f64::MIN_POSITIVE)).abs()
            });
            cosines.sum::<f64>() / a.len() as f64
        };
        let (read, other) = (along(false), along(true));
        match self.find(&["A"]) {
            Some((name, field)) if other > read + ORDER_DOUBTED => {
                let problem = format!(
                    "as read moves across the components (mean cosine to their long axes {read:.2}), and transposed along them ({other:.2})"
                );
                Err(self.fault(name, field, problem, "either, if --order rows or --order columns says which".into()))
            }
            _ => Ok(()),
        }
    }

    /// What the file says, or the file's own.
    fn name(&self) -> String {
        match self.fields.get("name").map(|f| &f.value) {
            Some(Value::Text(text)) if !text.is_empty() => text.chars().filter(|c| !c.is_control()).take(80).collect(),
            _ => Path::new(self.file).file_stem().map_or("imported".into(), |s| s.to_string_lossy().into_owned()),
        }
    }

    /// Gives the model a P that holds in f32 and f64, or says why there is none.
    fn prove(
        &self,
        model: &mut ModelFile,
        given: Option<DMatrix<f64>>,
        a: &[DMatrix<f64>],
    ) -> Result<Proof, ImportError> {
        let d = model.dimension;
        let mut holds = |p: &DMatrix<f64>| {
            let p = (p + p.transpose()) * (0.5 * d as f64 / p.trace());
            model.lyapunov = (0..d).map(|r| (0..d).map(|c| rounded(p[(r, c)])).collect()).collect();
            model.certified::<f32>() && model.certified::<f64>()
        };
        if given.as_ref().is_some_and(&mut holds) {
            return Ok(Proof::Given);
        }
        let problem = match lyapunov::search(a) {
            Ok(p) if holds(&p) => return Ok(if given.is_some() { Proof::Replaced } else { Proof::Found }),
            Ok(p) => {
                let (margin, k) = lyapunov::margin(a, &p);
                format!(
                    "the best P has a margin of {margin:.1e} of |A|, at component {}, which the rounding of f32 uses up",
                    k + 1
                )
            }
            Err(none) => match none.unstable {
                Some(k) => format!(
                    "component {} by itself leads away from the attractor (its A has an eigenvalue with a real part of 0 or more)",
                    k + 1
                ),
                None => format!(
                    "no P serves all components (the best misses by {:.1e} of |A|, at component {})",
                    none.margin,
                    none.tight + 1
                ),
            },
        };
        Err(ImportError::Unproven { file: self.file.into(), problem })
    }

    fn starts(&self, d: usize, length: f64) -> Vec<Vec<f64>> {
        match self.find(&["x0_all", "x_0"]).map(|(_, f)| &f.value) {
            Some(Value::Numbers { values, .. }) if values.len() % d == 0 && values.iter().all(|v| v.is_finite()) => {
                values.chunks_exact(d).take(64).map(|p| p.iter().map(|c| rounded(c * length)).collect()).collect()
            }
            _ => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests;
