//! Steady sound under a strike, such as hiss or the hum of mains: it sounds before the strike as
//! loudly as long after it, and so is no part of the struck thing.

use std::ops::Range;

use fourier::Complex;

use super::erb::erb_edges_hz;
use super::spectrogram::Spectrogram;
use crate::random::SplitMix64;
use crate::tones::{self, Tone};

/// Least time before a strike in which a background is heard, in seconds.
const LEAST_S: f64 = 0.25;
/// Longest time before a strike in which it is measured, in seconds.
const LONGEST_S: f64 = 1.0;
/// Time just before a strike that does not count, in seconds: the onset may be a little late.
const GAP_S: f64 = 0.005;
/// Length of a frame in which another strike is looked for, in seconds: a period of 50 Hz.
const FRAME_S: f64 = 0.02;
/// Ratio of a frame's power to that of the quietest one from which on something is struck: 10 dB.
const MOST_RISE: f64 = 10.0;
/// Number of bands in which the sound before and behind a strike are compared.
const BANDS: usize = 40;
/// Lowest edge of these bands in Hz.
const LOWEST_HZ: f64 = 20.0;
/// Largest ratio of a band's power before a strike to its power at the strike's end: 3 dB. What
/// sounds before the strike only is the ringing of another one, and no background.
const MOST_FALL: f64 = 2.0;
/// Least power of a background's loudest band relative to the strike's: -58 dB. Distances do not
/// hear what lies 60 dB below the strike.
const LEAST_POWER: f64 = 1.6e-6;
/// Least ratio of a mode's power to the background's, in a spectrum of the strike's beginning, for
/// it to be a mode of the thing: 10 dB. Modes of the noise itself stand up to 7 dB out of it.
const STANDS_OUT: f64 = 10.0;
/// Least ratio of a tone's power to the median of the spectrum round it: 12 dB.
const TONE: f64 = 16.0;
/// Number of bins on either side of a tone that are round it.
const ROUND: usize = 16;
/// Seed of a background that is added to renderings.
const SEED: u64 = 0x6261_636b;

/// Samples before a strike in which a background is heard: those that precede any other strike.
///
/// The ringing of an earlier strike may be as loud before this one as at its end.
fn quiet(before: &[f64], rate_hz: f64) -> Range<usize> {
    let samples = |seconds: f64| (seconds * rate_hz) as usize;
    let before = &before[..before.len().saturating_sub(samples(GAP_S))];
    let size = samples(FRAME_S).max(1);
    let power = |frame: &[f64]| frame.iter().map(|x| x * x).sum::<f64>();
    let least = before.chunks_exact(size).map(power).fold(f64::INFINITY, f64::min);
    let struck = before.chunks_exact(size).position(|frame| power(frame) > MOST_RISE * least);
    let end = struck.map_or(before.len(), |index| index * size);
    end.saturating_sub(samples(LONGEST_S))..end
}

/// Mean power spectrum of the steady sound under a strike.
#[derive(Clone, Debug)]
pub(crate) struct Background {
    /// Number of samples in a frame of the spectrum.
    size: usize,
    rate_hz: f64,
    /// Mean power in each bin under a Hann window; 0 in bands that are not steady.
    power: Vec<f64>,
}

impl Background {
    /// The background of a strike; `before` are the samples that precede it.
    ///
    /// `None` if less than 0.25 s precede the strike, if nothing there lasts until the strike's
    /// last quarter, or if all of it is inaudibly soft.
    pub(crate) fn under(before: &[f64], strike: &[f64], rate_hz: f64) -> Option<Self> {
        let samples = |seconds: f64| (seconds * rate_hz) as usize;
        let quiet = &before[quiet(before, rate_hz)];
        if quiet.len() < samples(LEAST_S) - samples(GAP_S) {
            return None;
        }
        // At least three lengths of a frame, so that the mean does not scatter by much.
        let size = (quiet.len() / 3 + 1).next_power_of_two() / 2;
        let end = &strike[strike.len() - strike.len() / 4..];
        if end.len() < size {
            return None;
        }
        let spectrogram = Spectrogram::new(size);
        let bins = spectrogram.bin_count();
        let mut power = vec![0.0; bins];
        let [mean, last] = [quiet, end].map(|part| {
            let frames = spectrogram.power(part);
            let count = (frames.len() / bins).max(1) as f64;
            let mut mean = vec![0.0; bins];
            frames
                .chunks_exact(bins)
                .for_each(|frame| mean.iter_mut().zip(frame).for_each(|(sum, x)| *sum += x / count));
            mean
        });
        let loudest = spectrogram.power(&strike[..strike.len().min(samples(LONGEST_S))]);
        let edges = erb_edges_hz([LOWEST_HZ, 0.5 * rate_hz], BANDS);
        let mut most = [0.0f64; 2];
        for edge in edges.windows(2) {
            let bin = |hz: f64| ((hz / rate_hz * size as f64).round() as usize).min(bins);
            let band = bin(edge[0])..bin(edge[1]);
            let sum = |of: &[f64]| of[band.clone()].iter().sum::<f64>();
            most[1] = loudest.chunks_exact(bins).map(sum).fold(most[1], f64::max);
            if sum(&mean) <= MOST_FALL * sum(&last) {
                power[band.clone()].copy_from_slice(&mean[band.clone()]);
                most[0] = most[0].max(sum(&mean));
            }
        }
        (most[0] > LEAST_POWER * most[1]).then_some(Self { size, rate_hz, power })
    }

