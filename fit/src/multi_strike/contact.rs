//! Response of a mode to one contact whose force is a half-sine, in continuous time.
//!
//! The force is `sin(pt)`, `p = π/τ`, from t = 0 to the contact time τ (diffimpact §3.2). A mode of
//! decay d and frequency ω answers an impulse with `e^{st}`, `s = -d + jω`. During the contact its
//! amplitude is
//!
//! ```text
//! B(t) = ∫₀ᵗ sin(pu) e^{s(t-u)} du = (p e^{st} - s sin pt - p cos pt) / (s² + p²)
//! ```
//!
//! Afterwards it rings as `Q(τ) e^{s(t - τ/2)}`, `Q(τ) = 2p cosh(sτ/2) / (s² + p²)`. Q is referred
//! to the middle of the contact: without damping it is real, whatever the contact time is, so that
//! the middle follows from the phases of all modes. Times are in samples. Each sample of the sound
//! is the continuous response at its time.

use std::f64::consts::PI;

use nalgebra::Complex;

use crate::modes::{Pole, add_ringing};

type C64 = Complex<f64>;

/// A contact: the half-sine force of one strike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Contact {
    /// Middle of the contact in samples of the recording.
    pub(crate) middle: f64,
    /// Contact time τ in samples.
    pub(crate) time: f64,
    /// Peak of the force.
    pub(crate) peak: f64,
}

impl Contact {
    /// First sample at or after the contact's beginning.
    pub(crate) fn first_sample(&self) -> f64 {
        (self.middle - 0.5 * self.time).ceil()
    }

    /// First sample after the contact's end.
    pub(crate) fn end_sample(&self) -> f64 {
        (self.middle + 0.5 * self.time).floor() + 1.0
    }

    /// Force at a sample, as a share of the peak, with its derivatives by middle and contact time.
    pub(crate) fn force(&self, sample: f64) -> [f64; 3] {
        let since = sample - self.middle + 0.5 * self.time;
        if !(0.0..=self.time).contains(&since) {
            return [0.0; 3];
        }
        let p = PI / self.time;
        let (sine, cosine) = (p * since).sin_cos();
        [sine, -p * cosine, cosine * (0.5 * p - p * since / self.time)]
    }

    /// Adds the motion of a mode of a gain to samples from `first` on, the peak being in the gain.
    ///
    /// Its exponentials turn from one sample to the next: three of them, not three a sample.
    pub(crate) fn add_motion(&self, pole: C64, gain: C64, first: usize, samples: &mut [f64]) {
        let index_of = |sample: f64| (sample.max(first as f64) as usize - first).min(samples.len());
        let (begun, over) = (index_of(self.first_sample()), index_of(self.end_sample()));
        let p = PI / self.time;
        let since = |index: usize| (first + index) as f64 - self.middle + 0.5 * self.time;
        let (during, behind) = samples.split_at_mut(over);
        let mut ringing = (pole * since(begun)).exp();
        let mut force = C64::new(0.0, p * since(begun)).exp();
        let (turn, force_turn) = (pole.exp(), C64::new(0.0, p).exp());
        let factor = gain / (pole * pole + p * p);
        for x in &mut during[begun..] {
            *x += (factor * (ringing * p - pole * force.im - p * force.re)).re;
            ringing *= turn;
            force *= force_turn;
        }
        if !behind.is_empty() {
            let start = strength(pole, self.time).value * (pole * (since(over) - 0.5 * self.time)).exp();
            add_ringing(Pole { decay: -pole.re, angular: pole.im }, gain * start, behind);
        }
    }

    /// Motion of a mode at a sample under a force with a peak of 1, with its derivatives.
    pub(crate) fn response(&self, pole: C64, sample: f64) -> Response {
        let from_middle = sample - self.middle;
        let since = from_middle + 0.5 * self.time;
        if since < 0.0 {
            return Response::default();
        }
        if since <= self.time {
            return during(pole, self.time, since);
        }
        let strength = strength(pole, self.time);
        let ringing = (pole * from_middle).exp();
        Response {
            value: strength.value * ringing,
            by_pole: (strength.by_pole + strength.value * from_middle) * ringing,
            by_middle: -pole * strength.value * ringing,
            by_time: strength.by_time * ringing,
        }
    }
}

/// Motion of a mode, and its derivatives by pole, middle and contact time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Response {
    pub(crate) value: C64,
    pub(crate) by_pole: C64,
    pub(crate) by_middle: C64,
    pub(crate) by_time: C64,
}

