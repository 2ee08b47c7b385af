//! What the device reports about itself and about the robot.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// What the device is doing.
///
/// ```
/// use pliant_protocol::message::{Mode, StopReason};
///
/// let stopped = Mode::Stopped(StopReason::LinkLost);
/// assert_eq!(stopped.to_string(), "stopped (the link was lost)");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Mode {
    /// Not armed since it started; the command is zero.
    Idle,
    /// Armed, and waiting for the first robot state.
    Armed,
    /// Commanding.
    Running,
    /// No fresh robot state: the command ramps to zero and comes back with the next state.
    Degraded,
    /// The command is zero until armed again.
    Stopped(StopReason),
}

/// Why the device stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum StopReason {
    /// The host said stop.
    Requested,
    /// No frame came for too long.
    LinkLost,
    /// The device found a fault in itself.
    Fault,
}

/// Where the robot is, as far as obstacles go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Region {
    /// Outside every obstacle, soft layers included.
    Free,
    /// In the soft layer of exactly one obstacle.
    Soft,
    /// Where the soft layers of two or more obstacles overlap.
    Intersection,
    /// In or on a hard core, safety factors included.
    Hard,
}

/// What the device counted since it started; counters stay at their greatest value rather than go round.
///
/// ```
/// use pliant_protocol::message::Statistics;
///
/// let quiet = Statistics { ticks: 10_000, frames: 10_000, ..Statistics::default() };
/// assert_eq!(quiet.missed + quiet.lost + quiet.crc_errors, 0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Statistics {
    /// Ticks computed.
    pub ticks: u32,
    /// Ticks that were due and were not computed.
    pub missed: u32,
    /// Ticks that had no fresh robot state.
    pub late: u32,
    /// Frames accepted.
    pub frames: u32,
    /// Frames that never came, by their sequence numbers.
    pub lost: u32,
    /// Requests refused.
    pub refused: u32,
    /// Frames damaged on the way.
    pub crc_errors: u32,
    /// Frames too long for any, or bytes that came faster than they were taken.
    pub overruns: u32,
    /// Robot states refused because they were not finite or out of range.
    pub rejected_states: u32,
    /// Most stack ever used, in bytes; 0 where it is not measured.
    pub stack_used: u32,
    /// Longest computation of a tick, in microseconds; 0 where it is not measured.
    pub worst_tick_us: u32,
}

impl core::fmt::Display for Mode {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Idle => "idle",
            Self::Armed => "armed",
            Self::Running => "running",
            Self::Degraded => "degraded",
            Self::Stopped(StopReason::Requested) => "stopped (the host said so)",
            Self::Stopped(StopReason::LinkLost) => "stopped (the link was lost)",
            Self::Stopped(StopReason::Fault) => "stopped (a fault in the device)",
        })
    }
}
