//! From a scene to a device and back: links, sessions, and devices that are not boards.
//!
//! A [`Device`] names where the device is; [`Device::open`] gives a [`Session`] with it, whichever it is. Above the [`link`] all devices
//! are the same bytes.

pub mod device;
pub mod link;
pub mod session;
pub mod wire;

pub use device::Device;
pub use session::{Info, Session};

use pliant_protocol::message::DeviceError;

/// Why a device cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum BridgeError {
    /// Nobody answers.
    #[error("{device} did not answer {what} within {seconds} s: is it running, and is this its address?")]
    NoAnswer {
        /// The device as the user named it.
        device: String,
        /// What was asked.
        what: &'static str,
        /// How long was waited.
        seconds: f64,
    },
    /// It answers, and will not.
    #[error("{device} refused {what}: {error}")]
    Refused {
        /// The device as the user named it.
        device: String,
        /// What was asked.
        what: String,
        /// Why it refused.
        error: DeviceError,
    },
    /// The scene cannot be sent as it then is.
    #[error(transparent)]
    Scene(#[from] crate::scene::ConvertError),
    /// It speaks another protocol.
    #[error(
        "{device} was built from other messages (its schema is {theirs:016x}, ours {ours:016x}): use firmware and host tool of one release"
    )]
    Schema {
        /// The device as the user named it.
        device: String,
        /// The device's schema.
        theirs: u64,
        /// The host's schema.
        ours: u64,
    },
    /// The link itself failed.
    #[error("{device}: {what}: {error}")]
    Link {
        /// The device as the user named it.
        device: String,
        /// What was tried.
        what: &'static str,
        /// What the system says.
        error: std::io::Error,
    },
    /// QEMU, or what it needs, is missing or failed; the sentence says what to do.
    #[error("{0}")]
    Emulator(String),
    /// The device stopped by itself in the middle of a run.
    #[error("{device} has {mode}: the run is over")]
    Stopped {
        /// The device as the user named it.
        device: String,
        /// What it is doing.
        mode: pliant_protocol::message::Mode,
    },
    /// Commands stopped coming in the middle of a run.
    #[error("{device} fell silent: no command for {seconds} s")]
    Silent {
        /// The device as the user named it.
        device: String,
        /// How long was waited.
        seconds: f64,
    },
    /// The scene does not fit the device.
    #[error("{device} has room for {room} {what}, the scene has {wanted}")]
    Capacity {
        /// The device as the user named it.
        device: String,
        /// Obstacles or components.
        what: &'static str,
        /// What it has.
        room: usize,
        /// What it would need.
        wanted: usize,
    },
}
