//! The force of a stick that is drawn along a rough edge.
//!
//! It is noise whose level and brightness follow the speed of the stick.

use dsp_core::SampleRate;
use dsp_core::fixed::q27_from;

/// Time from the start of the piece to the start of the scraping, in seconds.
const BEGIN_S: f64 = 9.2;
/// Duration of the scraping, in seconds.
const LENGTH_S: f64 = 2.1;
/// Number of strokes: one there and one back.
const STROKES: f64 = 2.0;
/// Rms force at full speed, in reference forces of the object.
const LEVEL: f64 = 0.02;
/// Corner frequency of the contact's low-pass at full speed, in Hz.
const BRIGHTEST_HZ: f64 = 6_000.0;

/// Samples of the scraping force in Q4.27, from the start of the piece.
pub(super) fn force(rate: SampleRate) -> Vec<i32> {
    let begin = (BEGIN_S * rate.hz()) as usize;
    let length = (LENGTH_S * rate.hz()) as usize;
    let mut force = vec![0; begin];
    let mut noise = Noise(0x4d61_6c6c);
    let mut low_passed = 0.0;
    for n in 0..length {
        let speed = (std::f64::consts::PI * STROKES * n as f64 / length as f64).sin().abs();
        let corner = 1.0 - (-std::f64::consts::TAU * BRIGHTEST_HZ * speed / rate.hz()).exp();
        low_passed += corner * (noise.next() - low_passed);
        force.push(q27_from(LEVEL * speed * low_passed));
    }
    force
}

/// Generator of white noise, uniform with unit variance: xorshift32 (Marsaglia 2003).
struct Noise(u32);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        (f64::from(self.0) / f64::from(u32::MAX) - 0.5) * 12f64.sqrt()
    }
}
