//! A conversation with a device.

use std::time::{Duration, Instant};

use pliant_protocol::message::{CHUNK_MAX, Mode, Region, Statistics};
use pliant_protocol::model::{MODEL_MAX, Model};
use pliant_protocol::{Arrival, FRAME_MAX, Frame, SCHEMA, Sequence, ToDevice, ToHost, checksum, decode, encode};

use super::BridgeError;
use super::link::Link;

/// How long a device may take to answer hello: QEMU has to boot first.
const HELLO: Duration = Duration::from_secs(15);
/// How long a request may take before it is sent again, and how often it is sent. A machine may be busy with other things.
const PATIENCE: Duration = Duration::from_millis(500);
const TRIES: u32 = 8;
/// How long the command of a step may take. A step cannot be sent again: the device might take it twice.
const STEP: Duration = Duration::from_secs(10);

/// Who the device says it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Info {
    /// Name of the board.
    pub board: String,
    /// Version of the firmware: major, minor, patch.
    pub firmware: [u8; 3],
    /// Ticks a second.
    pub tick_hz: u16,
    /// Most obstacles.
    pub obstacles: u16,
    /// Most components of a model.
    pub components: u8,
}

/// A command as it came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Received {
    /// Number of the tick.
    pub tick: u32,
    /// Sequence number of the state it was computed from.
    pub state: u16,
    /// Revision of the table it was computed from.
    pub revision: u32,
    /// m/s
    pub velocity: [f32; 3],
    /// Least Gamma.
    pub gamma: f32,
    /// Where the robot is.
    pub region: Region,
    /// Bits of [`pliant_core::Status`].
    pub status: u16,
    /// What the device is doing.
    pub mode: Mode,
}

/// What came while nothing was asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A command.
    Command(Received),
    /// A request that was sent without waiting was refused.
    Refused(pliant_protocol::message::DeviceError),
}

/// A conversation with a device that has said hello.
pub struct Session {
    device: String,
    link: Box<dyn Link>,
    info: Info,
    sequence: u16,
    arrivals: Sequence,
    lost: u64,
    damaged: u64,
}

impl Session {
    /// Says hello until the device answers.
    ///
    /// # Errors
    /// It does not, or it speaks another protocol.
    pub fn open(device: String, link: Box<dyn Link>) -> Result<Self, BridgeError> {
        let info = Info { board: String::new(), firmware: [0; 3], tick_hz: 0, obstacles: 0, components: 0 };
        let arrivals = Sequence::new();
        let mut session = Self { device, link, info, sequence: 0, arrivals, lost: 0, damaged: 0 };
        let deadline = Instant::now() + HELLO;
        let mut refusal = None;
        while Instant::now() < deadline {
            session.send(&ToDevice::Hello { schema: SCHEMA })?;
            let again = Instant::now() + Duration::from_millis(100);
            while let Some(message) = session.next(again.saturating_duration_since(Instant::now()))? {
                if let ToHost::Refused { error, .. } = message {
                    // Another host has it; that may end.
                    refusal = Some(error);
                }
                let ToHost::Hello { schema, firmware, board, tick_hz, obstacles, components } = message else {
                    continue;
                };
                if schema != SCHEMA {
                    return Err(BridgeError::Schema { device: session.device, theirs: schema, ours: SCHEMA });
                }
                session.info = Info { board: board.as_str().into(), firmware, tick_hz, obstacles, components };
                return Ok(session);
            }
        }
        Err(match refusal {
            Some(error) => BridgeError::Refused { device: session.device, what: "hello".into(), error },
            None => session.no_answer("hello", HELLO),
        })
    }

    /// Who the device is.
    pub fn info(&self) -> &Info {
        &self.info
    }

    /// The device as the user named it.
    pub fn device(&self) -> &str {
        &self.device
    }

    /// Frames that never came and frames that came damaged, so far.
    pub fn losses(&self) -> (u64, u64) {
        (self.lost, self.damaged)
    }

    /// Sends a request and waits until it is carried out, sending it again if need be.
    ///
    /// # Errors
    /// It is refused, or nobody answers.
    pub fn request(&mut self, what: &str, message: &ToDevice) -> Result<(), BridgeError> {
        let mut sent = [None; TRIES as usize];
        for slot in 0..sent.len() {
            sent[slot] = Some(self.send(message)?);
            let until = Instant::now() + PATIENCE;
            while let Some(answer) = self.next(until.saturating_duration_since(Instant::now()))? {
                match answer {
                    ToHost::Ack { of, .. } if sent.contains(&Some(of)) => return Ok(()),
                    ToHost::Refused { of, error } if sent.contains(&Some(of)) => {
                        return Err(BridgeError::Refused { device: self.device.clone(), what: what.into(), error });
                    }
                    _ => {}
                }
            }
        }
        Err(self.no_answer("a request", PATIENCE * TRIES))
    }

