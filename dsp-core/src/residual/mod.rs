//! Residual: what an object sounds beside its modes, as bands of decaying noise (physics-diffusion eq. 5, 6), and stationary background.
//!
//! ```text
//! y(t) = Σ_m w_m 10^(-γ_m t/20) BPF_m(noise)      w rms at t = 0, γ in dB/s, up to 100 bands
//!
//! strike --> energy a band --> spectrum of a frame --> random lines --> inverse transform --> window --> Σ
//!              ^      |        (of 128, 256, 512,       (SFC32)          (f32, in pieces)    (quarter sines)
//!              +------+         1024 samples)
//!            10^(-γ/10 a second)
//! ```
//!
//! A hundred filters would cost a hundred times a filter. Here one noise a pad is shaped frame by frame in frequency: each line of a frame's spectrum is a random
//! number with the power of the bands at its place. Frames overlap with power-complementary windows, so that the expected power is
//! constant from frame to frame. A strike begins a frame of its own, at its very sample and with nothing before it, made of 128 samples and
//! hence cheap enough to compute in its tick. Frames then double to 1024 samples: short where all decays, long where pitch counts. What
//! rang before joins the second frame after a strike: energies add, band by band. A frame carries the mean decay of its energy sample by
//! sample, and of each band the energy that its own decay leaves under the window.
//!
//! Resolution: a frame of N samples blurs a band's edges by about 1.5 fs/N (70 Hz for the longest at 48 kHz); with decays
//! steeper than the mean of all bands a band's level falls in steps as long as three quarters of a frame, right in energy and slope.
//!
//! Strikes within eight ticks of another one raise its first two frames as a whole: their energy is right, their spectra are the first one's.
//!
//! Amplitude is proportional to a strike's peak force, as that of the modes is.

mod bands;
mod fourier;
mod job;
mod square_root;
mod stream;

pub use bands::{BandLaw, MAX_BANDS};

use bands::{Bands, Shape, WAITING, When};
use fourier::{Complex, MAX_POINTS, Progress, SLOPE, SLOPE_STEPS};
use job::Job;
use square_root::square_root;
use stream::{Stream, Wave};

use crate::SampleRate;
use crate::fixed;
use crate::noise::Sfc32;
use crate::resonator::TICK_FRAMES;

/// Ticks from the one with a strike to the frame that carries all energy; that tick counts.
const ONSET_TICKS: u32 = 8;
/// Fade from a strike's own frame, and from all that rang before, to the frame that carries both.
const ONSET_FADE: usize = 64;
/// Points of a strike's own frame.
const ONSET_POINTS: usize = 64;
const ONSET_POINTS_LOG2: u32 = 6;
/// Frames double from 64 points so many times.
const LARGEST: usize = 3;
/// Of the first frame after a strike, which shares its region with the strike's own.
const SECOND_FIRST: usize = 128;

/// Noise in bands that decay, each at its own rate, after every strike.
///
/// 16 KB. Accuracy against the law and cycles: `docs/residual.md`.
#[derive(Clone, Debug)]
pub struct Shaper {
    bands: Bands,
    noise: Sfc32,
    /// Amplitudes of the lines of a strike's own frame, and its decay.
    onset: [f32; ONSET_POINTS],
    onset_per_frame: f32,
    /// Power below which the sound ends.
    silence: f32,
    waves: [[Complex; MAX_POINTS]; 3],
    /// What sounds: up to two frames, and a strike's own.
    streams: [Option<Stream>; 3],
    /// The end of all that rang before the frame that took it over.
    tail: [f32; ONSET_FADE],
    tail_at: usize,
    job: Option<Job>,
    /// Ticks to the next frame's beginning; 0: there will be none.
    ticks_to_next: u32,
    /// Whether the next frame is the first to carry a strike.
    in_onset: bool,
    /// Whether a strike came in this tick, which leaves no time for more.
    just_struck: bool,
    /// Ticks since the time for which the bands' energies stand.
    ticks_since: u32,
    /// Energy of strikes that no band has yet.
    waiting: [f32; WAITING],
    active: bool,
    /// What a choke leaves of the amplitude after a frame, and whether it does.
    choke_per_frame: f32,
    choked: bool,
    /// What chokes have left of the energies' amplitude.
    kept: f32,
}

