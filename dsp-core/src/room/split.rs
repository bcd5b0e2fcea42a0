//! Splits as the kernels meet them.

use super::elliptic::MOST_PAIRS;

/// Fewest and most second-order sections of a split, every second one behind the first-order one.
pub(super) const LEAST_SECTIONS: usize = 2;
pub(super) const MOST_SECTIONS: usize = MOST_PAIRS;

/// α (Q31) above which a section of first order carries its rounding error on: 13/16. Below, plain
/// rounding comes to rest within 4 steps, and the section is a fifth cheaper.
pub(super) const SHAPED_FIRST: i32 = 13 << 27;

/// Coefficients of a split, Q31.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Split {
    /// α of the first-order section `(z^-1 - α)/(1 - α z^-1)`.
    pub(super) first: i32,
    /// Number of sections of second order.
    pub(super) sections: u32,
    /// c1/2 and c2/2 of `(c2 + c1 z^-1 + z^-2)/(1 + c1 z^-1 + c2 z^-2)`.
    pub(super) second: [[i32; 2]; MOST_SECTIONS],
}

/// Memory of a split: inputs and outputs of its sections, the latest first, and the bits that they
/// cut off.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct SplitState {
    pub(super) first: [i32; 3],
    pub(super) second: [[i32; 5]; MOST_SECTIONS],
}

impl SplitState {
    pub(super) const SILENT: Self = Self { first: [0; 3], second: [[0; 5]; MOST_SECTIONS] };
}

impl Split {
    pub(super) const NONE: Self = Self { first: 0, sections: 0, second: [[0; 2]; MOST_SECTIONS] };
}
