//! Signal of a struck piezo on the ADC's pin, with its disturbances.

use std::f64::consts::{PI, TAU};

use super::random::Random;

/// ADC frames a second.
pub const RATE_HZ: f64 = 48_000.0;
/// Half the ADC's range in counts.
const HALF_RANGE: f64 = 2048.0;

/// Response of a piezo to a strike, normalised to a largest magnitude of 1.
#[derive(Clone, Copy, Debug)]
pub struct Ring {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Time in seconds in which the response falls to 1/e.
    pub decay_s: f64,
    /// Onset of the response.
    pub attack: Attack,
    /// Second mode: its frequency as a multiple of the first, and its share.
    pub second: (f64, f64),
}

/// Onset of a ring.
#[derive(Clone, Copy, Debug)]
pub enum Attack {
    /// Begins at zero, as a sine.
    Sine,
    /// Begins at its peak, as a cosine.
    Cosine,
    /// Begins as the half-sine of a contact of this length in seconds, under a sine ring of half
    /// its height.
    Contact(f64),
    /// Begins as a sine under an envelope that rises with this time constant in seconds.
    Soft(f64),
}

impl Ring {
    fn raw(&self, t: f64) -> f64 {
        if t < 0.0 {
            return 0.0;
        }
        let decay = (-t / self.decay_s).exp();
        let phase = TAU * self.frequency_hz * t;
        let second = |wave: f64, other: f64| wave * (1.0 - self.second.1) + other * self.second.1;
        let sine = second(phase.sin(), (phase * self.second.0).sin()) * decay;
        match self.attack {
            Attack::Sine => sine,
            Attack::Cosine => second(phase.cos(), (phase * self.second.0).cos()) * decay,
            Attack::Contact(contact_s) => {
                let pulse = if t < contact_s { (PI * t / contact_s).sin() } else { 0.0 };
                pulse + 0.5 * sine
            }
            Attack::Soft(rise_s) => sine * (1.0 - (-t / rise_s).exp()),
        }
    }

    /// Largest magnitude before normalisation, on a grid of 1/16 of a frame.
    fn peak(&self) -> f64 {
        (0..16 * 480).map(|n| self.raw(f64::from(n) / 16.0 / RATE_HZ).abs()).fold(0.0, f64::max)
    }

    /// Time of the largest magnitude in seconds.
    pub fn rise_s(&self) -> f64 {
        let peak = self.peak();
        let at = (0..16 * 480).find(|&n| self.raw(f64::from(n) / 16.0 / RATE_HZ).abs() >= peak);
        f64::from(at.unwrap_or(0)) / 16.0 / RATE_HZ
    }
}

/// A strike of a scene.
#[derive(Clone, Copy, Debug)]
pub struct Strike {
    /// Time of the onset in seconds.
    pub time_s: f64,
    /// Index of the pad; its channel has the same number.
    pub pad: usize,
    /// Peak as a fraction of half the ADC's range: the velocity that a trigger should find.
    pub velocity: f64,
}

/// Strikes on piezos, and the disturbances of their signals.
#[derive(Clone, Debug)]
pub struct Scene<const CHANNELS: usize> {
    /// Name of the scene's kind.
    pub name: &'static str,
    /// Strikes in order of time.
    pub strikes: Vec<Strike>,
    /// Ring of each channel's piezo, and its polarity: 1 or -1.
    pub rings: [(Ring, f64); CHANNELS],
    /// Standard deviation of white noise, in counts.
    pub noise_counts: f64,
    /// Amplitude of mains hum in counts, and its frequency in Hz.
    pub hum: (f64, f64),
    /// Offset from 2048, and the amplitude of its drift over 5 s, both in counts.
    pub offset: (f64, f64),
    /// Share of each pad's signal that reaches the others, and its delay in seconds.
    pub crosstalk: (f64, f64),
    /// Length in seconds.
    pub length_s: f64,
    /// Seed of the noise.
    pub seed: u64,
}

impl<const CHANNELS: usize> Scene<CHANNELS> {
    /// Counts that the ADC gives.
    pub fn counts(&self) -> Vec<[u16; CHANNELS]> {
        let frames = (self.length_s * RATE_HZ) as usize;
        let mut own = vec![[0.0; CHANNELS]; frames];
        for strike in &self.strikes {
            let (ring, sign) = &self.rings[strike.pad];
            let height = strike.velocity * HALF_RANGE * sign / ring.peak();
            let first = (strike.time_s * RATE_HZ).ceil() as usize;
            // After 18 time constants a ring is at -156 dB.
            let last = frames.min(first + (ring.decay_s * 18.0 * RATE_HZ) as usize);
            for (n, frame) in own.iter_mut().enumerate().take(last).skip(first) {
                frame[strike.pad] += height * ring.raw(n as f64 / RATE_HZ - strike.time_s);
            }
        }
        let mut random = Random::new(self.seed);
        let (ratio, delay_s) = self.crosstalk;
        let delay = (delay_s * RATE_HZ).round() as usize;
        let mut counts = Vec::with_capacity(frames);
        for n in 0..frames {
            let t = n as f64 / RATE_HZ;
            let mut frame = [0; CHANNELS];
            for (channel, count) in frame.iter_mut().enumerate() {
                let late = n.checked_sub(delay).map(|n| own[n]).unwrap_or([0.0; CHANNELS]);
                let others: f64 = late.iter().enumerate().filter(|(other, _)| *other != channel).map(|(_, x)| x).sum();
                let hum = self.hum.0 * (TAU * self.hum.1 * t + channel as f64).sin();
                let drift = self.offset.0 + self.offset.1 * (TAU * t / 5.0).sin();
                let disturbance = hum + drift + self.noise_counts * random.gaussian();
                let x = own[n][channel] + ratio * others + disturbance + HALF_RANGE;
                *count = x.round().clamp(0.0, 4095.0) as u16;
            }
            counts.push(frame);
        }
        counts
    }
}
