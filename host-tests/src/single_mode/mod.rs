//! One mode that a unit impulse strikes once, in each form, against the reference
//! `e^{-dt} sin 2πft` in `f64`.

pub mod float_forms;
pub mod framed;
pub mod q31;

use dsp_core::SampleRate;

/// Point of the grid.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// T60 in seconds.
    pub t60_s: f64,
    /// Sample rate.
    pub rate: SampleRate,
    /// Amplitude at the start, 1.0 = full scale.
    pub level: f64,
}

impl Case {
    /// Decay rate in 1/s.
    pub fn decay_per_s(&self) -> f64 {
        1000f64.ln() / self.t60_s
    }

    /// The case with parameters that a table's `f32` holds exactly, so that only the arithmetic is
    /// measured.
    pub fn exact(&self) -> Self {
        let decay = f64::from(self.decay_per_s() as f32);
        Self { frequency_hz: f64::from(self.frequency_hz as f32), t60_s: 1000f64.ln() / decay, ..*self }
    }

    /// Frames over which the SNR is taken: min(T60, 2 s).
    pub fn frames(&self) -> usize {
        (self.t60_s.min(2.0) * self.rate.hz()) as usize
    }

    /// Samples of the reference, without an end, 1.0 = full scale.
    pub fn reference(&self) -> impl Iterator<Item = f64> + use<> {
        let (fs, d, f, level) = (self.rate.hz(), self.decay_per_s(), self.frequency_hz, self.level);
        (0..).map(move |n| {
            let t = f64::from(n) / fs;
            // The phase is reduced before the sine, so that it stays exact over long times.
            level * (-d * t).exp() * (std::f64::consts::TAU * (f * t).fract()).sin()
        })
    }
}

/// Grid of 20 Hz to 20 kHz (`frequencies` log-spaced) x T60 {0.05, 0.2, 1, 5, 20} s x fs {44.1, 48}
/// kHz, at one level.
pub fn grid(frequencies: u32, level: f64) -> Vec<Case> {
    let mut cases = Vec::new();
    for rate in [SampleRate::HZ_44100, SampleRate::HZ_48000] {
        for t60_s in [0.05, 0.2, 1.0, 5.0, 20.0] {
            for step in 0..frequencies {
                let frequency_hz = 20.0 * 1000f64.powf(f64::from(step) / f64::from(frequencies.max(2) - 1));
                cases.push(Case { frequency_hz, t60_s, rate, level });
            }
        }
    }
    cases
}

/// SNR in dB of a signal against the expected one.
pub fn snr_db(expected: impl IntoIterator<Item = f64>, got: impl IntoIterator<Item = f64>) -> f64 {
    let (mut signal, mut noise) = (0.0, 0.0);
    for (expected, got) in expected.into_iter().zip(got) {
        signal += expected * expected;
        noise += (got - expected) * (got - expected);
    }
    10.0 * (signal / noise).log10()
}

/// Smallest and median of figures.
pub fn worst_and_median(mut figures: Vec<f64>) -> (f64, f64) {
    figures.sort_by(f64::total_cmp);
    (figures.first().copied().unwrap_or(f64::NAN), figures.get(figures.len() / 2).copied().unwrap_or(f64::NAN))
}
