//! Turn: the angle of the networks' mixes, the same for all bands and a function of time alone.

use super::dimensions::BLOCK_FRAMES;
use crate::SampleRate;
use crate::fixed;

/// Number of frames that are mixed by the same angle at the full rate.
pub(super) const TURN_FRAMES: usize = 16;
/// Swing of the angle to either side, in radians.
const SWING: f64 = 3.0;
/// Swings a second: they move the resonances by up to 6 Hz, and spread a steady tone by as much. A
/// wider swing makes a short band's decay uneven.
const SWINGS_HZ: f64 = 1.9;

/// Phase of the swing as a part of a turn, 2^32 = one turn; sine and cosine of the angle as Q31.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    phase: u32,
    /// Phase of half a block.
    speed: u32,
    /// Sine and cosine at the block's beginning, its middle and its end.
    at: [[i32; 2]; 3],
}

impl Turn {
    pub(super) const NONE: Self = Self { phase: 0, speed: 0, at: [[0; 2]; 3] };

    pub(super) fn new(rate: SampleRate) -> Self {
        let speed = libm::rint(SWINGS_HZ * (BLOCK_FRAMES / 2) as f64 / rate.hz() * 4_294_967_296.0) as u32;
        let mut turn = Self { speed, ..Self::NONE };
        turn.at = [[0; 2], [0; 2], turn.next()];
        turn
    }

    /// Goes on by a block, after `silent_blocks` that were silent.
    pub(super) fn advance(&mut self, silent_blocks: u32) {
        if silent_blocks > 0 {
            self.phase = self.phase.wrapping_add(self.speed.wrapping_mul(2).wrapping_mul(silent_blocks));
            self.at = [[0; 2], [0; 2], self.now()];
        }
        let [_, _, end] = self.at;
        self.at = [end, self.next(), self.next()];
    }

    /// Goes on by half a block.
    fn next(&mut self) -> [i32; 2] {
        self.phase = self.phase.wrapping_add(self.speed);
        self.now()
    }

    fn now(&self) -> [i32; 2] {
        // Q31 times radians over a turn, to parts of a turn.
        let angle = ((i64::from(sine(self.phase)) * SWING_PER_TURN_Q30) >> 29) as u32;
        [sine(angle), sine(angle.wrapping_add(1 << 30))]
    }

    /// Sines and cosines of each sixteenth frame of a block, on the straight lines between those at
    /// its beginning, its middle and its end.
    pub(super) fn steps(&self) -> [[i32; 2]; BLOCK_FRAMES / TURN_FRAMES] {
        let [begin, middle, end] = self.at;
        let mut steps = [[0; 2]; BLOCK_FRAMES / TURN_FRAMES];
        let (first, second) = steps.split_at_mut(BLOCK_FRAMES / TURN_FRAMES / 2);
        for (half, [sine, cosine], [next_sine, next_cosine]) in [(first, begin, middle), (second, middle, end)] {
            // The difference of two Q31 fits when both are a quarter.
            let (sine_step, cosine_step) = ((next_sine >> 2) - (sine >> 2), (next_cosine >> 2) - (cosine >> 2));
            let (mut sine, mut cosine) = (sine, cosine);
            for step in half {
                *step = [sine, cosine];
                (sine, cosine) = (sine + sine_step, cosine + cosine_step);
            }
        }
        steps
    }
}

/// `SWING / 2π` as Q30.
const SWING_PER_TURN_Q30: i64 = (SWING / (2.0 * core::f64::consts::PI) * 1_073_741_824.0) as i64;

/// Sine of a part of a turn, Q31, a little (2^-22) low, so that a rotation by it never adds energy.
/// Within 4e-7.
fn sine(angle: u32) -> i32 {
    // Quarters 1 and 2 mirrored: an angle from -1/4 to 1/4 turn, as Q31 of a quarter.
    let folded = if (angle.wrapping_add(1 << 30) as i32) < 0 { (1u32 << 31).wrapping_sub(angle) } else { angle } as i32;
    // 2^30 is a quarter turn, z = 1 in Q30; all that follows is below 2.
    let times = |a: i32, b: i32| i64::from(a) * i64::from(b);
    let z2 = (times(folded, folded) >> 30) as i32;
    // x (π/2 - (π/2)³ x²/3! + ...), to the eleventh power, Q30, times 1 - 2^-22.
    let [coefficients @ .., last] = COEFFICIENTS_Q30;
    let sum = coefficients.iter().rev().fold(last, |sum, &coefficient| coefficient + (times(sum, z2) >> 30) as i32);
    fixed::saturate(times(sum, folded) >> 29)
}

const fn q30(value: f64) -> i32 {
    (value * 1_073_741_824.0 * (1.0 - 1.0 / 4_194_304.0)) as i32
}

const COEFFICIENTS_Q30: [i32; 6] = [
    q30(core::f64::consts::FRAC_PI_2),
    q30(-0.645_964_097_506_246_3),
    q30(0.079_692_626_246_167_05),
    q30(-0.004_681_754_135_318_688),
    q30(0.000_160_441_184_787_359_8),
    q30(-0.000_003_598_843_235_212_085),
];
