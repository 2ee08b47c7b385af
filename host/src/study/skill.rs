//! The motions that are studied: learnt from LASA handwriting where it is at hand, or the project's own in their place.

use std::path::Path;

use nalgebra::{Vector2, Vector3};
use pliant_core::{Motion, Vector};

use super::parallel;
use crate::error::Error;
use crate::learn;
use crate::model::ModelFile;

/// A motion of the plane with the path it takes from its start.
#[derive(Clone, Debug)]
pub struct Skill {
    /// As the paper calls it.
    pub name: &'static str,
    /// What it was learnt from, for people.
    pub origin: String,
    /// Its model.
    pub model: ModelFile,
    /// The model as text.
    pub text: String,
    /// Where demonstrations start, in the mean, m.
    pub start: Vector2<f64>,
    /// The way from there with nothing in between, one point a millimetre, m.
    pub path: Vec<Vector2<f64>>,
    /// When it is there, s.
    pub times: Vec<f64>,
}

/// A place on a skill's path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// m
    pub at: Vector2<f64>,
    /// Unit direction of the motion.
    pub along: Vector2<f64>,
}

impl Place {
    /// The unit vector to the left of the motion.
    pub fn left(&self) -> Vector2<f64> {
        Vector2::new(-self.along.y, self.along.x)
    }
    /// The angle of the motion, rad.
    pub fn heading(&self) -> f64 {
        self.along.y.atan2(self.along.x)
    }
}

/// m
const STEP: f64 = 1e-3;

impl Skill {
    /// A model with the path from a start.
    ///
    /// # Errors
    /// The model is not stable, or not one of the plane.
    pub fn new(name: &'static str, origin: String, model: ModelFile, start: Vector2<f64>) -> Result<Self, Error> {
        let motion = Motion::Lpv(model.certify::<f64, 2>()?);
        let (mut at, mut path, mut times, mut time) = (start, vec![start], vec![0.0], 0.0);
        // No skill is 10 m long; one that is ends there.
        while path.len() < 10_000 && (at - motion.attractor()).norm() > STEP {
            let velocity = motion.velocity(&Vector::from(at));
            let middle = motion.velocity(&Vector::from(at + unit(&velocity) * (STEP / 2.0)));
            at += unit(&middle) * STEP;
            // Where it stands still there is no path to go on with.
            time += STEP / middle.norm().max(1e-6);
            path.push(at);
            times.push(time);
        }
        Ok(Self { name, origin, text: model.to_toml()?, model, start, path, times })
    }

    /// The place at a share of the path's length.
    pub fn place(&self, share: f64) -> Place {
        let last = self.path.len().saturating_sub(2);
        let i = ((share.clamp(0.0, 1.0) * last as f64) as usize).min(last);
        let (a, b) = (self.path.get(i).copied().unwrap_or(self.start), self.path.get(i + 1).copied());
        Place { at: a, along: unit(&(b.unwrap_or(a) - a)) }
    }

    /// When the motion is at a share of its path's length if nothing is in its way, s.
    pub fn time(&self, share: f64) -> f64 {
        let last = self.times.len().saturating_sub(1);
        self.times.get((share.clamp(0.0, 1.0) * last as f64) as usize).copied().unwrap_or_default()
    }

    /// How far a point is from the path, m.
    pub fn distance(&self, p: &Vector2<f64>) -> f64 {
        self.path.iter().map(|q| (p - q).norm_squared()).fold(f64::INFINITY, f64::min).sqrt()
    }

    /// Where it ends, m.
    pub fn goal(&self) -> Vector2<f64> {
        Vector2::from_fn(|i, _| self.model.attractor.get(i).copied().unwrap_or_default())
    }

    /// The path in three entries a point.
    pub fn path_in_space(&self) -> Vec<Vector3<f64>> {
        self.path.iter().map(|p| p.push(0.0)).collect()
    }
}

fn unit(v: &Vector2<f64>) -> Vector2<f64> {
    v.try_normalize(0.0).unwrap_or_default()
}

/// The motions of the paper.
#[derive(Clone, Debug)]
pub struct Skills {
    /// Its S-shape, for all but what follows.
    pub s: Skill,
    /// Its Angle.
    pub angle: Skill,
    /// Its Leaf.
    pub leaf: Skill,
    /// Its own recording with five obstacles; here always the project's arch, for that recording is not published.
    pub recorded: Skill,
    /// What that was learnt from, m.
    pub recordings: Vec<Vec<Vector2<f64>>>,
    /// Is this LASA handwriting?
    pub lasa: bool,
}

