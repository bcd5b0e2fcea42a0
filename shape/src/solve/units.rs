//! Units of a body, in which it is solved: its longest extent, its stiffness and its density are 1.
//! Bodies that differ by these alone have the same meshes and matrices, and frequencies to the last
//! bit but for one factor.

use crate::eigen::Modes;
use crate::element::{Elasticity, Material};
use crate::outline::{Outline, Side};
use crate::surface::Surface;

/// Binary digits that lengths and ratios keep: numbers that differ by rounding become one.
const DIGITS: i32 = 40;

/// Units of a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Units {
    /// Unit of length, metres.
    pub(crate) length_m: f64,
    /// Unit of angular frequency, rad/s.
    pub(crate) rad_per_s: f64,
    /// Unit of mass, kg.
    pub(crate) mass_kg: f64,
}

impl Units {
    /// Makes the units of a body of a length, Young's modulus and density.
    pub(super) fn of_body(length_m: f64, young_pa: f64, density_kg_per_m3: f64) -> Self {
        let rad_per_s = (young_pa / density_kg_per_m3).sqrt() / length_m;
        Self { length_m, rad_per_s, mass_kg: density_kg_per_m3 * length_m.powi(3) }
    }

    /// Makes the units of a membrane of a length, a tension in N/m and a mass per area in kg/m².
    pub(super) fn of_skin(length_m: f64, [tension, density]: [f64; 2]) -> Self {
        let rad_per_s = (tension / density).sqrt() / length_m;
        Self { length_m, rad_per_s, mass_kg: density * length_m.powi(2) }
    }

    /// Gives the unit of ω², (rad/s)².
    pub(super) fn square(&self) -> f64 {
        self.rad_per_s * self.rad_per_s
    }

    /// Takes a coordinate in metres to these units.
    fn place(&self, metres: f64) -> f64 {
        let grid = f64::from(DIGITS).exp2();
        (metres / self.length_m * grid).round() / grid
    }

    /// Takes an outline in metres to these units.
    pub(super) fn outline(&self, outline: &Outline) -> Outline {
        let point = |point: [f64; 2]| point.map(|part| self.place(part));
        let side = |side: &Side| Side { from: point(side.from), curve: side.curve.map(|curve| curve.map(point)) };
        Outline { rings: outline.rings.iter().map(|ring| ring.iter().map(side).collect()).collect() }
    }

    /// Takes a surface in metres to these units.
    pub(super) fn surface(&self, surface: &Surface) -> Surface {
        surface.with_coordinates(|metres| self.place(metres))
    }

    /// Takes the modes of matrices in these units to seconds and kilograms.
    pub(super) fn measure(&self, modes: &mut Modes) {
        let square = self.square();
        modes.values.iter_mut().chain(&mut modes.next).for_each(|value| *value *= square);
        modes.count_limit *= square;
        let shape = self.mass_kg.sqrt().recip();
        modes.vectors.iter_mut().flatten().for_each(|value| *value *= shape);
    }
}

/// Rounds a number to [`DIGITS`] binary digits.
pub(super) fn rounded(number: f64) -> f64 {
    let below = 1_u64 << (f64::MANTISSA_DIGITS as i32 - 1 - DIGITS);
    let bits = number.to_bits() + below / 2;
    if number.is_finite() { f64::from_bits(bits - bits % below) } else { number }
}

/// Gives a material in units of its Young's modulus, that along the grain of wood, and its density.
pub(super) fn relative(material: Material) -> Material {
    let elasticity = match material.elasticity {
        Elasticity::Isotropic { poisson, .. } => Elasticity::Isotropic { young: 1.0, poisson },
        Elasticity::Orthotropic { young, poisson, shear, transverse, grain } => {
            let ratio = |modulus: f64| rounded(modulus / young[0]);
            let transverse = transverse.map(ratio);
            Elasticity::Orthotropic { young: [1.0, ratio(young[1])], poisson, shear: ratio(shear), transverse, grain }
        }
    };
    Material { elasticity, density: 1.0 }
}
