//! Damping laws and Young's moduli of materials.

use std::f64::consts::TAU;

/// Decay of a material's modes as a function of frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Loss factor η: `d = πfη`. Hysteresis within the material, at all frequencies alike.
    LossFactor(f64),
    /// Rayleigh's law with α in 1/s and β in s: `d = (α + β ω²)/2`.
    Rayleigh(f64, f64),
    /// Measured: decay in 1/s at 1 kHz, and the power of frequency with which it grows.
    Measured(f64, f64),
}

impl Law {
    /// Decay in 1/s of a mode at a frequency.
    pub(super) fn decay_per_s(&self, frequency_hz: f64) -> f64 {
        match *self {
            Self::LossFactor(eta) => 0.5 * TAU * frequency_hz * eta,
            Self::Rayleigh(alpha, beta) => 0.5 * (alpha + beta * (TAU * frequency_hz).powi(2)),
            Self::Measured(at_1_khz, power) => at_1_khz * (frequency_hz / 1000.0).powf(power),
        }
    }
}

/// Kind of a material; those of one kind are measured together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Fired clay.
    Ceramic,
    /// Glass.
    Glass,
    /// Wood.
    Wood,
    /// Hard plastic.
    Plastic,
    /// Metal.
    Metal,
}

/// A material that sounding objects are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Name of the material.
    pub name: &'static str,
    /// Kind of the material.
    pub kind: Kind,
    /// Laws of its damping, each as likely as the others.
    pub laws: [Law; 3],
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
    of("ceramic", Kind::Ceramic, 1.0e-3, (6.0, 1e-7), [7.2e10, 0.4]),
    of("glass", Kind::Glass, 1.1e-3, (1.0, 1e-7), [6.2e10, 0.15]),
    of("wood", Kind::Wood, 1.2e-2, (60.0, 2e-6), [1.1e10, 0.4]),
    of("plastic", Kind::Plastic, 2.8e-2, (30.0, 1e-6), [1.4e9, 0.5]),
    of("polycarbonate", Kind::Plastic, 1.0e-2, (0.5, 4e-7), [2.4e9, 0.15]),
    of("steel", Kind::Metal, 2.0e-4, (5.0, 3e-8), [2.0e11, 0.05]),
    of("tin", Kind::Metal, 2.0e-3, (2.0, 3e-8), [5.0e10, 0.15]),
];

const fn of(
    name: &'static str,
    kind: Kind,
    loss_factor: f64,
    rayleigh: (f64, f64),
    young_modulus: [f64; 2],
) -> Material {
    let measured = match kind {
        Kind::Ceramic => Law::Measured(18.0, 0.82),
        Kind::Glass => Law::Measured(27.8, 0.45),
        Kind::Wood => Law::Measured(62.4, 0.27),
        Kind::Plastic => Law::Measured(100.9, 0.39),
        Kind::Metal => Law::Measured(32.6, 0.35),
    };
    Material { name, kind, laws: [Law::LossFactor(loss_factor), Law::Rayleigh(rayleigh.0, rayleigh.1), measured], young_modulus }
}

/// Names of all materials, for messages.
pub(super) fn names() -> String {
    MATERIALS.map(|material| material.name).join(", ")
}