/// Amplitude Q with which a mode rings after a contact, referred to the middle of the contact.
///
/// Its derivative by the middle is 0.
pub(crate) fn strength(pole: C64, time: f64) -> Response {
    let p = PI / time;
    let half = pole * (0.5 * time);
    let grown = half.exp();
    let shrunk = grown.inv();
    let (cosh, sinh) = ((grown + shrunk) * 0.5, (grown - shrunk) * 0.5);
    let below = pole * pole + p * p;
    let value = cosh * (2.0 * p) / below;
    let by_pole = sinh * PI / below - value * pole * 2.0 / below;
    let by_time = -value / time + pole * sinh * p / below + value * (2.0 * p * p / time) / below;
    Response { value, by_pole, by_middle: C64::new(0.0, 0.0), by_time }
}

fn during(pole: C64, time: f64, since: f64) -> Response {
    let p = PI / time;
    let (sine, cosine) = (p * since).sin_cos();
    let ringing = (pole * since).exp();
    let below = pole * pole + p * p;
    let value = (ringing * p - pole * sine - p * cosine) / below;
    let by_since = pole * value + sine;
    let by_pole = (ringing * (p * since) - sine) / below - pole * value * 2.0 / below;
    let by_p = (ringing - pole * (since * cosine) - cosine + p * since * sine) / below - value * (2.0 * p) / below;
    Response { value, by_pole, by_middle: -by_since, by_time: by_since * 0.5 - by_p * (p / time) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    fn random_case(random: &mut SplitMix64) -> (Contact, C64, f64) {
        let time = 15.0 + 100.0 * random.uniform();
        let contact = Contact { middle: 200.0 + random.uniform(), time, peak: 1.0 };
        let pole = C64::new(-10f64.powf(-4.0 + 2.0 * random.uniform()), 0.02 + random.uniform());
        (contact, pole, 200.0 + time * (2.0 * random.uniform() - 1.0))
    }

    #[test]
    fn response_is_the_integral_of_the_force() {
        let mut random = SplitMix64(3);
        for _ in 0..50 {
            let (contact, pole, sample) = random_case(&mut random);
            let steps = 4000;
            let end = sample - contact.middle + 0.5 * contact.time;
            let last = end.min(contact.time);
            // Simpson's rule.
            let mut sum = C64::new(0.0, 0.0);
            for step in 0..=steps {
                let u = last.max(0.0) * f64::from(step) / f64::from(steps);
                let weight = if step == 0 || step == steps { 1.0 } else { 2.0 + 2.0 * f64::from(step % 2) };
                sum += (pole * (end - u)).exp() * ((PI * u / contact.time).sin() * weight);
            }
            sum *= last.max(0.0) / f64::from(steps) / 3.0;
            let value = contact.response(pole, sample).value;
            assert!((value - sum).norm() < 1e-8 * (1.0 + sum.norm()), "{value} {sum}");
        }
    }

    #[test]
    fn motion_written_out_is_the_response_at_each_sample() {
        let mut random = SplitMix64(9);
        for first in [0, 150, 190, 230, 300] {
            let (contact, pole, _) = random_case(&mut random);
            let gain = C64::new(random.normal(), random.normal());
            let mut samples = vec![0.5; 250];
            contact.add_motion(pole, gain, first, &mut samples);
            for (n, x) in (first..).zip(&samples) {
                let expected = 0.5 + (gain * contact.response(pole, n as f64).value).re;
                assert!((x - expected).abs() < 1e-11 * (1.0 + expected.abs()), "{first} {n}: {x} {expected}");
            }
        }
    }

    #[test]
    fn derivatives_agree_with_central_differences() {
        let mut random = SplitMix64(5);
        let step = 1e-4;
        for _ in 0..300 {
            let (contact, pole, sample) = random_case(&mut random);
            let edges = [0.0, contact.time].map(|edge| (sample - contact.middle + 0.5 * contact.time - edge).abs());
            if edges.iter().any(|edge| *edge < 0.01) {
                continue;
            }
            let at = |middle: f64, time: f64, pole: C64| Contact { middle, time, ..contact }.response(pole, sample);
            let slope = |plus: Response, minus: Response, step: f64| (plus.value - minus.value) / (2.0 * step);
            let given = contact.response(pole, sample);
            let turn = step * 1e-2;
            let pairs = [
                (
                    given.by_middle,
                    slope(
                        at(contact.middle + step, contact.time, pole),
                        at(contact.middle - step, contact.time, pole),
                        step,
                    ),
                ),
                (
                    given.by_time,
                    slope(
                        at(contact.middle, contact.time + step, pole),
                        at(contact.middle, contact.time - step, pole),
                        step,
                    ),
                ),
                (
                    given.by_pole,
                    slope(
                        at(contact.middle, contact.time, pole + turn),
                        at(contact.middle, contact.time, pole - turn),
                        turn,
                    ),
                ),
            ];
            for (given, slope) in pairs {
                let scale = 1.0 + contact.time * given.norm();
                assert!((given - slope).norm() < 1e-6 * scale, "{contact:?} {pole} {sample}: {given} {slope}");
            }
        }
    }
}
