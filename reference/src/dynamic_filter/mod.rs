//! The dynamic filter in `f64` (*Analysis-Synthesis of Impact Sounds by Real-Time Dynamic Filtering*, eq. 5, 6 and 17), and its exciter.

mod band_pass;
mod carry;
mod exciter;
mod form;
mod noise;

pub use band_pass::BandPass;
pub use exciter::Exciter;
pub use form::Form;
pub use noise::White;

use crate::SampleRate;

/// The coefficients at a time after the strike: `s(n) = b0 e(n) + b1 e(n-1) + b2 e(n-2) - a1 s(n-1) - a2 s(n-2)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breakpoint {
    /// Seconds after the strike.
    pub time_s: f64,
    /// Level of the noise, 0 to 1: it scales e(n), never the filter.
    pub noise: f64,
    /// a1.
    pub a1: f64,
    /// a2, of the second order only.
    pub a2: f64,
    /// b0.
    pub b0: f64,
    /// b1; eq. 17 has b1 = b0.
    pub b1: f64,
    /// b2, of the second order only.
    pub b2: f64,
}

impl Default for Breakpoint {
    /// At 0 s, noise at its full level, the filter closed.
    fn default() -> Self {
        Self { time_s: 0.0, noise: 1.0, a1: 0.0, a2: 0.0, b0: 0.0, b1: 0.0, b2: 0.0 }
    }
}

impl Breakpoint {
    /// Rms of what white noise of rms 1 becomes: `sqrt(Σ h²)`.
    fn noise_gain(&self) -> f64 {
        let Self { a1, a2, b0, b1, b2, .. } = *self;
        // The variance of an ARMA(2, 2) process.
        let e = 1.0 + a2;
        let above =
            (b0 * b0 + b1 * b1 + b2 * b2) * e - 2.0 * (b0 * b1 + b1 * b2) * a1 + 2.0 * b0 * b2 * (a1 * a1 - a2 * e);
        let below = (1.0 - a2 * a2) * e - (1.0 - a2) * a1 * a1;
        (above / below).max(0.0).sqrt()
    }

    /// Radius of the slowest pole.
    fn radius(&self) -> f64 {
        let rest = self.a1 * self.a1 - 4.0 * self.a2;
        if rest < 0.0 { self.a2.sqrt() } else { (self.a1.abs() + rest.sqrt()) / 2.0 }
    }
}

/// A filter along its path, from rest.
#[derive(Clone, Debug)]
pub struct Filter<'a> {
    path: &'a [Breakpoint],
    order: u8,
    rate: SampleRate,
    state: [f64; 2],
    last: f64,
}

impl<'a> Filter<'a> {
    /// Of order 1 or 2.
    pub fn new(order: u8, path: &'a [Breakpoint], rate: SampleRate) -> Self {
        Self { path, order, rate, state: [0.0; 2], last: 0.0 }
    }

    /// The form's parameters so many samples after the strike: linear between breakpoints, the last one's afterwards.
    pub fn form(&self, samples: usize) -> Form {
        let time_s = samples as f64 / self.rate.hz();
        for pair in self.path.windows(2) {
            if (pair[0].time_s..pair[1].time_s).contains(&time_s) {
                let part = (time_s - pair[0].time_s) / (pair[1].time_s - pair[0].time_s);
                return Form::of(self.order, &pair[0]).toward(&Form::of(self.order, &pair[1]), part);
            }
        }
        Form::of(self.order, &self.path.last().copied().unwrap_or_default())
    }

    /// Level of the noise so many samples after the strike: linear between breakpoints, none from the last one on.
    pub fn noise(&self, samples: usize) -> f64 {
        let time_s = samples as f64 / self.rate.hz();
        let within = |pair: &&[Breakpoint]| (pair[0].time_s..pair[1].time_s).contains(&time_s);
        self.path.windows(2).find(within).map_or(0.0, |pair| {
            let part = (time_s - pair[0].time_s) / (pair[1].time_s - pair[0].time_s);
            pair[0].noise + part * (pair[1].noise - pair[0].noise)
        })
    }

    /// What is left of the sound after a sample, so many after the strike, by the path itself: by its level (the noise's times the filter's gain for white noise at each
    /// breakpoint, linear between them, 0 from the last one on), or by its slowest pole (its radius linear between breakpoints) where that leaves more; 1 where it grows.
    pub fn own_decay(&self, samples: usize) -> f64 {
        let at = |samples: usize| -> (f64, f64) {
            let time_s = samples as f64 / self.rate.hz();
            let within = |pair: &&[Breakpoint]| (pair[0].time_s..pair[1].time_s).contains(&time_s);
            match self.path.windows(2).find(within) {
                Some(pair) => {
                    let part = (time_s - pair[0].time_s) / (pair[1].time_s - pair[0].time_s);
                    let mix = |of: &dyn Fn(&Breakpoint) -> f64| of(&pair[0]) + part * (of(&pair[1]) - of(&pair[0]));
                    (mix(&|point| point.noise * point.noise_gain()), mix(&Breakpoint::radius))
                }
                None => (0.0, self.path.last().map_or(0.0, Breakpoint::radius)),
            }
        };
        let ((now, radius), (next, _)) = (at(samples), at(samples + 1));
        let of_level = if now > 0.0 {
            next / now
        } else if next > 0.0 {
            1.0
        } else {
            0.0
        };
        of_level.max(radius).min(1.0)
    }

    /// s(n) for e(n), so many samples after the last strike.
    pub fn step(&mut self, samples: usize, e: f64) -> f64 {
        let form = self.form(samples);
        form.step(&mut self.state, std::mem::replace(&mut self.last, e), e)
    }

    /// Whether there is noise so many samples after the strike: before the path's end, and not in a piece that is silent at both ends.
    pub fn is_noisy(&self, samples: usize) -> bool {
        let last_s = self.path.last().map_or(0.0, |point| point.time_s);
        let time_s = samples as f64 / self.rate.hz();
        let is_silent = |pair: &[Breakpoint]| {
            (pair[0].time_s..pair[1].time_s).contains(&time_s) && pair[0].noise == 0.0 && pair[1].noise == 0.0
        };
        samples < (last_s * self.rate.hz()).ceil() as usize && !self.path.windows(2).any(is_silent)
    }

    /// Leaves so much of what rings.
    pub fn attenuate(&mut self, left: f64) {
        self.state = self.state.map(|s| left * s);
        self.last *= left;
    }

    /// All of an input; `strikes` are samples, in order; before the first there is silence.
    pub fn run(&mut self, strikes: &[usize], input: &[f64]) -> Vec<f64> {
        let step = |(n, &e): (usize, &f64)| match strikes.iter().rev().find(|start| **start <= n) {
            Some(start) => self.step(n - start, e),
            None => 0.0,
        };
        input.iter().enumerate().map(step).collect()
    }
}
