//! What a tick says about itself.

use bitflags::bitflags;

/// Where the robot is, as far as obstacles go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Region {
    /// Outside every obstacle, soft layers included.
    #[default]
    Free,
    /// In the soft layer of exactly one obstacle.
    Soft,
    /// Where the soft layers of two or more obstacles overlap.
    Intersection,
    /// In or on a hard core, safety factors included (Gamma <= 1).
    Hard,
}

bitflags! {
    /// Conditions a command was computed under; none set is the normal case.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct Status: u16 {
        /// An obstacle's reference point is unusable from here (g.r is not positive): the robot keeps still relative to it.
        const REFERENCE = 1 << 0;
        /// The speed limit bound.
        const SPEED_LIMITED = 1 << 1;
        /// The acceleration limit bound.
        const ACCELERATION_LIMITED = 1 << 2;
        /// An obstacle is older than its time to live: its axes grow as it is carried on by its velocity.
        const EXTRAPOLATED = 1 << 3;
        /// An obstacle is older than its hold time: it stays where it is and is not to be trusted.
        const HELD = 1 << 4;
        /// No fresh robot state: the command ramps to zero.
        const LATE = 1 << 5;
        /// The arithmetic left the range of numbers, which no input is known to do, or the time step was negative or no number: the command is zero.
        const NOT_FINITE = 1 << 6;
        /// Hard cores overlap without a common reference point: the flow may end in a pocket between two of them.
        const CLUSTER = 1 << 7;
        /// The guard changed the command, for by the next sample it would have come nearer to a hard core than it may.
        const GUARDED = 1 << 8;
        /// The guard found no velocity within the speed limit that keeps the next sample out of every hard core: of those it knows of, the command
        /// violates the worst the least.
        const INFEASIBLE = 1 << 9;
    }
}
