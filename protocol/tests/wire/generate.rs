//! Arbitrary messages, floats of every bit pattern included.

use heapless::Vec;
use pliant_protocol::message::{
    BOARD_MAX, CHUNK_MAX, DeviceError, Field, FrameFault, Mode, Obstacle, PIECE_MAX, Region, ScanFault, Settings,
    Shape, Statistics, Steering, TickMode, UploadError, VERTICES_MAX,
};
use pliant_protocol::model::{COMPONENTS_MAX, Component, Model, Motion};
use pliant_protocol::{ToDevice, ToHost};
use proptest::array::{uniform2, uniform3, uniform4, uniform6, uniform9};
use proptest::collection::vec;
use proptest::option::of;
use proptest::prelude::*;
use proptest::sample::select;

use crate::examples::{FIELDS, MODES, REGIONS, UPLOAD_ERRORS};

fn float() -> impl Strategy<Value = f32> {
    any::<u32>().prop_map(f32::from_bits)
}

fn steering() -> impl Strategy<Value = Steering> {
    prop_oneof![
        float().prop_map(|angle| Steering::Fixed { angle }),
        float().prop_map(|beta| Steering::WithFlow { beta })
    ]
}

pub fn settings() -> impl Strategy<Value = Settings> {
    (any::<bool>(), steering(), uniform2(of(float())), uniform6(float())).prop_map(
        |(deformable, steering, [acceleration, guard], [gain, speed, deceleration, time_to_live, growth, hold])| {
            Settings {
                deformable,
                steering,
                gain,
                speed,
                acceleration,
                deceleration,
                time_to_live,
                growth,
                hold,
                guard,
            }
        },
    )
}

fn shape() -> impl Strategy<Value = Shape> {
    prop_oneof![
        (uniform3(float()), any::<u8>()).prop_map(|(axes, curvature)| Shape::Ellipsoid { axes, curvature }),
        (uniform3(float()), float()).prop_map(|(half, rounding)| Shape::Box { half, rounding }),
        uniform3(float()).prop_map(|[radius, half_length, rounding]| Shape::Cylinder { radius, half_length, rounding }),
        uniform2(float()).prop_map(|[radius, half_length]| Shape::Capsule { radius, half_length }),
        vec(uniform2(float()), 0..=VERTICES_MAX)
            .prop_map(|vertices| Shape::Polygon { vertices: Vec::from_slice(&vertices).unwrap() }),
    ]
}

pub fn obstacle() -> impl Strategy<Value = Obstacle> {
    let v = || uniform3(float());
    (v(), uniform4(float()), shape(), any::<bool>(), v(), v(), v(), v(), v(), float()).prop_map(
        |(center, rotation, shape, wall, soft_ratio, margin, reference, velocity, angular_velocity, growth)| Obstacle {
            center,
            rotation,
            shape,
            wall,
            soft_ratio,
            margin,
            reference,
            velocity,
            angular_velocity,
            growth,
        },
    )
}

pub fn to_device() -> impl Strategy<Value = ToDevice> {
    prop_oneof![
        any::<u64>().prop_map(|schema| ToDevice::Hello { schema }),
        any::<(u32, u32)>().prop_map(|(bytes, crc)| ToDevice::UploadBegin { bytes, crc }),
        (any::<u32>(), vec(any::<u8>(), 0..=CHUNK_MAX))
            .prop_map(|(offset, data)| ToDevice::UploadChunk { offset, data: Vec::from_slice(&data).unwrap() }),
        Just(ToDevice::UploadCommit),
        settings().prop_map(ToDevice::Configure),
        (any::<u16>(), any::<u64>(), obstacle()).prop_map(|(id, stamp, obstacle)| ToDevice::Upsert {
            id,
            stamp,
            obstacle
        }),
        any::<u16>().prop_map(|id| ToDevice::Remove { id }),
        Just(ToDevice::Clear),
        (any::<u64>(), uniform3(float())).prop_map(|(stamp, position)| ToDevice::State { stamp, position }),
        prop_oneof![Just(TickMode::Timed), Just(TickMode::Stepped)].prop_map(|tick| ToDevice::Arm { tick }),
        Just(ToDevice::Stop),
        Just(ToDevice::Statistics),
        (any::<(u64, u16, u16)>(), float(), vec(uniform3(float()), 0..=PIECE_MAX)).prop_map(
            |((stamp, start, total), radius, points)| ToDevice::Scan {
                stamp,
                start,
                total,
                radius,
                points: Vec::from_slice(&points).unwrap()
            }
        ),
        (any::<u64>(), uniform3(float()), uniform3(float())).prop_map(|(stamp, position, velocity)| ToDevice::Aim {
            stamp,
            position,
            velocity
        }),
    ]
}

