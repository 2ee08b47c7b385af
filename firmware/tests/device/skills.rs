//! Uploaded skills.

use pliant_protocol::message::{DeviceError, Field, Mode, TickMode, UploadError};
use pliant_protocol::model::{Component, Model, Motion};
use pliant_protocol::{ToDevice, ToHost};

use crate::host::{HERE, Host, linear};

#[test]
fn a_skill_that_fails_its_certificate_leaves_the_old_one_running() {
    let part =
        |a: [f32; 9]| Component { log_weight: 0.0, mean: [0.0; 3], whitening: [10.0, 0.0, 10.0, 0.0, 0.0, 0.0], a };
    let stable = part([-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0]);
    let unstable = part([-1.0, 5.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0]);
    let lyapunov = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let model = |components: &[Component]| Model {
        dimension: 2,
        motion: Motion::Lpv { attractor: [0.0; 3], lyapunov, components: components.iter().copied().collect() },
    };
    let mut host = Host::armed(TickMode::Stepped);
    let before = match host.state(HERE) {
        Some(ToHost::Command { velocity, .. }) => velocity,
        other => panic!("{other:?}"),
    };
    host.announce(&model(&[stable, unstable]));
    assert_eq!(host.refused(ToDevice::UploadCommit), DeviceError::Certificate { component: Some(1) });
    host.announce(&model(&[]));
    assert_eq!(host.refused(ToDevice::UploadCommit), DeviceError::OutOfRange(Field::Components));
    // Half an upload, and then another thing altogether.
    host.ok(ToDevice::UploadBegin { bytes: 100, crc: 0 });
    assert!(matches!(host.state(HERE), Some(ToHost::Command { velocity, .. }) if velocity == before));
    host.announce(&linear(3));
    assert_eq!(host.refused(ToDevice::UploadCommit), DeviceError::Mode(Mode::Running));
    host.announce(&model(&[stable]));
    host.ok(ToDevice::UploadCommit);
    assert!(matches!(host.state(HERE), Some(ToHost::Command { mode: Mode::Running, .. })));
}

#[test]
fn three_dimensions_are_another_workspace() {
    let mut host = Host::greeted();
    host.upload(&linear(3));
    host.ok(ToDevice::Arm { tick: TickMode::Stepped });
    let answer = host.state([0.1, 0.1, 0.2]);
    assert!(matches!(answer, Some(ToHost::Command { velocity: [_, _, z], .. }) if z == -0.2), "{answer:?}");
    host.ok(ToDevice::Stop);
    host.upload(&linear(2));
    host.ok(ToDevice::Arm { tick: TickMode::Stepped });
    assert_eq!(host.refused(ToDevice::State { stamp: 0, position: [0.1, 0.1, 0.2] }), DeviceError::Dimension);
}

#[test]
fn a_commit_sent_again_is_answered_alike() {
    let mut host = Host::greeted();
    host.upload(&linear(2));
    host.ok(ToDevice::UploadCommit);
    host.ok(ToDevice::UploadBegin { bytes: 10, crc: 0 });
    assert_eq!(host.refused(ToDevice::UploadCommit), DeviceError::Upload(UploadError::Incomplete));
}
