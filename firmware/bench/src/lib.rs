//! What the method is measured with, the same on host and board: seeded scenes, robot positions that make it hard, and digests of the commands.
//!
//! | module | |
//! |---|---|
//! | [`random`] | seeded numbers, each exact in every number type |
//! | [`scene`] | controllers full of obstacles of every shape and motion |
//! | [`stream`] | what happens to one: positions on boundaries, in intersections, at centres; obstacles that rush in |
//! | [`field`] | obstacles to measure one velocity among |
//! | [`skill`] | a learnt motion to measure one nominal velocity of |
//! | [`timing`] | what a tick takes, by whatever [`Clock`](timing::Clock) there is |
//! | [`bits`] | digests of many commands, so that two machines can be compared bit for bit |
//! | [`report`] | what a board prints of all this |
//!
//! All of it is arithmetic of the [`Number`] type and of integers: from one seed, two machines make the same scenes and, if the core keeps
//! its promise, the same commands.
//!
//! ```
//! use pliant_bench::bits;
//! let mut blocks = 0;
//! let digest = bits::run::<f32>(2_000, |_, _| blocks += 1);
//! assert_eq!((blocks, digest), (2, bits::run::<f32>(2_000, |_, _| ())));
//! ```
#![no_std]
#![forbid(unsafe_code)]

pub mod bits;
pub mod digest;
pub mod field;
pub mod number;
pub mod random;
pub mod report;
pub mod scene;
pub mod skill;
pub mod stream;
pub mod timing;

pub use digest::Digest;
pub use number::Number;
pub use random::Random;
pub use scene::{Kind, Plan};
pub use stream::Stream;

/// A tick, s: 2^-10, exact in every number type.
pub const TICK_UNITS: i32 = 16;
