//! The all-pass chains of the room's input as the kernels meet them.

/// Coefficients of one side.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Chain {
    /// 1 - α of the first section and of the second, Q32.
    pub(super) complements: [i32; 2],
    /// -α of the third section, Q32; on the right side less 1/2, which is added by a shift.
    pub(super) last: i32,
}

/// Chains of both sides: α is 0.995873, 0.908579, 0.075641 left and 0.977746, 0.66443, -0.648582
/// right (least largest error of 90° from 40 Hz to 20 kHz at 48 kHz).
pub(super) const CHAINS: [Chain; 2] = [
    Chain { complements: [q32(1.0 - 0.995_873), q32(1.0 - 0.908_579)], last: q32(-0.075_641) },
    Chain { complements: [q32(1.0 - 0.977_746), q32(1.0 - 0.664_43)], last: q32(0.648_582 - 0.5) },
];

/// States of one side, in bus steps times 1/4.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct ChainState {
    /// State of the slowest section, times 2^32.
    pub(super) slow: i64,
    pub(super) second: i32,
    pub(super) last: i32,
}

const fn q32(value: f64) -> i32 {
    (value * 4_294_967_296.0) as i32
}
