//! A host to drive the device with.

use pliant_core::Status;
use pliant_firmware::{Device, Identity};
use pliant_protocol::message::{DeviceError, Mode, Statistics, TickMode};
use pliant_protocol::model::{MODEL_MAX, Model, Motion};
use pliant_protocol::{FRAME_MAX, SCHEMA, ToDevice, ToHost, checksum, decode, encode};

/// A host that counts its frames.
pub struct Host {
    pub device: Device,
    pub sequence: u16,
    pub stamp: u64,
}

impl Host {
    pub fn stranger() -> Self {
        Self { device: Device::new(Identity { board: "test", firmware: [0, 1, 0] }), sequence: 0, stamp: 0 }
    }

    pub fn greeted() -> Self {
        let mut host = Self::stranger();
        assert!(matches!(host.say(ToDevice::Hello { schema: SCHEMA }), Some(ToHost::Hello { schema: SCHEMA, .. })));
        host
    }

    /// With a linear skill, armed.
    pub fn armed(tick: TickMode) -> Self {
        let mut host = Self::greeted();
        host.upload(&linear(2));
        host.ok(ToDevice::Arm { tick });
        host
    }

    pub fn say(&mut self, message: ToDevice) -> Option<ToHost> {
        let mut room = [0; FRAME_MAX];
        self.sequence = self.sequence.wrapping_add(1);
        let frame = encode(self.sequence, &message, &mut room).unwrap();
        let mut answer = [0; FRAME_MAX];
        self.device.receive(frame, &mut answer).map(|bytes| decode(bytes).unwrap().message)
    }

    pub fn ok(&mut self, message: ToDevice) {
        let answer = self.say(message.clone());
        assert!(matches!(answer, Some(ToHost::Ack { of, .. }) if of == self.sequence), "{message:?}: {answer:?}");
    }

    pub fn refused(&mut self, message: ToDevice) -> DeviceError {
        match self.say(message.clone()) {
            Some(ToHost::Refused { of, error }) if of == self.sequence => error,
            other => panic!("{message:?} was not refused: {other:?}"),
        }
    }

    pub fn upload(&mut self, model: &Model) {
        self.announce(model);
        self.ok(ToDevice::UploadCommit);
    }

    /// All but the commit.
    pub fn announce(&mut self, model: &Model) {
        let mut room = [0; MODEL_MAX];
        let bytes = model.to_bytes(&mut room).unwrap();
        self.ok(ToDevice::UploadBegin { bytes: bytes.len() as u32, crc: checksum(bytes) });
        for (i, piece) in bytes.chunks(50).enumerate() {
            self.ok(ToDevice::UploadChunk { offset: i as u32 * 50, data: piece.iter().copied().collect() });
        }
    }

    pub fn state(&mut self, position: [f32; 3]) -> Option<ToHost> {
        self.stamp += 1000;
        self.say(ToDevice::State { stamp: self.stamp, position })
    }

    /// A tick of the device's own clock: velocity and mode.
    pub fn tick(&mut self) -> Option<([f32; 3], Mode)> {
        let mut room = [0; FRAME_MAX];
        match decode::<ToHost>(self.device.tick(0, &mut room)?).unwrap().message {
            ToHost::Command { velocity, mode, .. } => Some((velocity, mode)),
            other => panic!("{other:?}"),
        }
    }

    /// In a stepped run: the velocity that is commanded at `position`.
    pub fn velocity(&mut self, position: [f32; 3]) -> [f32; 3] {
        match self.state(position) {
            Some(ToHost::Command { velocity, .. }) => velocity,
            other => panic!("{other:?}"),
        }
    }

    /// In a stepped run: the least gamma at `position`, and whose it is.
    pub fn gamma(&mut self, position: [f32; 3]) -> (f32, Option<u16>) {
        match self.state(position) {
            Some(ToHost::Command { gamma, nearest, .. }) => (gamma, nearest),
            other => panic!("{other:?}"),
        }
    }

    /// In a stepped run: the flags of the command at `position`.
    pub fn status(&mut self, position: [f32; 3]) -> Status {
        match self.state(position) {
            Some(ToHost::Command { status, .. }) => Status::from_bits(status).expect("bits that the core knows"),
            other => panic!("{other:?}"),
        }
    }

    pub fn statistics(&mut self) -> Statistics {
        match self.say(ToDevice::Statistics) {
            Some(ToHost::Statistics(s)) => s,
            other => panic!("{other:?}"),
        }
    }
}

pub fn linear(dimension: u8) -> Model {
    Model { dimension, motion: Motion::Linear { attractor: [0.0; 3], gain: 1.0 } }
}

pub fn speed([x, y, z]: [f32; 3]) -> f32 {
    (x * x + y * y + z * z).sqrt()
}

pub const HERE: [f32; 3] = [0.3, 0.1, 0.0];
