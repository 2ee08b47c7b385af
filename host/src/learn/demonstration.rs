//! Demonstrations: checked, in metres, and ending in one attractor.

use super::cleaning::{MOST_SAMPLES, Samples};
use super::error::LearnError;
use super::outlier;
use super::smoothing;
use super::warning::Warning;
use nalgebra::DVector;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// How far demonstrations may end from their mean end, as a part of the extent of the skill.
pub const END_TOLERANCE: f64 = 0.05;
/// From here on, as a part of the extent, a person is told that they end apart.
const ENDS_DIFFER: f64 = 0.02;
/// Fewer samples than these are too few to know the motion by.
const FEW: usize = 20;
/// A step between two samples of this part of the size is a gap.
const JUMP: f64 = 0.2;
/// Noise of this part of the size is much.
const NOISY: f64 = 0.01;
/// Rates that differ by less than this factor are left as they are.
const LIKE_RATES: f64 = 3.0;
/// Extents of skills, m: beyond them the unit is probably another.
const USUAL_EXTENTS: std::ops::RangeInclusive<f64> = 0.005..=10.0;
/// Mean speeds of skills, m/s.
const USUAL_SPEEDS: std::ops::RangeInclusive<f64> = 0.001..=10.0;
/// No demonstration lasts as long, s: its times are in another unit.
const LONGEST: f64 = 1e9;

/// The unit of lengths in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
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

impl std::fmt::Display for Unit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Unit::Mm => "mm",
            Unit::Cm => "cm",
            Unit::M => "m",
        })
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
    /// What a person should know about it.
    pub warnings: Vec<Warning>,
}

impl Demonstration {
    /// Checks one recording and cleans it: exact repeats and rests are left out, of more than 2000 samples means
    /// are taken, and velocities that are not given are computed from the positions.
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

        let mut warnings = Vec::new();
        let mut samples = Samples { t, x, v };
        let mut repeats = vec![false; n];
        for (i, repeat) in repeats.iter_mut().enumerate().skip(1) {
            // Repeats have the time of the sample that is kept, so the one before is as good.
            let (before, now) = (samples.t[i - 1], samples.t[i]);
            *repeat = now == before && samples.x[i] == samples.x[i - 1];
            if !*repeat && now <= before {
                return fail(format!("time goes from {before} to {now} at sample {}", i + 1), "time that increases");
            }
        }
        let count = repeats.iter().filter(|r| **r).count();
        samples.retain(|i| !repeats[i]);
        if samples.len() < 2 {
            return fail("it has one sample".into(), "2 samples or more");
        }
        if count > 0 {
            warnings.push(Warning::Repeated { demonstration: name.clone(), count, samples: n });
        }
        let size = samples.size();
        if size == 0.0 {
            return fail("it never moves".into(), "a motion");
        }
        if !(size.is_finite() && samples.duration().is_finite()) {
            return fail("its values overflow".into(), "positions of a robot and times in seconds");
        }
        if samples.duration() > LONGEST {
            return fail(
                format!("it lasts {:e} s", samples.duration()),
                "times in seconds, 1e9 from first to last at most",
            );
        }
        // As the file counts them.
        let number = |i: usize| 1 + (0..n).filter(|i| !repeats[*i]).nth(i).unwrap_or(i);
        let absurd = outlier::velocity(&samples).map(|(i, speed, fastest)| (number(i), samples.t[i], speed, fastest));
        // Given velocities that never go along with the positions cannot be meant, whatever their unit.
        if velocity_factor(&samples).is_some_and(|factor| factor <= 0.0) {
            let problem = match absurd {
                None => "its velocities do not go where its positions do".into(),
                Some((sample, t, speed, fastest)) => format!(
                    "the velocity of sample {sample} (t = {t}) is {speed:.4} m/s, where positions move at {fastest:.4} m/s at most"
                ),
            };
            return fail(problem, "velocities along the motion");
        }
        if let Some((i, distance)) = outlier::place(&samples) {
            let (sample, t) = (number(i), samples.t[i]);
            warnings.push(Warning::Off { demonstration: name.clone(), sample, t, distance });
        }
        if let Some((sample, t, speed, fastest)) = absurd {
            warnings.push(Warning::Absurd { demonstration: name.clone(), sample, t, speed, fastest });
        }
        if samples.len() < FEW {
            warnings.push(Warning::Few { demonstration: name.clone(), samples: samples.len(), wanted: FEW });
        }
        let samples = clean(&name, samples, size, &mut warnings);
        Ok(Self::from_samples(name, samples, warnings))
    }

    fn from_samples(name: String, samples: Samples, warnings: Vec<Warning>) -> Self {
        let Samples { t, x, v } = samples;
        let v = v.unwrap_or_else(|| smoothing::velocities(&t, &x, smoothing::half_width(t.len())));
        Self { name, t, x, v, warnings }
    }

    /// Samples a second.
    fn rate(&self) -> f64 {
        (self.t.len() - 1) as f64 / self.duration()
    }

    /// The same recording with its number of samples multiplied by `factor`.
    fn resampled(self, factor: f64) -> Self {
        let count = (self.t.len() as f64 * factor).round().clamp(2.0, MOST_SAMPLES as f64) as usize;
        let samples = Samples { t: self.t, x: self.x, v: Some(self.v) };
        let samples = if factor < 1.0 { samples.thinned(count) } else { samples.interpolated(count) };
        Self::from_samples(self.name, samples, self.warnings)
    }

    /// The same recording with lengths multiplied by `factor`.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.x.iter_mut().chain(&mut self.v).for_each(|p| *p *= factor);
        self
    }

    /// Length of the path.
    pub fn length(&self) -> f64 {
        self.x.windows(2).map(|w| (&w[1] - &w[0]).norm()).sum()
    }

    /// Seconds from the first to the last sample.
    pub fn duration(&self) -> f64 {
        self.t.last().copied().unwrap_or(0.0) - self.t.first().copied().unwrap_or(0.0)
    }
}

