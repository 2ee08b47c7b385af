//! What host and device say to each other.
//!
//! The order of variants and fields *is* the encoding: a new variant goes to the end, and any change changes
//! [`SCHEMA`], which both sides compare in their hello.

mod error;
mod obstacle;
mod state;

pub use error::{DeviceError, Field, FrameFault, ScanFault, UploadError};
pub use obstacle::{Obstacle, Shape, VERTICES_MAX};
pub use state::{Mode, Region, Statistics, StopReason};

use crate::model::Model;
use heapless::{String, Vec};
use postcard_schema::{Schema, key::Key};
use serde::{Deserialize, Serialize};

/// Fingerprint of every message and of the uploaded model: names, types and order of all they hold.
pub const SCHEMA: u64 =
    key::<ToDevice>("to-device") ^ key::<ToHost>("to-host").rotate_left(1) ^ key::<Model>("model").rotate_left(2);

const fn key<T: Schema>(path: &str) -> u64 {
    u64::from_le_bytes(Key::for_path::<T>(path).to_bytes())
}

/// Most bytes of a model in one [`ToDevice::UploadChunk`].
pub const CHUNK_MAX: usize = 192;
/// Most points in one [`ToDevice::Scan`].
pub const PIECE_MAX: usize = 16;
/// Most points of a whole scan.
pub const SCAN_MAX: usize = pliant_core::scan::MAX_POINTS;
/// Most bytes in the name of a board.
pub const BOARD_MAX: usize = 16;

/// A message from the host.
///
/// All but [`Hello`](Self::Hello), [`State`](Self::State) and [`Statistics`](Self::Statistics) are answered by
/// [`ToHost::Ack`] or [`ToHost::Refused`]; a refusal changes nothing on the device.
///
/// ```
/// use pliant_protocol::message::{Obstacle, Settings, Steering, TickMode, ToDevice};
///
/// let session = [
///     ToDevice::Hello { schema: pliant_protocol::SCHEMA },
///     ToDevice::Configure(Settings::default()),
///     ToDevice::Upsert { id: 1, stamp: 0, obstacle: Obstacle { center: [0.2, 0.21, 0.0], ..Obstacle::default() } },
///     ToDevice::Arm { tick: TickMode::Timed },
///     ToDevice::State { stamp: 1_000, position: [0.37, 0.41, 0.0] },
/// ];
/// # let _ = session;
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum ToDevice {
    /// First message of a session; restarts the sequence. Answered by [`ToHost::Hello`].
    Hello {
        /// The host's [`SCHEMA`].
        schema: u64,
    },
    /// A model follows, in pieces. It replaces one half uploaded before.
    UploadBegin {
        /// Length of the whole model, in bytes; at most [`MODEL_MAX`](crate::model::MODEL_MAX).
        bytes: u32,
        /// Its [`checksum`](crate::checksum).
        crc: u32,
    },
    /// The next piece of the model.
    UploadChunk {
        /// Where it begins, in bytes from the start of the model.
        offset: u32,
        /// The piece.
        data: Vec<u8, CHUNK_MAX>,
    },
    /// The model is complete: check it and, if it is sound, run it from now on. Else the old one keeps running.
    UploadCommit,
    /// How to modulate, and within which limits.
    Configure(Settings),
    /// Adds an obstacle, or replaces the one of this number.
    Upsert {
        /// The host's number for the obstacle.
        id: u16,
        /// When the obstacle was seen, in microseconds of the host's clock; its age counts from then.
        stamp: u64,
        /// Where it was then.
        obstacle: Obstacle,
    },
    /// Takes an obstacle out of the table.
    Remove {
        /// The host's number for it.
        id: u16,
    },
    /// Takes every obstacle out of the table, and the scan.
    Clear,
    /// Where the robot is. A [`ToHost::Command`] follows: with the next tick, or at once where states make the ticks. A
    /// bad state is answered by [`ToHost::Refused`].
    State {
        /// When the robot was there, in microseconds of the host's clock.
        stamp: u64,
        /// Position, in m.
        position: [f32; 3],
    },
    /// Begin to command; clears a latched stop.
    Arm {
        /// What makes a tick.
        tick: TickMode,
    },
    /// Command zero velocity, until armed again.
    Stop,
    /// Asks for [`ToHost::Statistics`].
    Statistics,
    /// A piece of a scan. Pieces come in order from `start` 0, and the one that completes the total puts the whole scan in
    /// the place of the one before. Until then, and after a piece that was refused, the scan before is kept.
    Scan {
        /// When the scan was taken, in microseconds of the host's clock; its age counts from then.
        stamp: u64,
        /// How many points of this scan came before.
        start: u16,
        /// How many points it has in all, at most [`SCAN_MAX`]; 0 takes the scan away.
        total: u16,
        /// What each point is kept away from by, in m.
        radius: f32,
        /// The piece: points, in m.
        points: Vec<[f32; 3], PIECE_MAX>,
    },
    /// Moves the attractor of the running model, until the next [`Aim`](Self::Aim) or another model.
    Aim {
        /// When the attractor was there, in microseconds of the host's clock; it is carried on from then.
        stamp: u64,
        /// Where it was then, in m.
        position: [f32; 3],
        /// Its velocity, in m/s.
        velocity: [f32; 3],
    },
}

