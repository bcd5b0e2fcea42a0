//! Gaussian smoothing of the path (§2.2), over a width that moves with the limit.

use super::TICK_FRAMES;

/// Standard deviations that the taps reach.
const DEVIATIONS: f32 = 3.5;
/// Most taps to either side of the middle one.
const MAX_REACH: usize = TICK_FRAMES - 1;
/// Widest standard deviation in frames.
const MAX_DEVIATION: f32 = MAX_REACH as f32 / 3.0;
/// Least variance that is smoothed, in square frames.
const LEAST_VARIANCE: f32 = 0.005;

/// Standard deviation in frames, rounded to one of 128 steps in an octave as the instrument does.
pub(super) fn rounded(deviation: f64) -> f32 {
    f32::from_bits(((deviation as f32).min(MAX_DEVIATION).to_bits() + (1 << 15)) & !((1 << 16) - 1))
}

/// Number of taps to either side for a variance in square frames.
fn reach_of(variance: f64) -> usize {
    if variance < f64::from(LEAST_VARIANCE) {
        0
    } else {
        ((variance.sqrt() as f32 * DEVIATIONS) as usize + 1).min(MAX_REACH)
    }
}

/// Smoothing filter with its history.
#[derive(Clone, Debug)]
pub(super) struct Smoothing {
    /// Frames of three ticks, the newest last.
    history: Vec<f64>,
    is_off: bool,
}

impl Smoothing {
    /// Filter for deviations of up to `widest` frames.
    pub(super) fn new(widest: f32) -> Self {
        Self { history: vec![0.0; 3 * TICK_FRAMES], is_off: widest * widest < LEAST_VARIANCE }
    }

    /// Delay of the output in frames: none, or a tick.
    pub(super) fn delay(&self) -> usize {
        if self.is_off { 0 } else { TICK_FRAMES }
    }

    /// Takes a tick and gives the tick before, smoothed by a deviation in frames, less a variance
    /// that it has been smoothed by already.
    pub(super) fn render(&mut self, deviation: f32, less: f64, rises: [f64; TICK_FRAMES]) -> [f64; TICK_FRAMES] {
        if self.is_off {
            return rises;
        }
        self.history.drain(..TICK_FRAMES);
        self.history.extend(rises);
        let variance = f64::from(deviation).powi(2) - less;
        let reach = reach_of(variance);
        let tap = |distance: f64| if reach == 0 { 1.0 } else { (-0.5 * distance * distance / variance).exp() };
        let taps: Vec<f64> = (0..=2 * reach).map(|index| tap(index as f64 - reach as f64)).collect();
        let sum: f64 = taps.iter().sum();
        std::array::from_fn(|frame| {
            let window = &self.history[TICK_FRAMES + frame - reach..];
            taps.iter().zip(window).map(|(tap, x)| tap * x).sum::<f64>() / sum
        })
    }
}
