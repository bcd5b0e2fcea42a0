//! A model as it sounds, in `f64` at 48 kHz.

use reference::SampleRate;
use reference::dynamic_filter::Filter;
use reference::waveguide;

use super::{Loop, Model};
use crate::synthetic::SplitMix64;

/// [`super::RATE_HZ`].
pub(crate) const RATE: SampleRate = SampleRate { numerator: 48_000, denominator: 1 };

/// Renders one strike of a model at a force of the reference: `length` samples at 48 kHz, the noise of a seed.
///
/// Eq. 12 and 13 by the reference, parameters interpolated at each sample: noise at its level and what the loops bring back go through the filter;
/// modes stand beside it.
pub fn render(model: &Model, length: usize, seed: u64) -> Vec<f64> {
    let mut random = SplitMix64(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let path = model.path.breakpoints();
    let mut filter = Filter::new(model.path.order(), &path, RATE);
    let noise = |n: usize| match filter.noise(n) {
        0.0 => 0.0,
        level => level * (2.0 * random.uniform() - 1.0),
    };
    let input: Vec<f64> = (0..length).map(noise).collect();
    let loops: Vec<waveguide::Loop> = model.loops.iter().map(Loop::exact).collect();
    let mut sound = waveguide::filter(&mut filter, &loops, &[0], &input, RATE);
    model.modes.iter().for_each(|mode| mode.add_to(&mut sound, super::RATE_HZ));
    sound
}

impl Loop {
    /// As the reference takes it.
    pub(crate) fn exact(&self) -> waveguide::Loop {
        let Self { frequency_hz, bandwidth_hz, gain, delay_s } = *self;
        waveguide::Loop { frequency_hz, bandwidth_hz, gain, delay_s }
    }
}
