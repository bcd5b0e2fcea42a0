//! Damping: the decay of a mode by its frequency.

use std::f64::consts::TAU;

use crate::file::Material;

/// Law of the decay d(f), 1/s, amplitude e^(-d t).
#[derive(Clone, Debug, PartialEq)]
pub enum Damping {
    /// Rayleigh's law: d = (α + β ω²)/2, α in 1/s, β in s.
    Rayleigh {
        /// Part of the mass.
        alpha_per_s: f64,
        /// Part of the stiffness.
        beta_s: f64,
    },
    /// Loss factor η: d = η ω/2.
    LossFactor(f64),
    /// Decays at frequencies in order, Hz and 1/s: straight between them in logarithms, level
    /// beyond.
    Measured(Vec<[f64; 2]>),
}

impl Damping {
    /// Law of a material. `measured` are the modes of the table that [`Material::damping`] names.
    pub fn of(material: &Material, measured: Vec<[f64; 2]>) -> Self {
        if material.damping.is_some() {
            let mut points = measured;
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            return Self::Measured(points);
        }
        if let Some(factor) = material.loss_factor {
            return Self::LossFactor(factor);
        }
        let (alpha_per_s, beta_s) = (material.rayleigh_alpha_per_s, material.rayleigh_beta_s);
        if alpha_per_s.is_some() || beta_s.is_some() {
            return Self::Rayleigh { alpha_per_s: alpha_per_s.unwrap_or(0.0), beta_s: beta_s.unwrap_or(0.0) };
        }
        match material.named().ok().flatten() {
            None => Self::Rayleigh { alpha_per_s: 0.0, beta_s: 0.0 },
            Some(named) => named.loss_factor.map_or(
                Self::Rayleigh { alpha_per_s: named.rayleigh_alpha_per_s, beta_s: named.rayleigh_beta_s },
                Self::LossFactor,
            ),
        }
    }

    /// Decay of a mode, 1/s.
    pub fn decay_per_s(&self, frequency_hz: f64) -> f64 {
        let omega = TAU * frequency_hz;
        match self {
            Self::Rayleigh { alpha_per_s, beta_s } => (alpha_per_s + beta_s * omega * omega) / 2.0,
            Self::LossFactor(factor) => factor * omega / 2.0,
            Self::Measured(points) => {
                let above = points.partition_point(|point| point[0] < frequency_hz);
                let (Some(low), Some(high)) = (above.checked_sub(1).and_then(|at| points.get(at)), points.get(above))
                else {
                    return points.get(above.min(points.len().saturating_sub(1))).map_or(0.0, |point| point[1]);
                };
                let share = (frequency_hz / low[0]).ln() / (high[0] / low[0]).ln();
                low[1] * (high[1] / low[1]).powf(share)
            }
        }
    }
}
