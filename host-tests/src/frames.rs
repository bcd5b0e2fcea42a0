//! A bank in frames without an engine, and its exact response.

use dsp_core::SampleRate;
use dsp_core::frames::{BLOCK_FRAMES, FrameBank, FrameMixer};
use dsp_core::output::Panner;
use dsp_core::resonator::{BankTable, TICK_FRAMES};
use dsp_core::table::layout::{GainRecord, ModeRecord};

use crate::lent;
use crate::snr::Random;

/// A mode by what is heard of it: `r^n (sine sin nθ + cosine cos nθ)`.
#[derive(Clone, Copy, Debug)]
pub struct HeardMode {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Time to a loss of 60 dB, in s.
    pub t60_s: f64,
    /// Amplitude of the sine, for a force of one bus step in one sample.
    pub sine: f64,
    /// Amplitude of the cosine.
    pub cosine: f64,
}

impl HeardMode {
    fn decay_per_s(&self) -> f64 {
        1000f64.ln() / self.t60_s
    }

    /// The mode as a table holds it, for weight 1.
    pub fn records(&self, rate: SampleRate) -> (ModeRecord, GainRecord) {
        let gain = |x: f64| ((x * rate.hz()) as f32).into();
        let decay_per_s = (self.decay_per_s() as f32).into();
        (
            ModeRecord { frequency_hz: (self.frequency_hz as f32).into(), decay_per_s },
            GainRecord { sine: gain(self.sine), cosine: gain(self.cosine) },
        )
    }

    /// Adds the mode's response to a force to a sound, in `f64` from what the table holds.
    pub fn add_response(&self, rate: SampleRate, force: &[f64], sound: &mut [f64]) {
        let (mode, gain) = self.records(rate);
        let (f, d) = (f64::from(mode.frequency_hz.get()) / rate.hz(), f64::from(mode.decay_per_s.get()) / rate.hz());
        let (sine, cosine) = (f64::from(gain.sine.get()) / rate.hz(), f64::from(gain.cosine.get()) / rate.hz());
        // Exact powers at every 4096th sample, a recursion between them.
        let power = |n: f64| {
            let (size, angle) = ((-d * n).exp(), std::f64::consts::TAU * (f * n).fract());
            [size * angle.cos(), size * angle.sin()]
        };
        let z = power(1.0);
        let struck: Vec<usize> = (0..force.len()).filter(|&m| force[m] != 0.0).collect();
        if struck.len() == 1 {
            let (m, x) = (struck[0], force[struck[0]]);
            for (chunk, sound) in sound[m..].chunks_mut(4096).enumerate() {
                let [mut re, mut im] = power(4096.0 * chunk as f64);
                for y in sound {
                    *y += x * (sine * im + cosine * re);
                    (re, im) = (re * z[0] - im * z[1], re * z[1] + im * z[0]);
                }
            }
            sound[m] -= x * cosine / 2.0;
            return;
        }
        let [mut re, mut im] = [0.0; 2];
        for (n, y) in sound.iter_mut().enumerate() {
            (re, im) = (re * z[0] - im * z[1], re * z[1] + im * z[0]);
            let x = force.get(n).copied().unwrap_or(0.0);
            re += x;
            *y += sine * im + cosine * (re - x / 2.0);
        }
    }
}

/// Modes at even distances up to 20 kHz with random T60s between bounds and random phases, as a
/// prior has them.
pub fn prior(count: usize, t60_s: [f64; 2]) -> Vec<HeardMode> {
    let mut random = Random::new(count as u64);
    let mode = |index: usize| {
        let phase = random.between(0.0, std::f64::consts::TAU);
        let t60_s = t60_s[0] * (t60_s[1] / t60_s[0]).powf(random.between(0.0, 1.0));
        let frequency_hz = 20.0 + 20_000.0 * index as f64 / count as f64;
        let size = 0.5 / (count as f64).sqrt();
        HeardMode { frequency_hz, t60_s, sine: size * phase.sin(), cosine: size * phase.cos() }
    };
    (0..count).map(mode).collect()
}

