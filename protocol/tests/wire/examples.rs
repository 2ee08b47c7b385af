//! One of each message, and of each variant within one: what golden frames and limits are made from.

use heapless::Vec;
use pliant_protocol::message::{
    DeviceError, Field, FrameFault, Mode, Obstacle, Region, ScanFault, Settings, Shape, Statistics, Steering,
    StopReason, TickMode, UploadError,
};
use pliant_protocol::model::{Component, Model, Motion};
use pliant_protocol::{ToDevice, ToHost};

pub const FIELDS: [Field; 31] = [
    Field::Center,
    Field::Rotation,
    Field::Axes,
    Field::Curvature,
    Field::SoftRatio,
    Field::Margin,
    Field::Reference,
    Field::Velocity,
    Field::AngularVelocity,
    Field::Position,
    Field::Gain,
    Field::Steering,
    Field::Speed,
    Field::Acceleration,
    Field::Deceleration,
    Field::Ageing,
    Field::Attractor,
    Field::LinearGain,
    Field::Lyapunov,
    Field::Components,
    Field::Prior,
    Field::Mean,
    Field::Whitening,
    Field::Matrix,
    Field::Rounding,
    Field::Vertices,
    Field::Growth,
    Field::Guard,
    Field::Points,
    Field::Radius,
    Field::AttractorVelocity,
];
pub const MODES: [Mode; 7] = [
    Mode::Idle,
    Mode::Armed,
    Mode::Running,
    Mode::Degraded,
    Mode::Stopped(StopReason::Requested),
    Mode::Stopped(StopReason::LinkLost),
    Mode::Stopped(StopReason::Fault),
];
pub const REGIONS: [Region; 4] = [Region::Free, Region::Soft, Region::Intersection, Region::Hard];
pub const UPLOAD_ERRORS: [UploadError; 6] = [
    UploadError::NotBegun,
    UploadError::TooLarge,
    UploadError::Gap,
    UploadError::Crc,
    UploadError::Incomplete,
    UploadError::Malformed,
];
pub const DEVICE_ERRORS: [DeviceError; 17] = [
    DeviceError::Schema { ours: 0x0123_4567_89ab_cdef },
    DeviceError::Frame(FrameFault::Version { ours: 1 }),
    DeviceError::Frame(FrameFault::Message),
    DeviceError::Frame(FrameFault::Trailing),
    DeviceError::Mode(Mode::Stopped(StopReason::Fault)),
    DeviceError::NotFinite(Field::Center),
    DeviceError::OutOfRange(Field::Matrix),
    DeviceError::Dimension,
    DeviceError::TableFull,
    DeviceError::UnknownObstacle,
    DeviceError::NoModel,
    DeviceError::Upload(UploadError::Malformed),
    DeviceError::Certificate { component: None },
    DeviceError::Certificate { component: Some(15) },
    DeviceError::NotGreeted,
    DeviceError::Scan(ScanFault::Gap { expected: 300 }),
    DeviceError::Scan(ScanFault::Total { expected: 128 }),
];

/// No two fields alike, so that a swap shows.
pub const OBSTACLE: Obstacle = Obstacle {
    center: [0.2, 0.21, 0.22],
    rotation: [0.5, -0.5, 0.5, -0.5],
    shape: Shape::Ellipsoid { axes: [0.04, 0.05, 0.06], curvature: 3 },
    wall: false,
    soft_ratio: [1.5, 1.25, 1.125],
    margin: [1.1, 1.2, 1.3],
    reference: [0.01, -0.02, 0.03],
    velocity: [-0.1, 0.2, -0.3],
    angular_velocity: [0.7, 0.8, 0.9],
    growth: -0.04,
};

/// The other shapes. No two numbers alike here either.
pub fn shapes() -> [Shape; 4] {
    [
        Shape::Box { half: [0.04, 0.05, 0.06], rounding: 0.01 },
        Shape::Cylinder { radius: 0.04, half_length: 0.05, rounding: 0.01 },
        Shape::Capsule { radius: 0.04, half_length: 0.05 },
        Shape::Polygon { vertices: Vec::from_slice(&[[0.1, 0.0], [-0.06, 0.08], [-0.02, -0.03]]).unwrap() },
    ]
}

