//! What host and device say to each other.
//!
//! The order of variants and fields *is* the encoding: a new variant goes to the end, and any change changes
//! [`SCHEMA`], which both sides compare in their hello.

mod error;
mod state;

pub use error::{DeviceError, Field, FrameFault, UploadError};
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
    /// Takes every obstacle out of the table.
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

/// An ellipsoid with a hard core and perhaps a soft layer.
///
/// In two dimensions it lies in the plane: see [`convert::obstacle`](crate::convert::obstacle()).
///
/// The default is that of `pliant_core`: a rigid ball of 5 cm radius at the origin, at rest.
///
/// ```
/// use pliant_protocol::message::Obstacle;
///
/// // A hard core of 4 cm in a layer of foam that is 2 cm thick.
/// let foam = Obstacle { axes: [0.04; 3], soft_ratio: [1.5; 3], ..Obstacle::default() };
/// # assert_eq!(foam.rotation, [1.0, 0.0, 0.0, 0.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Obstacle {
    /// Centre, in m.
    pub center: [f32; 3],
    /// Rotation from the obstacle's frame to the world's: a unit quaternion w, x, y, z.
    pub rotation: [f32; 4],
    /// Hard semi-axes, in m.
    pub axes: [f32; 3],
    /// Soft semi-axes as multiples of the hard ones (dimensionless, at least 1; 1 is rigid).
    pub soft_ratio: [f32; 3],
    /// Safety factors on the hard semi-axes (dimensionless, at least 1).
    pub margin: [f32; 3],
    /// Curvature exponent p: 1 an ellipsoid, larger ever more of a box (dimensionless).
    pub curvature: u8,
    /// Reference point in the obstacle's frame, inside the core, in m.
    pub reference: [f32; 3],
    /// Velocity of the centre, in m/s.
    pub velocity: [f32; 3],
    /// Angular velocity in the world's frame, in rad/s.
    pub angular_velocity: [f32; 3],
}
