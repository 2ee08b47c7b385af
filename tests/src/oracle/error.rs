use std::fmt;

/// Why the oracle has no answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OracleError {
    /// The dimension is neither 2 nor 3.
    Dimension(usize),
    /// A vector or matrix does not have the scene's dimension.
    Shape(&'static str),
    /// A number is not finite, or outside what the method allows.
    Value(&'static str),
    /// A matrix that must be inverted is singular.
    Singular(&'static str),
}

impl fmt::Display for OracleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Dimension(d) => write!(f, "dimension {d} is neither 2 nor 3"),
            Self::Shape(what) => write!(f, "{what} does not have the dimension of the scene"),
            Self::Value(what) => write!(f, "{what} is not a permitted value"),
            Self::Singular(what) => write!(f, "{what} has no inverse"),
        }
    }
}

impl std::error::Error for OracleError {}