    /// Uploads a skill in pieces and commits it.
    ///
    /// # Errors
    /// It is refused (its certificate does not hold, say), or nobody answers.
    pub fn upload(&mut self, model: &Model) -> Result<(), BridgeError> {
        let mut room = [0; MODEL_MAX];
        let bytes = model
            .to_bytes(&mut room)
            .map_err(|e| BridgeError::Emulator(format!("the model does not fit a device: {e}")))?;
        let begin = ToDevice::UploadBegin { bytes: bytes.len() as u32, crc: checksum(bytes) };
        self.request("the model", &begin)?;
        for (i, piece) in bytes.chunks(CHUNK_MAX).enumerate() {
            let data = piece.iter().copied().collect();
            self.request("the model", &ToDevice::UploadChunk { offset: (i * CHUNK_MAX) as u32, data })?;
        }
        self.request("the model", &ToDevice::UploadCommit)
    }

    /// Sends a state in a stepped run and waits for its command.
    ///
    /// # Errors
    /// It is refused, or nobody answers.
    pub fn step(&mut self, stamp: u64, position: [f32; 3]) -> Result<Received, BridgeError> {
        let of = self.send(&ToDevice::State { stamp, position })?;
        let until = Instant::now() + STEP;
        while let Some(message) = self.next(until.saturating_duration_since(Instant::now()))? {
            match message {
                ToHost::Refused { of: refused, error } if refused == of => {
                    return Err(BridgeError::Refused {
                        device: self.device.clone(),
                        what: "the robot's state".into(),
                        error,
                    });
                }
                other => {
                    if let Some(command) = received(&other).filter(|c| c.state == of) {
                        return Ok(command);
                    }
                }
            }
        }
        Err(self.no_answer("a robot state", STEP))
    }

    /// Asks for the device's counters.
    ///
    /// # Errors
    /// Nobody answers.
    pub fn statistics(&mut self) -> Result<Statistics, BridgeError> {
        for _ in 0..TRIES {
            self.send(&ToDevice::Statistics)?;
            let until = Instant::now() + PATIENCE;
            while let Some(message) = self.next(until.saturating_duration_since(Instant::now()))? {
                if let ToHost::Statistics(statistics) = message {
                    return Ok(statistics);
                }
            }
        }
        Err(self.no_answer("statistics", PATIENCE * TRIES))
    }

    /// Sends a message without waiting; its sequence number.
    ///
    /// # Errors
    /// The link is broken.
    pub fn send(&mut self, message: &ToDevice) -> Result<u16, BridgeError> {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        let mut room = [0; FRAME_MAX];
        let frame = encode(sequence, message, &mut room)
            .map_err(|e| BridgeError::Emulator(format!("a message does not fit a frame: {e}")))?;
        self.link.send(frame).map_err(|error| self.broken("cannot send", error))?;
        Ok(sequence)
    }

    /// What comes next, within `timeout`.
    ///
    /// # Errors
    /// The link is broken.
    pub fn event(&mut self, timeout: Duration) -> Result<Option<Event>, BridgeError> {
        let until = Instant::now() + timeout;
        while let Some(message) = self.next(until.saturating_duration_since(Instant::now()))? {
            if let ToHost::Refused { error, .. } = message {
                return Ok(Some(Event::Refused(error)));
            }
            if let Some(command) = received(&message) {
                return Ok(Some(Event::Command(command)));
            }
        }
        Ok(None)
    }

    /// The next message that arrives whole and in order.
    fn next(&mut self, timeout: Duration) -> Result<Option<ToHost>, BridgeError> {
        let until = Instant::now() + timeout;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            let Some(bytes) = self.link.receive(left).map_err(|error| self.broken("the link broke", error))? else {
                return Ok(None);
            };
            match decode::<ToHost>(&bytes) {
                Ok(Frame { sequence, message }) => {
                    if matches!(message, ToHost::Hello { .. }) {
                        self.arrivals.restart(sequence);
                        return Ok(Some(message));
                    }
                    match self.arrivals.arrived(sequence) {
                        Arrival::Stale => continue,
                        Arrival::After { lost } => self.lost += u64::from(lost),
                        Arrival::Next => {}
                    }
                    return Ok(Some(message));
                }
                Err(_) => self.damaged += 1,
            }
        }
    }

    fn no_answer(&self, what: &'static str, after: Duration) -> BridgeError {
        BridgeError::NoAnswer { device: self.device.clone(), what, seconds: after.as_secs_f64() }
    }

    fn broken(&self, what: &'static str, error: std::io::Error) -> BridgeError {
        BridgeError::Link { device: self.device.clone(), what, error }
    }
}

fn received(message: &ToHost) -> Option<Received> {
    match *message {
        ToHost::Command { tick, state, revision, velocity, gamma, nearest: _, region, status, mode } => {
            Some(Received { tick, state, revision, velocity, gamma, region, status, mode })
        }
        _ => None,
    }
}
