//! A force as a stick makes it that is drawn along a rough edge: noise whose level and brightness follow the stick's speed.

use dsp_core::SampleRate;
use dsp_core::fixed::q27_from;

const BEGIN_S: f64 = 9.2;
const LENGTH_S: f64 = 2.1;
/// Two strokes, there and back.
const STROKES: f64 = 2.0;
/// Force at full speed, of the object's reference force, rms.
const LEVEL: f64 = 0.02;
/// Corner of the contact's low-pass at full speed, in Hz.
const BRIGHTEST_HZ: f64 = 6_000.0;

/// The force, Q4.27, from the start of the piece.
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

/// White noise of unit variance, uniform: xorshift32 (Marsaglia 2003).
struct Noise(u32);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        (f64::from(self.0) / f64::from(u32::MAX) - 0.5) * 12f64.sqrt()
    }
}
