//! The descent: Adam on the numbers of modes and noise bands.

use fourier::Complex;

use super::cancelling::part_cancelling;
use super::objective::{BandSlope, Objective};
use crate::band::Band;
use crate::distance::Background;
use crate::modes::{Gains, Pole};

/// First steps of a mode: two of its gain, relative to it, of its frequency, in units of
/// [`unit`], and of ln decay.
const MODE_STEPS: [f64; 4] = [0.06, 0.06, 0.04, 0.04];
/// First steps of a band: of the logarithms of its power and its decay.
const BAND_STEPS: [f64; 2] = [0.12, 0.06];
/// First step of the gain of the force, relative to the sum of the modes' gains.
const FORCE_STEP: f64 = 0.01;
/// Largest change of a frequency in units of [`unit`], and of ln decay.
const REACH: [f64; 2] = [1.0, 1.2];
/// Angular frequency in rad/s that is added to a decay to give the unit of a frequency's change.
const LEAST_UNIT: f64 = 1.0;
/// Lowest frequency of a mode in Hz.
const LOWEST_HZ: f64 = 20.0;
/// Relative distance of a mode from one of the loudest partials within which it stays its mode.
pub(crate) const HELD: f64 = 0.003;
/// Slowest and fastest decay of a band in dB/s.
const DECAYS_DB_PER_S: [f64; 2] = [1.0, 4000.0];
/// Power of a band relative to the strike's at which the descent begins at least: 80 dB down.
const LEAST_POWER: f64 = 1e-8;

/// Modes, the gain of the force, and noise, as they sound.
#[derive(Clone, Debug)]
pub(crate) struct Sounding {
    pub(crate) poles: Vec<Pole>,
    pub(crate) gains: Gains,
    pub(crate) bands: Vec<Band>,
}

/// A strike to which modes and noise are brought nearer.
pub(crate) struct Descent {
    objective: Objective,
    rate_hz: f64,
    /// Slowest and fastest decay per sample.
    decays: [f64; 2],
    power: f64,
}

/// Mean and mean square of a slope.
#[derive(Clone, Copy, Default)]
struct Moment(f64, f64);

impl Moment {
    /// Step for a slope, in units of the first step.
    fn step(&mut self, slope: f64, age: i32) -> f64 {
        self.0 = 0.9 * self.0 + 0.1 * slope;
        self.1 = 0.98 * self.1 + 0.02 * slope * slope;
        let (mean, square) = (self.0 / (1.0 - 0.9f64.powi(age)), self.1 / (1.0 - 0.98f64.powi(age)));
        -mean / (square.sqrt() + 1e-9)
    }
}

impl Descent {
    /// A descent for the strike in `sound` that begins at sample `onset` and ends before `end`.
    ///
    /// The force drives the modes from the onset on. `fastest_decay` is per sample. The background
    /// is a part of the sound that nothing moves.
    pub(crate) fn new(
        sound: &[f64],
        (onset, end): (usize, usize),
        rate_hz: f64,
        force: &[f64],
        noise_edges_hz: &[f64],
        background: Option<&Background>,
        fastest_decay: f64,
    ) -> Self {
        let strike = &sound[onset..end.min(sound.len())];
        let first = &strike[..strike.len().min((0.25 * rate_hz) as usize)];
        Self {
            objective: Objective::new(sound, onset, end, rate_hz, force, noise_edges_hz, background),
            rate_hz,
            decays: [0.05 / rate_hz, fastest_decay],
            power: first.iter().map(|x| x * x).sum::<f64>() / first.len().max(1) as f64,
        }
    }

