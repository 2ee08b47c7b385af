//! From the tables of a file to a [`Scene`]: every check there is.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use pliant_core::{Ageing, Guard, Limits, RANGE};
use toml::Spanned;

use super::error::{SceneError, SceneErrorKind as Kind, Source};
use super::file::{
    AgeingFile, DsFile, GoalFile, GuardFile, LimitsFile, MethodFile, ModulationFile, Number, Numbers, SteeringFile,
};
use super::motion::point;
use super::obstacle::SceneObstacle;
use super::{Goal, MAX_OBSTACLES, Method, Modulation, MotionSource, Scene, Steering, syntax};
use crate::model::Text;

mod obstacle;
mod places;
mod shape;
mod track;

/// How a model's text is got, by its path relative to the scene: where it was found, and what it says.
type ReadModel<'a> = &'a dyn Fn(&Path) -> io::Result<(PathBuf, String)>;

pub(super) fn scene(name: &str, text: &str, read_model: ReadModel<'_>) -> Result<Scene, SceneError> {
    let source = Source { name, text };
    let file = syntax::read(&source)?;
    let (motion, dimension) = motion(&source, &file.ds, read_model)?;
    let check = Check { source, dimension };
    let modulation = check.modulation(&file.modulation)?;
    let limits = check.limits(&file.limits)?;
    let ageing = check.ageing(&file.ageing)?;
    let guard = check.guard(&file.guard)?;
    let goal = check.goal(&file.goal)?;
    let target = check.attractor(file.attractor.as_ref(), motion.attractor(), goal.timeout)?;
    if let Some(extra) = file.obstacle.get(MAX_OBSTACLES) {
        let problem = format!("is there {} times", file.obstacle.len());
        return Err(check.error(Kind::Value, "obstacle", extra.span(), problem));
    }
    let mut obstacles: Vec<SceneObstacle> = Vec::with_capacity(file.obstacle.len());
    for (id, o) in (0..).zip(&file.obstacle) {
        obstacles.push(check.obstacle(id, o, &obstacles, &target, goal.timeout)?);
    }
    let scan = file.scan.as_ref().map(|scan| check.scan(scan, &target)).transpose()?;
    if file.start.is_empty() {
        let problem = "is missing, and there is no default for it";
        return Err(check.error(Kind::Missing, "start", 0..0, problem));
    }
    let start = |s: &Spanned<_>| check.start(s.get_ref(), &obstacles, scan.as_ref());
    let starts = file.start.iter().map(start).collect::<Result<_, _>>()?;
    let stem = Path::new(name).file_stem().map(|stem| stem.to_string_lossy().into_owned());
    Ok(Scene {
        name: stem.unwrap_or_else(|| name.to_owned()),
        dimension,
        motion,
        modulation,
        limits,
        ageing,
        guard,
        goal,
        target,
        starts,
        obstacles,
        scan,
    })
}

fn motion(
    source: &Source<'_>,
    ds: &Spanned<DsFile>,
    read_model: ReadModel<'_>,
) -> Result<(MotionSource, usize), SceneError> {
    match (&ds.get_ref().model, &ds.get_ref().linear) {
        (Some(path), None) => model(source, path, read_model),
        (None, Some(linear)) => {
            let linear = linear.get_ref();
            let field = "ds.linear.attractor";
            let dimension = linear.attractor.get_ref().len();
            if !(2..=3).contains(&dimension) {
                let problem = format!("has {dimension} numbers");
                return Err(source.error(Kind::Dimension, field, linear.attractor.span(), problem));
            }
            let check = Check { source: Source { ..*source }, dimension };
            let attractor = check.point(&linear.attractor, field)?;
            let gain = check.number(&linear.gain, "ds.linear.gain", Above(0.0), 1000.0)?;
            Ok((MotionSource::Linear { attractor, gain }, dimension))
        }
        (Some(_), Some(linear)) => {
            let problem = "is there beside `model`: one of the two";
            Err(source.error(Kind::Conflict, "ds.linear", linear.span(), problem).allowing(either()))
        }
        (None, None) => Err(source.error(Kind::Missing, "ds", ds.span(), "names no motion")),
    }
}

fn either() -> &'static str {
    super::fields::allowed("ds").unwrap_or_default()
}

fn model(
    source: &Source<'_>,
    path: &Spanned<String>,
    read_model: ReadModel<'_>,
) -> Result<(MotionSource, usize), SceneError> {
    let error = |problem: String| source.error(Kind::Model, "ds.model", path.span(), problem);
    let (found, text) = read_model(Path::new(path.get_ref()))
        .map_err(|e| error(format!("the model `{}` cannot be read: {e}", path.get_ref())))?;
    let refused =
        |e: crate::model::ModelFileError| error(format!("the model `{}` cannot be used", path.get_ref())).because(e);
    let text = Text::new(found.display().to_string(), text);
    let model = text.model().map_err(refused)?;
    // The certificate has to hold in whichever precision the scene is going to run.
    model.is_certified().map_err(|e| refused(text.locate(e)))?;
    let dimension = model.dimension;
    Ok((MotionSource::Model { path: found, model: Box::new(model) }, dimension))
}

/// The lower end of a range.
enum Low {
    From(f64),
    Above(f64),
}
use Low::{Above, From};

