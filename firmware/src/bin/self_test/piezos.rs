//! Check of the ADC: its rate, and the bias and noise of each piezo's channel.

use firmware::board::CLOCKS;
use firmware::clock::ADC_RATE_HZ;
use firmware::input::piezo::{CHANNELS, Piezos};
use firmware::{cycles, watchdog};

use crate::failures::Failures;

/// Number of frames of the measurement: a tenth of a second.
const FRAMES: u32 = 4800;
/// Allowed bias in counts, round half the supply.
const BIAS: core::ops::RangeInclusive<u32> = 1800..=2300;
/// Largest rms noise of a channel at rest that leaves the softest strikes intact, in hundredths of
/// a count.
const NOISE: u32 = 400;
/// Largest error of the rate, in parts per million.
const TOLERANCE_PPM: i64 = 2000;

/// Sums over the samples of a channel.
#[derive(Clone, Copy, Default)]
struct Channel {
    sum: u64,
    squares: u64,
    smallest: Option<u16>,
    largest: u16,
}

/// Checks all channels. Piezos must be at rest or absent, but the bias resistors present.
pub(crate) fn check(piezos: &mut Piezos, failures: &mut Failures) {
    let mut channels = [Channel::default(); CHANNELS];
    let begun = cycles::now();
    piezos.start(begun);
    let mut counted = 0;
    while counted < FRAMES {
        let Ok(parts) = piezos.take() else {
            defmt::error!("ADC: stopped after {=u32} frames: {=str}", counted, failures.check(false));
            return;
        };
        for frame in parts.into_iter().flatten() {
            counted += 1;
            for (channel, &sample) in channels.iter_mut().zip(frame) {
                channel.sum += u64::from(sample);
                channel.squares += u64::from(sample) * u64::from(sample);
                channel.smallest = Some(channel.smallest.unwrap_or(sample).min(sample));
                channel.largest = channel.largest.max(sample);
            }
        }
        watchdog::feed();
    }
    let spent = cycles::now().wrapping_sub(begun);
    let rate_hz = i64::from(counted) * i64::from(CLOCKS.core_hz()) / i64::from(spent.max(1));
    let off_ppm = (rate_hz - i64::from(ADC_RATE_HZ)) * 1_000_000 / i64::from(ADC_RATE_HZ);
    let verdict = failures.check(off_ppm.abs() <= TOLERANCE_PPM);
    defmt::info!("ADC rate: {=i64} Hz, by its timer {=u32} Hz: {=str}", rate_hz, ADC_RATE_HZ, verdict);
    for (number, channel) in channels.iter().enumerate() {
        let frames = u64::from(counted);
        let mean = (channel.sum / frames) as u32;
        // The variance is taken times 10^4, so that its root is in hundredths of a count. 4800^2
        // times a square of 12 bits times 10^4 has 62 bits.
        let spread = (frames * channel.squares).saturating_sub(channel.sum * channel.sum);
        let variance = spread * 10_000 / (frames * frames);
        let noise = variance.isqrt() as u32;
        let verdict = failures.check(BIAS.contains(&mean) && noise <= NOISE);
        defmt::info!(
            "piezo {=usize}: bias {=u32} counts, noise {=u32}/100 counts rms, {=u16} to {=u16}: {=str}",
            number,
            mean,
            noise,
            channel.smallest.unwrap_or(0),
            channel.largest,
            verdict
        );
    }
}
