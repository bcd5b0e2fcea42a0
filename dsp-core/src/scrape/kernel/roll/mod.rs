//! The hot loops of a ball: its turn, its depth, and its force.

#[cfg(cortex_m4f)]
mod cortex_m4;
#[cfg(not(cortex_m4f))]
mod portable;

use super::super::ramp::Ramp;
use crate::time::TICK_FRAMES;

#[cfg(cortex_m4f)]
pub(in super::super) use cortex_m4::{press, sink, turn};
#[cfg(not(cortex_m4f))]
pub(in super::super) use portable::{press, sink, turn};

/// Values of a tick's frames that the loops hand on, and the path's slopes.
#[derive(Clone, Debug)]
#[repr(C)]
pub(in super::super) struct Frames {
    /// Depths.
    pub(in super::super) depths: [i32; TICK_FRAMES],
    /// Factors `1 + λ/k ρ'`.
    pub(in super::super) factors: [i32; TICK_FRAMES],
    /// Slopes of the path, Q28 of their unit.
    pub(in super::super) slopes: [i32; TICK_FRAMES],
}

impl Frames {
    /// Frames of silence.
    pub(in super::super) const NONE: Self =
        Self { depths: [0; TICK_FRAMES], factors: [0; TICK_FRAMES], slopes: [0; TICK_FRAMES] };
}

/// Turn of a ball over a tick, and what depends on it alone.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(in super::super) struct Turning {
    /// Cosine and sine of the turn, Q30.
    pub(in super::super) cosine: i32,
    pub(in super::super) sine: i32,
    /// Tangent of half a frame's turn, Q32, and the turn's sine, Q31: a turn is below 1/2.
    pub(in super::super) half: Ramp,
    pub(in super::super) whole: Ramp,
    /// Resting depth, and the offset as a multiple of a quarter of the depth's unit.
    pub(in super::super) rest: i32,
    pub(in super::super) offset: i32,
    /// From the sine, Q30, to the factor.
    pub(in super::super) rate: Ramp,
}

/// Height of the path over a tick, and its share of the factor.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(in super::super) struct Sinking {
    /// Height, with 32 bits more than the depth's.
    pub(in super::super) height: i64,
    /// From the slope to the height's rise.
    pub(in super::super) rise: Ramp,
    /// Share of the height that is lost in a frame, Q32, with its sign.
    pub(in super::super) less: i32,
    /// From the slope to the factor.
    pub(in super::super) rate: Ramp,
    /// Factor of a ball that does not sink.
    pub(in super::super) one: i32,
}

/// Force of a ball over a tick.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(in super::super) struct Pressing {
    /// Force that is left out, Q27 with 32 bits more.
    pub(in super::super) slow: i64,
    /// Mantissa of the stiffness, 2^29 to 2^30.
    pub(in super::super) stiffness: i32,
    /// Share of a frame's force, Q32, that goes over into what is left out.
    pub(in super::super) share: i32,
    /// Bits that the product of a full depth, stiffness and factor has too many.
    pub(in super::super) right: i32,
}

/// Number of pieces of the power.
const PIECES: usize = 64;

/// Power 1.5 of numbers from 1/4 to 1, Q31: parabolas over the way from each piece's middle, terms
/// of 1, t and t², t from -1/2 to 1/2. Below a quarter there is nothing but 0.
static POWERS: [[i32; 4]; PIECES] = {
    let mut pieces = [[0; 4]; PIECES];
    let mut piece = PIECES / 4;
    while piece < PIECES {
        // The parabola through the middle and two places 0.866 of the way to the ends.
        let apart = 0.866_025_403_784 / 2.0;
        let middle = piece as f64 + 0.5;
        let (low, centre, high) = (power(middle - apart), power(middle), power(middle + apart));
        let slope = (high - low) / (2.0 * apart);
        let growth = (high - 2.0 * centre + low) / (2.0 * apart * apart);
        pieces[piece] = [centre as i32, slope as i32, growth as i32, 0];
        piece += 1;
    }
    pieces
};

/// Power 1.5 of a number of pieces, Q31.
const fn power(pieces: f64) -> f64 {
    let x = pieces / PIECES as f64;
    // Newton's method from above.
    let (mut root, mut step) = (1.0, 0);
    while step < 8 {
        root = 0.5 * (root + x / root);
        step += 1;
    }
    x * root * 2_147_483_648.0
}
