//! Descent on the log-spectral distance, from the most likely modes to those that sound most alike.
//!
//! Least squares weigh energy: a mode 40 dB down counts a ten-thousandth of the strongest. An ear,
//! and the log-spectral distance, do not. With fewer modes than the sound has, the two criteria ask
//! for different modes in the gaps. The descent (Adam) moves gains freely and poles within a
//! fraction of their bandwidth, so that a mode stays the mode that was measured.
//!
//! The distance compares the beginning of a strike, which hardly shows the decay of a mode that
//! rings for seconds. With nothing else to compare, the tail of such a mode would end up tens of
//! decibels too loud. So short parts of the later sound are compared too.

use nalgebra::Complex;

use super::basis::{Basis, Stretch};
use super::pole::Pole;
use super::refine::{Gains, MOST_DECAY};
use crate::distance::{LONGEST_WINDOW, Target, log_spectral_distance_db};

/// Number of steps.
const STEPS: usize = 160;
/// First steps: two of a gain, relative to it, one of a frequency, relative to the decay, and one
/// of ln decay.
const FIRST_STEP: [f64; 4] = [0.05, 0.05, 0.03, 0.03];
/// Largest change of a frequency, relative to the decay, and of ln decay.
const REACH: [f64; 2] = [0.5, 0.5];

/// Number of later parts that are compared, each as long as the distance's longest window.
const PARTS: usize = 12;
/// Exponent that moves the parts towards the beginning: it is applied to their order, from 0 to 1.
const CROWDING: f64 = 1.5;
/// Weight of all later parts together, relative to the beginning.
const PARTS_WEIGHT: f64 = 0.5;
/// Level, as a ratio of amplitudes to the strongest sample, down to which the later sound is
/// compared: 60 dB.
const HEARD: f64 = 1e-3;

/// Moves poles and gains of one strike nearer to `wanted`, the beginning of the stretch, and to
/// later parts.
///
/// Returns the best poles and gains found, which may be those given.
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
    let parts = parts(&target, stretch.samples, length);
    let (mut now, mut now_gains) = (poles.to_vec(), gains.clone());
    let mut best = (now.clone(), now_gains.clone(), f64::INFINITY);
    let mut momentum = vec![[(0.0, 0.0); 4]; poles.len()];
    let floor = gains.modes.iter().map(|gain| gain.norm()).fold(0.0, f64::max) * 1e-6;
    for step in 0..STEPS {
        let (bases, sound) = render(&now, &now_gains);
        let heard: Vec<Heard> = parts.iter().map(|part| part.hear(&bases, &now_gains)).collect();
        let distance =
            log_spectral_distance_db(wanted, &sound) + heard.iter().map(|heard| heard.distance_db).sum::<f64>();
        if distance < best.2 {
            best = (now.clone(), now_gains.clone(), distance);
        }
        let (_, slope) = target.distance_and_slope(&sound);
        let ease = 0.5 + 0.5 * (std::f64::consts::PI * step as f64 / STEPS as f64).cos();
        for (k, basis) in bases.iter().enumerate() {
            let [mut plain, mut ramp] = basis.project(&slope);
            for (part, heard) in parts.iter().zip(&heard) {
                let [more_plain, more_ramp] = basis.later(part.from, LONGEST_WINDOW).project(&heard.slope);
                plain += more_plain;
                ramp += more_ramp;
            }
            let gain = now_gains.modes[k];
            let size = gain.norm().max(floor);
            let decay = now[k].decay;
            // Derivatives by the relative gain, by ω in units of the decay, and by ln d.
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
    // The distance ignores the level, so the recording's level is restored.
    let energy = |sound: &[f64]| sound.iter().map(|x| x * x).sum::<f64>();
    let (_, sound) = render(&poles, &gains);
    let level = (energy(wanted) / energy(&sound).max(f64::MIN_POSITIVE)).sqrt();
    gains.modes.iter_mut().for_each(|gain| *gain *= level);
    gains.force *= level;
    (poles, gains)
}

/// A part of the strike after its beginning.
struct Part {
    /// First sample of the part.
    from: usize,
    target: Target,
    weight: f64,
}

/// Share of a part in the distance, and its derivative by each sample of the part.
struct Heard {
    distance_db: f64,
    slope: Vec<f64>,
}

impl Part {
    fn hear(&self, bases: &[Basis], gains: &Gains) -> Heard {
        let mut sound = vec![0.0; LONGEST_WINDOW];
        for (basis, gain) in bases.iter().zip(&gains.modes) {
            basis.later(self.from, LONGEST_WINDOW).add(*gain, &mut sound);
        }
        let (distance_db, mut slope) = self.target.distance_and_slope_at_level(&sound);
        slope.iter_mut().for_each(|slope| *slope *= self.weight);
        Heard { distance_db: self.weight * distance_db, slope }
    }
}

/// Parts between the beginning and the last audible sample of a strike; none if that span is too
/// short.
fn parts(beginning: &Target, samples: &[f64], from: usize) -> Vec<Part> {
    let peak = samples.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
    let end = samples.iter().rposition(|x| x.abs() > HEARD * peak).unwrap_or(0);
    let Some(span) = end.checked_sub(from + LONGEST_WINDOW) else { return Vec::new() };
    let parts = (0..PARTS).filter_map(|part| {
        let place = ((part as f64 + 0.5) / PARTS as f64).powf(CROWDING);
        let from = from + (span as f64 * place) as usize;
        let target = beginning.part(samples.get(from..from + LONGEST_WINDOW)?);
        Some(Part { from, target, weight: PARTS_WEIGHT / PARTS as f64 })
    });
    parts.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn a_polished_tail_keeps_its_level_under_noise_at_the_beginning() {
        // One mode of T60 3 s, and noise for 0.25 s after the strike, for which there is no mode.
        let rate_hz = 44_100.0;
        let pole = Pole::new(700.0, 2.3, rate_hz);
        let mut random = SplitMix64(4);
        let mut sound = vec![0.0; 88_200];
        Basis::new(pole, &Stretch::ringing(&sound)).add(Complex::new(0.0, -0.3), &mut sound);
        let noise = |n: usize, x: f64| x * 0.05 * (-(n as f64) / 4000.0).exp();
        sound.iter_mut().enumerate().for_each(|(n, x)| *x += noise(n, random.normal()));
        let stretch = Stretch::ringing(&sound);
        let gains = Gains { modes: vec![Complex::new(0.0, -0.3)], force: 0.0 };
        let (poles, gains) = polish(&stretch, &sound[..11_025], &[pole], &gains);
        for seconds in [0.5, 1.0, 1.5] {
            let level = |pole: Pole, gain: f64| gain * pole.power(seconds * rate_hz).norm();
            let off_db = 20.0 * (level(poles[0], gains.modes[0].norm()) / level(pole, 0.3)).log10();
            println!("{seconds} s: {off_db:+.2} dB");
            assert!(off_db.abs() < 0.5, "{seconds} s: {off_db:+.2} dB");
        }
    }
}
