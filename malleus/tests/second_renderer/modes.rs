//! Sections "Modes" and "A hand on the modes" of docs/kit-format.md.

use std::f64::consts::PI;

use toml::{Table, Value};

use crate::text::{number, numbers, tables};

/// Number of modes of a bank that a hand reaches per tick.
const REACH: usize = 16;

/// Modal bank of an object or striker.
pub(crate) struct Bank {
    pub(crate) modes: Vec<Mode>,
    /// Index of the next mode that the hand reaches when it comes or goes.
    next: usize,
    fs: f64,
}

pub(crate) struct Mode {
    pub(crate) theta: f64,
    decay_per_s: f64,
    pub(crate) own_radius: f64,
    radius: f64,
    gain_sine: Vec<f64>,
    gain_cosine: Vec<f64>,
    /// State S of the mode.
    sine: f64,
    /// State C of the mode.
    cosine: f64,
}

impl Bank {
    pub(crate) fn new(table: &Table, fs: f64) -> Self {
        let gains = |mode: &Table, key| mode.get(key).map_or(vec![0.0], |value: &Value| numbers(value));
        let read = |mode: &Table| {
            let decay_per_s = number(mode, "decay_per_s", 0.0);
            let radius = (-decay_per_s / fs).exp();
            Mode {
                theta: 2.0 * PI * number(mode, "frequency_hz", 0.0) / fs,
                decay_per_s,
                own_radius: radius,
                radius,
                gain_sine: gains(mode, "gain_sine"),
                gain_cosine: gains(mode, "gain_cosine"),
                sine: 0.0,
                cosine: 0.0,
            }
        };
        let modes = tables(table, "modes").iter().map(read).filter(|mode| mode.theta < PI).collect::<Vec<_>>();
        Self { next: modes.len(), modes, fs }
    }

    /// Notes that a hand comes or goes; it reaches the first mode first.
    pub(crate) fn hand(&mut self) {
        self.next = 0;
    }

    /// Gives the next modes the hand's decay rate, 0 without a hand.
    pub(crate) fn reach(&mut self, hand_per_s: f64) {
        let end = (self.next + REACH).min(self.modes.len());
        for mode in &mut self.modes[self.next..end] {
            let radius = (-mode.decay_per_s.max(hand_per_s) / self.fs).exp();
            let rho = radius / mode.radius;
            mode.sine = rho * mode.sine + (1.0 - rho) * mode.cosine / mode.theta.tan();
            mode.radius = radius;
        }
        self.next = end;
    }

    /// Computes the next sample from (position, force) pairs.
    pub(crate) fn play(&mut self, forces: &[(f64, f64)]) -> f64 {
        let fs = self.fs;
        self.modes.iter_mut().map(|mode| mode.play(forces, fs)).sum()
    }
}

impl Mode {
    /// Gains gs and gc at a position.
    pub(crate) fn gains(&self, position: f64) -> (f64, f64) {
        (interpolated(&self.gain_sine, position), interpolated(&self.gain_cosine, position))
    }

    fn play(&mut self, forces: &[(f64, f64)], fs: f64) -> f64 {
        let (sin, cos) = self.theta.sin_cos();
        let (s, c) = (self.sine, self.cosine);
        self.sine = self.radius * (s * cos - c * sin);
        self.cosine = self.radius * (c * cos + s * sin);
        let rho = self.radius / self.own_radius;
        let mut half = 0.0;
        for &(position, force) in forces {
            let (gs, gc) = self.gains(position);
            self.sine += (rho * gs + (1.0 - rho) * gc / self.theta.tan()) * force / fs;
            self.cosine += gc * force / fs;
            half += gc / 2.0 * force / fs;
        }
        self.cosine - half
    }
}

/// Value at a position, linear between values at evenly spaced positions from 0 to 1.
fn interpolated(values: &[f64], position: f64) -> f64 {
    let place = position * (values.len() - 1) as f64;
    let k = (place as usize).min(values.len().saturating_sub(2));
    let part = place - k as f64;
    if values.len() == 1 { values[0] } else { values[k] * (1.0 - part) + values[k + 1] * part }
}
