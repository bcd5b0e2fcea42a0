//! Sweep of long rolls on every stage at once.

use std::thread;

use super::Extent;
use crate::rolls::roll;

/// Rolls on every stage for an hour, in blocks of 32 and of 480 frames.
///
/// The sound is bounded, silent within 45 s of the roll's end, and bit-equal for both block sizes.
///
/// # Panics
/// If a limit is broken.
pub fn hour(extent: Extent) {
    let seconds = extent.pick(12.0, 3600.0);
    let other = thread::spawn(move || roll(seconds, 480, |_| {}));
    let rolled = roll(seconds, 32, |_| {});
    let other = other.join().expect("the roll in blocks of 480 frames ends");
    println!("{rolled:?}");
    assert!(rolled.strikes as f64 > 400.0 / 12.0 * seconds, "{} strikes", rolled.strikes);
    assert!(rolled.peak > 0.05 && rolled.peak < 15.9, "peak {}", rolled.peak);
    let silent_after_s = rolled.silent_after_s.expect("silence within a minute");
    assert!(silent_after_s < 45.0, "{silent_after_s} s");
    assert_eq!(other.hash, rolled.hash, "blocks of 480 and of 32");
}