    /// True for each mode that is the nearest to one of the loudest partials.
    fn held(&self, poles: &[Pole]) -> Vec<bool> {
        let mut held = vec![false; poles.len()];
        for angular in self.objective.partials() {
            let distance = |k: &usize| (poles[*k].angular - angular).abs();
            let nearest = (0..poles.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            if let Some(nearest) = nearest.filter(|nearest| distance(nearest) < HELD * angular) {
                held[nearest] = true;
            }
        }
        held
    }

    /// The nearest sound that is found within a number of steps, and its distance.
    pub(crate) fn run(&mut self, start: &Sounding, steps: usize) -> (Sounding, f64) {
        let mut now = start.clone();
        for band in &mut now.bands {
            band.weight = band.weight.max((LEAST_POWER * self.power).sqrt());
        }
        let mut best = (now.clone(), f64::INFINITY);
        let floor = now.gains.modes.iter().map(|gain| gain.norm()).fold(0.0, f64::max) * 1e-6;
        let mut of_modes = vec![[Moment::default(); 4]; now.poles.len()];
        let mut of_bands = vec![[Moment::default(); 2]; now.bands.len()];
        let mut of_force = Moment::default();
        let held = self.held(&start.poles);
        let lowest = std::f64::consts::TAU * LOWEST_HZ / self.rate_hz;
        let unit = |pole: &Pole| pole.decay + LEAST_UNIT / self.rate_hz;
        for (step, age) in (0..steps).zip(1..) {
            let modes = as_modes(&now);
            let slope = self.objective.slope(&modes, now.gains.force, &now.bands);
            if !slope.distance.is_finite() {
                break;
            }
            if slope.distance < best.1 {
                best = (now.clone(), slope.distance);
            }
            let ease = 0.52 + 0.48 * (std::f64::consts::PI * step as f64 / steps as f64).cos();
            let sum = now.gains.modes.iter().map(|gain| gain.norm()).sum::<f64>();
            now.gains.force += ease * FORCE_STEP * sum * of_force.step(slope.force_gain * sum, age);
            for (k, slopes) in slope.modes.iter().enumerate() {
                let (from, pole) = (start.poles[k], now.poles[k]);
                let size = now.gains.modes[k].norm().max(floor);
                let slopes = [
                    slopes.gain[0] * size,
                    slopes.gain[1] * size,
                    slopes.pole[1] * unit(&from),
                    slopes.pole[0] * pole.decay,
                ];
                let mut moves = [0.0; 4];
                for (index, moved) in moves.iter_mut().enumerate() {
                    *moved = ease * MODE_STEPS[index] * of_modes[k][index].step(slopes[index], age);
                }
                now.gains.modes[k] += Complex::new(moves[0], moves[1]) * size;
                let reach = if held[k] { HELD * from.angular } else { REACH[0] * unit(&from) };
                now.poles[k] = Pole {
                    angular: (pole.angular + moves[2] * unit(&from))
                        .clamp(from.angular - reach, from.angular + reach)
                        .clamp(lowest.min(from.angular), std::f64::consts::PI * 0.999),
                    decay: (pole.decay * moves[3].exp())
                        .clamp(from.decay * (-REACH[1]).exp(), from.decay * REACH[1].exp())
                        .clamp(self.decays[0], self.decays[1]),
                };
            }
            part_cancelling(&now.poles, &mut now.gains.modes);
            for ((band, moments), BandSlope { by_power, by_decay }) in
                now.bands.iter_mut().zip(&mut of_bands).zip(&slope.bands)
            {
                let power = band.weight * band.weight;
                let more = ease * BAND_STEPS[0] * moments[0].step(by_power * power, age);
                let faster = ease * BAND_STEPS[1] * moments[1].step(by_decay * band.decay_db_per_s, age);
                band.weight *= (0.5 * more).exp();
                band.decay_db_per_s =
                    (band.decay_db_per_s * faster.exp()).clamp(DECAYS_DB_PER_S[0], DECAYS_DB_PER_S[1]);
            }
        }
        best
    }
}

/// Each mode's `ln z` and gain.
fn as_modes(sounding: &Sounding) -> Vec<(Complex<f64>, Complex<f64>)> {
    let modes = sounding.poles.iter().zip(&sounding.gains.modes);
    modes.map(|(pole, gain)| (Complex::new(-pole.decay, pole.angular), *gain)).collect()
}
