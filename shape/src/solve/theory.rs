//! Waves in a body, and how far the theory of plates is off elasticity in space.

use std::f64::consts::{PI, TAU};

use super::body::width;
use super::{Body, Wanted};
use crate::element::{Elasticity, Material, Support};
use crate::file::Kind;
use crate::outline::FlatSide;

/// Model errors of a plate against elasticity in space, measured by the tests of `shape` named
/// `boxes`: waves err by a share of (k h)² with the wave number k and the thickness h, edges by a
/// share of thickness times length of the edge by area of the plate.
///
/// Waves along isotropic plates: at most 0.0019 (hinged plates), and a little for other edges.
const WAVE_ERROR: f64 = 0.0022;
/// Waves along orthotropic plates, whose mass does not take in that they become thinner: not
/// measured.
const GRAIN_ERROR: f64 = 0.004;
/// Twist at free edges: up to 0.0009 of a square, 0.001 of a bar.
const FREE_ERROR: f64 = 0.0011;
/// Lowest modes without a row of elements one thickness wide along free edges: thin-plate theory
/// is 0.3 thicknesses a side of a square above elasticity, and finite elements lie between.
const ROW_ERROR: f64 = 0.08;
/// Share of the error that is asked for below which rows along free edges are left out.
const ROW_SHARE: f64 = 0.2;
/// Clamped edges hold the surfaces, too, as if they lay 0.013 thicknesses further inside.
const CLAMPED_ERROR: f64 = 0.02;

/// Guess of the lowest mode's wave number times the longer extent, for bodies with a free edge. It
/// is 3.7 for a free square and 4.7 for a free bar.
const FREE: f64 = 4.2;
/// Guess of the lowest mode's wave number for bodies without a free edge, as a multiple of
/// √(1/a² + 1/b²) for a body of the extents a and b. The exact multiple is π for hinged rectangles
/// and 4.2 for clamped squares.
const HELD: f64 = 3.5;

impl Body {
    /// True if frequencies with a relative error want rows of elements along free edges.
    pub(super) fn wants_rows(&self, error: f64) -> bool {
        self.row_error() > ROW_SHARE * error
    }

    /// Share by which frequencies err without rows along free edges.
    fn row_error(&self) -> f64 {
        let is_free = |support: &Support| if *support == Support::Free { ROW_ERROR } else { 0.0 };
        self.edge_error(is_free)
    }

    /// Error from edges: a share of thickness, of a sheet width, times length by area.
    pub(super) fn edge_error(&self, of_edge: impl Fn(&Support) -> f64) -> f64 {
        let sides = self.outline.sides();
        let length = |side: &FlatSide| (side.to[0] - side.from[0]).hypot(side.to[1] - side.from[1]);
        let edges: f64 = sides.iter().zip(&self.supports).map(|(side, edge)| length(side) * of_edge(edge)).sum();
        edges * self.thickness / self.outline.area()
    }

    /// Wave number at a frequency in Hz of the slowest wave, in the body's units.
    fn wave_number(&self, frequency_hz: f64) -> f64 {
        let omega = TAU * frequency_hz / self.units.rad_per_s;
        let (youngs, shear) = softest(&self.material);
        match self.kind {
            Kind::Membrane => omega,
            Kind::Plate => {
                let bending = youngs * self.thickness.powi(3) / 12.0;
                (omega * omega * self.thickness / bending).powf(0.25)
            }
            // The lowest modes of a slender sheet bend: their waves are about this short.
            Kind::Sheet | Kind::Revolve | Kind::Solid => omega / shear.sqrt(),
        }
    }

    /// Guess of the lowest ω² that is not 0, in the body's units; `None` of bodies whose depth says
    /// nothing about their waves.
    pub(super) fn lowest(&self) -> Option<f64> {
        let [low, high] = self.outline.bounds().unwrap_or_default();
        let [width, height] = [0, 1].map(|axis| high[axis] - low[axis]);
        let along = 1.0 / width.max(height);
        let number = if self.is_held() { HELD * (1.0 / width).hypot(1.0 / height) } else { FREE * along };
        match self.kind {
            Kind::Membrane => Some(number.powi(2)),
            Kind::Plate => {
                let (youngs, _) = softest(&self.material);
                Some(youngs * self.thickness.powi(2) / 12.0 * number.powi(4))
            }
            Kind::Sheet | Kind::Revolve | Kind::Solid => None,
        }
    }

    /// Wavelength of the highest mode that is wanted, in the body's units; at most twice the longer
    /// extent.
    pub(super) fn wavelength(&self, wanted: Wanted) -> f64 {
        let [low, high] = self.outline.bounds().unwrap_or_default();
        let extents = [0, 1].map(|axis| high[axis] - low[axis]);
        let (longest, narrow) = (extents[0].max(extents[1]), width(&self.outline, extents));
        let number = match wanted {
            // As many half waves as modes in a slender body, their root in a wide one.
            Wanted::Lowest(count) => {
                let wide = (4.0 * PI * (count as f64 + 3.0) / self.outline.area()).sqrt();
                let slender = PI * (count as f64 + 1.0) / longest;
                wide.min(slender.max(PI / narrow))
            }
            Wanted::Below(frequency_hz) => self.wave_number(frequency_hz),
        };
        (TAU / number).min(2.0 * longest)
    }

    /// Share by which the theory of thick plates, or the expansion of a sheet across its width,
    /// errs at a frequency, against elasticity in space.
    pub(super) fn model_error(&self, frequency_hz: f64) -> f64 {
        if self.kind != Kind::Plate {
            return self.across.error(frequency_hz);
        }
        let of_edge = |support: &Support| match support {
            Support::Free => FREE_ERROR,
            Support::Hinged => 0.0,
            Support::Clamped => CLAMPED_ERROR,
        };
        let waves = match self.material.elasticity {
            Elasticity::Isotropic { .. } => WAVE_ERROR,
            Elasticity::Orthotropic { .. } => GRAIN_ERROR,
        };
        let turn = self.wave_number(frequency_hz) * self.thickness;
        let rows = if self.has_rows { 0.0 } else { self.row_error() };
        self.edge_error(of_edge) + rows + self.hinged_error() + waves * turn * turn
    }
}

/// Lowest Young's modulus and shear modulus of a material.
fn softest(material: &Material) -> (f64, f64) {
    match material.elasticity {
        Elasticity::Isotropic { young, poisson } => (young, young / (2.0 * (1.0 + poisson))),
        Elasticity::Orthotropic { young, shear, .. } => (young[0].min(young[1]), shear),
    }
}
