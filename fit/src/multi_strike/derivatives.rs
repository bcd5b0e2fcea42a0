//! Derivatives of the thing's sound by what all strikes share, written out as sounds.

use nalgebra::Complex;

use super::equations::residual;
use super::model::Model;
use crate::modes::Pole;

/// Difference of poles, as a share of the decay, by which their derivatives are computed: central
/// differences are exact to 1e-8 of the derivative.
const DIFFERENCE: f64 = 1e-4;

/// Sound of a model over `length` samples.
pub(super) fn sound(model: &Model, length: usize) -> Vec<f64> {
    // The residual of silence is the sound with its sign turned.
    let mut sound = residual(model, &vec![0.0; length]);
    sound.iter_mut().for_each(|x| *x = -*x);
    sound
}

/// Derivatives over `length` samples of a mode's sound by decay, angular frequency, real and
/// imaginary part of its gain, with the strikes held.
pub(super) fn of_mode(model: &Model, mode: usize, length: usize) -> [Vec<f64>; 4] {
    let pole = model.poles[mode];
    let alone = |pole: Pole, gain: Complex<f64>| {
        let (poles, gains, owners) = (vec![pole], vec![vec![gain]], vec![model.owners[mode]]);
        sound(&Model { poles, gains, owners, acceleration: 0.0, strikes: model.strikes.clone(), ..*model }, length)
    };
    let size = DIFFERENCE * pole.decay;
    let by_pole = |decay: f64, angular: f64| {
        let at = |sign: f64| {
            let pole = Pole { decay: pole.decay + sign * decay, angular: pole.angular + sign * angular };
            alone(pole, model.gains[mode][0])
        };
        let (mut more, less) = (at(1.0), at(-1.0));
        more.iter_mut().zip(&less).for_each(|(more, less)| *more = (*more - less) / (2.0 * size));
        more
    };
    let by_gain = |re: f64, im: f64| alone(pole, Complex::new(re, im));
    [by_pole(size, 0.0), by_pole(0.0, size), by_gain(1.0, 0.0), by_gain(0.0, 1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::descend::Fitted;
    use crate::multi_strike::synthetic::plain;
    use crate::multi_strike::truth::model_of;
    use crate::multi_strike::whitening::Whitening;

    #[test]
    fn sums_with_a_residual_are_those_of_the_normal_equations() {
        let recording = plain(8, 2.0, 4, -40.0);
        let whitening = Whitening::of_residual(&recording.samples, 5);
        let fitted = Fitted::new(model_of(&recording), &recording.samples, &whitening);
        let (covariance, right) = fitted.equations(&whitening).held_shared(0.0).expect("modes differ");
        let length = recording.samples.len();
        let left = whitening.filtered(&fitted.residual, 0..length);
        let mut sums = vec![0.0f64; right.len()];
        for mode in 0..fitted.model.poles.len() {
            for (column, sound) in fitted.model.columns_of(mode).zip(of_mode(&fitted.model, mode, length)) {
                let sound = whitening.filtered(&sound, 0..length);
                sums[column] = sound.iter().zip(&left).map(|(a, b)| a * b).sum();
            }
        }
        // Sums differ in size by many orders: each is held against its deviation.
        for (column, (sum, right)) in sums.iter().zip(&right).enumerate() {
            let unit = covariance[(column, column)].sqrt();
            assert!((sum - right).abs() * unit < 1e-6 * (1.0 + right.abs() * unit), "{column}: {sum} {right}");
        }
    }
}
