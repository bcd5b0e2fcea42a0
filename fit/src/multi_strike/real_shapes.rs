//! Real shapes: all gains of a mode along the object have one phase, or its opposite.
//!
//! A lightly damped thing moves in one phase all along in each of its modes: mode k has a real
//! shape φ_k(x). The way to the microphone adds one phase θ_k: the gains are `e^{jθ_k} φ_k(x)`.
//!
//! Gains with any phase at each position do not tell the times of contacts: a contact that comes
//! later by a time D(x) and gains that are turned back by `e^{sD(x)}` give the same ringing.

use nalgebra::{Complex, DMatrix};

use super::model::Model;

type C64 = Complex<f64>;

/// Phase of a mode with these gains, of size 1; the sign is arbitrary.
fn phase(gains: &[C64]) -> C64 {
    let squares: C64 = gains.iter().map(|gain| gain * gain).sum();
    C64::from_polar(1.0, 0.5 * squares.arg())
}

/// Gains with the phase of all, or its opposite, that lie nearest to given ones.
pub(super) fn nearest_real(gains: &[C64]) -> Vec<C64> {
    let phase = phase(gains);
    gains.iter().map(|gain| phase * (gain * phase.conj()).re).collect()
}

/// Matrix from the free parameters of a model with real shapes to steps of all shared parameters.
///
/// A mode with a shape has one free parameter for each coefficient and one for its phase, beside
/// its decay and frequency.
pub(super) fn directions(model: &Model) -> DMatrix<f64> {
    let size = model.shared_size();
    let mut directions = DMatrix::zeros(size, model.shared_freedom());
    let mut next = 2 * model.poles.len();
    (0..next).for_each(|index| directions[(index, index)] = 1.0);
    for (mode, gains) in model.gains.iter().enumerate() {
        let first = model.gain_column(mode);
        if gains.len() == 1 {
            for row in first..first + 2 {
                directions[(row, next)] = 1.0;
                next += 1;
            }
            continue;
        }
        let phase = phase(gains);
        let turned = next + gains.len();
        for (place, gain) in gains.iter().enumerate() {
            let row = first + 2 * place;
            (directions[(row, next + place)], directions[(row + 1, next + place)]) = (phase.re, phase.im);
            (directions[(row, turned)], directions[(row + 1, turned)]) = (-gain.im, gain.re);
        }
        next = turned + 1;
    }
    directions[(size - 1, next)] = 1.0;
    directions
}

/// Gains of a real shape after a step along [`directions`]: turned by the step's phase, then
/// changed along it.
pub(super) fn stepped(gains: &[C64], step: &[C64]) -> Vec<C64> {
    let phase = phase(gains);
    let (mut along, mut size) = (0.0, 1e-300);
    for (gain, step) in gains.iter().zip(step) {
        along += (gain.conj() * step).im;
        size += gain.norm_sqr();
    }
    let turn = C64::from_polar(1.0, along / size);
    gains.iter().zip(step).map(|(gain, step)| turn * (gain + phase * (step * phase.conj()).re)).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::*;
    use crate::multi_strike::synthetic::at_places;
    use crate::multi_strike::truth::model_of;
    use crate::random::SplitMix64;

    #[test]
    fn step_along_the_directions_leaves_shapes_real_and_is_linear_where_it_is_short() {
        let mut model = model_of(&at_places(3, 6.0, 10));
        let largest = model.gains.iter().flatten().map(|gain| gain.norm()).fold(0.0, f64::max);
        for gains in &mut model.gains {
            *gains = nearest_real(gains).into_iter().map(|gain| gain / largest).collect();
        }
        let directions = directions(&model);
        assert_eq!(directions.ncols(), model.shared_freedom());
        let mut random = SplitMix64(4);
        let all = &directions * DVector::from_fn(directions.ncols(), |_, _| 1e-5 * random.normal());
        for (mode, gains) in model.gains.iter().enumerate().filter(|(_, gains)| gains.len() > 1) {
            let first = model.gain_column(mode);
            let step: Vec<C64> =
                (0..gains.len()).map(|at| C64::new(all[first + 2 * at], all[first + 2 * at + 1])).collect();
            let next = stepped(gains, &step);
            for (real, next) in nearest_real(&next).iter().zip(&next) {
                assert!((real - next).norm() < 1e-12 * next.norm().max(1e-3), "{real} {next}");
            }
            for ((gain, step), next) in gains.iter().zip(&step).zip(&next) {
                assert!((gain + step - next).norm() < 1e-8, "{gain} {step} {next}");
            }
        }
    }
}
