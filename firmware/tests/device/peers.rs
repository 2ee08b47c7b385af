//! Two peers at one desk.

use pliant_firmware::{Control, Desk, Identity, LOST_TICKS};
use pliant_protocol::message::{DeviceError, Mode, StopReason, TickMode};
use pliant_protocol::model::MODEL_MAX;
use pliant_protocol::{FRAME_MAX, SCHEMA, ToDevice, ToHost, checksum, encode};

use crate::host::{HERE, linear};

/// A device in its two halves.
pub struct Table {
    desk: Desk<u8>,
    pub control: Control,
}

impl Table {
    pub fn say(&mut self, from: u8, sequence: u16, message: ToDevice) -> Option<ToHost> {
        let mut room = [0; FRAME_MAX];
        let frame = encode(sequence, &message, &mut room).unwrap();
        self.desk.receive(from, frame, &mut self.control)
    }

    /// A host, 1, that drives.
    pub fn driven() -> Self {
        let desk = Desk::new(Identity { board: "test", firmware: [0, 1, 0] });
        let mut table = Self { desk, control: Control::new() };
        let mut room = [0; MODEL_MAX];
        let model = linear(2);
        let bytes = model.to_bytes(&mut room).unwrap();
        let (len, crc, data) = (bytes.len() as u32, checksum(bytes), bytes.iter().copied().collect());
        let session = [
            ToDevice::Hello { schema: SCHEMA },
            ToDevice::UploadBegin { bytes: len, crc },
            ToDevice::UploadChunk { offset: 0, data },
            ToDevice::UploadCommit,
            ToDevice::Arm { tick: TickMode::Timed },
            ToDevice::State { stamp: 0, position: HERE },
        ];
        for (sequence, message) in session.into_iter().enumerate() {
            let answer = table.say(1, sequence as u16, message);
            assert!(!matches!(answer, Some(ToHost::Refused { .. })), "{answer:?}");
        }
        table
    }

    fn mode(&mut self) -> Mode {
        self.control.tick(0);
        match self.control.take_report() {
            Some(ToHost::Command { mode, .. }) => mode,
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn a_stranger_can_stop_and_nothing_else() {
    let mut table = Table::driven();
    for (sequence, message) in [(9, ToDevice::Clear), (10, ToDevice::Arm { tick: TickMode::Timed })] {
        let answer = table.say(2, sequence, message);
        assert!(matches!(answer, Some(ToHost::Refused { error: DeviceError::NotGreeted, .. })), "{answer:?}");
    }
    for schema in [SCHEMA, 1] {
        let answer = table.say(2, 30_000, ToDevice::Hello { schema });
        assert!(matches!(answer, Some(ToHost::Refused { error: DeviceError::Mode(_), .. })), "{answer:?}");
    }
    assert_eq!((table.desk.host(), table.mode()), (Some(1), Mode::Running));
    assert!(matches!(table.say(2, 20_000, ToDevice::Stop), Some(ToHost::Ack { .. })));
    assert_eq!(table.mode(), Mode::Stopped(StopReason::Requested));
    // The host's own numbers still count.
    assert!(matches!(table.say(1, 6, ToDevice::Arm { tick: TickMode::Timed }), Some(ToHost::Ack { .. })));
}

#[test]
fn a_strangers_chatter_does_not_keep_a_lost_link_alive() {
    let mut table = Table::driven();
    for sequence in 0..=LOST_TICKS as u16 {
        table.say(2, sequence, ToDevice::Statistics);
        table.control.tick(0);
    }
    assert_eq!(table.mode(), Mode::Stopped(StopReason::LinkLost));
    // Now another may come, and has to say hello.
    assert!(matches!(table.say(2, 999, ToDevice::Hello { schema: SCHEMA }), Some(ToHost::Hello { .. })));
    assert_eq!(table.desk.host(), Some(2));
    assert!(matches!(table.say(2, 1000, ToDevice::Clear), Some(ToHost::Ack { .. })));
}

#[test]
fn no_command_that_moves_follows_the_answer_to_a_stop() {
    let mut table = Table::driven();
    table.control.tick(0);
    // The tick's command has not been sent yet when the stop comes in.
    assert!(matches!(table.say(1, 6, ToDevice::Stop), Some(ToHost::Ack { .. })));
    assert_eq!(table.control.take_report(), None);
}
