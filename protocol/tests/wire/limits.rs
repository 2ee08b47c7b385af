//! Every message fits a frame, and every model the room for one.

use heapless::Vec;
use pliant_protocol::message::{
    CHUNK_MAX, DeviceError, Mode, Obstacle, PIECE_MAX, Region, Settings, Shape, Statistics, Steering, StopReason,
    TickMode, VERTICES_MAX,
};
use pliant_protocol::model::{COMPONENTS_MAX, Component, MODEL_MAX, Model, Motion};
use pliant_protocol::{FRAME_MAX, ToDevice, ToHost, encode};
use serde::Serialize;

use crate::examples::DEVICE_ERRORS;

/// A float is always four bytes; what varies is counts, lengths and whole numbers, and these are at their longest here.
const OBSTACLE: Obstacle = Obstacle {
    center: [f32::MAX; 3],
    rotation: [f32::MAX; 4],
    shape: Shape::Ellipsoid { axes: [f32::MAX; 3], curvature: u8::MAX },
    wall: true,
    soft_ratio: [f32::MAX; 3],
    margin: [f32::MAX; 3],
    reference: [f32::MAX; 3],
    velocity: [f32::MAX; 3],
    angular_velocity: [f32::MAX; 3],
    growth: f32::MAX,
};
const SETTINGS: Settings = Settings {
    deformable: true,
    steering: Steering::WithFlow { beta: f32::MAX },
    gain: f32::MAX,
    speed: f32::MAX,
    acceleration: Some(f32::MAX),
    deceleration: f32::MAX,
    time_to_live: f32::MAX,
    growth: f32::MAX,
    hold: f32::MAX,
    guard: Some(f32::MAX),
};
const STATISTICS: Statistics = Statistics {
    ticks: u32::MAX,
    missed: u32::MAX,
    late: u32::MAX,
    frames: u32::MAX,
    lost: u32::MAX,
    refused: u32::MAX,
    crc_errors: u32::MAX,
    overruns: u32::MAX,
    rejected_states: u32::MAX,
    stack_used: u32::MAX,
    worst_tick_us: u32::MAX,
};

fn length<M: Serialize>(message: &M) -> usize {
    encode(u16::MAX, message, &mut [0; FRAME_MAX]).unwrap().len()
}

#[test]
fn the_longest_of_each_message_fits_a_frame() {
    let upsert = |shape| ToDevice::Upsert { id: u16::MAX, stamp: u64::MAX, obstacle: Obstacle { shape, ..OBSTACLE } };
    let x = f32::MAX;
    let to_device = [
        (ToDevice::Hello { schema: u64::MAX }, 18),
        (ToDevice::UploadBegin { bytes: u32::MAX, crc: u32::MAX }, 18),
        (ToDevice::UploadChunk { offset: u32::MAX, data: Vec::from_slice(&[255; CHUNK_MAX]).unwrap() }, 207),
        (ToDevice::UploadCommit, 8),
        (ToDevice::Configure(SETTINGS), 48),
        (upsert(OBSTACLE.shape), 128),
        (upsert(Shape::Box { half: [x; 3], rounding: x }), 131),
        (upsert(Shape::Cylinder { radius: x, half_length: x, rounding: x }), 127),
        (upsert(Shape::Capsule { radius: x, half_length: x }), 123),
        (upsert(Shape::Polygon { vertices: Vec::from_slice(&[[x; 2]; VERTICES_MAX]).unwrap() }), 212),
        (ToDevice::Remove { id: u16::MAX }, 11),
        (ToDevice::Clear, 8),
        (ToDevice::State { stamp: u64::MAX, position: [f32::MAX; 3] }, 30),
        (ToDevice::Arm { tick: TickMode::Stepped }, 9),
        (ToDevice::Stop, 8),
        (ToDevice::Statistics, 8),
        (
            ToDevice::Scan {
                stamp: u64::MAX,
                start: u16::MAX,
                total: u16::MAX,
                radius: x,
                points: Vec::from_slice(&[[x; 3]; PIECE_MAX]).unwrap(),
            },
            221,
        ),
        (ToDevice::Aim { stamp: u64::MAX, position: [x; 3], velocity: [x; 3] }, 42),
    ];
    for (message, expected) in &to_device {
        assert_eq!(length(message), *expected, "{message:?}");
    }
    let stopped = Mode::Stopped(StopReason::Fault);
    let to_host = [
        (
            ToHost::Hello {
                schema: u64::MAX,
                firmware: [u8::MAX; 3],
                board: "sixteen letters!".try_into().unwrap(),
                tick_hz: u16::MAX,
                obstacles: u16::MAX,
                components: u8::MAX,
            },
            45,
        ),
        (ToHost::Ack { of: u16::MAX, tick: u32::MAX, revision: u32::MAX }, 21),
        (ToHost::Refused { of: u16::MAX, error: DeviceError::Schema { ours: u64::MAX } }, 22),
        (
            ToHost::Command {
                tick: u32::MAX,
                state: u16::MAX,
                revision: u32::MAX,
                velocity: [f32::MAX; 3],
                gamma: f32::INFINITY,
                nearest: Some(u16::MAX),
                region: Region::Hard,
                status: u16::MAX,
                mode: stopped,
            },
            47,
        ),
        (ToHost::Statistics(STATISTICS), 63),
    ];
    for (message, expected) in &to_host {
        assert_eq!(length(message), *expected, "{message:?}");
    }
    for error in DEVICE_ERRORS {
        assert!(length(&ToHost::Refused { of: u16::MAX, error }) <= 22, "{error:?}");
    }
}

#[test]
fn the_longest_model_fits_its_room() {
    let component = Component { log_weight: f32::MAX, mean: [f32::MAX; 3], whitening: [f32::MAX; 6], a: [f32::MAX; 9] };
    let model = Model {
        dimension: u8::MAX,
        motion: Motion::Lpv {
            attractor: [f32::MAX; 3],
            lyapunov: [f32::MAX; 6],
            components: Vec::from_slice(&[component; COMPONENTS_MAX]).unwrap(),
        },
    };
    let mut room = [0; MODEL_MAX];
    assert_eq!(model.to_bytes(&mut room).unwrap().len(), 1_255);
}
