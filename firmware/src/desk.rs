//! The half that faces the links: decodes, checks, answers, counts.

use pliant_protocol::message::{self, DeviceError, StopReason, ToDevice, ToHost};
use pliant_protocol::{Arrival, FRAME_MAX, Frame, FrameError, SCHEMA, Sequence, convert, decode, encode};

use crate::scan::{Collecting, Piece};
use crate::space::{AnyMotion, AnyObstacle, AnyScan, AnyState, AnyTarget, InSpace};
use crate::upload::Upload;
use crate::{Control, OBSTACLES, TICK_HZ};

/// Access to the control half, however it is shared.
///
/// On a board this locks it against the tick, so `work` is kept short.
pub trait Locked {
    /// Does `work` on the control half.
    fn with<R>(&mut self, work: impl FnOnce(&mut Control) -> R) -> R;
}

impl Locked for Control {
    fn with<R>(&mut self, work: impl FnOnce(&mut Control) -> R) -> R {
        work(self)
    }
}

/// Who the device is.
#[derive(Clone, Copy, Debug)]
pub struct Identity {
    /// Name of the board, at most 16 bytes.
    pub board: &'static str,
    /// Version of the firmware: major, minor, patch.
    pub firmware: [u8; 3],
}

/// What only the board can measure; it keeps these up to date.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gauges {
    /// Most stack ever used, bytes.
    pub stack_used: u32,
    /// Longest computation of a tick, us.
    pub worst_tick_us: u32,
    /// Frames too long, or bytes lost because they came too fast.
    pub overruns: u32,
    /// Frames damaged before they were whole: bad stuffing on a serial line.
    pub damaged: u32,
}

/// The conversation with one host, among all who send frames. `P` tells peers apart: an address, or which line it is.
///
/// The host is who said hello last. While it has the device armed nobody can take its place; once the device has stopped - by request or
/// because the host fell silent - the next hello does. Others are obeyed in one thing only: an emergency stop.
#[derive(Debug)]
pub struct Desk<P> {
    identity: Identity,
    /// What the board measures.
    pub gauges: Gauges,
    host: Option<P>,
    upload: Upload,
    /// The last upload was committed, so that a commit sent again because its answer was lost is answered alike.
    committed: bool,
    scan: Collecting,
    dimension: Option<Dimension>,
    arrivals: Sequence,
    departures: u16,
    frames: u32,
    lost: u32,
    refused: u32,
    damaged: u32,
    rejected_states: u32,
}

type Dimension = InSpace<(), ()>;

impl<P: Copy + PartialEq> Desk<P> {
    /// A desk that has heard of nobody yet.
    pub const fn new(identity: Identity) -> Self {
        Self {
            identity,
            gauges: Gauges { stack_used: 0, worst_tick_us: 0, overruns: 0, damaged: 0 },
            host: None,
            upload: Upload::new(),
            committed: false,
            scan: Collecting::new(),
            dimension: None,
            arrivals: Sequence::new(),
            departures: 0,
            frames: 0,
            lost: 0,
            refused: 0,
            damaged: 0,
            rejected_states: 0,
        }
    }

    /// Who the commands go to.
    pub fn host(&self) -> Option<P> {
        self.host
    }

    /// Takes one frame from a peer, whatever its bytes; the answer, if it has one.
    pub fn receive(&mut self, from: P, bytes: &[u8], control: &mut impl Locked) -> Option<ToHost> {
        let Frame { sequence, message } = match decode::<ToDevice>(bytes) {
            Ok(frame) => frame,
            Err(error) => return self.undecoded(error),
        };
        self.frames = self.frames.saturating_add(1);
        let known = self.host == Some(from);
        // A stop is obeyed from anyone, in any order, and moves nobody's sequence but its sender's.
        if message == ToDevice::Stop {
            if known {
                let _ = self.arrivals.arrived(sequence);
            }
            return Some(control.with(|c| {
                c.stop(StopReason::Requested);
                ack(c, sequence)
            }));
        }
        if let ToDevice::Hello { schema } = message {
            return Some(self.hello(from, sequence, schema, control));
        }
        if !known {
            return Some(self.refusal(sequence, DeviceError::NotGreeted));
        }
        control.with(Control::heard);
        match self.arrivals.arrived(sequence) {
            Arrival::Next => {}
            Arrival::After { lost } => self.lost = self.lost.saturating_add(u32::from(lost)),
            Arrival::Stale => return None,
        }
        match self.serve(sequence, message, control) {
            Ok(answer) => answer,
            Err(error) => Some(self.refusal(sequence, error)),
        }
    }