    /// Steady tones of the background, such as the hum of mains.
    pub(crate) fn tones(&self, before: &[f64], strike: &[f64]) -> Vec<Tone> {
        let behind = strike.len() - strike.len() / 4;
        let quiet = quiet(before, self.rate_hz);
        let gap = before.len() - quiet.end;
        tones::steady((&before[quiet], gap), (&strike[behind..], behind), &self.tones_hz(), self.rate_hz)
    }

    /// Mean power in each bin of Hann frames of `size` samples.
    pub(crate) fn bins(&self, size: usize) -> Vec<f64> {
        let step = self.size as f64 / size as f64;
        let at = |bin: usize| self.power.get(bin).or(self.power.last()).copied().unwrap_or(0.0);
        let power = |bin: usize| {
            let (from, to) = ((bin as f64 - 0.5) * step, (bin as f64 + 0.5) * step);
            let (first, last) = (from.max(0.0).round() as usize, to.round() as usize);
            if last > first + 1 {
                (first..last).map(at).sum::<f64>() / (last - first) as f64 / step
            } else {
                let place = bin as f64 * step;
                let part = place.fract();
                ((1.0 - part) * at(place as usize) + part * at(place as usize + 1)) / step
            }
        };
        (0..=size / 2).map(power).collect()
    }

    /// True if a damped sine stands out of the background where it begins.
    pub(crate) fn is_over(&self, frequency_hz: f64, decay_per_s: f64, amplitude: f64) -> bool {
        let fall = decay_per_s * self.size as f64 / self.rate_hz;
        let shape = if fall > 1e-6 { (1.0 - (-fall).exp()) / fall } else { 1.0 };
        let power = (0.25 * self.size as f64 * amplitude * shape).powi(2);
        let bin = (frequency_hz / self.rate_hz * self.size as f64).round() as usize;
        let near = self.power.iter().skip(bin.saturating_sub(1)).take(3).copied().fold(0.0, f64::max);
        power > STANDS_OUT * near
    }

    /// Frequencies in Hz of the tones in the background.
    fn tones_hz(&self) -> Vec<f64> {
        let is_tone = |bin: &usize| {
            let (from, to) = (bin.saturating_sub(ROUND), (bin + ROUND + 1).min(self.power.len()));
            let mut round: Vec<f64> = self.power[from..to].to_vec();
            round.sort_by(f64::total_cmp);
            let (at, near) = (self.power[*bin], &self.power[bin.saturating_sub(2)..(bin + 3).min(self.power.len())]);
            at > TONE * round[round.len() / 2] && near.iter().all(|x| *x <= at)
        };
        let centred = |bin: usize| {
            let at = |index: usize| self.power.get(index).copied().unwrap_or(0.0).sqrt();
            let (left, peak, right) = (at(bin - 1), at(bin), at(bin + 1));
            // A Hann window's main lobe: the larger neighbour tells the place between bins.
            let (side, sign) = if right > left { (right, 1.0) } else { (left, -1.0) };
            let ratio = side / peak.max(f64::MIN_POSITIVE);
            (bin as f64 + sign * (2.0 * ratio - 1.0) / (1.0 + ratio)) * self.rate_hz / self.size as f64
        };
        (1..self.power.len()).filter(is_tone).map(centred).collect()
    }

    /// Rms of the background, full scale 1.
    pub(crate) fn rms(&self) -> f64 {
        // A Hann window has a mean square of 3/8.
        let whole = 2.0 * self.power.iter().sum::<f64>();
        (whole / (0.375 * (self.size * self.size) as f64)).sqrt()
    }

    /// A sound of `length` samples with the spectrum of the background.
    pub(crate) fn sound(&self, length: usize) -> Vec<f64> {
        let size = length.next_power_of_two().max(self.size);
        let inverse = fourier::inverse(size);
        let mut random = SplitMix64(SEED);
        let bin = |power: &f64| {
            // Noise of the mean square s has the power 3/8 size s under the window, size s without.
            let half = (power / 0.375 / 2.0).sqrt();
            Complex::new(half * random.normal(), half * random.normal())
        };
        let mut spectrum: Vec<Complex<f64>> = self.bins(size).iter().map(bin).collect();
        for end in [0, size / 2] {
            spectrum[end].im = 0.0;
        }
        let mut sound = inverse.make_output_vec();
        if inverse.process(&mut spectrum, &mut sound).is_err() {
            sound.fill(0.0);
        }
        sound.iter().take(length).map(|x| x / size as f64).collect()
    }
}