impl Shaper {
    /// Without bands, silent for ever.
    pub const NONE: Self = Self {
        bands: Bands::NONE,
        noise: Sfc32::new(0, 0),
        onset: [0.0; ONSET_POINTS],
        onset_per_frame: 1.0,
        silence: 0.0,
        waves: [[[0.0; 2]; MAX_POINTS]; 3],
        streams: [None; 3],
        tail: [0.0; ONSET_FADE],
        tail_at: ONSET_FADE,
        job: None,
        ticks_to_next: 0,
        in_onset: false,
        just_struck: false,
        ticks_since: 0,
        waiting: [0.0; WAITING],
        active: false,
        choke_per_frame: 1.0,
        choked: false,
        kept: 1.0,
    };

    /// Derives the stage in place (it is large) for a rate. `silence` is the rms (1.0 = full scale) below which the sound ends, `stream` tells
    /// stages of one seed apart. Bands beyond [`MAX_BANDS`] are left out: a kit's check refuses them.
    pub fn load(&mut self, laws: impl Iterator<Item = BandLaw>, rate: SampleRate, noise: Sfc32, silence: f32) {
        self.reset();
        self.bands = Bands::new(laws, rate);
        self.noise = noise;
        self.silence = silence * silence;
        let common = self.bands.ready_onset();
        self.onset_per_frame = common.per_frame;
        let mut spectrum = [[0.0; 2]; ONSET_POINTS];
        self.bands.fill_amplitudes(&mut spectrum, &mut self.bands.lowest(), u32::MAX);
        for (amplitude, line) in self.onset.iter_mut().zip(spectrum) {
            *amplitude = line[0];
        }
    }

    /// Forgets all sound and all bands.
    pub fn reset(&mut self) {
        self.stop();
        self.bands.clear();
        self.bands = Bands::NONE;
        (self.choked, self.choke_per_frame, self.kept) = (false, 1.0, 1.0);
    }

    fn stop(&mut self) {
        (self.streams, self.job, self.tail_at) = ([None; 3], None, ONSET_FADE);
        (self.ticks_to_next, self.in_onset, self.just_struck, self.active) = (0, false, false, false);
        (self.waiting, self.ticks_since) = ([0.0; WAITING], 0);
    }

    /// Whether the table has this stage at all.
    pub fn is_built(&self) -> bool {
        self.bands.count() > 0
    }

    /// Whether anything sounds; otherwise [`render`](Self::render) and [`end_tick`](Self::end_tick) do nothing.
    #[inline(always)]
    pub fn is_active(&self) -> bool {
        self.active
    }

    /// What a hand on the object leaves of the amplitude after a frame (1.0: nothing is choked), until told otherwise.
    pub fn set_choked(&mut self, choke_per_frame: Option<f32>) {
        self.choked = choke_per_frame.is_some();
        self.choke_per_frame = choke_per_frame.unwrap_or(1.0);
    }

    /// Begins the noise of a strike: `strength` is its peak force over the reference force, `offset` the frame within the tick.
    #[inline(never)]
    pub fn strike(&mut self, strength: f32, offset: usize) {
        let energy = strength * strength;
        if !self.is_built() || energy.is_nan() || energy <= 0.0 {
            return;
        }
        self.active = true;
        if self.in_onset {
            self.join_onset(energy);
        } else {
            self.begin_onset(strength);
        }
        // Shared between the two ticks beside the distance: the line between two values of the exponential.
        let fraction = offset.min(TICK_FRAMES) as f32 / TICK_FRAMES as f32;
        let ticks = self.ticks_to_next as usize;
        for (place, energy) in [(ticks, energy * (1.0 - fraction)), (ticks.saturating_sub(1), energy * fraction)] {
            if let Some(waiting) = self.waiting.get_mut(place) {
                *waiting += energy;
            }
        }
    }

