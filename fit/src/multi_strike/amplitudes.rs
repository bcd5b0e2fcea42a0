//! Changes of the modes' amplitudes by each strike, from the stretches before and behind it.

use nalgebra::{Cholesky, Complex, DMatrix, Dyn};
use rayon::prelude::*;

use super::free::{Guard, amplitudes, stretches};
use super::whitening::Whitening;
use crate::modes::{Basis, Pole, Stretch};

type C64 = Complex<f64>;

/// Error of an amplitude that is allowed for beside the noise, as a share of it.
pub(super) const OWN_ERROR: f64 = 0.006;
/// Share by which the energies of modes grow: two modes in one place have finite variances.
const RIDGE: f64 = 1e-9;

/// Change of all modes' amplitudes by a strike.
pub(super) struct Change {
    /// Moment to which the amplitudes refer, in samples.
    pub(super) at: usize,
    pub(super) amplitudes: Vec<C64>,
    /// Variances of the amplitudes' real and of their imaginary parts, in full scale squared.
    pub(super) variances: Vec<f64>,
}

/// Assumption with which the variances of amplitudes are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Told {
    /// All modes of a stretch are told together, as they are.
    Together,
    /// Each mode is told as if it rang alone: close modes keep their weight.
    Alone,
}

/// A whitened recording with its filter, and the variance of its noise.
pub(crate) struct White<'a> {
    pub(crate) samples: &'a [f64],
    pub(crate) whitening: &'a Whitening,
    pub(crate) variance: f64,
}

/// Changes of amplitudes by the strikes near `onsets`, from the whitened recording.
///
/// Strikes too close to their neighbours for an amplitude of their own are left out.
pub(super) fn changes_of(white: &White<'_>, onsets: &[usize], poles: &[Pole], rate_hz: f64, told: Told) -> Vec<Change> {
    let stretches = stretches(onsets, Guard::OF_CHANGE, white.samples.len(), rate_hz);
    let amplitudes = amplitudes(white.samples, &stretches, poles);
    let spreads: Vec<Vec<f64>> = stretches.par_iter().map(|stretch| spreads(poles, stretch.len(), told)).collect();
    let responses: Vec<C64> = poles.iter().map(|&pole| white.whitening.response(pole)[0]).collect();
    let mut changes = Vec::new();
    // Stretch before the strike whose amplitudes are known.
    let mut before: Option<usize> = None;
    for (index, &at) in onsets.iter().enumerate() {
        let Some(own) = amplitudes.get(index).filter(|own| !own.is_empty()) else {
            before = None;
            continue;
        };
        let is_alone = index == 0 || before == Some(index - 1);
        let (mut sums, mut variances) = (Vec::with_capacity(poles.len()), Vec::with_capacity(poles.len()));
        for (mode, pole) in poles.iter().enumerate() {
            let back = pole.power(at as f64 - stretches[index].start as f64);
            let (mut sum, mut both) = (own[mode] * back, white.variance * spreads[index][mode] * back.norm_sqr());
            if let Some(before) = before {
                let ahead = pole.power(at as f64 - stretches[before].start as f64);
                sum -= amplitudes[before][mode] * ahead;
                both += white.variance * spreads[before][mode] * ahead.norm_sqr();
            }
            variances.push(both + (OWN_ERROR * own[mode].norm() * back.norm()).powi(2));
            sums.push(sum);
        }
        before = Some(index);
        // The filter scales each mode.
        sums.iter_mut().zip(&responses).for_each(|(sum, response)| *sum /= response);
        variances.iter_mut().zip(&responses).for_each(|(variance, response)| *variance /= response.norm_sqr());
        if is_alone {
            changes.push(Change { at, amplitudes: sums, variances });
        }
    }
    changes
}

/// Variance of one part of each mode's amplitude in a stretch, in units of the noise's variance.
///
/// All amplitudes are told together: of two modes that a stretch is too short to tell apart, each
/// has a large variance, though the sum of both is known. Weights that took each mode for alone
/// trusted their differences, and no contact explained those.
pub(super) fn spreads(poles: &[Pole], length: usize, told: Told) -> Vec<f64> {
    if told == Told::Alone {
        return poles.iter().flat_map(|pole| spreads(&[*pole], length, Told::Together)).collect();
    }
    let inverse = gram(poles, length).map(|factor| factor.inverse());
    let of_mode = |mode: usize| {
        let part = |index: usize| inverse.as_ref().map_or(f64::INFINITY, |inverse| inverse[(index, index)]);
        0.5 * (part(2 * mode) + part(2 * mode + 1))
    };
    (0..poles.len()).map(of_mode).collect()
}

/// Factor of the inner products of `Re zⁿ` and `Re jzⁿ` of all modes over a length.
fn gram(poles: &[Pole], length: usize) -> Option<Cholesky<f64, Dyn>> {
    const UNITS: [C64; 2] = [C64::new(1.0, 0.0), C64::new(0.0, 1.0)];
    let silence = vec![0.0; length];
    let stretch = Stretch::ringing(&silence);
    let bases: Vec<Basis> = poles.iter().map(|&pole| Basis::new(pole, &stretch)).collect();
    let mut gram = DMatrix::zeros(2 * poles.len(), 2 * poles.len());
    for (k, a) in bases.iter().enumerate() {
        for (l, b) in bases.iter().enumerate().take(k + 1) {
            let products = a.products(b).uu;
            for (i, alpha) in UNITS.into_iter().enumerate() {
                for (j, beta) in UNITS.into_iter().enumerate() {
                    let value = products.real(alpha, beta);
                    gram[(2 * k + i, 2 * l + j)] = value;
                    gram[(2 * l + j, 2 * k + i)] = value;
                }
            }
        }
    }
    (0..gram.nrows()).for_each(|index| gram[(index, index)] *= 1.0 + RIDGE);
    Cholesky::new(gram)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn stated_variances_are_those_of_amplitudes_in_noise() {
        let poles = [0.02, 0.0203, 0.3].map(|angular| Pole { decay: 1e-3, angular });
        let stated = spreads(&poles, 3000, Told::Together);
        assert!(stated[0] > 5.0 * stated[2], "two close modes are told worse than one alone: {stated:?}");
        let mut random = SplitMix64(3);
        let mut sums = [0.0; 3];
        let trials = 300;
        for _ in 0..trials {
            let noise: Vec<f64> = (0..3000).map(|_| random.normal()).collect();
            let found = amplitudes(&noise, std::slice::from_ref(&(0..3000)), &poles);
            sums.iter_mut().zip(&found[0]).for_each(|(sum, amplitude)| *sum += 0.5 * amplitude.norm_sqr());
        }
        for (sum, stated) in sums.into_iter().zip(stated) {
            let ratio = sum / f64::from(trials) / stated;
            assert!((0.8..1.25).contains(&ratio), "{ratio}");
        }
    }
}
