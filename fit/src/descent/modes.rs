//! Modal response: decaying sines (eq. 8 to 18).

use std::f64::consts::TAU;

use super::scale::ExpSigmoid;

/// Scaling of dampings to 1/s (eq. 11). The paper prints the upper bound, the released notebook
/// the bias.
const DAMPING: ExpSigmoid = ExpSigmoid { upper: 10_000.0, lower: 1e-7, bias: -1.5 };
/// Lowest centre of a mode in Hz.
const LOWEST_HZ: f64 = 20.0;
/// Highest centre of a mode in Hz, as in the released notebook.
const HIGHEST_HZ: f64 = 18_000.0;
/// Largest share of the sample rate that a centre may be at.
const HIGHEST_SHARE: f64 = 0.4;
/// Natural logarithm of the decay at which a mode ends.
const ENDED: f64 = 36.0;
/// Number of modes that are computed side by side.
const LANES: usize = 8;

/// Modes of an object over a recording of `length` samples.
#[derive(Clone, Debug)]
pub(super) struct ModalResponse {
    length: usize,
    rate_hz: f64,
    /// Centre of the range of each mode in Hz (eq. 16).
    centres_hz: Vec<f64>,
}

/// Normalised numbers of the modes.
#[derive(Clone, Copy, Debug)]
pub(super) struct ModeInputs<'a> {
    pub(super) gains: &'a [f64],
    pub(super) dampings: &'a [f64],
    pub(super) frequencies: &'a [f64],
}

/// A mode with the derivatives of damping and frequency by their normalised numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScaledMode {
    /// Gain as a share of all gains.
    pub(super) gain: f64,
    /// Damping in 1/s, and its derivative.
    pub(super) decay_per_s: (f64, f64),
    /// Frequency in Hz, and its derivative.
    pub(super) frequency_hz: (f64, f64),
}

/// Gradient by the normalised numbers of the modes.
#[derive(Clone, Debug)]
pub(super) struct ModeGradient {
    pub(super) gains: Vec<f64>,
    pub(super) dampings: Vec<f64>,
    pub(super) frequencies: Vec<f64>,
}

/// Eq. 13.
fn mel_to_hz(mel: f64) -> f64 {
    700.0 * (10f64.powf(mel / 2595.0) - 1.0)
}

/// Eq. 14.
fn hz_to_mel(hz: f64) -> f64 {
    2595.0 * (1.0 + hz / 700.0).log10()
}

/// Eq. 15.
fn hz_to_erb(hz: f64) -> f64 {
    0.108 * hz + 24.7
}

impl ModalResponse {
    pub(super) fn new(modes: usize, length: usize, rate_hz: f64) -> Self {
        let [low, high] = [LOWEST_HZ, HIGHEST_HZ.min(HIGHEST_SHARE * rate_hz)].map(hz_to_mel);
        let share = |index: usize| index as f64 / modes.saturating_sub(1).max(1) as f64;
        let centres_hz = (0..modes).map(|index| mel_to_hz(low + share(index) * (high - low))).collect();
        Self { length, rate_hz, centres_hz }
    }

    /// Scaled modes (eq. 9, 11 and 17). Eq. 17 takes the centres of eq. 16 in Hz.
    pub(super) fn scaled(&self, inputs: &ModeInputs<'_>) -> Vec<ScaledMode> {
        let most = inputs.gains.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = inputs.gains.iter().map(|x| (x - most).exp()).sum();
        let of_mode = |(index, centre): (usize, &f64)| {
            let reach = hz_to_erb(*centre);
            let turned = inputs.frequencies[index].tanh();
            ScaledMode {
                gain: (inputs.gains[index] - most).exp() / sum,
                decay_per_s: DAMPING.at(inputs.dampings[index]),
                frequency_hz: (centre + turned * reach, reach * (1.0 - turned * turned)),
            }
        };
        self.centres_hz.iter().enumerate().map(of_mode).collect()
    }