fn mode() -> impl Strategy<Value = Mode> {
    select(&MODES[..])
}

fn region() -> impl Strategy<Value = Region> {
    select(&REGIONS[..])
}

fn field() -> impl Strategy<Value = Field> {
    select(&FIELDS[..])
}

fn upload_error() -> impl Strategy<Value = UploadError> {
    select(&UPLOAD_ERRORS[..])
}

fn device_error() -> impl Strategy<Value = DeviceError> {
    prop_oneof![
        any::<u64>().prop_map(|ours| DeviceError::Schema { ours }),
        any::<u8>().prop_map(|ours| DeviceError::Frame(FrameFault::Version { ours })),
        Just(DeviceError::Frame(FrameFault::Message)),
        Just(DeviceError::Frame(FrameFault::Trailing)),
        mode().prop_map(DeviceError::Mode),
        field().prop_map(DeviceError::NotFinite),
        field().prop_map(DeviceError::OutOfRange),
        Just(DeviceError::Dimension),
        Just(DeviceError::TableFull),
        Just(DeviceError::NotGreeted),
        Just(DeviceError::UnknownObstacle),
        Just(DeviceError::NoModel),
        upload_error().prop_map(DeviceError::Upload),
        of(any::<u8>()).prop_map(|component| DeviceError::Certificate { component }),
        any::<u16>().prop_map(|expected| DeviceError::Scan(ScanFault::Gap { expected })),
        any::<u16>().prop_map(|expected| DeviceError::Scan(ScanFault::Total { expected })),
    ]
}

fn statistics() -> impl Strategy<Value = Statistics> {
    any::<[u32; 11]>().prop_map(|n| Statistics {
        ticks: n[0],
        missed: n[1],
        late: n[2],
        frames: n[3],
        lost: n[4],
        refused: n[5],
        crc_errors: n[6],
        overruns: n[7],
        rejected_states: n[8],
        stack_used: n[9],
        worst_tick_us: n[10],
    })
}

fn board() -> impl Strategy<Value = heapless::String<BOARD_MAX>> {
    any::<String>().prop_map(|s| {
        let mut board = heapless::String::new();
        s.chars().take_while(|c| board.push(*c).is_ok()).count();
        board
    })
}

pub fn to_host() -> impl Strategy<Value = ToHost> {
    prop_oneof![
        (any::<u64>(), any::<[u8; 3]>(), board(), any::<(u16, u16, u8)>()).prop_map(
            |(schema, firmware, board, (tick_hz, obstacles, components))| ToHost::Hello {
                schema,
                firmware,
                board,
                tick_hz,
                obstacles,
                components
            }
        ),
        any::<(u16, u32, u32)>().prop_map(|(of, tick, revision)| ToHost::Ack { of, tick, revision }),
        (any::<u16>(), device_error()).prop_map(|(of, error)| ToHost::Refused { of, error }),
        (any::<(u32, u16, u32, u16)>(), uniform3(float()), float(), of(any::<u16>()), region(), mode()).prop_map(
            |((tick, state, revision, status), velocity, gamma, nearest, region, mode)| ToHost::Command {
                tick,
                state,
                revision,
                velocity,
                gamma,
                nearest,
                region,
                status,
                mode
            }
        ),
        statistics().prop_map(ToHost::Statistics),
    ]
}

fn component() -> impl Strategy<Value = Component> {
    (float(), uniform3(float()), uniform6(float()), uniform9(float()))
        .prop_map(|(log_weight, mean, whitening, a)| Component { log_weight, mean, whitening, a })
}

pub fn model() -> impl Strategy<Value = Model> {
    let linear = (uniform3(float()), float()).prop_map(|(attractor, gain)| Motion::Linear { attractor, gain }).boxed();
    let lpv = (uniform3(float()), uniform6(float()), vec(component(), 0..=COMPONENTS_MAX)).prop_map(
        |(attractor, lyapunov, components)| Motion::Lpv {
            attractor,
            lyapunov,
            components: Vec::from_slice(&components).unwrap(),
        },
    );
    (any::<u8>(), linear.prop_union(lpv.boxed())).prop_map(|(dimension, motion)| Model { dimension, motion })
}
