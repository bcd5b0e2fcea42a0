//! The map from the ADC's frames to the output's: two clocks whose ratio is known exactly.

use super::error::TriggerError;
use crate::SampleRate;

/// Map `output = floor(adc · Q / P)`, where `P/Q` is the reduced ratio of the ADC's rate to the
/// output's.
///
/// It is exact for every 64-bit frame whose result fits 64 bits, so that nothing drifts.
///
/// ```
/// use dsp_core::{SampleRate, trigger::FrameMap};
/// let adc = SampleRate::HZ_48000;
/// let i2s = SampleRate::new(86_000_000, 1792).unwrap();
/// let map = FrameMap::new(adc, i2s)?;
/// assert_eq!(map.ratio(), (5376, 5375));
/// assert_eq!(map.output_frame(5376 * 1_000_000), 5375 * 1_000_000);
/// # Ok::<(), dsp_core::trigger::TriggerError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameMap {
    adc: u32,
    output: u32,
}

impl FrameMap {
    /// Makes the map between two rates.
    ///
    /// # Errors
    /// [`TriggerError::Ratio`] if the reduced ratio does not fit two numbers of 31 bits.
    pub fn new(adc: SampleRate, output: SampleRate) -> Result<Self, TriggerError> {
        let ((adc_numerator, adc_denominator), (out_numerator, out_denominator)) = (adc.ratio(), output.ratio());
        // Products of two 32-bit numbers fit 64 bits.
        let p = u64::from(adc_numerator) * u64::from(out_denominator);
        let q = u64::from(out_numerator) * u64::from(adc_denominator);
        let divisor = greatest_common_divisor(p, q);
        let reduced = |value: u64| {
            let value = value.checked_div(divisor)?;
            u32::try_from(value).ok().filter(|&value| value > 0 && value < 1 << 31)
        };
        match (reduced(p), reduced(q)) {
            (Some(adc), Some(output)) => Ok(Self { adc, output }),
            _ => Err(TriggerError::Ratio { adc, output }),
        }
    }

    /// Reduced ratio (P, Q): the output takes Q frames in the time of P frames of the ADC.
    pub const fn ratio(self) -> (u32, u32) {
        (self.adc, self.output)
    }

    /// Output frame that plays when the ADC takes frame `adc_frame`, rounded down and saturating.
    /// Both count from a common start.
    pub fn output_frame(self, adc_frame: u64) -> u64 {
        scale(adc_frame, self.output, self.adc)
    }

    /// ADC frame that is taken when output frame `output_frame` plays, rounded down and saturating.
    /// Both count from a common start.
    pub fn adc_frame(self, output_frame: u64) -> u64 {
        scale(output_frame, self.adc, self.output)
    }
}

/// Quotient `floor(value · numerator / denominator)`, in two parts so that only the result can
/// overflow.
fn scale(value: u64, numerator: u32, denominator: u32) -> u64 {
    let (numerator, denominator) = (u64::from(numerator), u64::from(denominator));
    let whole = value.checked_div(denominator).unwrap_or(0);
    let rest = value.checked_rem(denominator).unwrap_or(0);
    // Both factors of the second product are below 2^31.
    let part = rest.wrapping_mul(numerator).checked_div(denominator).unwrap_or(0);
    whole.saturating_mul(numerator).saturating_add(part)
}

fn greatest_common_divisor(mut a: u64, mut b: u64) -> u64 {
    while let Some(rest) = a.checked_rem(b) {
        (a, b) = (b, rest);
    }
    a
}
