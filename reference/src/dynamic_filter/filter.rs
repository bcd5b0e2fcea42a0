//! The dynamic filter along its path of breakpoints.

use super::breakpoint::Breakpoint;
use super::form::Form;
use crate::rate::SampleRate;

/// Filter that moves along a path of breakpoints, from rest.
#[derive(Clone, Debug)]
pub struct Filter<'a> {
    path: &'a [Breakpoint],
    order: u8,
    rate: SampleRate,
    state: [f64; 2],
    last: f64,
}

impl<'a> Filter<'a> {
    /// Filter of order 1 or 2, at rest.
    pub fn new(order: u8, path: &'a [Breakpoint], rate: SampleRate) -> Self {
        Self { path, order, rate, state: [0.0; 2], last: 0.0 }
    }

    /// Parameters `samples` after the strike: linear between breakpoints, and those of the last one
    /// after it.
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

    /// Level of the noise `samples` after the strike: linear between breakpoints, and 0 from the
    /// last one on.
    pub fn noise(&self, samples: usize) -> f64 {
        let time_s = samples as f64 / self.rate.hz();
        let within = |pair: &&[Breakpoint]| (pair[0].time_s..pair[1].time_s).contains(&time_s);
        self.path.windows(2).find(within).map_or(0.0, |pair| {
            let part = (time_s - pair[0].time_s) / (pair[1].time_s - pair[0].time_s);
            pair[0].noise + part * (pair[1].noise - pair[0].noise)
        })
    }

    /// Factor, 0 to 1, by which the sound falls by itself from `samples` after the strike to the
    /// next sample.
    ///
    /// It is the larger of two factors, and 1 if the level grows.
    ///
    /// The first factor is the fall of the level. The level is the noise's level times the filter's
    /// gain for white noise at each breakpoint, linear between them, and 0 from the last one on.
    /// The second factor is the radius of the slowest pole, linear between breakpoints.
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

    /// Filters one sample: s(n) for e(n), `samples` after the last strike.
    pub fn step(&mut self, samples: usize, e: f64) -> f64 {
        let form = self.form(samples);
        form.step(&mut self.state, std::mem::replace(&mut self.last, e), e)
    }

    /// True before the path's end, `samples` after the strike.
    pub fn is_under_way(&self, samples: usize) -> bool {
        let last_s = self.path.last().map_or(0.0, |point| point.time_s);
        samples < (last_s * self.rate.hz()).ceil() as usize
    }

    /// True if there is noise `samples` after the strike.
    ///
    /// It is false after the path's end, and between two breakpoints whose noise is 0.
    pub fn is_noisy(&self, samples: usize) -> bool {
        let time_s = samples as f64 / self.rate.hz();
        let is_silent = |pair: &[Breakpoint]| {
            (pair[0].time_s..pair[1].time_s).contains(&time_s) && pair[0].noise == 0.0 && pair[1].noise == 0.0
        };
        self.is_under_way(samples) && !self.path.windows(2).any(is_silent)
    }

    /// Multiplies the filter's state by `left`.
    pub fn attenuate(&mut self, left: f64) {
        self.state = self.state.map(|s| left * s);
        self.last *= left;
    }

    /// Filters all of `input`, with strikes at the sorted sample numbers `strikes`. The output is 0
    /// before the first strike.
    pub fn run(&mut self, strikes: &[usize], input: &[f64]) -> Vec<f64> {
        let step = |(n, &e): (usize, &f64)| match strikes.iter().rev().find(|start| **start <= n) {
            Some(start) => self.step(n - start, e),
            None => 0.0,
        };
        input.iter().enumerate().map(step).collect()
    }
}
