//! Response of the room between the thing and the microphone, from what its dry sound leaves.
//!
//! The recording is `y = x + h * x + noise`: x is the sound of the model, h the room's response
//! without the direct sound (diffimpact eq. 1). The response is taken for noise that fades,
//! `h[n] ~ N(0, v[n])`, `v[n] = v0 e^{-2rn}`. The most likely one minimises
//!
//! ```text
//! |w * (y - x - h * x)|² / σ² + Σ h[n]² / v[n],
//! ```
//!
//! w the filter that makes the noise white and σ² its power: with R the Toeplitz matrix of the
//! correlation of w * x and c its correlation with w * (y - x), `(R + σ²/v) h = c`. Conjugate
//! gradients solve it in the unit `h[n] / √v[n]`; products with R are transforms of the response's
//! length.

use fourier::Complex;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::arrow::Arrow;
use super::derivatives;
use super::descend::Fitted;
use super::model::Model;
use super::whitening::Whitening;
use crate::convolution::{Convolution, Correlation};

/// Longest response in shares of the assumed T60: there it has faded by 84 dB.
const LENGTH_T60: f64 = 1.4;
/// Maximum number of steps.
const STEPS: usize = 80;
/// Size of the gradient, as a share of the first one, at which the steps end.
const ENDING: f64 = 1e-4;
/// Share of the recording's frames that are quieter than the noise that is assumed.
const NOISE_SHARE: f64 = 0.1;
/// Length of a frame of the noise in samples.
const NOISE_FRAME: usize = 1024;
/// T60 in seconds that is assumed of a room of which nothing is known.
pub(crate) const UNKNOWN_T60_S: f64 = 0.5;
/// T60 in seconds that is assumed where the T60 is to be measured: the response may fade as it
/// likes within [`LONGEST_S`].
pub(crate) const FLAT_T60_S: f64 = 5.0;
/// Energy that is assumed of a response; that of the direct sound is 1.
const LEVEL: f64 = 0.1;
/// Longest response in seconds.
const LONGEST_S: f64 = 1.0;

/// Standard deviations `√v[n]` that are assumed of a response at a rate in Hz.
fn spreads(t60_s: f64, rate_hz: f64) -> Vec<f64> {
    let fall = 1000f64.ln() / (t60_s * rate_hz);
    let count = ((LENGTH_T60 * t60_s).min(LONGEST_S) * rate_hz) as usize;
    let mut spreads: Vec<f64> = (0..count.max(2)).map(|n| (-fall * n as f64).exp()).collect();
    // Sample 0 is the direct sound.
    spreads[0] = 0.0;
    let energy: f64 = spreads.iter().map(|x| x * x).sum();
    let scale = (LEVEL / energy).sqrt();
    spreads.iter_mut().for_each(|x| *x *= scale);
    spreads
}

/// Equations of the response in the unit of its standard deviations.
struct Equations {
    spreads: Vec<f64>,
    /// Correlation with the filtered dry sound.
    dry: Correlation,
    /// Transforms of twice the response's length.
    short: Convolution,
    /// Spectrum of the dry sound's correlation with itself.
    own: Vec<Complex<f64>>,
    right: Vec<f64>,
    /// Power of the noise.
    noise: f64,
}

impl Equations {
    fn new([dry, left]: [&[f64]; 2], whitening: &Whitening, t60_s: f64, rate_hz: f64) -> Self {
        let [dry, left] = [dry, left].map(|sound| whitening.filtered(sound, 0..sound.len()));
        let spreads = spreads(t60_s, rate_hz);
        let count = spreads.len();
        let (correlation, short) = (Correlation::new(&dry, count), Convolution::new(2 * count));
        let mut both_ways = vec![0.0; short.size()];
        for (lag, value) in correlation.with(&dry).into_iter().enumerate() {
            both_ways[lag] = value;
            both_ways[(short.size() - lag) % short.size()] = value;
        }
        let own = short.spectrum(&both_ways);
        let mut equations =
            Self { spreads, dry: correlation, short, own, right: Vec::new(), noise: noise_power(&left) };
        equations.right = equations.correlated(&left);
        equations
    }