/// Leaves out what is no motion, and bounds the number of samples.
fn clean(name: &str, mut samples: Samples, size: f64, warnings: &mut Vec<Warning>) -> Samples {
    let demonstration = || name.to_owned();
    let held = samples.held();
    if samples.v.is_none() && samples.len() > 20 && 2 * held > samples.len() {
        let (kept, all) = (samples.len() - held, samples.len());
        warnings.push(Warning::Held { demonstration: demonstration(), kept, samples: all });
        let changes: Vec<bool> = (0..all).map(|i| i == 0 || i + 1 == all || samples.x[i] != samples.x[i - 1]).collect();
        samples.retain(|i| changes[i]);
    }
    let begin = samples.t[0];
    let rests = samples.rests();
    for rest in &rests {
        let (at, seconds) = (rest.from - begin, rest.to - rest.from);
        warnings.push(Warning::Rest { demonstration: demonstration(), at, seconds });
    }
    let moving = samples.clone().without(&rests);
    // A motion that is all rests is slow, not still.
    let mut samples = if moving.len() >= 2 && moving.size() > 0.5 * size { moving } else { samples };
    // A step to a sample that is named already is no gap of its own, nor is a factor that comes of one velocity all velocities'.
    let (off, absurd) = warnings.iter().fold((false, false), |(off, absurd), w| {
        (off || matches!(w, Warning::Off { .. }), absurd || matches!(w, Warning::Absurd { .. }))
    });
    if let Some((i, step)) = samples.largest_step()
        && samples.len() > 20
        && step > JUMP * size
        && !off
    {
        warnings.push(Warning::Jump { demonstration: demonstration(), at: samples.t[i] - begin, part: step / size });
    }
    samples = samples.thinned(MOST_SAMPLES);
    let part = samples.noise() / size;
    if part > NOISY {
        warnings.push(Warning::Noise { demonstration: demonstration(), part });
    }
    if let Some(factor) = velocity_factor(&samples)
        && !(0.5..=2.0).contains(&factor)
        && !absurd
    {
        warnings.push(Warning::Velocity { demonstration: demonstration(), factor });
    }
    samples
}

/// What the positions' velocities have to be multiplied by to match the given ones best.
fn velocity_factor(samples: &Samples) -> Option<f64> {
    let v = samples.v.as_ref()?;
    let (mut products, mut squares) = (0.0, 0.0);
    for i in 1..samples.len() {
        let step = &samples.x[i] - &samples.x[i - 1];
        let mean = (&v[i] + &v[i - 1]) * (0.5 * (samples.t[i] - samples.t[i - 1]));
        products += mean.dot(&step);
        squares += step.norm_squared();
    }
    (squares > 0.0 && products.is_finite()).then(|| products / squares)
}

