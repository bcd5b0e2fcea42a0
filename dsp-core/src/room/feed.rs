//! The room's input: one signal made of left and right whose energy is `(L² + R²)/2` at every pan.
//!
//! ```text
//!  left  ─► all-pass chain 0 ─┐
//!                            (+)─► 1/4 ─► splits
//!  right ─► all-pass chain 1 ─┘
//! ```
//!
//! Both chains pass all frequencies alike. Their phases differ by 90° ± 7.7° from 1/1200 to 1/2.4
//! of the rate (40 Hz to 20 kHz at 48 kHz). A sound on both sides, such as a pad's, then adds up by
//! energy: `cos² + sin² = 1` by the constant-power law, whatever the pan. A plain sum gives a pad
//! in the middle 3 dB more than one at a side. The ripple of the phases leaves at most 0.63 dB at
//! one frequency, and 0.4 dB over all.
//!
//! Two chains cost 33 cycles a frame more than a plain sum. Splitting and feeding both sides on
//! their own costs 65 and more; a third bus beside the stereo sum costs every pad that rings.
//!
//! **Form.** `(z^-1 - α)/(1 - α z^-1)` with one state: `d = x - s`, `y = s - α d`, `s' = x - α d`.
//! Where α is near 1 it is `s' = s + (1 - α) d`, `y = s' - d`. The slowest section keeps 32 bits
//! behind its state's last step: rounding there would be raised by 1/(1 - α), 242.
//!
//! **Bounds.** Inputs are clipped to ±2^27. The impulse responses of a chain's sections sum up to
//! at most 2.99, 4.43 and 4.45 (this file's test), a state is at most as large as its section's
//! input, and so no difference is beyond 2 · 4.43 · 2^27 < 2^30.2, the sum of both chains below
//! 2^30.1.

use super::chain::ChainState;
use super::kernel;

/// Memory of both chains.
#[derive(Clone, Copy, Debug)]
pub(super) struct Feed {
    sides: [ChainState; 2],
}

/// Size of the states, in steps, that rounding leaves: -133 dBFS.
const RESTING_STEPS: u32 = 32;

impl Feed {
    pub(super) const SILENT: Self = Self { sides: [ChainState { slow: 0, second: 0, last: 0 }; 2] };

    /// Adds `wet` to `out` and makes the room's input of the former `out`. Gives 0 only if that was
    /// silent.
    pub(super) fn exchange(&mut self, out: &mut [[i32; 2]], wet: &[[i32; 2]], input: &mut [i32]) -> u32 {
        kernel::exchange(out, wet, input, &mut self.sides)
    }

    /// Silences the remains of rounding after a block of silence. True if the chains still ring.
    pub(super) fn settle(&mut self, was_silent: bool) -> bool {
        let rests = |side: &ChainState| {
            [(side.slow >> 32) as i32, side.second, side.last].iter().all(|x| x.unsigned_abs() <= RESTING_STEPS)
        };
        if was_silent && self.sides.iter().all(rests) {
            *self = Self::SILENT;
        }
        self.sides.iter().any(|side| side.slow != 0 || side.second != 0 || side.last != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;
    use std::vec::Vec;

    /// Answer of a chain to 2^24 steps on one side.
    fn response(side: usize, frames: usize) -> Vec<f64> {
        let mut out = vec![[0; 2]; frames];
        out[0][side] = 1 << 26;
        let mut input = vec![0; frames];
        let mut feed = Feed::SILENT;
        feed.exchange(&mut out, &vec![[0; 2]; frames], &mut input);
        input.iter().map(|&x| f64::from(x) / f64::from(1 << 24)).collect()
    }

    #[test]
    fn chains_pass_all_frequencies_alike_and_a_quarter_turn_apart() {
        let responses = [0, 1].map(|side| response(side, 24_000));
        for step in 0..=100 {
            let hz = 40.0 * 500f64.powf(f64::from(step) / 100.0);
            let turn = std::f64::consts::TAU * hz / 48_000.0;
            let [left, right] = responses.each_ref().map(|response| {
                let mut sum = [0.0, 0.0];
                for (frame, x) in response.iter().enumerate() {
                    let (sine, cosine) = (turn * frame as f64).sin_cos();
                    sum = [sum[0] + x * cosine, sum[1] - x * sine];
                }
                sum
            });
            for side in [left, right] {
                let power = side[0] * side[0] + side[1] * side[1];
                assert!((power - 1.0).abs() < 1e-3, "{hz:.0} Hz: {power}");
            }
            let middle = 1.0 + left[0] * right[0] + left[1] * right[1];
            let db = 10.0 * middle.log10();
            assert!(db.abs() < 0.63, "{hz:.0} Hz: a pad in the middle is {db:.2} dB above one at a side");
        }
    }

    #[test]
    fn no_section_raises_a_signal_beyond_its_headroom() {
        for (side, alphas) in [[0.995_873, 0.908_579, 0.075_641], [0.977_746, 0.664_43, -0.648_582]].iter().enumerate()
        {
            let mut signal = vec![0.0; 40_000];
            signal[0] = 1.0;
            for (alpha, most) in alphas.iter().zip([2.995, 4.44, 4.46]) {
                let mut state = 0.0;
                for x in &mut signal {
                    let d = *x - state;
                    (*x, state) = (state - alpha * d, *x - alpha * d);
                }
                let sum: f64 = signal.iter().map(|x: &f64| x.abs()).sum();
                assert!(sum <= most, "side {side}, α {alpha}: {sum:.3}");
            }
        }
    }

    #[test]
    fn chains_come_to_rest_after_any_sound() {
        for level in [1, -1, 1 << 20, i32::MIN, i32::MAX] {
            let mut feed = Feed::SILENT;
            let mut input = [0; 128];
            for _ in 0..100 {
                let mut out = [[level, level.saturating_neg()]; 128];
                feed.exchange(&mut out, &[[0; 2]; 128], &mut input);
            }
            let blocks = (0..400).find(|_| {
                let heard = feed.exchange(&mut [[0; 2]; 128], &[[0; 2]; 128], &mut input);
                assert_eq!(heard, 0);
                !feed.settle(true)
            });
            assert!(blocks.is_some(), "{level}: {feed:?}");
        }
    }
}