/// A message from the device.
///
/// ```
/// use pliant_protocol::{SCHEMA, ToHost};
///
/// let hello = ToHost::Hello {
///     schema: SCHEMA,
///     firmware: [0, 1, 0],
///     board: "mps2-an386".try_into()?,
///     tick_hz: 1_000,
///     obstacles: 16,
///     components: 16,
/// };
/// # let _ = hello;
/// # Ok::<(), heapless::CapacityError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum ToHost {
    /// Answer to a hello, also where the schemas differ.
    Hello {
        /// The device's [`SCHEMA`].
        schema: u64,
        /// Version of the firmware: major, minor, patch.
        firmware: [u8; 3],
        /// Name of the board, such as `mps2-an386`.
        board: String<BOARD_MAX>,
        /// Ticks a second in [`TickMode::Timed`], in Hz.
        tick_hz: u16,
        /// Most obstacles that the table holds.
        obstacles: u16,
        /// Most components that a model may have.
        components: u8,
    },
    /// The request was carried out.
    Ack {
        /// Sequence number of the request.
        of: u16,
        /// Tick before which it took effect.
        tick: u32,
        /// Revision of the obstacle table after it.
        revision: u32,
    },
    /// The request was refused and has changed nothing.
    Refused {
        /// Sequence number of the request.
        of: u16,
        /// Why.
        error: DeviceError,
    },
    /// What the robot should do now.
    Command {
        /// Number of the tick, from the device's start.
        tick: u32,
        /// Sequence number of the robot state that was used.
        state: u16,
        /// Revision of the obstacle table that was used.
        revision: u32,
        /// Velocity, in m/s.
        velocity: [f32; 3],
        /// Least gamma over all obstacles (dimensionless); the largest number there is where there is none.
        gamma: f32,
        /// The obstacle of the least gamma.
        nearest: Option<u16>,
        /// Region that the robot is in.
        region: Region,
        /// Flags of the tick, the bits of `pliant_core`'s status.
        status: u16,
        /// What the device is doing.
        mode: Mode,
    },
    /// Answer to [`ToDevice::Statistics`].
    Statistics(Statistics),
}

/// What makes a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum TickMode {
    /// The device's own clock.
    Timed,
    /// Each robot state: for runs that must repeat exactly.
    Stepped,
}

/// How to modulate, and within which limits.
///
/// The default is that of `pliant_core`.
///
/// ```
/// use pliant_protocol::message::Settings;
///
/// let brisk = Settings { speed: 1.0, ..Settings::default() };
/// assert!(brisk.deformable);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Settings {
    /// Whether soft layers count; if not, every obstacle is its hard core only.
    pub deformable: bool,
    /// Where the push in a soft layer points.
    pub steering: Steering,
    /// Gain c of the push in a soft layer, in m/s.
    pub gain: f32,
    /// Greatest speed, in m/s.
    pub speed: f32,
    /// Greatest acceleration, in m/s^2; none for no limit.
    pub acceleration: Option<f32>,
    /// Deceleration of a ramp to a stop, in m/s^2.
    pub deceleration: f32,
    /// Age from which an obstacle that is not seen again grows, in s.
    pub time_to_live: f32,
    /// How fast its semi-axes grow then, in m/s.
    pub growth: f32,
    /// Age from which it stays where it is and is flagged, in s.
    pub hold: f32,
    /// Keeps every sample out of every hard core: the share of the distance to one that a sample may use up (dimensionless,
    /// above 0, at most 1). None leaves it to the modulation.
    pub guard: Option<f32>,
}

/// Where the push in a soft layer points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum Steering {
    /// One direction for all, as in the paper.
    Fixed {
        /// The angle theta, in rad.
        angle: f32,
    },
    /// Along the modulated flow.
    WithFlow {
        /// Most that the push may be, as a multiple of the nominal speed (dimensionless).
        beta: f32,
    },
}