/// The checks, with what all of them need to know.
struct Check<'a> {
    source: Source<'a>,
    dimension: usize,
}

impl Check<'_> {
    fn error(&self, kind: Kind, field: &str, span: Range<usize>, problem: impl Into<String>) -> SceneError {
        self.source.error(kind, field, span, problem)
    }

    fn number(&self, number: &Number, field: &str, low: Low, high: f64) -> Result<f64, SceneError> {
        let x = *number.get_ref();
        let problem = if !x.is_finite() {
            format!("{x} is not a finite number")
        } else if match low {
            From(low) => x < low,
            // A device has it in single precision, where it has to be above as well.
            Above(low) => f64::from(x as f32) <= low,
        } {
            format!("{x} is too small")
        } else if x > high {
            format!("{x} is too large")
        } else {
            return Ok(x);
        };
        Err(self.error(Kind::Value, field, number.span(), problem))
    }

    fn optional(
        &self,
        number: &Option<Number>,
        field: &str,
        low: Low,
        high: f64,
        default: f64,
    ) -> Result<f64, SceneError> {
        number.as_ref().map_or(Ok(default), |n| self.number(n, field, low, high))
    }

    /// One number for each dimension, each in a range.
    fn numbers(&self, numbers: &Numbers, field: &str, low: f64, high: f64) -> Result<Vector3<f64>, SceneError> {
        let found = numbers.get_ref();
        if found.len() != self.dimension {
            let s = if found.len() == 1 { "" } else { "s" };
            let problem = format!("has {} number{s}, but the scene has {} dimensions", found.len(), self.dimension);
            return Err(self.error(Kind::Dimension, field, numbers.span(), problem));
        }
        let checked: Vec<f64> =
            found.iter().map(|n| self.number(n, field, From(low), high)).collect::<Result<_, _>>()?;
        Ok(point(&checked))
    }

    fn point(&self, numbers: &Numbers, field: &str) -> Result<Vector3<f64>, SceneError> {
        self.numbers(numbers, field, -RANGE, RANGE)
    }

    fn modulation(&self, file: &ModulationFile) -> Result<Modulation, SceneError> {
        let method = match file.method {
            None | Some(MethodFile::Deformable) => Method::Deformable,
            Some(MethodFile::Original) => Method::Original,
        };
        let steering = match (&file.steering, &file.beta) {
            (Some(SteeringFile::Fixed(_)), Some(beta)) => {
                let problem = "is there beside a fixed steering, which has no such bound";
                return Err(self.error(Kind::Conflict, "modulation.beta", beta.span(), problem));
            }
            (Some(SteeringFile::Fixed(angle)), None) => {
                Steering::Fixed { angle: self.number(angle, "modulation.steering.fixed", From(-RANGE), RANGE)? }
            }
            (None | Some(SteeringFile::WithFlow), beta) => {
                Steering::WithFlow { beta: self.optional(beta, "modulation.beta", From(0.0), 10.0, 1.0)? }
            }
        };
        Ok(Modulation { method, c: self.optional(&file.c, "modulation.c", From(0.0), 10.0, 0.03)?, steering })
    }

    fn limits(&self, file: &LimitsFile) -> Result<Limits<f64>, SceneError> {
        let default = Limits::default();
        let acceleration =
            file.acceleration.as_ref().map(|a| self.number(a, "limits.acceleration", Above(0.0), 1e4)).transpose()?;
        Ok(Limits {
            speed: self.optional(&file.speed, "limits.speed", Above(0.0), 100.0, default.speed)?,
            acceleration,
            deceleration: self.optional(
                &file.deceleration,
                "limits.deceleration",
                Above(0.0),
                1e4,
                default.deceleration,
            )?,
        })
    }

    fn ageing(&self, file: &AgeingFile) -> Result<Ageing<f64>, SceneError> {
        let Ageing { time_to_live, growth, hold } = Ageing::default();
        let ttl = self.optional(&file.time_to_live, "ageing.time_to_live", From(0.0), 3600.0, time_to_live)?;
        // A long life given alone moves the hold time along with it.
        let hold = self.optional(&file.hold, "ageing.hold", From(ttl), 3600.0, hold.max(ttl))?;
        let growth = self.optional(&file.growth, "ageing.growth", From(0.0), 10.0, growth)?;
        Ok(Ageing { time_to_live: ttl, growth, hold })
    }

    fn goal(&self, file: &GoalFile) -> Result<Goal, SceneError> {
        Ok(Goal {
            tolerance: self.optional(&file.tolerance, "goal.tolerance", Above(0.0), RANGE, 0.01)?,
            timeout: self.optional(&file.timeout, "goal.timeout", Above(0.0), 3600.0, 30.0)?,
        })
    }

    fn guard(&self, file: &GuardFile) -> Result<Option<Guard<f64>>, SceneError> {
        let off = file.enabled.as_ref().is_some_and(|enabled| !*enabled.get_ref());
        if let (Some(approach), true) = (&file.approach, off) {
            let problem = "is there beside `enabled = false`";
            return Err(self.error(Kind::Conflict, "guard.approach", approach.span(), problem));
        }
        let approach =
            self.optional(&file.approach, "guard.approach", Above(0.0), 1.0, Guard::<f64>::default().approach)?;
        Ok((!off).then_some(Guard { approach }))
    }
}
