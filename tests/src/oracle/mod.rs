//! A second evaluation of the method, written from `docs/method.md` alone.
//!
//! It shares no code with the core, runs in `f64` on the standard math library, takes its dimension at run
//! time, and uses other algebra wherever the page leaves a choice: the modulation is an explicit E D E^-1
//! with a matrix inverse, rounded shapes are found by bisection, the Gaussians use covariance matrices, the weights are ratios, the directional mean
//! is a mean of rotations. What two such programs agree on is the page, not a shared slip.
//!
//! Some inputs lie on a switch of the method (a soft shell, an unusable reference point), where rounding alone
//! decides; [`Evaluation::switches`] says how far each switch is, so that a comparison can leave those out.

mod adaptation;
mod carry;
mod cluster;
mod combination;
mod error;
mod evaluation;
mod geometry;
mod guard;
mod limits;
mod modulation;
mod motion;
mod obstacle;
mod polygon;
pub mod random_scene;
mod scan;
mod scene;
mod shape;

#[cfg(test)]
mod properties;

pub use carry::carried;
pub use cluster::{OracleCluster, Sharing, clusters, lean, pair_reference, refer, reference_in_world, sharing};
pub use error::OracleError;
pub use evaluation::{Evaluation, ObstacleView, Region, Switches, evaluate};
pub use guard::{Guarded, HalfSpace, HalfSpaces, Violation, guarded, half_spaces, violations};
pub use scene::{
    OracleComponent, OracleDrift, OracleLimits, OracleMethod, OracleMotion, OracleObstacle, OracleRotation, OracleScan,
    OracleScene, OracleShape, OracleSpin, OracleSteering, OracleTick,
};