    /// Puts a message into a frame with the next sequence number.
    pub fn frame<'a>(&mut self, message: &ToHost, room: &'a mut [u8; FRAME_MAX]) -> Option<&'a [u8]> {
        let frame = encode(self.departures, message, room).ok()?;
        self.departures = self.departures.wrapping_add(1);
        Some(frame)
    }

    fn hello(&mut self, from: P, sequence: u16, schema: u64, control: &mut impl Locked) -> ToHost {
        let mode = control.with(|c| if c.is_busy() { Some(c.mode()) } else { None });
        match mode {
            Some(mode) if self.host != Some(from) => return self.refusal(sequence, DeviceError::Mode(mode)),
            _ => {}
        }
        // One who speaks another schema is told ours, and becomes nobody's successor.
        if schema == SCHEMA {
            self.arrivals.restart(sequence);
            if self.host != Some(from) {
                self.host = Some(from);
                control.with(Control::greeted);
            }
        }
        let name = self.identity.board.get(..message::BOARD_MAX).unwrap_or(self.identity.board);
        ToHost::Hello {
            schema: SCHEMA,
            firmware: self.identity.firmware,
            board: name.try_into().unwrap_or_default(),
            tick_hz: TICK_HZ,
            obstacles: OBSTACLES as u16,
            components: pliant_core::ds::MAX_COMPONENTS as u8,
        }
    }

    /// The motion of what has been uploaded. In a function of its own: the model is off the stack when the motion finds its place.
    #[inline(never)]
    fn uploaded(&mut self) -> Result<AnyMotion, DeviceError> {
        let model = self.upload.commit().map_err(DeviceError::Upload)?;
        match model.dimension {
            2 => Ok(AnyMotion::Planar(convert::motion::<2>(&model)?)),
            3 => Ok(AnyMotion::Spatial(convert::motion::<3>(&model)?)),
            _ => Err(DeviceError::Dimension),
        }
    }

    fn undecoded(&mut self, error: FrameError) -> Option<ToHost> {
        match DeviceError::of_frame(error) {
            Some((sequence, error)) => Some(self.refusal(sequence, error)),
            None => {
                self.damaged = self.damaged.saturating_add(1);
                None
            }
        }
    }

    fn refusal(&mut self, of: u16, error: DeviceError) -> ToHost {
        self.refused = self.refused.saturating_add(1);
        ToHost::Refused { of, error }
    }

    /// Carries out a request of a greeted host. Checks come first, then one short visit to the control half.
    fn serve(&mut self, of: u16, message: ToDevice, control: &mut impl Locked) -> Result<Option<ToHost>, DeviceError> {
        let mut act = |work: &mut dyn FnMut(&mut Control) -> Result<(), DeviceError>| {
            control.with(|c| {
                work(c)?;
                Ok(Some(ack(c, of)))
            })
        };
        match message {
            ToDevice::State { stamp, position } => {
                let state = self.state(&position).inspect_err(|_| {
                    self.rejected_states = self.rejected_states.saturating_add(1);
                })?;
                control.with(|c| c.state(state, of, stamp))
            }
            ToDevice::Upsert { id, stamp, obstacle } => {
                let mut obstacle = Some(self.obstacle(&obstacle)?);
                act(&mut |c| obstacle.take().map_or(Ok(()), |o| c.upsert(id, o, stamp)))
            }
            ToDevice::Remove { id } => act(&mut |c| c.remove(id)),
            ToDevice::Clear => act(&mut |c| {
                c.clear();
                Ok(())
            }),
            ToDevice::Configure(settings) => {
                let settings = convert::settings(&settings)?;
                act(&mut |c| {
                    c.configure(settings);
                    Ok(())
                })
            }
            ToDevice::Arm { tick } => act(&mut |c| c.arm(tick)),
            ToDevice::UploadBegin { bytes, crc } => {
                self.committed = false;
                self.upload.begin(bytes, crc).map_err(DeviceError::Upload)?;
                act(&mut |_| Ok(()))
            }
            ToDevice::UploadChunk { offset, data } => {
                self.upload.chunk(offset, &data).map_err(DeviceError::Upload)?;
                act(&mut |_| Ok(()))
            }
            ToDevice::UploadCommit if self.committed => act(&mut |_| Ok(())),
            ToDevice::UploadCommit => {
                let motion = self.uploaded()?;
                let dimension = match motion {
                    InSpace::Planar(_) => InSpace::Planar(()),
                    InSpace::Spatial(_) => InSpace::Spatial(()),
                };
                let mut motion = Some(motion);
                let answer = act(&mut |c| motion.take().map_or(Ok(()), |m| c.set_motion(m)))?;
                self.dimension = Some(dimension);
                self.committed = true;
                Ok(answer)
            }
            ToDevice::Scan { stamp, start, total, radius, points } => {
                let piece = Piece { stamp, start, total, radius, points: &points };
                let mut scan = self.scan(&piece)?;
                // Nothing to do for a piece that does not complete its scan.
                act(&mut |c| scan.take().map_or(Ok(()), |s| c.set_scan(s, stamp)))
            }
            ToDevice::Aim { stamp, position, velocity } => {
                let target = self.target(&position, &velocity)?;
                act(&mut |c| c.aim(&target, stamp))
            }
            ToDevice::Statistics => Ok(Some(ToHost::Statistics(self.statistics(control)))),
            // Answered before the sequence was looked at.
            ToDevice::Hello { .. } | ToDevice::Stop => Ok(None),
        }
    }

    fn state(&self, position: &[f32; 3]) -> Result<AnyState, DeviceError> {
        match self.dimension {
            Some(InSpace::Planar(())) => Ok(AnyState::Planar(convert::state::<2>(position)?)),
            Some(InSpace::Spatial(())) => Ok(AnyState::Spatial(convert::state::<3>(position)?)),
            None => Err(DeviceError::NoModel),
        }
    }

    fn obstacle(&self, obstacle: &message::Obstacle) -> Result<AnyObstacle, DeviceError> {
        match self.dimension {
            Some(InSpace::Planar(())) => Ok(AnyObstacle::Planar(convert::obstacle::<2>(obstacle)?)),
            Some(InSpace::Spatial(())) => Ok(AnyObstacle::Spatial(convert::obstacle::<3>(obstacle)?)),
            None => Err(DeviceError::NoModel),
        }
    }

    fn target(&self, position: &[f32; 3], velocity: &[f32; 3]) -> Result<AnyTarget, DeviceError> {
        match self.dimension {
            Some(InSpace::Planar(())) => Ok(AnyTarget::Planar(convert::target::<2>(position, velocity)?)),
            Some(InSpace::Spatial(())) => Ok(AnyTarget::Spatial(convert::target::<3>(position, velocity)?)),
            None => Err(DeviceError::NoModel),
        }
    }

    /// The whole scan, if this piece completes it.
    fn scan(&mut self, piece: &Piece) -> Result<Option<AnyScan>, DeviceError> {
        match self.dimension {
            Some(InSpace::Planar(())) => Ok(self.scan.take::<2>(piece)?.map(AnyScan::Planar)),
            Some(InSpace::Spatial(())) => Ok(self.scan.take::<3>(piece)?.map(AnyScan::Spatial)),
            None => Err(DeviceError::NoModel),
        }
    }

    fn statistics(&self, control: &mut impl Locked) -> message::Statistics {
        message::Statistics {
            frames: self.frames,
            lost: self.lost,
            refused: self.refused,
            crc_errors: self.damaged.saturating_add(self.gauges.damaged),
            overruns: self.gauges.overruns,
            rejected_states: self.rejected_states,
            stack_used: self.gauges.stack_used,
            worst_tick_us: self.gauges.worst_tick_us,
            ..control.with(|c| c.counters())
        }
    }
}

fn ack(control: &Control, of: u16) -> ToHost {
    ToHost::Ack { of, tick: control.ticks(), revision: control.revision() }
}
