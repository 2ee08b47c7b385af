//! A checksum of commands.

use crate::Number;
use pliant_core::{Command, Region};

/// FNV-1a (64 bit) over the bits of commands: any bit that differs shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    /// The sum so far.
    pub fn value(&self) -> u64 {
        self.0
    }

    /// Takes in a word, low byte first.
    pub fn word(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// Takes in all of a command.
    pub fn command<S: Number, const D: usize>(&mut self, command: &Command<S, D>) {
        for v in &command.velocity {
            self.word(v.bits());
        }
        self.word(command.gamma.bits());
        let region = match command.region {
            Region::Free => 0,
            Region::Soft => 1,
            Region::Intersection => 2,
            Region::Hard => 3,
        };
        let nearest = command.nearest.map_or(0, |id| u64::from(id) + 1);
        self.word(nearest << 32 | region << 16 | u64::from(command.status.bits()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_sum() {
        let mut digest = Digest::default();
        digest.word(u64::from_le_bytes(*b"foobar!?"));
        let mut expected = 0xcbf2_9ce4_8422_2325_u64;
        b"foobar!?".iter().for_each(|b| expected = (expected ^ u64::from(*b)).wrapping_mul(0x100_0000_01b3));
        assert_eq!(digest.value(), expected);
    }
}