    /// Sums of a filtered sound with the dry one, for each sample of the response.
    fn correlated(&self, sound: &[f64]) -> Vec<f64> {
        self.scaled(&self.dry.with(sound))
    }

    fn scaled(&self, values: &[f64]) -> Vec<f64> {
        values.iter().zip(&self.spreads).map(|(value, spread)| value * spread).collect()
    }

    /// Product with the matrix of the equations.
    fn product(&self, g: &[f64]) -> Vec<f64> {
        let scaled = self.short.spectrum(&self.scaled(g));
        let sums = self.short.convolved(&scaled, &self.own, self.spreads.len());
        g.iter().zip(self.scaled(&sums)).map(|(g, sum)| self.noise * g + sum).collect()
    }
}

/// Most likely response of the room to a dry sound, if `left` is the rest of the recording and a
/// T60 in seconds is assumed.
pub(super) fn response(sounds: [&[f64]; 2], whitening: &Whitening, t60_s: f64, rate_hz: f64) -> Vec<f64> {
    let equations = Equations::new(sounds, whitening, t60_s, rate_hz);
    equations.scaled(&solved(|g| equations.product(g), equations.right.clone()))
}

/// Equations of the response together with a step of what all strikes share, poles and gains.
///
/// An error of a mode's decay leaves a sound that fades as the mode does, and the response alone
/// would take it up. With J the derivatives of the model's sound, the equations are
///
/// ```text
/// [R + σ²/v, XᵀJ; JᵀX, JᵀJ] [h; step] = [Xᵀ; Jᵀ] (y - x),
/// ```
///
/// of which the step is eliminated. Strikes are held.
pub(super) struct WithModes {
    equations: Equations,
    /// Equations of the model's parameters.
    of_model: Arrow,
    /// `XᵀJ`, in the unit of the response's standard deviations.
    border: DMatrix<f64>,
}

impl WithModes {
    /// Equations at a model, for a recording and an assumed T60 in seconds.
    pub(super) fn new(model: &Model, samples: &[f64], whitening: &Whitening, t60_s: f64, rate_hz: f64) -> Self {
        let fitted = Fitted::new(model.clone(), samples, whitening);
        let dry: Vec<f64> = samples.iter().zip(&fitted.residual).map(|(x, left)| x - left).collect();
        let equations = Equations::new([&dry, &fitted.residual], whitening, t60_s, rate_hz);
        let mut border = DMatrix::zeros(equations.spreads.len(), model.shared_size());
        let of_mode = |mode: usize| {
            let sums = |sound: Vec<f64>| equations.correlated(&whitening.filtered(&sound, 0..sound.len()));
            derivatives::of_mode(model, mode, samples.len()).map(sums)
        };
        let sums: Vec<[Vec<f64>; 4]> = (0..model.poles.len()).into_par_iter().map(of_mode).collect();
        for (mode, sums) in sums.iter().enumerate() {
            for (column, sums) in model.columns_of(mode).zip(sums) {
                border.column_mut(column).copy_from_slice(sums);
            }
        }
        Self { of_model: fitted.equations(whitening), equations, border }
    }

    /// Response and step, with each diagonal element of `JᵀJ` grown by a share (Levenberg's
    /// damping).
    ///
    /// `None` if two modes cannot be told apart.
    pub(super) fn solved(&self, damping: f64) -> Option<(Vec<f64>, DVector<f64>)> {
        let (inverse, along) = self.of_model.held_shared(damping.max(UNTOLD))?;
        let through = &self.border * &inverse;
        let less = |values: Vec<f64>, shared: &DVector<f64>| -> Vec<f64> {
            values.iter().zip(&(&through * shared)).map(|(value, taken)| value - taken).collect()
        };
        let of_border = |g: &[f64]| self.border.tr_mul(&DVector::from_column_slice(g));
        let product = |g: &[f64]| less(self.equations.product(g), &of_border(g));
        let found = solved(product, less(self.equations.right.clone(), &along));
        let step = &inverse * (&along - of_border(&found));
        Some((self.equations.scaled(&found), step))
    }
}

/// Damping under which equations of modes are definite in spite of rounding.
const UNTOLD: f64 = 1e-9;

