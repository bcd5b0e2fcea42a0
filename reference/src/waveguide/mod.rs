//! Banded waveguides in `f64` (*Analysis-Synthesis of Impact Sounds by Real-Time Dynamic
//! Filtering*, eq. 8 to 13).

use std::collections::VecDeque;
use std::f64::consts::TAU;

use crate::dynamic_filter::Filter;
use crate::rate::SampleRate;

/// Feedback loop round a dynamic filter: a delay and a band-pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loop {
    /// Centre frequency f_c in Hz.
    pub frequency_hz: f64,
    /// Bandwidth Δf in Hz.
    pub bandwidth_hz: f64,
    /// Gain γ at f_c.
    pub gain: f64,
    /// Delay d in seconds, at least one sample.
    pub delay_s: f64,
}

/// Coefficients of a loop at one sample rate.
///
/// `y(n) = c0 s(n-d) + c1 s(n-d-1) - c3 y(n-1) - c4 y(n-2)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuned {
    /// Delay in whole samples.
    pub delay: usize,
    /// Coefficients c0, c1.
    pub numerator: [f64; 2],
    /// Coefficients c3, c4.
    pub denominator: [f64; 2],
}

impl Loop {
    /// Coefficients of the loop at a sample rate.
    ///
    /// The denominator is that of eq. 10 with `τ = sin(2πf_c) Δf / (2 f_c)`. The numerator has the
    /// gain γ at f_c, and delays by the fraction of a sample that is left of the delay.
    pub fn tuned(&self, rate: SampleRate) -> Tuned {
        let omega = TAU * self.frequency_hz / rate.hz();
        let tau = omega.sin() * self.bandwidth_hz / (2.0 * self.frequency_hz);
        let [c3, c4] = [-2.0 * omega.cos() / (1.0 + tau), (1.0 - tau) / (1.0 + tau)];
        let samples = self.delay_s * rate.hz();
        let phase = -omega * samples.fract();
        // c0 + c1 e^{-iω} = γ e^{i phase} (1 + c3 e^{-iω} + c4 e^{-2iω}).
        let re = 1.0 + c3 * omega.cos() + c4 * (2.0 * omega).cos();
        let im = -c3 * omega.sin() - c4 * (2.0 * omega).sin();
        let wanted_re = self.gain * (phase.cos() * re - phase.sin() * im);
        let wanted_im = self.gain * (phase.cos() * im + phase.sin() * re);
        let c1 = -wanted_im / omega.sin();
        Tuned { delay: samples as usize, numerator: [wanted_re - c1 * omega.cos(), c1], denominator: [c3, c4] }
    }
}

/// Loops round a filter, at work sample by sample, from rest.
#[derive(Clone, Debug)]
pub struct Loops {
    /// Each loop with its last outputs y_s(n-1), y_s(n-2).
    loops: Vec<(Tuned, [f64; 2])>,
    /// Past outputs s(n-1), s(n-2) ... as far back as the longest delay.
    past: VecDeque<f64>,
}

impl Loops {
    /// Loops at rest, tuned for a sample rate.
    pub fn new(loops: &[Loop], rate: SampleRate) -> Self {
        let loops: Vec<_> = loops.iter().map(|one| (one.tuned(rate), [0.0; 2])).collect();
        let longest = loops.iter().map(|(tuned, _)| tuned.delay + 1).max().unwrap_or(0);
        Self { loops, past: vec![0.0; longest].into() }
    }

    /// Sum of the loops' outputs for this sample, to be added to the filter's input (eq. 12).
    pub fn sum(&mut self) -> f64 {
        let mut sum = 0.0;
        for (tuned, y) in &mut self.loops {
            let Tuned { delay, numerator: [c0, c1], denominator: [c3, c4] } = *tuned;
            let now = c0 * self.past[delay - 1] + c1 * self.past[delay] - c3 * y[0] - c4 * y[1];
            *y = [now, y[0]];
            sum += now;
        }
        sum
    }

    /// Takes the filter's output of this sample.
    pub fn hear(&mut self, s: f64) {
        if self.past.pop_back().is_some() {
            self.past.push_front(s);
        }
    }

    /// Multiplies the loops' states by `left`.
    pub fn attenuate(&mut self, left: f64) {
        let states = self.loops.iter_mut().flat_map(|(_, y)| y);
        states.chain(&mut self.past).for_each(|value| *value *= left);
    }
}

/// Filters the excitation `input` from rest by a filter with loops (eq. 12 and 13).
///
/// `strikes` are sorted sample numbers.
pub fn filter(filter: &mut Filter<'_>, loops: &[Loop], strikes: &[usize], input: &[f64], rate: SampleRate) -> Vec<f64> {
    let mut loops = Loops::new(loops, rate);
    let step = |(n, &e): (usize, &f64)| {
        let sum = e + loops.sum();
        let start = strikes.iter().rev().find(|start| **start <= n);
        let s = start.map_or(0.0, |start| filter.step(n - start, sum));
        loops.hear(s);
        s
    };
    input.iter().enumerate().map(step).collect()
}