    /// Begins stationary noise: bands without decay, faded in.
    pub fn begin(&mut self) {
        if self.is_built() {
            (self.active, self.in_onset, self.just_struck) = (true, true, true);
            self.ticks_to_next = ONSET_TICKS;
            (self.waiting, self.ticks_since) = ([0.0; WAITING], 0);
            self.waiting[0] = 1.0;
            self.plan_second();
        }
    }

    /// A second strike before the frame that carries the first: what there is already grows.
    fn join_onset(&mut self, energy: f32) {
        if let Some(own) = self.streams.iter_mut().flatten().find(|stream| stream.wave.points() == ONSET_POINTS) {
            own.gain = square_root(own.gain * own.gain + energy);
        }
        if let Some(job) = self.job.as_mut() {
            job.add_late(energy * self.bands.strike_power());
        }
    }

    fn begin_onset(&mut self, strength: f32) {
        // A frame that was to be replaced now holds on.
        for stream in self.streams.iter_mut().flatten().filter(|stream| stream.position < stream.fade_out_at) {
            stream.fade_out_at = u32::MAX / 2;
        }
        (self.in_onset, self.just_struck, self.ticks_to_next) = (true, true, ONSET_TICKS);
        self.plan_second();
        let Some(Job { wave, .. }) = self.job else { return };
        let wave = Wave { region: wave.region, first: 0, points_log2: ONSET_POINTS_LOG2 };
        let Some(memory) = self.waves.get_mut(wave.region) else { return };
        let spectrum = wave.of_mut(memory);
        for (line, &amplitude) in spectrum.iter_mut().zip(&self.onset) {
            line[0] = amplitude;
        }
        fill(spectrum, &mut self.noise);
        let mut progress = Progress::start(ONSET_POINTS);
        while !progress.is_over() {
            progress.advance(spectrum, u32::MAX);
        }
        let own = Stream {
            wave,
            position: 0,
            fade_in: 0,
            fade_out_at: u32::MAX / 2,
            fade_out: 0,
            gain: strength,
            per_frame: self.onset_per_frame,
        };
        if let Some(free) = self.streams.iter_mut().find(|stream| stream.is_none()) {
            *free = Some(own);
        }
    }

    /// The frame after a strike's own.
    fn plan_second(&mut self) {
        let when = When::AfterStrike(self.ticks_since + ONSET_TICKS);
        let wave = Wave { region: self.free_region(), first: SECOND_FIRST, points_log2: ONSET_POINTS_LOG2 + 1 };
        self.job = Some(Job::new(wave, (1, Shape::Growing), when, self.bands.count()));
    }

    fn free_region(&self) -> usize {
        let is_used = |region: &usize| self.streams.iter().flatten().any(|stream| stream.wave.region == *region);
        (0..self.waves.len()).find(|region| !is_used(region)).unwrap_or(0)
    }

    /// Adds a run of at most a tick to `out`, Q4.27.
    #[inline(never)]
    pub fn render(&mut self, out: &mut [i32]) {
        if !self.active {
            return;
        }
        let mut sum = [0.0; TICK_FRAMES];
        let Some(sum) = sum.get_mut(..out.len()) else { return };
        for (sum, &tail) in sum.iter_mut().zip(self.tail.iter().skip(self.tail_at)) {
            *sum = tail;
        }
        self.tail_at = (self.tail_at + sum.len()).min(ONSET_FADE);
        self.add_streams(sum);
        for (out, &sum) in out.iter_mut().zip(&*sum) {
            // `as` saturates.
            *out = fixed::qadd(*out, (sum * fixed::ONE_Q27 as f32) as i32);
        }
    }

    fn add_streams(&mut self, sum: &mut [f32]) {
        for stream in self.streams.iter_mut().flatten() {
            if let Some(memory) = self.waves.get(stream.wave.region) {
                stream.add_to(stream.wave.of(memory), self.choke_per_frame, sum);
            }
        }
    }