/// A contact of a number of samples: a half sine of 0.3 times full scale.
pub fn contact(samples: usize) -> Vec<i32> {
    let place = |n: usize| std::f64::consts::PI * (n as f64 + 0.5) / samples as f64;
    (0..samples).map(|n| (place(n).sin() * 0.3 * f64::from(1 << 27)) as i32).collect()
}

/// A bank in frames, with its mixer.
#[derive(Debug)]
pub struct FramesOnPc {
    banks: [FrameBank<'static>; 1],
    mixer: FrameMixer<'static>,
    now: usize,
}

impl FramesOnPc {
    /// Bank of modes at a rate, on the left side. Modes that no longer sound retire if `retires`.
    pub fn new(modes: &[HeardMode], rate: SampleRate, retires: bool) -> Self {
        Self::with_positions(&[modes.to_vec()], rate, retires)
    }

    /// Bank whose modes have the frequencies and decays of the first position, and the gains of
    /// each.
    pub fn with_positions(positions: &[Vec<HeardMode>], rate: SampleRate, retires: bool) -> Self {
        let modes: Vec<_> = positions[0].iter().map(|mode| mode.records(rate).0).collect();
        let of_mode = |index: usize| positions.iter().map(move |modes| modes[index].records(rate).1);
        let gains: Vec<_> = (0..modes.len()).flat_map(of_mode).collect();
        let table = BankTable {
            modes: Vec::leak(modes),
            gains: Vec::leak(gains),
            positions: positions.len(),
            weight: 1.0,
            choke_t60_s: 0.0,
            is_balanced: false,
            typical_contact: (0.0, 0.0),
        };
        let size = FrameBank::size(&table, rate).expect("gains and decays in range");
        let mut mixer = lent!(lender => FrameMixer::take(lender, retires));
        let mut bank = lent!(lender => FrameBank::take(lender, size));
        bank.load(&table, rate, [1.0, 0.0], &mut mixer).expect("checked with its size");
        Self { banks: [bank], mixer, now: 0 }
    }

    /// Slot for a strike at a position, moved there; `None` if both slots sound elsewhere.
    pub fn strike_at(&mut self, position: f32) -> Option<usize> {
        let place = self.banks[0].place(position, |_| false);
        if place.moves {
            self.banks[0].set_position(place.slot, position);
        }
        (!place.is_merged).then_some(place.slot.into())
    }

    /// True if nothing sounds and nothing will.
    pub fn is_silent(&self) -> bool {
        self.mixer.is_silent() && !self.banks[0].is_active()
    }

    /// Left side under a force in slot 0, rendered in runs of at most `most` frames.
    pub fn render(&mut self, force: &[i32], most: usize) -> Vec<i32> {
        self.render_in(0, force, most)
    }

    /// Left side under a force in a slot.
    pub fn render_in(&mut self, slot: usize, force: &[i32], most: usize) -> Vec<i32> {
        let mut out = Vec::with_capacity(force.len());
        let mut rest = force;
        while !rest.is_empty() {
            let frame = self.now % BLOCK_FRAMES;
            if frame == 0 {
                self.mixer.begin_block(&mut self.banks);
            }
            let count = rest.len().min(most).min(TICK_FRAMES - self.now % TICK_FRAMES);
            let (run, later) = rest.split_at(count);
            rest = later;
            let mut head = vec![0; count];
            let force = run.iter().any(|&x| x != 0).then_some(run);
            let mut forces = [None; 2];
            forces[slot] = force;
            self.banks[0].begin_run(frame);
            self.banks[0].render(forces, &mut head);
            let mut stereo = vec![[0; 2]; count];
            Panner::new(0.0, -1.0).render(&head, &mut stereo);
            self.mixer.render(frame, &mut stereo);
            out.extend(stereo.iter().map(|side| side[0]));
            self.now += count;
            if self.now.is_multiple_of(TICK_FRAMES) {
                self.mixer.end_tick((self.now - 1) % BLOCK_FRAMES / TICK_FRAMES, 0.0, &mut self.banks);
            }
        }
        out
    }
}
