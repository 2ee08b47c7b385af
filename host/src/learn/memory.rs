//! What a model file remembers of its demonstrations, so that one can be added later.
//!
//! The table `learnt` names the files it was learnt from (relative to the model file) with the unit that was declared for them,
//! and where the demonstrations began. To add a demonstration these files are read again and everything is fitted anew. Where they are gone, or the model was
//! moved since, the model's own motions from those starts stand for them: what it does is known, what the person did is not.

use super::demonstration::{Demonstration, Demonstrations, Unit};
use super::error::LearnError;
use super::warning::Warning;
use super::{motion_of, read};
use crate::model::{ModelFile, SourceFile, rounded};
use nalgebra::{DVector, SVector};
use std::path::{Component, Path, PathBuf};

/// Starts that are remembered.
const MOST_STARTS: usize = 64;
/// Steps of one motion that stands for a demonstration.
const STEPS: usize = 20_000;

/// A file or folder of demonstrations.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// Where it is, from the working folder.
    pub path: PathBuf,
    /// The unit that was declared for it.
    pub unit: Option<Unit>,
}

/// Notes where a model comes from, in its `learnt` table. `file` is where the model will be.
pub fn note(model: &mut ModelFile, file: &Path, sources: &[Source], starts: &[Vec<f64>]) {
    let learnt = model.learnt.get_or_insert_default();
    learnt.sources = sources.iter().map(|s| SourceFile { file: relative(file, &s.path), unit: s.unit }).collect();
    learnt.starts = starts.iter().take(MOST_STARTS).map(|p| p.iter().map(|c| rounded(*c)).collect()).collect();
}

/// Where the demonstrations began.
pub fn starts(model: &ModelFile) -> Vec<Vec<f64>> {
    model.learnt.iter().flat_map(|l| &l.starts).take(MOST_STARTS).cloned().collect()
}

/// Their mean.
pub fn mean_start(model: &ModelFile) -> Option<Vec<f64>> {
    let all = starts(model);
    let mean = |c: usize| all.iter().map(|p| p[c]).sum::<f64>() / all.len() as f64;
    (!all.is_empty()).then(|| (0..model.dimension).map(mean).collect())
}

/// What a model was learnt from. `file` is where the model is.
pub fn sources(model: &ModelFile, file: &Path) -> Vec<Source> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let source = |s: &SourceFile| Source { path: folder.join(&s.file), unit: s.unit };
    model.learnt.iter().flat_map(|l| &l.sources).map(source).collect()
}

/// The demonstrations of a model together with new ones, and what can be remembered of the old ones. `file` is where the model is.
///
/// # Errors
/// Where what the model remembers cannot be read, or it remembers nothing, or old and new are not of one skill.
pub fn with(
    model: &ModelFile,
    file: &Path,
    new: Vec<Demonstration>,
) -> Result<(Demonstrations, Vec<Source>), LearnError> {
    let sources = sources(model, file);
    let name = file.display().to_string();
    let read = |s: &Source| read::recordings(std::slice::from_ref(&s.path), s.unit);
    let problem = match sources.iter().map(read).collect::<Result<Vec<_>, _>>() {
        Ok(all) if !all.is_empty() => {
            return Ok((Demonstrations::new(all.into_iter().flatten().chain(new).collect())?, sources));
        }
        Ok(_) => "it does not name the files it was learnt from".to_owned(),
        // What is there but damaged is for a person to look at; what is gone is gone.
        Err(LearnError::Unreadable { file, problem }) if problem.kind() == std::io::ErrorKind::NotFound => {
            format!("{file}, which it was learnt from, is gone")
        }
        Err(other) => return Err(other),
    };
    let mut all = motions(model, &name);
    let Some(first) = all.first_mut() else { return Err(LearnError::Forgotten { model: name, problem }) };
    first.warnings.push(Warning::Forgotten { model: name, problem });
    all.extend(new);
    Ok((Demonstrations::new(all)?, vec![]))
}

/// The model's own motions from the remembered starts.
fn motions(model: &ModelFile, name: &str) -> Vec<Demonstration> {
    let all = starts(model).into_iter().enumerate();
    let title = |i: usize| format!("{name}, motion {}", i + 1);
    let motion = |(i, start): (usize, Vec<f64>)| match model.dimension {
        2 => motion::<2>(model, title(i), &start),
        _ => motion::<3>(model, title(i), &start),
    };
    all.filter_map(motion).collect()
}

fn motion<const D: usize>(model: &ModelFile, name: String, start: &[f64]) -> Option<Demonstration> {
    let motion = motion_of::<D>(model)?;
    let mut p = SVector::<f64, D>::from_column_slice(start);
    let whole = (p - motion.attractor).norm();
    let (mut t, mut x, mut v) = (vec![], vec![], vec![]);
    let mut time = 0.0;
    for _ in 0..STEPS {
        let f = motion.velocity(&p);
        t.push(time);
        x.push(DVector::from_column_slice(p.as_slice()));
        v.push(DVector::from_column_slice(f.as_slice()));
        let left = (p - motion.attractor).norm();
        if !(left > 0.002 * whole) {
            break;
        }
        // A two-hundredth of the way, or of what is left near the end.
        let dt = (0.005 * whole).min(0.1 * left) / f.norm();
        p = motion.step(&p, dt);
        time += dt;
    }
    Demonstration::new(name, t, x, Some(v)).ok()
}

/// How to get from the folder of `file` to `to`; `to` as it is where that cannot be said.
fn relative(file: &Path, to: &Path) -> String {
    let plain = || to.to_string_lossy().into_owned();
    let (Ok(from), Ok(target)) = (std::path::absolute(file), std::path::absolute(to)) else { return plain() };
    let from = from.parent().unwrap_or(&from);
    let (from, target): (Vec<_>, Vec<_>) = (from.components().collect(), target.components().collect());
    let common = from.iter().zip(&target).take_while(|(a, b)| a == b).count();
    if common == 0 || from[common..].contains(&Component::ParentDir) {
        return plain();
    }
    let up = std::iter::repeat_n("..", from.len() - common).map(str::to_owned);
    let down = target[common..].iter().map(|c| c.as_os_str().to_string_lossy().into_owned());
    up.chain(down).collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_from_the_model_to_its_sources() {
        let from = |file: &str, to: &str| relative(Path::new(file), Path::new(to));
        assert_eq!(from("models/a.toml", "demos/a"), "../demos/a");
        assert_eq!(from("a.toml", "demos/a.csv"), "demos/a.csv");
        let here = std::path::absolute("demos/a.csv").expect("a working folder");
        assert_eq!(relative(Path::new("a.toml"), &here), "demos/a.csv");
        assert_eq!(from("/x/y/a.toml", "/x/b.csv"), "../b.csv");
    }
}