pub const FIXED: Settings = Settings {
    deformable: false,
    steering: Steering::Fixed { angle: 0.785 },
    gain: 0.03,
    speed: 0.5,
    acceleration: Some(2.0),
    deceleration: 4.0,
    time_to_live: 0.2,
    growth: 0.05,
    hold: 1.0,
    guard: Some(0.5),
};
pub const COUNTED: Statistics = Statistics {
    ticks: 1,
    missed: 2,
    late: 3,
    frames: 4,
    lost: 5,
    refused: 6,
    crc_errors: 7,
    overruns: 8,
    rejected_states: 9,
    stack_used: 10,
    worst_tick_us: 11,
};

pub fn to_device() -> [ToDevice; 20] {
    let [rounded, cylinder, capsule, polygon] = shapes();
    let upsert = |shape| ToDevice::Upsert { id: 1, stamp: 2, obstacle: Obstacle { shape, wall: true, ..OBSTACLE } };
    [
        ToDevice::Hello { schema: 0x0123_4567_89ab_cdef },
        ToDevice::UploadBegin { bytes: 1_255, crc: 0xdead_beef },
        ToDevice::UploadChunk { offset: 192, data: Vec::from_slice(&[1, 0, 255]).unwrap() },
        ToDevice::UploadCommit,
        ToDevice::Configure(FIXED),
        ToDevice::Configure(Settings {
            steering: Steering::WithFlow { beta: 1.0 },
            acceleration: None,
            guard: None,
            ..FIXED
        }),
        ToDevice::Upsert { id: 300, stamp: 1_000_000, obstacle: OBSTACLE },
        ToDevice::Remove { id: 300 },
        ToDevice::Clear,
        ToDevice::State { stamp: 1_001_000, position: [0.37, 0.41, -0.5] },
        ToDevice::Arm { tick: TickMode::Timed },
        ToDevice::Arm { tick: TickMode::Stepped },
        ToDevice::Stop,
        ToDevice::Statistics,
        ToDevice::Scan {
            stamp: 1_002_000,
            start: 16,
            total: 128,
            radius: 0.05,
            points: Vec::from_slice(&[[0.1, 0.2, 0.3], [-0.1, -0.2, -0.3]]).unwrap(),
        },
        ToDevice::Aim { stamp: 1_003_000, position: [0.5, 0.25, 0.125], velocity: [-0.1, 0.2, -0.3] },
        upsert(rounded),
        upsert(cylinder),
        upsert(capsule),
        upsert(polygon),
    ]
}

pub fn command() -> ToHost {
    ToHost::Command {
        tick: 70_000,
        state: 513,
        revision: 3,
        velocity: [0.25, -0.125, 0.5],
        gamma: 1.75,
        nearest: Some(300),
        region: Region::Soft,
        status: 0b1_0010,
        mode: Mode::Running,
    }
}

pub fn to_host() -> [ToHost; 5] {
    [
        ToHost::Hello {
            schema: 0x0123_4567_89ab_cdef,
            firmware: [0, 1, 2],
            board: "mps2-an386".try_into().unwrap(),
            tick_hz: 1_000,
            obstacles: 16,
            components: 15,
        },
        ToHost::Ack { of: 258, tick: 70_000, revision: 3 },
        ToHost::Refused { of: 259, error: DeviceError::TableFull },
        command(),
        ToHost::Statistics(COUNTED),
    ]
}

pub fn models() -> [Model; 2] {
    let component = Component {
        log_weight: -1.5,
        mean: [0.1, 0.2, 0.3],
        whitening: [1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
        a: [-1.0, -2.0, -3.0, -4.0, -5.0, -6.0, -7.0, -8.0, -9.0],
    };
    [
        Model { dimension: 2, motion: Motion::Linear { attractor: [0.5, 0.25, 0.0], gain: 2.0 } },
        Model {
            dimension: 3,
            motion: Motion::Lpv {
                attractor: [0.5, 0.25, 0.125],
                lyapunov: [1.0, 0.1, 0.2, 2.0, 0.3, 3.0],
                components: Vec::from_slice(&[component]).unwrap(),
            },
        },
    ]
}
