//! Digests of many commands, so that two machines can be compared bit for bit.

use crate::{Digest, Kind, Number, Plan, stream};
use pliant_core::Status;

/// Ticks of a block: each is a scene of its own, so that a difference is found in no more.
pub const BLOCK: u32 = 1000;
/// Most obstacles of a block.
pub const OBSTACLES: usize = 16;

/// What blocks went through, for a test that they go everywhere.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    /// Every status flag that some command had.
    pub status: Status,
    /// Commands by region: free, soft, intersection, hard.
    pub regions: [u32; 4],
    /// Status flags: how many commands had each.
    pub flags: [u32; 16],
}

/// The scene of a block, and whether it is planar: kinds, dimensions, obstacles and points all go round.
pub fn plan(block: u32) -> (Plan, bool) {
    let kind = match block / 2 % 4 {
        0 => Kind::Ellipsoids,
        3 => Kind::Crowd,
        _ => Kind::Mixed,
    };
    let obstacles = (block * 7 % (OBSTACLES as u32 + 1)) as u16;
    let plan = Plan {
        seed: 1 + block,
        obstacles,
        components: 1 + block as usize * 5 % 8,
        points: if block % 3 == 2 { 24 } else { 0 },
        kind,
    };
    (plan, block.is_multiple_of(2))
}

/// Runs `ticks` ticks (in whole blocks) in the plane and in space, with every shape and motion, and gives the digest of all commands; `each`
/// is called with every block's number and its own digest.
pub fn run<S: Number>(ticks: u32, mut each: impl FnMut(u32, u64)) -> u64 {
    let mut all = Digest::default();
    for number in 0..ticks.div_ceil(BLOCK) {
        let (digest, _) = block::<S>(number);
        all.word(digest);
        each(number, digest);
    }
    all.value()
}

/// One block.
pub fn block<S: Number>(number: u32) -> (u64, Seen) {
    let (plan, planar) = plan(number);
    if planar { commands::<S, 2>(plan) } else { commands::<S, 3>(plan) }
}

fn commands<S: Number, const D: usize>(plan: Plan) -> (u64, Seen) {
    let (mut digest, mut seen) = (Digest::default(), Seen::default());
    let mut number = 0_u32;
    stream::run::<S, D, OBSTACLES>(plan, BLOCK, |controller, state| {
        number += 1;
        // Now and then the robot's state stays away.
        let late = number % 64 > 60;
        let dt = stream::Stream::<S, D>::dt();
        let command = if late { controller.tick_late(state, dt) } else { controller.tick(state, dt) };
        digest.command(&command);
        seen.status |= command.status;
        if let Some(count) = seen.regions.get_mut(command.region as usize) {
            *count += 1;
        }
        for (bit, count) in seen.flags.iter_mut().enumerate() {
            *count += u32::from(command.status.bits() >> bit & 1);
        }
        command
    });
    (digest.value(), seen)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pliant_core::scalar::Fixed;

    fn seen<S: Number>(blocks: u32) -> Seen {
        let mut all = Seen::default();
        for number in 0..blocks {
            let (_, seen) = block::<S>(number);
            all.status |= seen.status;
            all.regions.iter_mut().zip(seen.regions).for_each(|(a, b)| *a += b);
            all.flags.iter_mut().zip(seen.flags).for_each(|(a, b)| *a += b);
        }
        all
    }

    #[test]
    fn blocks_go_everywhere() {
        for seen in [seen::<f32>(16), seen::<Fixed>(16)] {
            assert_eq!(seen.status | Status::NOT_FINITE, Status::all(), "{seen:?}");
            assert!(!seen.status.contains(Status::NOT_FINITE));
            assert!(seen.regions.iter().all(|n| *n > 200), "{seen:?}");
        }
    }

    #[test]
    fn blocks_repeat_and_differ() {
        assert_eq!(block::<f32>(3).0, block::<f32>(3).0);
        assert_ne!(block::<f32>(3).0, block::<f32>(4).0);
        assert_ne!(block::<f32>(3).0, block::<f64>(3).0);
    }
}
