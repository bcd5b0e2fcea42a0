//! The dynamic filter in `f64` (*Analysis-Synthesis of Impact Sounds by Real-Time Dynamic Filtering*, eq. 5, 6 and 17).

use crate::SampleRate;

/// The coefficients at a time after the strike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breakpoint {
    /// Seconds after the strike.
    pub time_s: f64,
    /// b0.
    pub b0: f64,
    /// b1; eq. 17 has b1 = b0.
    pub b1: f64,
    /// a1.
    pub a1: f64,
}

/// b0, b1, a1 at a time: linear between breakpoints, the last one's afterwards.
pub fn coefficients(breakpoints: &[Breakpoint], time_s: f64) -> [f64; 3] {
    let values = |point: &Breakpoint| [point.b0, point.b1, point.a1];
    for pair in breakpoints.windows(2) {
        if (pair[0].time_s..pair[1].time_s).contains(&time_s) {
            let part = (time_s - pair[0].time_s) / (pair[1].time_s - pair[0].time_s);
            let (from, to) = (values(&pair[0]), values(&pair[1]));
            return std::array::from_fn(|i| from[i] + part * (to[i] - from[i]));
        }
    }
    breakpoints.last().map_or([0.0; 3], values)
}

/// Eq. 6 with L = K = 1, from rest: `strikes` are (sample, gain of b0 and b1), in order; before the first there is silence.
pub fn filter(breakpoints: &[Breakpoint], strikes: &[(usize, f64)], input: &[f64], rate: SampleRate) -> Vec<f64> {
    let (mut last_input, mut last_output) = (0.0, 0.0);
    let step = |(n, &e): (usize, &f64)| {
        let Some(&(start, gain)) = strikes.iter().rev().find(|(start, _)| *start <= n) else { return 0.0 };
        let [b0, b1, a1] = coefficients(breakpoints, (n - start) as f64 / rate.hz());
        last_output = gain * (b0 * e + b1 * last_input) - a1 * last_output;
        last_input = e;
        last_output
    };
    input.iter().enumerate().map(step).collect()
}
