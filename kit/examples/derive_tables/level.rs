//! Physical gains of modes, from the amplitudes that they are to have.

use kit::{Gain, Mode};

/// Mean of a pulse of the default restitution over its contact time, as a share of its peak.
const AREA: f64 = 0.498_25;

/// Contact for which levels are set: a Hertz pulse of the default restitution at velocity 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    /// Contact time τ in seconds.
    pub(crate) time_s: f64,
    /// Peak force in the object's force units.
    pub(crate) peak: f64,
}

impl Contact {
    /// Approximate magnitude of the pulse's spectrum at a frequency.
    ///
    /// It is the pulse's impulse at low frequencies, and falls by 12 dB per octave above 1/(2τ).
    /// The true spectrum lies up to 8 dB higher near 1/τ.
    fn spectrum(self, frequency_hz: f64) -> f64 {
        let x = 2.0 * frequency_hz * self.time_s;
        AREA * self.peak * self.time_s / (1.0 + x * x)
    }
}

/// Mode that rings in sine phase after a contact, with a given amplitude.
///
/// The amplitude at each position is `amplitude` (1.0 = full scale) times the shape there.
pub(crate) fn mode(frequency_hz: f64, t60_s: f64, amplitude: f64, shape: &[f64], contact: Contact) -> Mode {
    let gain = amplitude / contact.spectrum(frequency_hz.min(1.0 / contact.time_s));
    Mode {
        frequency_hz: rounded(frequency_hz),
        decay_per_s: rounded(1000f64.ln() / t60_s),
        gains: shape
            .iter()
            // At a node the shape is 0, and its computed value is a rounding error.
            .map(|shape| if shape.abs() < 1e-9 { 0.0 } else { rounded(gain * shape) })
            .map(|sine| Gain { sine, cosine: 0.0 })
            .collect(),
    }
}

/// Rounds to six significant digits, the most that these tables can claim.
pub(crate) fn rounded(value: f64) -> f32 {
    format!("{value:.5e}").parse().unwrap_or(value as f32)
}
