//! A chain of sections as sections side by side: the partial fractions of eq. 3's product.
//!
//! Bounds of states multiply along a chain, and each costs bits. Side by side each section has a
//! bound of its own. Parts of opposite sign would cancel if poles (nearly) coincide: such sections
//! stay in a row, as a *cluster*, in Newton's form instead of Lagrange's,
//!
//! ```text
//! H = b0 + Σ_clusters  A_1 / (D_1 D_2 ... D_n) + A_2 / (D_2 ... D_n) + ... + A_n / D_n
//!     A_k linear in z
//! ```
//!
//! which is a chain that feeds the input into every section with two gains of its own, and whose
//! last section sounds. No term grows when D_1 = D_2.
//!
//! # Arithmetic
//!
//! Polynomials are in `ζ = z - 1` (`-z - 1` for mirrored sections), in which a slow pole pair is
//! `ζ² + (δ + e²) ζ + e²`: no digit is lost however near it is to 1. The numerator is kept as its
//! residue modulo D_1 ... D_n in Newton's coordinates, `A_1 + D_1 A_2 + D_1 D_2 A_3 + ...`. The
//! residue is multiplied by each section's numerator, and divided by the denominators outside the
//! cluster. Neither needs a difference of near poles as a divisor.

use super::design::{Biquad, Root};
use crate::square_root::length;

/// A pole as some arithmetic realises it: `D = z² - (2 - δ - e²) z + 1 - δ`, and an input into u
/// reaches v times `entry`.
pub trait Realised: Copy {
    /// Arithmetic that all sections of a cluster must share.
    type Form: Ord;

    /// Pole of an empty section.
    const EMPTY: Self;

    /// Bound of the mean real part of a cluster's poles, below which they run mirrored.
    const MIRROR_BELOW: f64;

    /// First form in which a pole is exact.
    fn form_of(root: Root, mirrored: bool) -> Self::Form;
    /// Nearest pole that a form can hold.
    fn new(root: Root, mirrored: bool, form: &Self::Form) -> Self;
    /// True if the pole stands for -p, on input and output of alternating sign.
    fn is_mirrored(self) -> bool;
    /// δ, after rounding.
    fn delta(self) -> f64;
    /// e², after rounding.
    fn step_squared(self) -> f64;
    /// Share of u that goes into v in each sample.
    fn entry(self) -> f64;
    /// Nearest possible multiplier to a wanted one, from another section's v into this section's v
    /// by way of u; not 0.
    fn handed(self, wanted: f64) -> f64;
}

/// One section of a chain's partial fractions.
#[derive(Clone, Copy, Debug)]
pub struct Part<P> {
    /// Pair of conjugate poles.
    pub pole: P,
    /// Gains of the input into u and into v.
    pub gains: [f64; 2],
    /// Share of the v of the part before that goes into this part's v, by way of u; 0 where a
    /// cluster begins.
    pub handed: f64,
}

impl<P: Realised> Part<P> {
    /// An empty part, which is silent.
    pub const EMPTY: Self = Self { pole: P::EMPTY, gains: [0.0; 2], handed: 0.0 };
}

/// Linear polynomial `a0 + a1 ζ`.
type Line = [f64; 2];

/// Derives the parts of a chain of at most four sections, one part for each section.
///
/// Parts of one cluster follow each other. Parts beyond the number of sections are empty.
pub fn parts<P: Realised>(chain: &[Biquad]) -> [Part<P>; 4] {
    let clusters = clusters(chain);
    let mut parts = [Part::EMPTY; 4];
    let mut slots = parts.iter_mut();
    for label in 0..4u8 {
        let is_member = |index: usize| clusters.get(index) == Some(&label);
        let (members, others) =
            (|| (0..chain.len()).filter(|&i| is_member(i)), || (0..chain.len()).filter(|&i| !is_member(i)));
        // All of a cluster run alike: mirrored or not, in a form that serves all.
        let Some((mirrored, form)) = in_common::<P>(chain, &clusters, label) else { continue };
        let mut poles = [None; 4];
        for (slot, index) in poles.iter_mut().zip(members()) {
            *slot = chain.get(index).map(|biquad| (P::new(biquad.pole, mirrored, &form), biquad.pole));
        }
        let mut newton = Newton::one(poles.map(|pole| pole.map(|(pole, _)| monic(pole, mirrored))));
        chain.iter().for_each(|biquad| newton.multiply(numerator(biquad, mirrored)));
        for other in others() {
            if let (Some(biquad), Some(&label)) = (chain.get(other), clusters.get(other))
                && let Some((its_side, form)) = in_common::<P>(chain, &clusters, label)
            {
                newton.divide(monic(P::new(biquad.pole, its_side, &form), mirrored));
            }
        }
        // From the last to the first: what a part's sound is multiplied by on its way out.
        let mut way = 1.0;
        let mut cluster = [None; 4];
        let lines = newton.lines;
        for ((slot, pole), [a0, a1]) in cluster.iter_mut().zip(poles).zip(lines).rev() {
            let Some((pole, root)) = pole else { continue };
            let gain_v = a1 / way;
            let gains = [(a0 / way - pole.delta() * gain_v) / pole.entry(), gain_v];
            let handed = coupling(pole, root);
            way *= handed;
            *slot = Some(Part { pole, gains, handed });
        }
        for (index, part) in cluster.into_iter().flatten().enumerate() {
            if let Some(slot) = slots.next() {
                *slot = Part { handed: if index == 0 { 0.0 } else { part.handed }, ..part };
            }
        }
    }
    parts
}

