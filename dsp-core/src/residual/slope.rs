//! Slope of the residual's windows, computed by the compiler.

use crate::fourier::{MAX_POINTS, quarter_sine};

/// Number of samples of a window's slope: a quarter of the largest wave.
pub(super) const SLOPE_FRAMES: usize = MAX_POINTS / 2;

/// `sin(π/2 k/256)`, the slope of windows: `sin² + cos² = 1` at every step.
pub(super) static SLOPE: [f32; SLOPE_FRAMES + 1] = {
    let mut table = [0.0; SLOPE_FRAMES + 1];
    let mut index = 0;
    while index < table.len() {
        table[index] = quarter_sine(index as f64 / SLOPE_FRAMES as f64) as f32;
        index += 1;
    }
    table
};
