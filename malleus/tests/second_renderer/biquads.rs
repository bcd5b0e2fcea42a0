//! Section `[object.biquads]` of docs/kit-format.md.

use std::f64::consts::PI;

use toml::{Table, Value};

use crate::text::{number, numbers};

/// Chain of biquads in series.
pub(crate) struct Chain {
    biquads: Vec<Biquad>,
    /// Decay rate of the slowest pole in nepers per second.
    decay_per_s: f64,
}

struct Biquad {
    b: [f64; 3],
    a: [f64; 2],
    states: [f64; 2],
}

/// Magnitude and angle of a root in the upper half plane.
#[derive(Clone, Copy)]
struct Root {
    size: f64,
    angle: f64,
}

impl Root {
    fn new(value: Option<&Value>) -> Self {
        let place = value.map_or(vec![0.0, 0.0], numbers);
        Self { size: place[0].hypot(place[1]), angle: place[1].abs().atan2(place[0]) }
    }

    fn carried_over(self, rho: f64) -> Self {
        let size = if self.size == 0.0 { 0.0 } else { self.size.powf(rho) };
        Self { size, angle: (rho * self.angle).min(PI) }
    }

    /// E(r e^(iα), θ) of the page, for this root.
    fn distance(self, theta: f64) -> f64 {
        let part = |angle: f64| (1.0 - self.size).powi(2) + 4.0 * self.size * (angle / 2.0).sin().powi(2);
        part(self.angle - theta) * part(self.angle + theta)
    }
}

/// Chains of an object at a sample rate.
pub(crate) fn chains(object: &Table, fs: f64) -> Vec<Chain> {
    let Some(table) = object.get("biquads").and_then(Value::as_table) else { return Vec::new() };
    let rho = number(table, "rate_hz", 48000.0) / fs;
    let chains = table["chains"].as_array().unwrap().iter();
    chains.map(|chain| Chain::new(chain.as_array().unwrap(), rho, fs)).collect()
}

impl Chain {
    fn new(tables: &[Value], rho: f64, fs: f64) -> Self {
        let mut slowest = 0.0_f64;
        let read = |value: &Value| {
            let table = value.as_table().unwrap();
            let (p, q) = (Root::new(table.get("pole")), Root::new(table.get("zero")));
            let (p2, q2) = (p.carried_over(rho), q.carried_over(rho));
            slowest = slowest.max(p2.size);
            let mut gain = number(table, "gain", 0.0);
            let zeros = [q.distance(p.angle).sqrt(), q2.distance(p2.angle).sqrt()];
            if zeros[0] >= 1e-6 && zeros[1] >= 1e-6 {
                gain *= zeros[0] / zeros[1] * (p2.distance(p2.angle) / p.distance(p.angle)).sqrt();
            }
            let second = |root: Root| [-2.0 * root.size * root.angle.cos(), root.size * root.size];
            let b = second(q2);
            Biquad { b: [gain, gain * b[0], gain * b[1]], a: second(p2), states: [0.0; 2] }
        };
        let biquads = tables.iter().map(read).collect();
        Self { biquads, decay_per_s: -fs * slowest.ln() }
    }

    pub(crate) fn play(&mut self, force: f64) -> f64 {
        self.biquads.iter_mut().fold(force, |x, biquad| {
            let Biquad { b, a, states } = biquad;
            let y = b[0] * x + states[0];
            *states = [b[1] * x - a[0] * y + states[1], b[2] * x - a[1] * y];
            y
        })
    }

    /// Damps the states as a hand on the pad does after each sample.
    pub(crate) fn damp(&mut self, hand_per_s: f64, fs: f64) {
        let kappa = (-(hand_per_s - self.decay_per_s).max(0.0) / fs).exp();
        let states = self.biquads.iter_mut().flat_map(|biquad| &mut biquad.states);
        states.for_each(|state| *state *= kappa);
    }
}
