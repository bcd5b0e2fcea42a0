//! Section "The contact force" of docs/kit-format.md.

use std::f64::consts::PI;

use toml::Table;

use crate::text::{number, word};

/// Contact that begins with a strike.
pub(crate) struct Contact {
    /// Time of the strike in samples, not rounded.
    start: f64,
    peak: f64,
    /// Contact time in samples.
    time: f64,
    shape: Shape,
    pub(crate) position: f64,
    /// Index of the striker among the pad's strikers.
    pub(crate) striker: usize,
}

enum Shape {
    Hertz { n: f64, a: f64 },
    Gaussian,
}

/// Peak force m of a strike in newtons, before a short Gaussian pulse is made longer.
pub(crate) fn peak_force(striker: &Table, velocity: f64) -> f64 {
    number(striker, "peak_force", 0.0) * velocity.powf(number(striker, "peak_exponent", f64::from(1.2_f32)))
}

impl Contact {
    pub(crate) fn new(table: &Table, striker: usize, velocity: f64, position: f64, start: f64, fs: f64) -> Self {
        let mut peak = peak_force(table, velocity);
        let exponent = number(table, "contact_exponent", f64::from(-0.2_f32));
        let time = number(table, "contact_time_s", 0.0) * velocity.powf(exponent);
        let mut time = time.clamp(10e-6, 0.25) * fs;
        let shape = if word(table, "pulse", "hertz") == "hertz" {
            let r = number(table, "restitution", f64::from(0.45_f32)).powf(4.6);
            let a = (1.0 - r) / (1.0 + r);
            let c = 2.0 * a / (1.0 + (1.0 + 8.0 * a * a).sqrt());
            Shape::Hertz { n: 1.0 / ((1.0 - c * c).sqrt() * (1.0 + a * c)), a }
        } else {
            peak *= (time / 1.75).min(1.0);
            time = time.max(1.75);
            Shape::Gaussian
        };
        Self { start, peak, time, shape, position, striker }
    }

    /// Force F\[n\] of this contact at sample n.
    pub(crate) fn force(&self, n: usize) -> f64 {
        let n = n as f64;
        match self.shape {
            Shape::Hertz { n: norm, a } => {
                let end = ((n - self.start) / self.time).min(1.0);
                let begin = ((n - 1.0 - self.start) / self.time).max(0.0);
                let (w, x) = (end - begin, (end + begin) / 2.0);
                if w <= 0.0 {
                    return 0.0;
                }
                let wave = sinc(w / 2.0) * (PI * x).sin() + a / 2.0 * sinc(w) * (2.0 * PI * x).sin();
                self.peak * norm * (w * self.time) * wave
            }
            Shape::Gaussian => {
                let c = self.time * (1e5_f64.ln() / 6.0).sqrt();
                let t = n - self.start;
                let inside = (0.0..=2.0 * c).contains(&t);
                if inside { self.peak * (-6.0 * ((t - c) / self.time).powi(2)).exp() } else { 0.0 }
            }
        }
    }

    /// True if the force is 0 from sample n on.
    pub(crate) fn is_over(&self, n: usize) -> bool {
        n as f64 > self.start + 3.0 * self.time + 1.0
    }
}

fn sinc(y: f64) -> f64 {
    if y == 0.0 { 1.0 } else { (PI * y).sin() / (PI * y) }
}
