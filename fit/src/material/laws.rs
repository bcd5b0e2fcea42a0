//! Damping laws and Young's moduli of materials.

use std::f64::consts::PI;

/// Decay of a material's modes as a function of frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Loss factor η: `d = πfη`. Hysteresis within the material, at all frequencies alike.
    LossFactor(f64),
    /// Measured: decay in 1/s at 1 kHz, and the power of frequency with which it grows.
    Measured(f64, f64),
}

impl Law {
    /// Decay in 1/s of a mode at a frequency.
    pub(super) fn decay_per_s(&self, frequency_hz: f64) -> f64 {
        match *self {
            Self::LossFactor(eta) => PI * frequency_hz * eta,
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
    /// Published law of its damping.
    pub published: Law,
    /// Young's modulus in pascals, and the standard deviation of its logarithm among things of this
    /// material.
    pub young_modulus: [f64; 2],
}

impl Kind {
    /// Decay measured on things of this kind.
    ///
    /// Lines through ln decay over ln frequency of the modes in J. Traer, M. Cusimano and J. H.
    /// McDermott, A perceptually inspired generative model of rigid-body contact sounds (DAFx
    /// 2019), as the package tdw has them (BSD-2-Clause), without decays of more than 20 s: 355
    /// modes of ceramic, 485 of glass, 549 of wood, 50 of hard plastic and 503 of metal.
    pub(super) fn measured(self) -> Law {
        match self {
            Self::Ceramic => Law::Measured(18.0, 0.82),
            Self::Glass => Law::Measured(27.8, 0.45),
            Self::Wood => Law::Measured(62.4, 0.27),
            Self::Plastic => Law::Measured(100.9, 0.39),
            Self::Metal => Law::Measured(32.6, 0.35),
        }
    }
}

/// All materials that are known.
///
/// Loss factors of glass (0.6 to 2e-3), wood (oak to plywood, 0.8 to 2e-2), plastic (2 to 4e-2),
/// steel (in bending, 2 to 6e-4) and tin (2e-3) are the middles of the ranges in L. Cremer and M.
/// Heckl, Structure-Borne Sound (1988). Those of ceramic (1 to 3e-3) and polycarbonate (0.7 to
/// 1.5e-2) are orders of magnitude, without one source. Young's moduli are those of materials for
/// modal sound synthesis; their scatter is this project's choice.
pub(super) const MATERIALS: [Material; 7] = [
    of("ceramic", Kind::Ceramic, 1.7e-3, [7.2e10, 0.4]),
    of("glass", Kind::Glass, 1.1e-3, [6.2e10, 0.15]),
    of("wood", Kind::Wood, 1.2e-2, [1.1e10, 0.4]),
    of("plastic", Kind::Plastic, 2.8e-2, [1.4e9, 0.5]),
    of("polycarbonate", Kind::Plastic, 1.0e-2, [2.4e9, 0.15]),
    of("steel", Kind::Metal, 3.5e-4, [2.0e11, 0.05]),
    of("tin", Kind::Metal, 2.0e-3, [5.0e10, 0.15]),
];

const fn of(name: &'static str, kind: Kind, loss_factor: f64, young_modulus: [f64; 2]) -> Material {
    Material { name, kind, published: Law::LossFactor(loss_factor), young_modulus }
}

/// Names of all materials, for messages.
pub(super) fn names() -> String {
    MATERIALS.map(|material| material.name).join(", ")
}
