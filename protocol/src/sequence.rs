//! What sequence numbers say about frames that did not come.

/// What a sequence number says about the frames before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// The one expected.
    Next,
    /// Newer, and some before it did not come, or will come too late.
    After {
        /// How many.
        lost: u16,
    },
    /// The same as one already seen, or older: to be passed over.
    Stale,
}

/// The receiver's account of one sender's sequence numbers.
///
/// Numbers go round after 65 535. Up to 32 767 ahead of the last is newer, everything else is stale; so a link that
/// was silent for longer than that begins again with a hello.
///
/// ```
/// use pliant_protocol::{Arrival, Sequence};
///
/// let mut sequence = Sequence::new();
/// sequence.restart(65_534); // the hello
/// assert_eq!(sequence.arrived(65_535), Arrival::Next);
/// assert_eq!(sequence.arrived(2), Arrival::After { lost: 2 });
/// assert_eq!(sequence.arrived(1), Arrival::Stale);
/// assert_eq!(sequence.arrived(3), Arrival::Next);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sequence {
    last: Option<u16>,
}

impl Sequence {
    /// One that has seen nothing: whichever number comes first is the next.
    pub const fn new() -> Self {
        Self { last: None }
    }

    /// Begins again at a hello, which is new whatever its number is.
    pub const fn restart(&mut self, sequence: u16) {
        self.last = Some(sequence);
    }

    /// Enters the number of a frame that came.
    pub const fn arrived(&mut self, sequence: u16) -> Arrival {
        let ahead = match self.last {
            None => 1,
            Some(last) => sequence.wrapping_sub(last),
        };
        if ahead == 0 || ahead > i16::MAX as u16 {
            return Arrival::Stale;
        }
        self.last = Some(sequence);
        match ahead {
            1 => Arrival::Next,
            _ => Arrival::After { lost: ahead - 1 },
        }
    }
}
