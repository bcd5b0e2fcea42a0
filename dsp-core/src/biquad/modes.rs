//! Modes as biquads and chains of biquads as modes.
//!
//! A mode at a rate is one biquad. Impulse invariance gives
//! `h[n] = r^n (gs sin nθ + gc cos nθ) / fs` with half of `h[0]`, so that (eq. 2)
//!
//! ```text
//! b0 = gc / 2 fs,   b1 = gs r sin θ / fs,   b2 = -gc r² / 2 fs
//! ```
//!
//! A chain is the sum of its partial fractions, which are modes, and a direct gain.

use super::design::{Biquad, BiquadError, Root};
use crate::SampleRate;
use crate::exponential;

/// A mode: `h(t) = e^{-d t} (gs sin 2πft + gc cos 2πft)`, a force of 1 for 1 s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Partial {
    /// Frequency f in Hz.
    pub frequency_hz: f64,
    /// Decay rate d in 1/s.
    pub decay_per_s: f64,
    /// Sine gain gs.
    pub sine: f64,
    /// Cosine gain gc.
    pub cosine: f64,
}

/// A chain of biquads as modes side by side and a direct term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModalForm {
    /// Modes in the order of the chain's biquads; the first `count` are valid.
    pub modes: [Partial; 4],
    /// Number of modes.
    pub count: usize,
    /// Direct gain from input to output, beside the halves of `h[0]` that the modes have.
    pub direct: f64,
}

impl Partial {
    /// Derives the biquad of the mode at a rate; the frequency must be below half the rate.
    pub fn to_biquad(self, rate: SampleRate) -> Biquad {
        let radius = exponential::exp(-self.decay_per_s / rate.hz());
        let pole = Root::polar(radius, core::f64::consts::TAU * self.frequency_hz / rate.hz());
        let half = self.cosine / 2.0 / rate.hz();
        Biquad { pole, numerator: [half, self.sine / rate.hz() * pole.imaginary, -half * pole.square()] }
    }
}

impl ModalForm {
    /// Derives the modes of a chain of 1 to 4 biquads at a rate.
    ///
    /// They are exact to 1e-9 of the response if the poles are apart by their widths.
    ///
    /// # Errors
    /// [`BiquadError::NotFinite`], [`BiquadError::UnstablePole`], [`BiquadError::Depth`];
    /// [`BiquadError::NoMode`] for a pole at 0, real poles, and poles that coincide.
    pub fn of(chain: &[Biquad], rate: SampleRate) -> Result<Self, BiquadError> {
        if !(1..=4).contains(&chain.len()) {
            return Err(BiquadError::Depth { depth: chain.len(), sections: chain.len() });
        }
        let mut form = Self { modes: [Partial::default(); 4], count: chain.len(), direct: 1.0 };
        for (index, biquad) in chain.iter().enumerate() {
            biquad.check(index)?;
            form.direct *= biquad.numerator[0];
        }
        for (index, (biquad, mode)) in chain.iter().zip(&mut form.modes).enumerate() {
            let pole = biquad.pole;
            let radius = libm::sqrt(pole.square());
            if pole.imaginary == 0.0 {
                return Err(BiquadError::NoMode { biquad: index });
            }
            // At z = p: Π N(p) / ((p - p*) Π_others D(p)), times p: the factor of p^n from n = 0
            // on.
            let pole = Root { imaginary: pole.imaginary.abs(), ..pole };
            let mut residue = Root { real: 1.0, imaginary: 0.0 };
            for (other, section) in chain.iter().enumerate() {
                residue = times(residue, numerator_at(section, pole));
                if other != index {
                    let (above, below) = conjugates(section.pole);
                    residue = divide(residue, times(minus(pole, above), minus(pole, below)));
                }
            }
            residue = divide(residue, times(pole, Root { real: 0.0, imaginary: 2.0 * pole.imaginary }));
            if !(residue.real.is_finite() && residue.imaginary.is_finite()) {
                return Err(BiquadError::NoMode { biquad: index });
            }
            // h[n] = 2 Re(residue p^n).
            let fs = rate.hz();
            let (sine, cosine) = (-2.0 * residue.imaginary * fs, 2.0 * residue.real * fs);
            let theta = libm::atan2(pole.imaginary, pole.real);
            let (frequency_hz, decay_per_s) = (theta * fs / core::f64::consts::TAU, -libm::log(radius) * fs);
            *mode = Partial { frequency_hz, decay_per_s, sine, cosine };
            form.direct -= cosine / 2.0 / fs;
        }
        Ok(form)
    }
}

fn numerator_at(section: &Biquad, z: Root) -> Root {
    let [b0, b1, b2] = section.numerator;
    // b0 z² + b1 z + b2.
    let first = Root { real: b0 * z.real + b1, imaginary: b0 * z.imaginary };
    let product = times(first, z);
    Root { real: product.real + b2, ..product }
}

fn conjugates(root: Root) -> (Root, Root) {
    let imaginary = root.imaginary.abs();
    (Root { imaginary, ..root }, Root { imaginary: -imaginary, ..root })
}

fn minus(a: Root, b: Root) -> Root {
    Root { real: a.real - b.real, imaginary: a.imaginary - b.imaginary }
}

fn times(a: Root, b: Root) -> Root {
    Root { real: a.real * b.real - a.imaginary * b.imaginary, imaginary: a.real * b.imaginary + a.imaginary * b.real }
}

fn divide(a: Root, b: Root) -> Root {
    let square = b.square();
    times(a, Root { real: b.real / square, imaginary: -b.imaginary / square })
}