    /// The work of a tick for the frames to come; after the tick's last run.
    #[inline(never)]
    pub fn end_tick(&mut self) {
        if !self.active {
            return;
        }
        self.ticks_since += 1;
        if self.choked {
            for _ in 0..TICK_FRAMES {
                self.kept *= self.choke_per_frame;
            }
        }
        for stream in &mut self.streams {
            *stream = stream.filter(|stream| !stream.is_over());
        }
        if self.ticks_to_next > 0 {
            self.ticks_to_next -= 1;
            if !core::mem::take(&mut self.just_struck) {
                self.work();
            }
            if self.ticks_to_next == 0 {
                self.begin_next();
            }
        }
        if self.ticks_to_next == 0 && self.tail_at >= ONSET_FADE && self.streams.iter().all(Option::is_none) {
            self.bands.clear();
            self.stop();
        }
    }

    /// Cycles that this tick's work will take, about; without what strikes bring.
    pub fn cycles_ahead(&self) -> u32 {
        self.job.filter(|_| self.ticks_to_next > 0).map_or(0, |job| job.share(self.ticks_to_next))
    }

    /// This tick's share of the next frame.
    fn work(&mut self) {
        let Some(mut job) = self.job else { return };
        match job.when() {
            Some(When::AfterStrike(ticks)) => {
                job.begin_update(ticks, self.kept * self.kept);
                self.kept = 1.0;
            }
            Some(When::After(shape)) => {
                if self.waiting.iter().any(|&energy| energy > 0.0) {
                    self.bands.add_waiting(&self.waiting);
                    self.waiting = [0.0; WAITING];
                }
                let common = self.bands.ready(Some(shape), job.frame);
                // They stand for the beginning of the frame that began with this tick.
                self.ticks_since = 1;
                if common.power < self.silence {
                    self.job = None;
                    return;
                }
                job.set_common(&self.bands, common);
            }
            None => {}
        }
        // The tick before a strike's second frame has everything else to fade out.
        let slices = if self.in_onset { self.ticks_to_next } else { self.ticks_to_next + 1 };
        let Some(memory) = self.waves.get_mut(job.wave.region) else { return };
        let spectrum = job.wave.of_mut(memory);
        job.advance(&mut self.bands, &mut self.waiting, spectrum, &mut self.noise, slices);
        self.job = Some(job);
    }

    fn begin_next(&mut self) {
        if core::mem::take(&mut self.in_onset) {
            self.fade_all();
            self.ticks_since = 0;
        }
        let Some(job) = self.job.take() else {
            // Below what can be heard: what still sounds fades out.
            self.bands.clear();
            return;
        };
        let (number, shape) = job.frame;
        let stream = job.stream(self.kept);
        if let Some(free) = self.streams.iter_mut().find(|stream| stream.is_none()) {
            *free = Some(stream);
        }
        self.ticks_to_next = stream.fade_out_at / TICK_FRAMES as u32;
        let next = (LARGEST.min(number + 1), if number == LARGEST { Shape::Steady } else { Shape::Growing });
        let wave = Wave { region: self.free_region(), first: 0, points_log2: ONSET_POINTS_LOG2 + next.0 as u32 };
        self.job = Some(Job::new(wave, next, When::After(shape), self.bands.count()));
    }

    /// What sounds fades out under a slope of its own: computed ahead, so that its memory is free.
    fn fade_all(&mut self) {
        let mut tail = [0.0; ONSET_FADE];
        self.add_streams(&mut tail);
        let step = SLOPE_STEPS / ONSET_FADE;
        let slope = SLOPE.iter().rev().step_by(step);
        for (tail, slope) in tail.iter_mut().zip(slope) {
            *tail *= slope;
        }
        (self.tail, self.tail_at, self.streams) = (tail, 0, [None; 3]);
    }
}

/// Random lines in a whole spectrum.
fn fill(spectrum: &mut [Complex], noise: &mut Sfc32) {
    let pairs = 1..spectrum.len() / 2;
    fourier::fill_middle(spectrum, lines(noise));
    fill_pairs(spectrum, pairs, noise);
}

fn fill_pairs(spectrum: &mut [Complex], pairs: core::ops::Range<usize>, noise: &mut Sfc32) {
    // A copy, which stays in registers.
    let mut local = *noise;
    fourier::fill_pairs(spectrum, pairs, || lines(&mut local));
    *noise = local;
}

/// Two lines' random parts.
#[inline(always)]
fn lines(noise: &mut Sfc32) -> [f32; 4] {
    noise.four().map(|part| part as f32)
}
