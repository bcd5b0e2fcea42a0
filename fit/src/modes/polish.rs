//! From the most likely modes to those that sound most alike: a descent on the log-spectral distance.
//!
//! Least squares care for energy: a mode 40 dB down counts a ten-thousandth of the strongest. An ear, and the log-spectral distance, do
//! not. With fewer modes than the sound has, the two ask for different ones in the gaps. The descent (Adam) moves gains freely
//! and poles within a fraction of their bandwidth, so that a mode stays the mode that was measured.

use nalgebra::Complex;

use super::basis::{Basis, Stretch};
use super::pole::Pole;
use super::refine::{Gains, MOST_DECAY};
use crate::distance::{Target, log_spectral_distance_db};

const STEPS: usize = 160;
/// First step: of a gain, as a share of it; of a frequency, as a share of the decay; of the logarithm of the decay.
const FIRST_STEP: [f64; 4] = [0.05, 0.05, 0.03, 0.03];
/// How far a frequency may move, as a share of the decay, and the logarithm of a decay.
const REACH: [f64; 2] = [0.5, 0.5];

/// Moves poles and gains of one strike to come nearer to `wanted`, the beginning of the stretch. Returns the best that was met, which
/// may be what was given.
pub(crate) fn polish(stretch: &Stretch<'_>, wanted: &[f64], poles: &[Pole], gains: &Gains) -> (Vec<Pole>, Gains) {
    let target = Target::new(wanted);
    let length = wanted.len();
    let frame = Stretch { samples: wanted, force: stretch.force.map(|force| &force[..force.len().min(length)]) };
    let render = |poles: &[Pole], gains: &Gains| {
        let mut sound = vec![0.0; length];
        let bases: Vec<Basis> = poles.iter().map(|&pole| Basis::new(pole, &frame)).collect();
        for (basis, gain) in bases.iter().zip(&gains.modes) {
            basis.add(*gain, &mut sound);
        }
        for (sound, force) in sound.iter_mut().zip(frame.force.unwrap_or(&[])) {
            *sound += gains.force * force;
        }
        (bases, sound)
    };
    let (mut now, mut now_gains) = (poles.to_vec(), gains.clone());
    let (_, sound) = render(&now, &now_gains);
    let mut best = (now.clone(), now_gains.clone(), log_spectral_distance_db(wanted, &sound));
    let mut momentum = vec![[(0.0, 0.0); 4]; poles.len()];
    let floor = gains.modes.iter().map(|gain| gain.norm()).fold(0.0, f64::max) * 1e-6;
    for step in 0..STEPS {
        let (bases, sound) = render(&now, &now_gains);
        let distance = log_spectral_distance_db(wanted, &sound);
        if distance < best.2 {
            best = (now.clone(), now_gains.clone(), distance);
        }
        let (_, slope) = target.distance_and_slope(&sound);
        let ease = 0.5 + 0.5 * (std::f64::consts::PI * step as f64 / STEPS as f64).cos();
        for (k, basis) in bases.iter().enumerate() {
            let [plain, ramp] = basis.project(&slope);
            let gain = now_gains.modes[k];
            let size = gain.norm().max(floor);
            let decay = now[k].decay;
            // Slopes by the size-relative gain, by ω in units of the decay, by ln d.
            let slopes = [
                plain.re * size,
                -plain.im * size,
                (Complex::new(0.0, 1.0) * gain * ramp).re * decay,
                (-gain * ramp).re * decay,
            ];
            let mut moves = [0.0; 4];
            for (((first, second), slope), (moved, rate)) in
                momentum[k].iter_mut().map(|(a, b)| (a, b)).zip(slopes).zip(moves.iter_mut().zip(FIRST_STEP))
            {
                *first = 0.9 * *first + 0.1 * slope;
                *second = 0.99 * *second + 0.01 * slope * slope;
                let age = (step + 1) as f64;
                let (mean, square) = (*first / (1.0 - 0.9f64.powf(age)), *second / (1.0 - 0.99f64.powf(age)));
                *moved = -ease * rate * mean / (square.sqrt() + 1e-9);
            }
            now_gains.modes[k] += Complex::new(moves[0], moves[1]) * size;
            let from = poles[k];
            let reach = REACH[0] * from.decay;
            now[k] = Pole {
                angular: (now[k].angular + moves[2] * decay)
                    .clamp(from.angular - reach, from.angular + reach)
                    .clamp(1e-4, std::f64::consts::PI * 0.999),
                decay: (decay * moves[3].exp())
                    .clamp(from.decay * (-REACH[1]).exp(), from.decay * REACH[1].exp())
                    .min(MOST_DECAY),
            };
        }
    }
    let (poles, mut gains, _) = best;
    // The distance knows no level: the recording's is put back.
    let energy = |sound: &[f64]| sound.iter().map(|x| x * x).sum::<f64>();
    let (_, sound) = render(&poles, &gains);
    let level = (energy(wanted) / energy(&sound).max(f64::MIN_POSITIVE)).sqrt();
    gains.modes.iter_mut().for_each(|gain| *gain *= level);
    gains.force *= level;
    (poles, gains)
}
