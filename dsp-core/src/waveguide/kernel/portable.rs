//! The loop in plain Rust: the definition of the bits.

use super::super::resonance::Resonance;
use crate::fixed::{qadd, smmlar, smmlsr, smmulr};

/// What comes out of the line through the band, added to the mix, as many frames as both have.
pub fn run(band: &mut Resonance, line: &[i32], mix: &mut [i32]) {
    for (sum, &x) in mix.iter_mut().zip(line) {
        band.u = smmlsr(band.u, band.damp, band.u);
        band.u = smmlsr(band.u, band.turn, band.v);
        match band.shift {
            0 => band.v = smmlar(band.v, band.turn, band.u),
            shift => band.v += band.u << shift,
        }
        band.u = smmlar(band.u, band.gain_u, x);
        band.v = smmlar(band.v, band.gain_v, x);
        *sum = qadd(*sum, smmulr(band.v, band.scale));
    }
}
