//! What a person should know about demonstrations that can be learnt from all the same.

use crate::error::counted;
use std::fmt;

/// Something that may not be what was meant. Learning goes on.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// Arrays of a file that no reader knows.
    Ignored {
        /// File.
        file: String,
        /// Their names.
        names: String,
    },
    /// Recordings that are there more than once.
    Again {
        /// Where the first of them comes from: file and number.
        demonstration: String,
        /// Where the recording it repeats comes from.
        first: String,
        /// How many repeat another.
        count: usize,
        /// How many demonstrations there are in all.
        demonstrations: usize,
    },
    /// Samples that repeat the one before them, time and all.
    Repeated {
        /// Where it comes from: file and number.
        demonstration: String,
        /// How many there are.
        count: usize,
        /// How many samples there are in all.
        samples: usize,
    },
    /// So few samples that most of the motion is between them.
    Few {
        /// Where it comes from: file and number.
        demonstration: String,
        /// How many there are.
        samples: usize,
        /// As many are asked for.
        wanted: usize,
    },
    /// The position is held over several samples: the sensor is slower than the recorder.
    Held {
        /// Where it comes from: file and number.
        demonstration: String,
        /// Samples with a position of their own.
        kept: usize,
        /// How many samples there are in all.
        samples: usize,
    },
    /// The hand stands still, longer than a stroke needs to turn.
    Rest {
        /// Where it comes from: file and number.
        demonstration: String,
        /// When it begins, in seconds after the first sample.
        at: f64,
        /// How long it lasts, s.
        seconds: f64,
    },
    /// The path has a gap.
    Jump {
        /// Where it comes from: file and number.
        demonstration: String,
        /// The time after the gap, s.
        at: f64,
        /// Its part of the size of the motion.
        part: f64,
    },
    /// One sample lies far off the path.
    Off {
        /// Where it comes from: file and number.
        demonstration: String,
        /// The sample, from 1.
        sample: usize,
        /// Its time as recorded, s.
        t: f64,
        /// How far from the line between its neighbours, m.
        distance: f64,
    },
    /// One velocity is far from that of the positions beside it.
    Absurd {
        /// Where it comes from: file and number.
        demonstration: String,
        /// The sample, from 1.
        sample: usize,
        /// Its time as recorded, s.
        t: f64,
        /// Its speed, m/s.
        speed: f64,
        /// The fastest that positions move, m/s.
        fastest: f64,
    },
    /// Tremor or sensor noise that is large against the motion.
    Noise {
        /// Where it comes from: file and number.
        demonstration: String,
        /// Standard deviation as a part of the size of the motion.
        part: f64,
    },
    /// The velocities in the file are not those of its positions.
    Velocity {
        /// Where it comes from: file and number.
        demonstration: String,
        /// What the positions' velocities have to be multiplied by for the best match.
        factor: f64,
    },
    /// Recorded much faster or slower than the other demonstrations.
    Rate {
        /// Where it comes from: file and number.
        demonstration: String,
        /// Samples a second.
        rate: f64,
        /// Samples a second of the others (their median), to which it is brought.
        others: f64,
    },
    /// End points that lie apart, but within what is allowed.
    EndsDiffer {
        /// The demonstration that ends farthest from the others.
        demonstration: String,
        /// Its distance from the mean end, m.
        distance: f64,
        /// The largest distance allowed, m.
        allowed: f64,
    },
    /// The skill is larger or smaller than what a robot's hand does.
    Size {
        /// Diagonal of the box around all positions, m.
        extent: f64,
    },
    /// The skill is faster or slower than what a robot's hand does.
    Speed {
        /// Mean speed, m/s.
        speed: f64,
    },
    /// The demonstrations that a model was learnt from are gone; what it does stands for them.
    Forgotten {
        /// The model file.
        model: String,
        /// Why.
        problem: String,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::Ignored { file, names } => write!(f, "{file}: {names} not used; docs/learning.md names what is"),
            Warning::Again { demonstration, first, count, demonstrations } => {
                let again = if demonstration == first {
                    "it is given twice".into()
                } else {
                    format!("it is the same as {first}")
                };
                write!(
                    f,
                    "{demonstration}: {again}; of {demonstrations} demonstrations {count} repeat another, which counts the more"
                )
            }
            Warning::Repeated { demonstration, count, samples } => {
                write!(f, "{demonstration}: {count} of {samples} samples repeat the one before them; they are left out")
            }
            Warning::Few { demonstration, samples, wanted } => write!(
                f,
                "{demonstration}: it has {}; with fewer than {wanted} the way between them is a guess",
                counted(*samples, "sample")
            ),
            Warning::Held { demonstration, kept, samples } => write!(
                f,
                "{demonstration}: the position changes only {kept} times in {samples} samples; those between are left out"
            ),
            Warning::Rest { demonstration, at, seconds } => write!(
                f,
                "{demonstration}: it stands still for {seconds:.2} s from {at:.2} s on; a skill has no pauses, so this one is left out"
            ),
            Warning::Jump { demonstration, at, part } => write!(
                f,
                "{demonstration}: it jumps by {:.0} % of its size at {at:.2} s; are samples missing?",
                part * 100.0
            ),
            Warning::Noise { demonstration, part } => write!(
                f,
                "{demonstration}: its positions are noisy (standard deviation {:.1} % of its size); the velocities are smoothed, \
                 and more demonstrations help",
                part * 100.0
            ),
            Warning::Off { demonstration, sample, t, distance } => write!(
                f,
                "{demonstration}: sample {sample} (t = {t}) lies {distance:.4} m off the path between its neighbours, and is learnt from \
                 as it is; if it is not meant, leave it out"
            ),
            Warning::Absurd { demonstration, sample, t, speed, fastest } => write!(
                f,
                "{demonstration}: the velocity of sample {sample} (t = {t}) is {speed:.4} m/s, where positions move at {fastest:.4} m/s at \
                 most; it is learnt from as it is; if it is not meant, leave it out"
            ),
            Warning::Velocity { demonstration, factor } => write!(
                f,
                "{demonstration}: its velocities are {factor:.3} times those of its positions; are both in one unit, and t in \
                 seconds?"
            ),
            Warning::Rate { demonstration, rate, others } => write!(
                f,
                "{demonstration}: recorded at {rate:.4} samples a second, the others at {others:.4}; it is brought to their rate, \
                 so that each counts alike"
            ),
            Warning::EndsDiffer { demonstration, distance, allowed } => write!(
                f,
                "{demonstration}: it ends {distance:.4} m from the mean end point ({allowed:.4} m is the limit); all are shifted \
                 to end there"
            ),
            Warning::Size { extent } => write!(
                f,
                "the demonstrations are {extent:.4} m across; if that is not meant, declare the unit with --unit mm, cm or m"
            ),
            Warning::Speed { speed } => write!(
                f,
                "the demonstrations move at {speed:.4} m/s on average; if that is not meant, are times in seconds and is the unit right?"
            ),
            Warning::Forgotten { model, problem } => write!(
                f,
                "{model}: {problem}; motions of the model itself stand for the demonstrations it was learnt from"
            ),
        }
    }
}