/// Sound of a room with a response to a dry sound.
pub(crate) fn reflected(dry: &[f64], response: &[f64]) -> Vec<f64> {
    let both = Convolution::new(dry.len() + response.len());
    both.convolved(&both.spectrum(dry), &both.spectrum(response), dry.len())
}

/// Power of the noise: that of the quieter frames.
fn noise_power(left: &[f64]) -> f64 {
    let power = |frame: &[f64]| frame.iter().map(|x| x * x).sum::<f64>() / frame.len() as f64;
    let mut powers: Vec<f64> = left.chunks(NOISE_FRAME).map(power).collect();
    powers.sort_by(f64::total_cmp);
    powers.get((NOISE_SHARE * powers.len() as f64) as usize).map_or(LEAST_NOISE, |power| power.max(LEAST_NOISE))
}

/// Least power of the noise: that of 24 bits.
const LEAST_NOISE: f64 = 1e-15;

/// Solution of equations with a positive definite matrix, given as products, by conjugate
/// gradients.
fn solved(product: impl Fn(&[f64]) -> Vec<f64>, right: Vec<f64>) -> Vec<f64> {
    let square = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>();
    let mut found = vec![0.0; right.len()];
    let (mut left, mut along) = (right.clone(), right);
    let mut size = square(&left);
    let least = ENDING * ENDING * size;
    for _ in 0..STEPS {
        if size <= least {
            break;
        }
        let turned = product(&along);
        let far = size / along.iter().zip(&turned).map(|(a, b)| a * b).sum::<f64>();
        found.iter_mut().zip(&along).for_each(|(x, a)| *x += far * a);
        left.iter_mut().zip(&turned).for_each(|(x, b)| *x -= far * b);
        let next = square(&left);
        along.iter_mut().zip(&left).for_each(|(a, x)| *a = x + next / size * *a);
        size = next;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::synthetic::plain;
    use crate::multi_strike::truth::model_of;
    use crate::random::SplitMix64;

    #[test]
    fn response_of_a_room_is_told_by_noise_through_it() {
        let mut random = SplitMix64(7);
        let rate_hz = 8_000.0;
        let t60_s = 0.2;
        let truth: Vec<f64> = spreads(t60_s, rate_hz).iter().map(|spread| spread * random.normal()).collect();
        // Silence behind the sound tells the noise.
        let mut dry: Vec<f64> = (0..40_000).map(|_| random.normal()).collect();
        dry.resize(60_000, 0.0);
        let left: Vec<f64> = reflected(&dry, &truth).iter().map(|x| x + 1e-3 * random.normal()).collect();
        let found = response([&dry, &left], &Whitening::none(), t60_s, rate_hz);
        let error: f64 = found.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum();
        let energy: f64 = truth.iter().map(|x| x * x).sum();
        assert!(error < 1e-3 * energy, "{:.1} dB", 10.0 * (error / energy).log10());
    }

    #[test]
    fn decays_are_told_from_a_room_by_steps_of_modes_and_response_together() {
        let mut recording = plain(8, 6.0, 10, -60.0);
        let (rate_hz, t60_s) = (recording.rate_hz, 0.4);
        let mut random = SplitMix64(3);
        let truth = model_of(&recording);
        let response: Vec<f64> = spreads(t60_s, rate_hz).iter().map(|spread| spread * random.normal()).collect();
        let wet = reflected(&recording.samples, &response);
        recording.samples.iter_mut().zip(&wet).for_each(|(x, wet)| *x += wet);
        let mut model = truth.clone();
        model.poles.iter_mut().for_each(|pole| pole.decay *= 1.1);
        for _ in 0..2 {
            let equations = WithModes::new(&model, &recording.samples, &Whitening::none(), t60_s, rate_hz);
            let (_, step) = equations.solved(0.0).expect("modes differ");
            model.step_shared(&step);
        }
        let mut errors: Vec<f64> =
            model.poles.iter().zip(&truth.poles).map(|(a, b)| (a.decay / b.decay - 1.0).abs()).collect();
        errors.sort_by(f64::total_cmp);
        // Quiet modes are hardly told in so short a sound.
        assert!(errors[errors.len() / 2] < 0.05, "{errors:?}");
    }
}
