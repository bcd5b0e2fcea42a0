//! Check of the clocks against each other. All come from one crystal, so this checks the dividers.

use firmware::audio::i2s::{I2s, position};
use firmware::board::CLOCKS;
use firmware::{cycles, watchdog};

use crate::failures::Failures;

/// Number of frames that are counted: a quarter of a second.
const FRAMES: u32 = 12_000;
/// Largest error of the rate, in parts per million: the count may be off by a frame at either end.
const TOLERANCE_PPM: i64 = 200;

/// Checks the rate at which frames leave the I2S output against the core's clock.
pub(crate) fn check(i2s: &mut I2s, failures: &mut Failures) {
    i2s.start();
    let mut at = position();
    // The count goes from the beginning of one frame to that of another.
    while position() == at {}
    at = position();
    let begun = cycles::now();
    let mut counted = 0;
    while counted < FRAMES {
        let next = position();
        counted += ((next + 64 - at) % 64) as u32;
        at = next;
        if counted % 512 == 0 {
            watchdog::feed();
        }
    }
    let spent = cycles::now().wrapping_sub(begun);
    let milli_hz = u64::from(counted) * u64::from(CLOCKS.core_hz()) * 1000 / u64::from(spent.max(1));
    let (numerator, denominator) = CLOCKS.sample_rate_ratio();
    let expected = u64::from(numerator) * 1000 / u64::from(denominator);
    let off_ppm = (milli_hz as i64 - expected as i64) * 1_000_000 / expected as i64;
    let verdict = failures.check(off_ppm.abs() <= TOLERANCE_PPM);
    defmt::info!("I2S rate: {=u64} mHz, by its dividers {=u64} mHz: {=str}", milli_hz, expected, verdict);
}
