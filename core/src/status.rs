//! What a tick says about itself: where the robot is ([`Region`]), and what was out of the ordinary ([`Status`]).
//!
//! Gamma and Gamma_k are those of [`obstacle`](crate::obstacle). Which stage sets which flag is on the page of
//! [`Controller::tick`](crate::Controller::tick).

use bitflags::bitflags;

/// Where the robot is, as far as obstacles go. Without [`Settings::deformable`](crate::Settings::deformable) no layer
/// counts as soft.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Region {
    /// Outside every obstacle, soft layers included: Gamma > 1 and Gamma_k > 1 of all.
    #[default]
    Free,
    /// In the soft layer of exactly one obstacle, Gamma_k <= 1, and in no core.
    Soft,
    /// Where the soft layers of two or more obstacles overlap, and in no core.
    Intersection,
    /// In or on a hard core or within the radius of a scan's point: Gamma <= 1, safety factors, growth and ageing
    /// included.
    Hard,
}

bitflags! {
    /// Conditions a command was computed under, one a bit; none set is the normal case.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct Status: u16 {
        /// An obstacle's reference point is unusable from here, g.r <= 1e-6 |g|_1 |r|_1 (of a wall -g.r): the
        /// velocity past it is that of its surface.
        const REFERENCE = 1 << 0;
        /// The speed limit bound: |u| > speed was wanted, after modulation and soft layers.
        const SPEED_LIMITED = 1 << 1;
        /// The acceleration limit bound: |u - u_previous| > acceleration dt.
        const ACCELERATION_LIMITED = 1 << 2;
        /// An obstacle or the scan is older than its time to live: its axes grow as it is carried on by its velocity;
        /// see [`Ageing`](crate::Ageing).
        const EXTRAPOLATED = 1 << 3;
        /// An obstacle or the scan is older than its hold time: it stays where it is and is not to be trusted.
        const HELD = 1 << 4;
        /// No fresh robot state: the command ramps to zero, [`Controller::tick_late`](crate::Controller::tick_late).
        const LATE = 1 << 5;
        /// The arithmetic left the range of numbers, which no input is known to do, or the time step was negative or
        /// no number: the command is zero.
        const NOT_FINITE = 1 << 6;
        /// Hard cores overlap without a common reference point, anywhere in the table: the flow may end in a pocket
        /// between two of them.
        const CLUSTER = 1 << 7;
        /// The guard changed the command, for by the next sample it would have come nearer to a hard core than it may.
        const GUARDED = 1 << 8;
        /// The guard found no velocity within the speed limit that keeps the next sample out of every hard core by more than rounding may do
        /// (within a metre 4 units and 8 more for each metre of the body's size: in fixed point 4 um for small bodies), and standing still
        /// does not either: the command violates what the worst of them asks for the least.
        const INFEASIBLE = 1 << 9;
    }
}
