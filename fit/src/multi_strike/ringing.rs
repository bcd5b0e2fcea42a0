//! Amplitudes of all modes at a moment, and their derivatives by all parameters.

use std::collections::VecDeque;

use nalgebra::{Complex, DMatrix};

use super::model::{Model, Strike};
use super::spline::Weights;

type C64 = Complex<f64>;
const TURN: C64 = C64::new(0.0, 1.0);

/// Complex amplitudes of the modes at a sample: mode k sounds as `Re(C_k z_k^n)` from there on.
#[derive(Clone, Debug)]
pub(super) struct Ringing {
    pub(super) amplitudes: Vec<C64>,
    /// Derivatives of the amplitudes by the poles' `s`.
    by_pole: Vec<C64>,
    /// Derivatives of the amplitudes by the gains, mode by mode.
    by_gain: Vec<C64>,
    /// First strike that is still heard.
    pub(super) first: usize,
    /// Derivatives by each parameter of the strikes that are still heard: parameter by parameter.
    by_strike: VecDeque<Vec<Vec<C64>>>,
}

impl Ringing {
    /// Silence before the strike `first`.
    pub(super) fn silence(model: &Model, first: usize) -> Self {
        let zero = C64::new(0.0, 0.0);
        let count = model.poles.len();
        Self {
            amplitudes: vec![zero; count],
            by_pole: vec![zero; count],
            by_gain: vec![zero; count * model.places()],
            first,
            by_strike: VecDeque::new(),
        }
    }

    /// Number of strikes that are still heard.
    pub(super) fn heard(&self) -> usize {
        self.by_strike.len()
    }

    /// Lets `length` samples pass.
    pub(super) fn pass(&mut self, model: &Model, length: usize) {
        let places = model.places();
        let length = length as f64;
        for (mode, pole) in model.poles.iter().enumerate() {
            let power = pole.power(length);
            self.by_pole[mode] = power * (self.by_pole[mode] + self.amplitudes[mode] * length);
            self.amplitudes[mode] *= power;
            self.by_gain[mode * places..(mode + 1) * places].iter_mut().for_each(|gain| *gain *= power);
            for parameter in self.by_strike.iter_mut().flatten() {
                parameter[mode] *= power;
            }
        }
    }

    /// Adds a strike whose contact is over at the sample `now`, the moment of these amplitudes.
    pub(super) fn strike(&mut self, model: &Model, strike: &Strike, now: usize) {
        let places = model.places();
        let mut own = vec![vec![C64::new(0.0, 0.0); model.poles.len()]; model.strike_size()];
        for mode in 0..model.poles.len() {
            let Effect { response, gain, slope, weights } = Effect::of(model, strike, mode, now as f64);
            self.amplitudes[mode] += gain * response.value;
            self.by_pole[mode] += gain * response.by_pole;
            let peak = strike.contact.peak;
            for (by_gain, weight) in self.by_gain[mode * places + weights.first..].iter_mut().zip(weights.values()) {
                *by_gain += response.value * (peak * weight);
            }
            own[0][mode] = gain * response.by_middle;
            own[1][mode] = gain * response.by_time * strike.contact.time;
            own[2][mode] = gain * response.value;
            if let Some(position) = own.get_mut(3) {
                position[mode] = slope * response.value;
            }
        }
        self.by_strike.push_back(own);
    }

    /// Forgets strikes that are at most `level` loud in all modes, oldest first.
    ///
    /// At most `most` strikes are kept.
    pub(super) fn forget(&mut self, level: f64, most: usize) {
        let is_quiet = |strike: &Vec<Vec<C64>>| strike[2].iter().all(|amplitude| amplitude.norm_sqr() < level * level);
        while self.by_strike.len() > most || self.by_strike.front().is_some_and(is_quiet) {
            self.by_strike.pop_front();
            self.first += 1;
        }
    }

    /// Derivatives as coefficients of `Re u, Re ju, Re v, Re jv` of each mode, `u = zⁿ, v = n zⁿ`.
    ///
    /// There is a column for each parameter of the strikes that are heard, then of `extra` strikes
    /// without a term.
    pub(super) fn columns(&self, model: &Model, extra: usize) -> DMatrix<f64> {
        let size = model.strike_size();
        let mut columns = DMatrix::zeros(4 * model.poles.len(), size * (self.heard() + extra));
        for (index, strike) in self.by_strike.iter().enumerate() {
            for (parameter, amplitudes) in strike.iter().enumerate() {
                for (mode, amplitude) in amplitudes.iter().enumerate() {
                    columns[(4 * mode, index * size + parameter)] = amplitude.re;
                    columns[(4 * mode + 1, index * size + parameter)] = amplitude.im;
                }
            }
        }
        columns
    }

    /// Derivatives by the shared parameters of each mode, as [`Ringing::columns`] has those of the
    /// strikes.
    ///
    /// A mode's decay, frequency and gains change the mode alone, so that each block has four rows.
    /// Its columns are decay, angular frequency, and the real and imaginary part of each gain.
    pub(super) fn blocks(&self, model: &Model) -> Vec<DMatrix<f64>> {
        let places = model.places();
        let of_mode = |mode: usize| {
            let mut block = DMatrix::zeros(4, 2 + 2 * model.gains[mode].len());
            let mut put = |row: usize, column: usize, value: C64| {
                block[(row, column)] = value.re;
                block[(row + 1, column)] = value.im;
            };
            // Decay and angular frequency: s = -d + jω.
            put(0, 0, -self.by_pole[mode]);
            put(2, 0, -self.amplitudes[mode]);
            put(0, 1, TURN * self.by_pole[mode]);
            put(2, 1, TURN * self.amplitudes[mode]);
            for place in 0..model.gains[mode].len() {
                let gain = self.by_gain[mode * places + place];
                put(0, 2 + 2 * place, gain);
                put(0, 3 + 2 * place, TURN * gain);
            }
            block
        };
        (0..model.poles.len()).map(of_mode).collect()
    }
}

/// Effect of a strike on a mode at a sample.
pub(super) struct Effect {
    pub(super) response: super::contact::Response,
    /// Gain at the strike's position times its peak, and the derivative by the position.
    pub(super) gain: C64,
    pub(super) slope: C64,
    /// Weights of the mode's gains at the position.
    pub(super) weights: Weights,
}

impl Effect {
    /// Effect of a strike; none on a mode that the strike does not ring.
    pub(super) fn of(model: &Model, strike: &Strike, mode: usize, sample: f64) -> Self {
        let gains = &model.gains[mode];
        let weights = Weights::at(strike.position, gains.len());
        let response = if model.rings(mode, strike) {
            strike.contact.response(model.exponent(mode), sample)
        } else {
            super::contact::Response::default()
        };
        let peak = strike.contact.peak;
        Self { response, gain: weights.sum(gains) * peak, slope: weights.slope(gains) * peak, weights }
    }
}