/// Labels the sections by cluster: each has the number of the first section of its cluster.
fn clusters(chain: &[Biquad]) -> [u8; 4] {
    let mut labels = [0, 1, 2, 3];
    for (i, one) in chain.iter().enumerate() {
        for (j, other) in chain.iter().enumerate().take(i) {
            if are_near(one.pole, other.pole)
                && let (Some(&mine), Some(&its)) = (labels.get(i), labels.get(j))
            {
                labels.iter_mut().filter(|label| **label == mine).for_each(|label| *label = its.min(mine));
                labels.iter_mut().filter(|label| **label == its.max(mine)).for_each(|label| *label = its.min(mine));
            }
        }
    }
    labels
}

/// True if two poles are so near that their parts would cancel.
///
/// Each near neighbour makes a part `width / distance` times too large. Further apart, sections in
/// a row would lose more than that, because one rings to another's rounding.
fn are_near(one: Root, other: Root) -> bool {
    let width = |pole: Root| 1.0 - libm::sqrt(pole.square());
    let distance = length(one.real - other.real, one.imaginary.abs() - other.imaginary.abs());
    width(one).min(width(other)) > 0.6 * distance
}

/// Side (true: mirrored) and form that all sections of a cluster share; `None` if there is no such
/// cluster.
fn in_common<P: Realised>(chain: &[Biquad], clusters: &[u8; 4], label: u8) -> Option<(bool, P::Form)> {
    let members = || chain.iter().zip(clusters).filter(|(_, its)| **its == label).map(|(biquad, _)| biquad.pole);
    let mirrored = members().map(|pole| pole.real - P::MIRROR_BELOW).sum::<f64>() < 0.0;
    members().map(|pole| P::form_of(pole, mirrored)).max().map(|form| (mirrored, form))
}

/// Multiplier between two parts of a cluster that makes the second as loud as the first.
///
/// Both are compared at the loudest point, at the pole's angle or at 0. Very narrow parts get four
/// times as much: strikes are over long before such a chain has built up its level.
fn coupling<P: Realised>(pole: P, root: Root) -> f64 {
    let radius = libm::sqrt(root.square());
    let width = 1.0 - radius;
    let there = width * length(width, 2.0 * root.imaginary.abs());
    let louder = if width < 0.01 { 4.0 } else { 1.0 };
    pole.handed(louder * there.min(pole.step_squared()))
}

/// Coefficients c0 and c1 of `z² - 2 Re p z + |p|² = ζ² + c1 ζ + c0`, with ζ mirrored or not.
fn monic<P: Realised>(pole: P, mirrored: bool) -> Line {
    let (delta, step) = (pole.delta(), pole.step_squared());
    if pole.is_mirrored() == mirrored { [step, delta + step] } else { [4.0 - 2.0 * delta - step, 4.0 - delta - step] }
}

/// Coefficients of `b0 z² + b1 z + b2` in powers of ζ.
fn numerator(biquad: &Biquad, mirrored: bool) -> [f64; 3] {
    let [b0, b1, b2] = biquad.numerator;
    let b1 = if mirrored { -b1 } else { b1 };
    [b0 + b1 + b2, 2.0 * b0 + b1, b0]
}

/// A polynomial modulo D_1 ... D_n as `lines[0] + D_1 lines[1] + D_1 D_2 lines[2] + ...`.
struct Newton {
    denominators: [Option<Line>; 4],
    lines: [Line; 4],
}

impl Newton {
    fn one(denominators: [Option<Line>; 4]) -> Self {
        Self { denominators, lines: [[1.0, 0.0], [0.0; 2], [0.0; 2], [0.0; 2]] }
    }

    /// Multiplies by `n0 + n1 ζ + n2 ζ²`, which is `n2 D_k` plus a linear polynomial for each k.
    fn multiply(&mut self, [n0, n1, n2]: [f64; 3]) {
        let (mut before, mut carry) = ([0.0; 2], 0.0);
        for (line, denominator) in self.lines.iter_mut().zip(self.denominators) {
            let Some(d @ [c0, c1]) = denominator else { break };
            let (product, above) = times([n0 - n2 * c0, n1 - n2 * c1], *line, d);
            let [b0, b1] = before;
            before = *line;
            *line = [product[0] + n2 * b0 + carry, product[1] + n2 * b1];
            carry = above;
        }
    }

