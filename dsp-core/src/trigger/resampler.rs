//! The resampler from the ADC's clock to the output's, for direct drive.

use super::clock::FrameMap;
use super::error::TriggerError;
use crate::SampleRate;

/// Number of samples that a resampler holds.
const BUFFER: usize = 256;
/// Number of later samples that the interpolation at a position needs.
const AHEAD: u32 = 3;
/// Number of earlier samples that the interpolation needs, beside the sample at the position.
const BEHIND: u64 = 2;
/// 1.0 of fractions and weights, in Q28.
const ONE: i32 = 1 << 28;

/// Stream of samples that is written at the ADC's rate and read at the output's.
///
/// Output frame `k` is the signal at the ADC frame `k·P/Q - delay` with the exact ratio of both
/// rates, so that nothing ever drifts. Between samples the signal is interpolated by a polynomial
/// of degree 5 through six samples (Lagrange). The shortest delay is 3 frames.
///
/// Late or lost samples do not shift time. A position without samples (not yet pushed, or pushed
/// over 256 frames ago) sounds as 0, and [`missed`](Self::missed) counts it.
///
/// ```
/// use dsp_core::{SampleRate, trigger::Resampler};
/// let output = SampleRate::new(86_000_000, 1792).unwrap();
/// let mut resampler = Resampler::new(SampleRate::HZ_48000, output, 3)?;
/// let mut force = [0; 32];
/// for _ in 0..100 {
///     resampler.push(&[1 << 20; 32]);
///     resampler.pull(&mut force[..31]);
/// }
/// assert!(force[..31].iter().all(|sample| (sample - (1 << 20)).abs() <= 1));
/// assert_eq!(resampler.missed(), 0);
/// # Ok::<(), dsp_core::trigger::TriggerError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Resampler {
    ring: [i32; BUFFER],
    /// Number of samples pushed so far.
    pushed: u64,
    /// Number of samples pushed up to the last that is not 0.
    quiet_from: u64,
    /// Position of the next output frame plus the delay, in whole ADC frames.
    whole: u64,
    /// Remainder of that position, in ADC frames over Q.
    remainder: u32,
    delay: u64,
    /// Step of the position from one output frame to the next: `P = step_whole·Q + step_rest`.
    step_whole: u32,
    step_rest: u32,
    q: u32,
    /// Quotient `2^60 / Q`.
    reciprocal: u64,
    missed: u64,
}

impl Resampler {
    /// Shortest delay in ADC frames.
    pub const MIN_DELAY: u32 = AHEAD;
    /// Longest delay in ADC frames.
    pub const MAX_DELAY: u32 = BUFFER as u32 - 8;

    /// Makes a resampler whose output is `delay_frames` ADC frames late. The delay is at least 3
    /// frames, and longer by the time that blocks come after they are asked for.
    ///
    /// # Errors
    /// [`TriggerError::Delay`] for a delay outside its range. [`TriggerError::Ratio`] if the
    /// reduced ratio of the rates does not fit two numbers of 31 bits.
    pub fn new(adc: SampleRate, output: SampleRate, delay_frames: u32) -> Result<Self, TriggerError> {
        let (min, max) = (Self::MIN_DELAY, Self::MAX_DELAY);
        if !(min..=max).contains(&delay_frames) {
            return Err(TriggerError::Delay { frames: delay_frames, min, max });
        }
        let (p, q) = FrameMap::new(adc, output)?.ratio();
        Ok(Self {
            ring: [0; BUFFER],
            pushed: 0,
            quiet_from: 0,
            whole: 0,
            remainder: 0,
            delay: u64::from(delay_frames),
            step_whole: p.checked_div(q).unwrap_or(0),
            step_rest: p.checked_rem(q).unwrap_or(0),
            q,
            reciprocal: (1u64 << 60).checked_div(u64::from(q)).unwrap_or(0),
            missed: 0,
        })
    }

    /// Takes the next samples at the ADC's rate.
    pub fn push(&mut self, samples: &[i32]) {
        for &sample in samples {
            if let Some(slot) = self.ring.get_mut((self.pushed % BUFFER as u64) as usize) {
                *slot = sample;
            }
            self.pushed = self.pushed.wrapping_add(1);
            if sample != 0 {
                self.quiet_from = self.pushed;
            }
        }
    }

    /// Writes the next samples at the output's rate.
    pub fn pull(&mut self, output: &mut [i32]) {
        for slot in output {
            *slot = self.sample();
            let remainder = self.remainder.wrapping_add(self.step_rest);
            let carry = remainder >= self.q;
            // Q is below 2^31, so that the sum of two remainders fits 32 bits.
            self.remainder = if carry { remainder.wrapping_sub(self.q) } else { remainder };
            self.whole = self.whole.wrapping_add(u64::from(self.step_whole) + u64::from(carry));
        }
    }

    /// Number of output samples so far for which input was missing.
    pub fn missed(&self) -> u64 {
        self.missed
    }

    fn sample(&mut self) -> i32 {
        // Before the first sample there was silence.
        let Some(at) = self.whole.checked_sub(self.delay) else { return 0 };
        let Some(first) = at.checked_sub(BEHIND) else { return 0 };
        let last = at.saturating_add(u64::from(AHEAD));
        if last >= self.pushed || first.saturating_add(BUFFER as u64) < self.pushed {
            self.missed = self.missed.saturating_add(1);
            return 0;
        }
        if first >= self.quiet_from {
            return 0;
        }
        let fraction = ((u64::from(self.remainder).wrapping_mul(self.reciprocal)) >> 32) as i32;
        let weights = lagrange_weights(fraction);
        let mut sum = 0i64;
        for (index, &weight) in (first..=last).zip(&weights) {
            let sample = self.ring.get((index % BUFFER as u64) as usize).copied().unwrap_or(0);
            // Six products of 28 and 31 bits.
            sum = sum.wrapping_add(i64::from(weight) * i64::from(sample));
        }
        let rounded = sum.wrapping_add(i64::from(ONE / 2)) >> 28;
        rounded.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
    }
}

/// Weights of the samples at -2 to 3 for the polynomial through them at `d`, 0 to 1, all in Q28.
fn lagrange_weights(d: i32) -> [i32; 6] {
    // Sixths are taken early, so that every product stays below 6; less than 8 fits.
    let product = |x: i32, y: i32| ((i64::from(x) * i64::from(y)) >> 28) as i32;
    let [a, b, c, e, f, g] = [2, 1, 0, -1, -2, -3].map(|node: i32| d.wrapping_add(node.wrapping_mul(ONE)));
    let ab = product(a, b);
    let fg = product(f, g);
    let abc_sixth = product(ab, c) / 6;
    let efg_sixth = product(e, fg) / 6;
    [
        product(product(b, c), efg_sixth) / -20,
        product(product(a, c), efg_sixth) / 4,
        product(ab, efg_sixth) / -2,
        product(abc_sixth, fg) / 2,
        product(product(abc_sixth, e), g) / -4,
        product(abc_sixth, product(e, f)) / 20,
    ]
}
