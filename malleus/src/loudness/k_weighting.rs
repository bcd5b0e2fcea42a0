//! K-weighting and loudness of ITU-R BS.1770, at any sample rate.
//!
//! The recommendation gives two biquads at 48 kHz: a shelf for the effect of a head, and a
//! high-pass (RLB). Here their analogue prototypes go through the bilinear transformation at the
//! actual rate, which gives the recommendation's numbers at 48 kHz to eight digits.

use std::f64::consts::PI;

/// Biquad `y = b0 x + b1 x' + b2 x'' - a1 y' - a2 y''` with its state.
#[derive(Clone, Copy, Debug)]
struct Biquad {
    b: [f64; 3],
    a: [f64; 2],
    state: [f64; 2],
}

impl Biquad {
    fn new(b: [f64; 3], a: [f64; 2]) -> Self {
        Self { b, a, state: [0.0; 2] }
    }

    /// Filters one sample, in the transposed direct form II.
    fn step(&mut self, x: f64) -> f64 {
        let y = self.b[0] * x + self.state[0];
        self.state = [self.b[1] * x - self.a[0] * y + self.state[1], self.b[2] * x - self.a[1] * y];
        y
    }
}

/// Pre-filter of the K-weighting: a shelf of +4 dB above 1.7 kHz.
fn shelf(rate_hz: f64) -> Biquad {
    let (k, q) = ((PI * 1681.974450955533 / rate_hz).tan(), 0.7071752369554196);
    let high = 10f64.powf(3.999843853973347 / 20.0);
    let middle = high.powf(0.4996667741545416);
    let a0 = 1.0 + k / q + k * k;
    let b = [high + middle * k / q + k * k, 2.0 * (k * k - high), high - middle * k / q + k * k];
    Biquad::new(b.map(|b| b / a0), [2.0 * (k * k - 1.0) / a0, (1.0 - k / q + k * k) / a0])
}

/// RLB filter of the K-weighting: a high-pass at 38 Hz.
fn high_pass(rate_hz: f64) -> Biquad {
    let (k, q) = ((PI * 38.13547087602444 / rate_hz).tan(), 0.5003270373238773);
    let a0 = 1.0 + k / q + k * k;
    Biquad::new([1.0, -2.0, 1.0], [2.0 * (k * k - 1.0) / a0, (1.0 - k / q + k * k) / a0])
}

/// Loudness in LKFS of the loudest stretch of `window_s` seconds of a sound.
///
/// A sound that is shorter than the stretch counts as followed by silence.
pub fn loudest_lkfs(sound: &[[f64; 2]], rate_hz: f64, window_s: f64) -> f64 {
    let mut filters = [[shelf(rate_hz), high_pass(rate_hz)]; 2];
    let mut energy = Vec::with_capacity(sound.len() + 1);
    energy.push(0.0);
    let mut total = 0.0;
    for frame in sound {
        for (x, [shelf, high_pass]) in frame.iter().zip(&mut filters) {
            total += high_pass.step(shelf.step(*x)).powi(2);
        }
        energy.push(total);
    }
    let window = ((window_s * rate_hz).round() as usize).max(1);
    let stretch = |end: usize| energy[end] - energy[end.saturating_sub(window)];
    let loudest = (0..energy.len()).map(stretch).fold(0.0, f64::max);
    -0.691 + 10.0 * (loudest / window as f64).log10()
}