    /// Divides by `ζ² + c1 ζ + c0`, which has no root in common with any D_k: the inverse of
    /// [`multiply`](Self::multiply).
    fn divide(&mut self, [n0, n1]: Line) {
        let (mut before, mut carry) = ([0.0; 2], 0.0);
        for (line, denominator) in self.lines.iter_mut().zip(self.denominators) {
            let Some(d @ [c0, c1]) = denominator else { break };
            let rest = [n0 - c0, n1 - c1];
            let wanted = [line[0] - before[0] - carry, line[1] - before[1]];
            let (quotient, _) = times(inverse(rest, d), wanted, d);
            carry = rest[1] * quotient[1];
            before = quotient;
            *line = quotient;
        }
    }
}

/// Product modulo `ζ² + c1 ζ + c0`, and the multiple of the modulus that was removed.
fn times([a0, a1]: Line, [b0, b1]: Line, [c0, c1]: Line) -> (Line, f64) {
    let square = a1 * b1;
    ([a0 * b0 - square * c0, a0 * b1 + a1 * b0 - square * c1], square)
}

/// Reciprocal of a linear polynomial modulo `ζ² + c1 ζ + c0`: its conjugate over its norm.
fn inverse([a0, a1]: Line, [c0, c1]: Line) -> Line {
    let norm = a0 * a0 - a0 * a1 * c1 + a1 * a1 * c0;
    [(a0 - a1 * c1) / norm, -a1 / norm]
}

#[cfg(test)]
mod tests {
    use super::super::pole::Pole;
    use super::*;

    type Complex = [f64; 2];

    fn product([a, b]: Complex, [c, d]: Complex) -> Complex {
        [a * c - b * d, a * d + b * c]
    }

    fn quotient(a: Complex, [c, d]: Complex) -> Complex {
        let square = c * c + d * d;
        product(a, [c / square, -d / square])
    }

    /// `c0 + c1 ζ + c2 ζ²` at a point of the circle, given by its angle.
    fn at([c0, c1, c2]: [f64; 3], angle: f64) -> Complex {
        // e^{iω} - 1 without cancellation.
        let half = (angle / 2.0).sin();
        let zeta = [-2.0 * half * half, angle.sin()];
        let square = product(zeta, zeta);
        [c0 + c1 * zeta[0] + c2 * square[0], c1 * zeta[1] + c2 * square[1]]
    }

    /// Answer of the parts of a chain at an angle, and of the product that they stand for, with the
    /// poles as they are realised.
    fn both(chain: &[Biquad], angle: f64) -> (Complex, Complex) {
        let parts = parts::<Pole>(chain);
        let parts = &parts[..chain.len()];
        let mut sum = [chain.iter().map(|biquad| biquad.numerator[0]).product(), 0.0];
        let mut whole = [1.0, 0.0];
        for cluster in parts.chunk_by(|_, next| next.handed != 0.0) {
            let mut sound = [0.0; 2];
            for part in cluster {
                let pole = part.pole;
                let angle = if pole.mirrored { core::f64::consts::PI - angle } else { angle };
                let [gain_u, gain_v] = part.gains;
                let own = at([pole.delta() * gain_v + pole.entry() * gain_u, gain_v, 0.0], angle);
                let couple = part.handed;
                let [c0, c1] = monic(pole, pole.mirrored);
                let below = at([c0, c1, 1.0], angle);
                sound = quotient([own[0] + couple * sound[0], own[1] + couple * sound[1]], below);
                // A mirrored point is the conjugate of the point's negative.
                let below = if pole.mirrored { [below[0], -below[1]] } else { below };
                whole = quotient(whole, below);
            }
            let sound = if cluster[0].pole.mirrored { [sound[0], -sound[1]] } else { sound };
            sum = [sum[0] + sound[0], sum[1] + sound[1]];
        }
        for biquad in chain {
            whole = product(whole, at(numerator(biquad, false), angle));
        }
        (sum, whole)
    }

    #[test]
    fn parts_add_up_to_the_chain_however_near_its_poles_are() {
        for (radius, angle) in [(0.999_99, 0.0104), (0.9999, 2.0), (0.99, 0.3), (0.5, 1.0)] {
            for nearness in [0.0, 1e-9, 1e-4, 0.1, 1.0, 30.0] {
                for depth in 1..=4 {
                    let width = 1.0 - radius;
                    let chain: std::vec::Vec<Biquad> = (0..depth)
                        .map(|index| {
                            let pole = Root::polar(radius, angle + width * nearness * f64::from(index));
                            Biquad::from_roots(pole, Root::polar(0.7, 1.3 - 0.2 * f64::from(index)), 1.0)
                        })
                        .collect();
                    let (sum, whole) = both(&chain, angle + 0.3 * width);
                    let error = (sum[0] - whole[0]).hypot(sum[1] - whole[1]) / whole[0].hypot(whole[1]);
                    assert!(error < 1e-7, "{radius} {angle} {nearness} {depth}: {error:e}");
                }
            }
        }
    }
}
