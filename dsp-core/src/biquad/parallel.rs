//! A chain of sections as sections side by side: the partial fractions of eq. 3's product.
//!
//! Worst-case bounds of a section's state multiply along a chain (a resonance behind another may see 32 frames of input in step, and hardly ever does),
//! and each costs bits: chains of two lose 20 dB, of four 60 dB and more. Side by side each section has its bits.

use super::design::{Biquad, Root};

/// By how much the parts may be larger than their sum, which is what cancelling costs.
const MAX_LOSS: f64 = 64.0;

/// b0 and the sections of a chain's partial fractions, `H = b0 + Σ (n1 z⁻¹ + n2 z⁻²) / D_m`, in the chain's order. `None` where the
/// poles of two sections, or the two of one, are so near each other that the parts cancel.
pub(super) fn parts(chain: &[Biquad]) -> Option<(f64, [Option<Biquad>; 4])> {
    let mut parts = [None; 4];
    let (mut largest_part, mut largest) = (0.0f64, 0.0f64);
    for (index, (biquad, slot)) in chain.iter().zip(&mut parts).enumerate() {
        let pole = biquad.pole;
        let (square, radius) = (pole.square(), libm::sqrt(pole.square()));
        if radius < 1e-4 || pole.imaginary.abs() < 1e-9 {
            return None;
        }
        // w = 1/p; B = p N(w) / ((1 - p* w) Π D_j(w)), the residue of (H - b0) z.
        let w = Root { real: pole.real / square, imaginary: -pole.imaginary / square };
        let own = times(Root { real: pole.real, imaginary: -pole.imaginary }, w);
        let mut residue = divide(pole, Root { real: 1.0 - own.real, imaginary: -own.imaginary });
        for (other, section) in chain.iter().enumerate() {
            residue = times(residue, at(section.numerator, w));
            if other != index {
                residue = divide(residue, at(denominator(section), w));
            }
        }
        let n1 = 2.0 * residue.real;
        let n2 = -2.0 * (residue.real * pole.real + residue.imaginary * pole.imaginary);
        if !(n1.is_finite() && n2.is_finite()) {
            return None;
        }
        let part = Biquad { pole, numerator: [0.0, n1, n2] };
        // On the circle at the pole's own angle.
        let there = Root { real: pole.real / radius, imaginary: -pole.imaginary / radius };
        let response = |section: &Biquad| divide(at(section.numerator, there), at(denominator(section), there));
        let whole =
            chain.iter().fold(Root { real: 1.0, imaginary: 0.0 }, |product, section| times(product, response(section)));
        largest_part = largest_part.max(response(&part).square());
        largest = largest.max(whole.square());
        *slot = Some(part);
    }
    let direct = chain.iter().map(|biquad| biquad.numerator[0]).product();
    (largest_part <= MAX_LOSS * MAX_LOSS * largest).then_some((direct, parts))
}

fn denominator(biquad: &Biquad) -> [f64; 3] {
    [1.0, -2.0 * biquad.pole.real, biquad.pole.square()]
}

fn at([c0, c1, c2]: [f64; 3], w: Root) -> Root {
    let square = times(w, w);
    Root { real: c0 + c1 * w.real + c2 * square.real, imaginary: c1 * w.imaginary + c2 * square.imaginary }
}

fn times(a: Root, b: Root) -> Root {
    Root { real: a.real * b.real - a.imaginary * b.imaginary, imaginary: a.real * b.imaginary + a.imaginary * b.real }
}

fn divide(a: Root, b: Root) -> Root {
    let square = b.square();
    times(a, Root { real: b.real / square, imaginary: -b.imaginary / square })
}
