//! Biquad bank of a sounding object (diffmodal eq. 2, 3), rendered sample by sample.

use super::hand::Hand;
use crate::biquad::Biquad;

/// Biquad bank in motion: each biquad with its last two inputs and last two outputs.
pub(crate) struct Biquads<'a> {
    chains: Vec<Vec<(&'a Biquad, [f64; 4])>>,
}

impl<'a> Biquads<'a> {
    pub(crate) fn new(chains: &'a [Vec<Biquad>]) -> Self {
        let at_rest = |chain: &'a Vec<Biquad>| chain.iter().map(|biquad| (biquad, [0.0; 4])).collect();
        Self { chains: chains.iter().map(at_rest).collect() }
    }

    /// Damps each chain after a sample by the part of the hand's decay that its slowest pole lacks.
    pub(crate) fn damp(&mut self, hand: &Hand) {
        for chain in &mut self.chains {
            let slowest = chain.iter().map(|(biquad, _)| biquad.radius()).fold(0.0, f64::max);
            let kept = hand.keeps(slowest);
            chain.iter_mut().flat_map(|(_, state)| state).for_each(|value| *value *= kept);
        }
    }

    /// Response of the bank to one sample of force in newtons.
    pub(crate) fn step(&mut self, force: f64) -> f64 {
        let mut sum = 0.0;
        for chain in &mut self.chains {
            sum += chain.iter_mut().fold(force, |x, (biquad, [x1, x2, y1, y2])| {
                let ([b0, b1, b2], [a1, a2]) = (biquad.numerator, biquad.denominator);
                let y = b0 * x + b1 * *x1 + b2 * *x2 - a1 * *y1 - a2 * *y2;
                (*x2, *x1, *y2, *y1) = (*x1, x, *y1, y);
                y
            });
        }
        sum
    }
}
