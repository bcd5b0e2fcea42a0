//! From how loud a mode shall be to its physical gain.

use kit::{Gain, Mode};

/// Mean of a pulse of the default restitution over its contact time, of its peak.
const AREA: f64 = 0.498_25;

/// The contact for which levels are set: a Hertz pulse of peak 1 and the default restitution at velocity 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    /// Contact time τ in seconds.
    pub(crate) time_s: f64,
    /// Peak force in the object's force units.
    pub(crate) peak: f64,
}

impl Contact {
    /// Magnitude of the pulse's spectrum at a frequency: its impulse, and a fall of 12 dB an octave above
    /// 1/(2τ); the pulse's own lies up to 8 dB above that about 1/τ.
    fn spectrum(self, frequency_hz: f64) -> f64 {
        let x = 2.0 * frequency_hz * self.time_s;
        AREA * self.peak * self.time_s / (1.0 + x * x)
    }
}

/// A mode that rings with `amplitude` (1.0 = full scale) times its shape at each position after such a contact, in sine phase.
pub(crate) fn mode(frequency_hz: f64, t60_s: f64, amplitude: f64, shape: &[f64], contact: Contact) -> Mode {
    let gain = amplitude / contact.spectrum(frequency_hz.min(1.0 / contact.time_s));
    Mode {
        frequency_hz: rounded(frequency_hz),
        decay_per_s: rounded(1000f64.ln() / t60_s),
        gains: shape
            .iter()
            // At a node only rounding is left of a shape.
            .map(|shape| if shape.abs() < 1e-9 { 0.0 } else { rounded(gain * shape) })
            .map(|sine| Gain { sine, cosine: 0.0 })
            .collect(),
    }
}

/// Six significant digits: more would claim more than any of these tables knows.
pub(crate) fn rounded(value: f64) -> f32 {
    format!("{value:.5e}").parse().unwrap_or(value as f32)
}