    /// Runs all modes from sample 0 on, in groups of [`LANES`].
    ///
    /// `visit` gets the group's first mode, the sample, and for each lane the decaying sine and
    /// cosine. Lanes beyond the last mode are silent.
    fn run(&self, modes: &[ScaledMode], mut visit: impl FnMut(usize, usize, &[f64; LANES], &[f64; LANES])) {
        for (group, modes) in modes.chunks(LANES).enumerate() {
            let (mut sine, mut cosine) = ([0.0; LANES], [0.0; LANES]);
            let (mut turn_re, mut turn_im) = ([0.0; LANES], [0.0; LANES]);
            let mut end = 0.0f64;
            for (lane, mode) in modes.iter().enumerate() {
                let decay = mode.decay_per_s.0 / self.rate_hz;
                let (im, re) = (TAU * mode.frequency_hz.0 / self.rate_hz).sin_cos();
                (turn_re[lane], turn_im[lane]) = ((-decay).exp() * re, (-decay).exp() * im);
                cosine[lane] = 1.0;
                end = end.max(ENDED / decay);
            }
            for n in 0..(end.ceil() as usize).min(self.length) {
                visit(group * LANES, n, &sine, &cosine);
                for lane in 0..LANES {
                    let (re, im) = (cosine[lane], sine[lane]);
                    cosine[lane] = re * turn_re[lane] - im * turn_im[lane];
                    sine[lane] = re * turn_im[lane] + im * turn_re[lane];
                }
            }
        }
    }

    /// Samples of the response to an impulse (eq. 8).
    pub(super) fn response(&self, modes: &[ScaledMode]) -> Vec<f64> {
        let mut response = vec![0.0; self.length];
        let gains = by_lanes(modes);
        self.run(modes, |first, n, sine, _| {
            let gains = &gains[first / LANES];
            response[n] += (0..LANES).map(|lane| gains[lane] * sine[lane]).sum::<f64>();
        });
        response
    }

    /// Gradient by the normalised numbers, from that by the samples of the response.
    pub(super) fn gradient(&self, modes: &[ScaledMode], by_response: &[f64]) -> ModeGradient {
        let groups = modes.len().div_ceil(LANES);
        // Sums of the gradient times the sine, and times n times sine and cosine.
        let (mut plain, mut sines, mut cosines) =
            (vec![[0.0; LANES]; groups], vec![[0.0; LANES]; groups], vec![[0.0; LANES]; groups]);
        self.run(modes, |first, n, sine, cosine| {
            let (slope, group) = (by_response[n], first / LANES);
            let timed = slope * n as f64;
            let (plain, sines, cosines) = (&mut plain[group], &mut sines[group], &mut cosines[group]);
            for lane in 0..LANES {
                plain[lane] += slope * sine[lane];
                sines[lane] += timed * sine[lane];
                cosines[lane] += timed * cosine[lane];
            }
        });
        let mean: f64 = modes.iter().zip(plain.as_flattened()).map(|(mode, by_gain)| mode.gain * by_gain).sum();
        let mut gradient = ModeGradient { gains: Vec::new(), dampings: Vec::new(), frequencies: Vec::new() };
        let sums = plain.as_flattened().iter().zip(sines.as_flattened().iter().zip(cosines.as_flattened()));
        for (mode, (plain, (sines, cosines))) in modes.iter().zip(sums) {
            // The derivative of a softmax.
            gradient.gains.push(mode.gain * (plain - mean));
            gradient.dampings.push(-mode.gain * sines / self.rate_hz * mode.decay_per_s.1);
            gradient.frequencies.push(mode.gain * TAU * cosines / self.rate_hz * mode.frequency_hz.1);
        }
        gradient
    }
}

/// Gains in groups of [`LANES`], with zeros behind the last.
fn by_lanes(modes: &[ScaledMode]) -> Vec<[f64; LANES]> {
    let group = |modes: &[ScaledMode]| {
        let mut gains = [0.0; LANES];
        gains.iter_mut().zip(modes).for_each(|(slot, mode)| *slot = mode.gain);
        gains
    };
    modes.chunks(LANES).map(group).collect()
}
