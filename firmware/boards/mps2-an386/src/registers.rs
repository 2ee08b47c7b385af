//! Memory-mapped registers that have one owner.
//!
//! A driver is given the [`Registers`] of its peripheral and with them the right to use it; offsets are checked when
//! the driver is compiled. So this is the only module that makes addresses from numbers.

use core::marker::PhantomData;
use core::ptr;

/// A kind of peripheral.
pub trait Block {
    /// Size of its registers, in bytes.
    const SIZE: usize;
}

/// The registers of one peripheral of kind `B`. Whoever holds them owns it.
pub struct Registers<B> {
    base: usize,
    block: PhantomData<B>,
}

impl<B: Block> Registers<B> {
    /// The registers at an address.
    ///
    /// # Safety
    ///
    /// A peripheral of kind `B` lies at `base`, on a multiple of four, and nobody else writes its registers while
    /// this value is in use.
    pub const unsafe fn at(base: usize) -> Self {
        Self { base, block: PhantomData }
    }

    /// Reads the register at `OFFSET`. Reading may take a byte or a word from the device.
    pub fn read<const OFFSET: usize>(&self) -> u32 {
        // SAFETY: `address` lies within the peripheral, by the promise made to `at`, and is aligned.
        unsafe { ptr::read_volatile(ptr::with_exposed_provenance(self.address::<OFFSET>())) }
    }

    /// Writes the register at `OFFSET`.
    pub fn write<const OFFSET: usize>(&mut self, value: u32) {
        // SAFETY: as in `read`; and the device has no other owner.
        unsafe { ptr::write_volatile(ptr::with_exposed_provenance_mut(self.address::<OFFSET>()), value) }
    }

    fn address<const OFFSET: usize>(&self) -> usize {
        const { assert!(OFFSET + 4 <= B::SIZE && OFFSET.is_multiple_of(4)) };
        self.base + OFFSET
    }
}