/// All demonstrations of one skill, shifted so that each ends at the attractor.
#[derive(Debug, Clone, PartialEq)]
pub struct Demonstrations {
    items: Vec<Demonstration>,
    attractor: DVector<f64>,
    extent: f64,
    shifts: Vec<f64>,
    warnings: Vec<Warning>,
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
        let mut warnings: Vec<Warning> = items.iter_mut().flat_map(|i| std::mem::take(&mut i.warnings)).collect();
        warnings.extend(repeated(&items));
        items = with_like_rates(items, &mut warnings);
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
                demonstration: items[0].name.clone(),
                problem: "positions overflow".into(),
                allowed: "positions of a robot, in metres",
            });
        }
        if let Some(far) = items.iter().find(|i| i.x.iter().any(|p| p.amax() > pliant_core::RANGE)) {
            return Err(LearnError::Demonstration {
                demonstration: far.name.clone(),
                problem: format!("it reaches {:.4e} m", far.x.iter().fold(0.0, |most, p| p.amax().max(most))),
                allowed: "-1000 to 1000 m; declare the unit with --unit mm, cm or m",
            });
        }
        let allowed = END_TOLERANCE * extent;
        let farthest = ends.iter().map(|e| (e - &mean).norm()).enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((i, distance)) = farthest
            && distance > ENDS_DIFFER * extent
        {
            let demonstration = items[i].name.clone();
            if distance > allowed {
                return Err(LearnError::EndsApart { demonstration, distance, allowed });
            }
            warnings.push(Warning::EndsDiffer { demonstration, distance, allowed });
        }
        if !USUAL_EXTENTS.contains(&extent) {
            warnings.push(Warning::Size { extent });
        }
        let duration: f64 = items.iter().map(Demonstration::duration).sum();
        let speed = items.iter().map(Demonstration::length).sum::<f64>() / duration;
        if !USUAL_SPEEDS.contains(&speed) {
            warnings.push(Warning::Speed { speed });
        }
        let mut shifts = Vec::with_capacity(items.len());
        for (item, end) in items.iter_mut().zip(&ends) {
            let shift = &attractor - end;
            item.x.iter_mut().for_each(|p| *p += &shift);
            shifts.push(shift.norm());
        }
        Ok(Self { items, attractor, extent, shifts, warnings })
    }

    /// What a person should know about them.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// The recordings.
    pub fn items(&self) -> &[Demonstration] {
        &self.items
    }

    /// How far each was shifted to end there, m.
    pub fn shifts(&self) -> &[f64] {
        &self.shifts
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

    /// Where each begins.
    pub fn starts(&self) -> Vec<Vec<f64>> {
        self.items.iter().map(|i| i.x[0].iter().copied().collect()).collect()
    }

    /// Number of samples in all recordings.
    pub fn samples(&self) -> usize {
        self.items.iter().map(|i| i.t.len()).sum()
    }
}

/// Is a recording there more than once?
fn repeated(items: &[Demonstration]) -> Option<Warning> {
    let bits = |d: &Demonstration| -> Vec<u64> {
        d.t.iter().chain(d.x.iter().flat_map(|p| p.iter())).map(|c| c.to_bits()).collect()
    };
    let mut known = HashMap::new();
    let mut again = Vec::new();
    for item in items {
        match known.entry(bits(item)) {
            Entry::Vacant(new) => _ = new.insert(item),
            Entry::Occupied(first) => again.push((item, *first.get())),
        }
    }
    let (item, first) = again.first()?;
    Some(Warning::Again {
        demonstration: item.name.clone(),
        first: first.name.clone(),
        count: again.len(),
        demonstrations: items.len(),
    })
}

/// Brings recordings to the rate of the others where it is very different, so that a fast recorder does not outvote the rest.
fn with_like_rates(items: Vec<Demonstration>, warnings: &mut Vec<Warning>) -> Vec<Demonstration> {
    let mut rates: Vec<f64> = items.iter().map(Demonstration::rate).collect();
    rates.sort_by(f64::total_cmp);
    let others = rates[rates.len() / 2];
    items
        .into_iter()
        .map(|item| {
            let rate = item.rate();
            if (others / LIKE_RATES..=others * LIKE_RATES).contains(&rate) {
                return item;
            }
            warnings.push(Warning::Rate { demonstration: item.name.clone(), rate, others });
            item.resampled(others / rate)
        })
        .collect()
}

#[cfg(test)]
mod tests;
