//! What Arm's floating-point unit has an instruction for and stable Rust, without `std`, no function.
//!
//! `libm` computes a square root of `f32` by whole numbers on these cores, some 50 instructions long; its development version has the
//! instruction. Once a release has, this crate can go.
#![no_std]

/// The square root to the nearest number; of what is below zero, not-a-number.
///
/// There only where hard floats are passed in registers (targets that end in `eabihf`).
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
#[inline(always)]
#[must_use]
pub fn sqrt(x: f32) -> f32 {
    let root: u32;
    // Through registers for whole numbers: rustc does not take floats here (rust-lang/rust#159976).
    //
    // SAFETY: the target says that there is a unit with this instruction; it changes no memory, no stack and no flag that Rust relies on.
    unsafe {
        core::arch::asm!(
            "vmov s0, {bits}",
            "vsqrt.f32 s0, s0",
            "vmov {root}, s0",
            bits = in(reg) x.to_bits(),
            root = lateout(reg) root,
            out("s0") _,
            options(pure, nomem, nostack, preserves_flags)
        );
    }
    f32::from_bits(root)
}
