//! Damping laws and Young's moduli of materials.

use std::f64::consts::TAU;

/// Decay of a material's modes as a function of frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Loss factor η: `d = πfη`. Hysteresis within the material, at all frequencies alike.
    LossFactor(f64),
    /// Rayleigh's law with α in 1/s and β in s: `d = (α + β ω²)/2`.
    Rayleigh(f64, f64),
    /// Measured: decay in 1/s at 1 kHz, power of frequency, standard deviation of ln decay.
    Measured(f64, f64, f64),
}

impl Law {
    /// Logarithm of the decay in 1/s at a frequency, and the standard deviation of the law itself.
    pub(super) fn log_decay(&self, frequency_hz: f64) -> (f64, f64) {
        match *self {
            Self::LossFactor(eta) => ((0.5 * TAU * frequency_hz * eta).ln(), PUBLISHED),
            Self::Rayleigh(alpha, beta) => ((0.5 * (alpha + beta * (TAU * frequency_hz).powi(2))).ln(), PUBLISHED),
            Self::Measured(at_1_khz, power, spread) => (at_1_khz.ln() + power * (frequency_hz / 1000.0).ln(), spread),
        }
    }
}

/// Standard deviation of the logarithm of a published loss: tables give ranges of a factor of three.
const PUBLISHED: f64 = 0.5;

/// A material that sounding objects are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Name of the material.
    pub name: &'static str,
    /// Laws of its damping, each as likely as the others.
    pub laws: [Option<Law>; 3],
    /// Young's modulus in pascals, and the standard deviation of its logarithm among things of this
    /// material.
    pub young_modulus: [f64; 2],
}

/// All materials that are known.
///
/// Loss factors: middle of the ranges in L. Cremer and M. Heckl, Structure-Borne Sound (1988), and
/// for ceramic and polycarbonate of those in M. F. Ashby, Materials Selection in Mechanical Design.
/// Rayleigh damping and Young's moduli: as published for modal sound synthesis (the constants of
/// the shipped materials). Measured laws: lines through ln decay over ln frequency of the modes in
/// J. Traer, M. Cusimano and J. McDermott, A perceptually inspired generative model of rigid-body
/// contact sounds (DAFx 2019), without decays of more than 20 s: 503 modes of metal, 355 of
/// ceramic, 485 of glass, 549 of wood and 50 of hard plastic.
pub(super) const MATERIALS: [Material; 7] = [
    of("ceramic", 1.0e-3, (6.0, 1e-7), Some((18.0, 0.82, 0.73)), [7.2e10, 0.4]),
    of("glass", 1.1e-3, (1.0, 1e-7), Some((27.8, 0.45, 0.45)), [6.2e10, 0.15]),
    of("wood", 1.2e-2, (60.0, 2e-6), Some((62.4, 0.27, 0.58)), [1.1e10, 0.4]),
    of("plastic", 2.8e-2, (30.0, 1e-6), Some((100.9, 0.39, 0.50)), [1.4e9, 0.5]),
    of("polycarbonate", 1.0e-2, (0.5, 4e-7), Some((100.9, 0.39, 0.50)), [2.4e9, 0.15]),
    of("steel", 2.0e-4, (5.0, 3e-8), Some((32.6, 0.35, 0.56)), [2.0e11, 0.05]),
    of("tin", 2.0e-3, (2.0, 3e-8), None, [5.0e10, 0.15]),
];

const fn of(
    name: &'static str,
    loss_factor: f64,
    rayleigh: (f64, f64),
    measured: Option<(f64, f64, f64)>,
    young_modulus: [f64; 2],
) -> Material {
    let measured = match measured {
        Some((at_1_khz, power, spread)) => Some(Law::Measured(at_1_khz, power, spread)),
        None => None,
    };
    let laws = [Some(Law::LossFactor(loss_factor)), Some(Law::Rayleigh(rayleigh.0, rayleigh.1)), measured];
    Material { name, laws, young_modulus }
}

/// Names of all materials, for messages.
pub(super) fn names() -> String {
    MATERIALS.map(|material| material.name).join(", ")
}
