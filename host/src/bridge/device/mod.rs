//! The devices there are, by the names they have on the command line.

pub(crate) mod emulator;
mod qemu;
mod virtual_device;

use std::fmt;
use std::net::ToSocketAddrs;
use std::path::PathBuf;
use std::str::FromStr;

use super::link::{Serial, Udp};
use super::{BridgeError, Session};

/// Where a device is.
///
/// ```
/// use pliant::bridge::Device;
/// assert_eq!("qemu".parse(), Ok(Device::Qemu));
/// assert!("serial:/dev/ttyACM0@115200".parse::<Device>().is_ok());
/// assert!("qmeu".parse::<Device>().unwrap_err().contains("virtual"));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Device {
    /// The firmware's application in a thread of this process.
    Virtual,
    /// The firmware in QEMU, over UDP.
    Qemu,
    /// The firmware in QEMU, over its UART.
    QemuSerial,
    /// A board on a serial port.
    Serial {
        /// The port.
        path: PathBuf,
        /// Symbols a second.
        baud: u32,
    },
    /// A board, or whatever else, on the network.
    Udp {
        /// `HOST:PORT`
        address: String,
    },
}

/// Symbols a second where the user does not say.
const BAUD: u32 = 115_200;
/// Symbols a second below which a serial line cannot carry a state and a command every millisecond (some 80 bytes).
const FAST: u32 = 1_000_000;

impl FromStr for Device {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        match name.split_once(':') {
            None if name == "virtual" => Ok(Self::Virtual),
            None if name == "qemu" => Ok(Self::Qemu),
            None if name == "qemu-serial" => Ok(Self::QemuSerial),
            Some(("serial", rest)) if !rest.is_empty() => {
                let (path, baud) = match rest.rsplit_once('@') {
                    None => (rest, BAUD),
                    Some((path, baud)) => {
                        let number = baud.parse().ok().filter(|b| *b > 0);
                        (path, number.ok_or(format!("`{baud}` is not a baud rate: use serial:PATH@115200, say"))?)
                    }
                };
                Ok(Self::Serial { path: path.into(), baud })
            }
            Some(("udp", address)) if address.contains(':') => Ok(Self::Udp { address: address.into() }),
            _ => Err(format!(
                "`{name}` is not a device: use virtual, qemu, qemu-serial, serial:PATH[@BAUD] or udp:HOST:PORT"
            )),
        }
    }
}

impl fmt::Display for Device {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Virtual => f.write_str("virtual"),
            Self::Qemu => f.write_str("qemu"),
            Self::QemuSerial => f.write_str("qemu-serial"),
            Self::Serial { path, baud } => write!(f, "serial:{}@{baud}", path.display()),
            Self::Udp { address } => write!(f, "udp:{address}"),
        }
    }
}

impl Device {
    /// Starts what has to be started and says hello. What was started ends with the session.
    ///
    /// # Errors
    /// What is missing, who does not answer, or whose schema differs.
    pub fn open(&self) -> Result<Session, BridgeError> {
        let failed = |what| move |error| BridgeError::Link { device: self.to_string(), what, error };
        match self {
            Self::Virtual => {
                let link = virtual_device::start().map_err(failed("cannot start its thread"))?;
                Session::open(self.to_string(), Box::new(link))
            }
            Self::Qemu => Session::open(self.to_string(), Box::new(qemu::start_udp()?)),
            Self::QemuSerial => Session::open(self.to_string(), Box::new(qemu::start_serial()?)),
            Self::Serial { path, baud } => {
                let port = serial2::SerialPort::open(path, *baud).map_err(failed("cannot open the port"))?;
                Session::open(self.to_string(), Box::new(Serial::over(port)))
            }
            Self::Udp { address } => {
                let mut found = address.to_socket_addrs().map_err(failed("cannot find the host"))?;
                let nobody = || std::io::Error::new(std::io::ErrorKind::NotFound, "no address");
                let peer = found.next().ok_or_else(nobody).map_err(failed("cannot find the host"))?;
                let link = Udp::to(peer).map_err(failed("cannot open a socket"))?;
                Session::open(self.to_string(), Box::new(link))
            }
        }
    }

    /// Is the link too slow for a state every millisecond? In QEMU the UART is.
    pub fn is_slow(&self) -> bool {
        match self {
            Self::QemuSerial => true,
            Self::Serial { baud, .. } => *baud < FAST,
            Self::Virtual | Self::Qemu | Self::Udp { .. } => false,
        }
    }
}
