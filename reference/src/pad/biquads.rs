//! The object's biquad bank sounding (diffmodal eq. 2, 3), sample by sample.

use crate::biquad::Biquad;
use crate::rate::SampleRate;

/// The state of a bank: of each biquad its last two inputs and outputs; and a hand that fades what it sounds.
pub(crate) struct Biquads<'a> {
    chains: Vec<Vec<(&'a Biquad, [f64; 4])>>,
    /// What the hand has left of the amplitude, and leaves of it after a sample.
    left: f64,
    per_sample: f64,
}

impl<'a> Biquads<'a> {
    pub(crate) fn new(chains: &'a [Vec<Biquad>]) -> Self {
        let at_rest = |chain: &'a Vec<Biquad>| chain.iter().map(|biquad| (biquad, [0.0; 4])).collect();
        Self { chains: chains.iter().map(at_rest).collect(), left: 1.0, per_sample: 1.0 }
    }

    /// A hand that lets the sound fall by 60 dB in `t60_s` from now on, and from each strike on.
    pub(crate) fn choke(&mut self, t60_s: f64, rate: SampleRate) {
        self.per_sample = (-1000f64.ln() / (t60_s * rate.hz())).exp();
    }

    pub(crate) fn release(&mut self) {
        self.lift();
        self.per_sample = 1.0;
    }

    /// What rings is what the hand has left of it, and the hand begins anew.
    pub(crate) fn lift(&mut self) {
        for state in self.chains.iter_mut().flatten().flat_map(|(_, state)| state) {
            *state *= self.left;
        }
        self.left = 1.0;
    }

    /// Adds the answer to `force`, in newtons, to `sound`.
    pub(crate) fn add_sound(&mut self, force: &[f64], sound: &mut [f64]) {
        for (&f, sound) in force.iter().zip(sound) {
            let mut sum = 0.0;
            for chain in &mut self.chains {
                sum += chain.iter_mut().fold(f, |x, (biquad, [x1, x2, y1, y2])| {
                    let ([b0, b1, b2], [a1, a2]) = (biquad.numerator, biquad.denominator);
                    let y = b0 * x + b1 * *x1 + b2 * *x2 - a1 * *y1 - a2 * *y2;
                    (*x2, *x1, *y2, *y1) = (*x1, x, *y1, y);
                    y
                });
            }
            *sound += self.left * sum;
            self.left *= self.per_sample;
        }
    }
}