/// A skill that is compiled in: name, model, start.
const OWN: [(&str, &str, [f64; 2]); 3] = [
    ("sbend", include_str!("../../../models/sbend.toml"), [0.37, 0.41]),
    ("arch", include_str!("../../../models/arch.toml"), [-0.42, -0.02]),
    ("hook", include_str!("../../../models/hook.toml"), [0.26, 0.28]),
];
/// The demonstrations of the arch, as they are in `demos/arch`.
const ARCH: [(&str, &str); 7] = [
    ("arch-1.csv", include_str!("../../../demos/arch/arch-1.csv")),
    ("arch-2.csv", include_str!("../../../demos/arch/arch-2.csv")),
    ("arch-3.csv", include_str!("../../../demos/arch/arch-3.csv")),
    ("arch-4.csv", include_str!("../../../demos/arch/arch-4.csv")),
    ("arch-5.csv", include_str!("../../../demos/arch/arch-5.csv")),
    ("arch-6.csv", include_str!("../../../demos/arch/arch-6.csv")),
    ("arch-7.csv", include_str!("../../../demos/arch/arch-7.csv")),
];
/// What the paper calls them, and the files of the LASA set.
const NAMES: [(&str, &str); 3] = [("S-shape", "Sshape.mat"), ("Angle", "Angle.mat"), ("Leaf", "Leaf_1.mat")];

impl Skills {
    /// Learnt from the files `Sshape.mat`, `Angle.mat` and `Leaf_1.mat` of a folder, one unit of theirs as a centimetre; without a folder the
    /// project's own in their place.
    ///
    /// # Errors
    /// A file that is missing or no skill.
    pub fn new(lasa: Option<&Path>, done: &(dyn Fn(usize) + Sync)) -> Result<Self, Error> {
        let numbers: Vec<usize> = (0..NAMES.len()).collect();
        let three = parallel::map(&numbers, done, |i| match lasa {
            Some(folder) => learnt(folder, *i),
            None => own(*i, NAMES[*i].0),
        })?;
        let [s, angle, leaf] = <[Skill; 3]>::try_from(three).map_err(|_| Error::failed("there are three skills"))?;
        let (recorded, recordings) = (own(1, "recorded")?, recordings()?);
        Ok(Self { s, angle, leaf, recorded, recordings, lasa: lasa.is_some() })
    }

    /// The three of the paper's first figure.
    pub fn three(&self) -> [&Skill; 3] {
        [&self.s, &self.angle, &self.leaf]
    }
}

fn own(i: usize, name: &'static str) -> Result<Skill, Error> {
    let (file, text, [x, y]) = OWN[i];
    let origin = format!("models/{file}.toml");
    let model = ModelFile::parse(&origin, text)?;
    Skill::new(name, origin, model, Vector2::new(x, y))
}

fn recordings() -> Result<Vec<Vec<Vector2<f64>>>, Error> {
    let mut all = Vec::new();
    for (name, text) in ARCH {
        for d in learn::read::csv::read(name, text.as_bytes())? {
            all.push(d.x.iter().map(|x| Vector2::from_fn(|i, _| x.get(i).copied().unwrap_or_default())).collect());
        }
    }
    Ok(all)
}

fn learnt(folder: &Path, i: usize) -> Result<Skill, Error> {
    let (name, file) = NAMES[i];
    // Ten times the size of the handwriting: about the table's.
    let unit = Some(learn::Unit::Cm);
    let options = learn::Options { name: name.to_lowercase(), unit, ..learn::Options::default() };
    let learnt = learn::learn(&[folder.join(file)], &options, &|_| {})?;
    let starts: Vec<Vector2<f64>> = learnt
        .demonstrations
        .items()
        .iter()
        .filter_map(|d| Some(Vector2::new(*d.x.first()?.get(0)?, d.x[0][1])))
        .collect();
    let mean = starts.iter().sum::<Vector2<f64>>() / starts.len().max(1) as f64;
    Skill::new(name, format!("LASA handwriting, {file}"), learnt.model, mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn our_own_skills_have_paths_from_their_start_to_their_goal() {
        let skills = Skills::new(None, &|_| {}).unwrap();
        assert_eq!(skills.recordings.len(), ARCH.len());
        for demonstration in &skills.recordings {
            // Each starts near where the motion is driven from, and ends at its goal.
            let (first, last) = (demonstration.first().unwrap(), demonstration.last().unwrap());
            assert!((first - skills.recorded.start).norm() < 0.05 && (last - skills.recorded.goal()).norm() < 0.02);
        }
        for skill in skills.three().into_iter().chain([&skills.recorded]) {
            assert_eq!(skill.place(0.0).at, skill.start);
            assert!((skill.place(1.0).at - skill.goal()).norm() < 3.0 * STEP, "{}", skill.name);
            assert!(skill.path.windows(2).all(|w| ((w[1] - w[0]).norm() - STEP).abs() < 1e-9));
            assert!(skill.times.windows(2).all(|w| w[1] > w[0]) && skill.time(1.0) > 1.0);
            let place = skill.place(0.4);
            assert!((place.along.norm() - 1.0).abs() < 1e-12 && place.along.dot(&place.left()).abs() < 1e-12);
            assert_eq!(skill.distance(&place.at), 0.0);
            let beside = skill.distance(&(place.at + place.left() * 0.01));
            assert!(beside > 0.008 && beside < 0.0101, "{beside}");
        }
    }
}
