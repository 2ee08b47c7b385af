//! Everything that can be wrong with demonstrations, each said in one sentence.

use std::io;

/// Why demonstrations could not be read or a skill could not be learnt.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum LearnError {
    /// The file or folder cannot be opened.
    #[error("{file}: cannot be read: {problem}")]
    Unreadable {
        /// Path as given.
        file: String,
        /// What the system said.
        problem: io::Error,
    },
    /// The name of the file says nothing about its format.
    #[error("{file}: unknown format; demonstrations are .mat, .npz or .csv files, or folders of them")]
    UnknownFormat {
        /// Path as given.
        file: String,
    },
    /// A folder without demonstrations, or no path at all.
    #[error("{file}: no demonstrations here; .mat, .npz or .csv files are needed")]
    NoDemonstrations {
        /// Path as given.
        file: String,
    },
    /// The bytes are not a MATLAB file this reader understands.
    #[error("{file}: not a readable MATLAB file: {reason}")]
    NotMat {
        /// Path as given.
        file: String,
        /// What is wrong with the bytes.
        reason: super::read::mat::MatError,
    },
    /// The bytes are not a NumPy archive this reader understands.
    #[error("{file}: not a readable .npz archive: {reason}")]
    NotNpz {
        /// Path as given.
        file: String,
        /// What is wrong with the bytes.
        reason: super::read::zip::ZipError,
    },
    /// A file larger than a recording of demonstrations is.
    #[error("{file}: it is larger than 512 MiB; thin it out, a few hundred samples a second are plenty")]
    TooLarge {
        /// Path as given.
        file: String,
    },
    /// A MATLAB file or NumPy archive, but not one of demonstrations.
    #[error("{file}: `{field}` {problem}; allowed is {allowed}")]
    Field {
        /// Path as given.
        file: String,
        /// Variable, array or field, such as `demos{3}.pos`.
        field: String,
        /// What is wrong with it.
        problem: String,
        /// What it should be.
        allowed: &'static str,
    },
    /// A line of a CSV file is wrong.
    #[error("{file}, line {line}: {problem}; allowed is {allowed}")]
    Line {
        /// Path as given.
        file: String,
        /// Line, from 1.
        line: u64,
        /// What is wrong.
        problem: String,
        /// What it should be.
        allowed: &'static str,
    },
    /// A whole demonstration is unusable.
    #[error("{demonstration}: {problem}; allowed is {allowed}")]
    Demonstration {
        /// Where it comes from: file and number.
        demonstration: String,
        /// What is wrong.
        problem: String,
        /// What it should be.
        allowed: &'static str,
    },
    /// The demonstrations do not lead to one place.
    #[error(
        "{demonstration} ends {distance:.4} m from the mean end point; \
         allowed is 5 % of the extent, {allowed:.4} m, for one skill has one attractor"
    )]
    EndsApart {
        /// The demonstration that ends farthest from the others.
        demonstration: String,
        /// Its distance from the mean end, in metres.
        distance: f64,
        /// The largest distance allowed, in metres.
        allowed: f64,
    },
    /// An option is out of its range.
    #[error("{option} = {value}; allowed is {allowed}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// The value given.
        value: String,
        /// Its range.
        allowed: &'static str,
    },
    /// A model to which a demonstration cannot be added.
    #[error(
        "{model}: no demonstration can be added: {problem}, and it does not say where its motions begin; learn from all demonstrations at once"
    )]
    Forgotten {
        /// Path of the model.
        model: String,
        /// Why.
        problem: String,
    },
    /// The convex programme found no motion.
    #[error("no stable motion could be fitted: {reason}")]
    Fit {
        /// What the solver said.
        reason: String,
    },
    /// The fitted numbers do not make a model.
    #[error("the learnt model is not usable: {0}")]
    Model(#[from] crate::model::FieldError),
}
