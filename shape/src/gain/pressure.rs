//! Sound pressure before a plate in a baffle, by the Rayleigh integral.

use super::Gain;

/// Speed of sound in air at 20 °C, m/s.
pub const SPEED_OF_SOUND_M_PER_S: f64 = 343.2;
/// Density of air at 20 °C, kg/m³.
const AIR_KG_PER_M3: f64 = 1.204;

/// Piece of a surface for an integral over it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Place, metres.
    pub at_m: [f64; 2],
    /// Area, m²; the shape's value there is that of the whole piece.
    pub area_m2: f64,
}

/// Gain of the pressure at a point, Pa/(N s), from the shape at the strike and on the surface.
///
/// p(t) = ρ/(2π) ∫ a(t - r/c)/r dS with the acceleration a of the surface. The delay of the nearest
/// piece is left out, so that the sound begins with the strike.
pub fn pressure(
    at_strike: f64,
    shape: impl Iterator<Item = (Surface, f64)> + Clone,
    at_m: [f64; 3],
    omega: f64,
    decay_per_s: f64,
) -> Gain {
    let distance = |piece: &Surface| {
        let [x, y] = [0, 1].map(|axis| piece.at_m[axis] - at_m[axis]);
        (x * x + y * y + at_m[2] * at_m[2]).sqrt()
    };
    let nearest = shape.clone().map(|(piece, _)| distance(&piece)).fold(f64::MAX, f64::min);
    // v(t) = Re C e^(s t) with s = -d + iω, C = φ (1 + i d/ω): its acceleration is Re s C e^(s t).
    let (mut real, mut imaginary) = (0.0, 0.0);
    for (piece, value) in shape {
        let far = distance(&piece);
        let delay = (far - nearest) / SPEED_OF_SOUND_M_PER_S;
        // e^(-s r/c) grows by the decay, and turns back by ω.
        let size = value * piece.area_m2 / far * (decay_per_s * delay).exp();
        real += size * (omega * delay).cos();
        imaginary -= size * (omega * delay).sin();
    }
    let scale = at_strike * AIR_KG_PER_M3 / std::f64::consts::TAU;
    let (c, s) = ([1.0, decay_per_s / omega], [-decay_per_s, omega]);
    let product = |a: [f64; 2], b: [f64; 2]| [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
    let [cosine, minus_sine] = product(product(c, s), [scale * real, scale * imaginary]);
    Gain { sine: -minus_sine, cosine }
}
