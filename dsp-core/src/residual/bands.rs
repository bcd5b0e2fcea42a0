//! The bands: how much energy each has, how it decays, and what spectrum a frame needs for it.

use super::fourier::Complex;
use super::square_root::square_root;
use crate::SampleRate;
use crate::exponential;
use crate::noise::DEVIATION;
use crate::resonator::TICK_FRAMES;

/// Bands that one stage may have.
pub const MAX_BANDS: usize = 100;

/// A band of noise as the table gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandLaw {
    /// Lower and upper edge in Hz.
    pub edges_hz: [f32; 2],
    /// Rms w at t = 0 (1.0 = full scale) of a strike whose peak force is the reference force.
    pub weight: f32,
    /// Decay γ in dB/s.
    pub decay_db_per_s: f32,
}

/// One band. Densities are power per (cycle/sample).
#[derive(Clone, Copy, Debug)]
struct Band {
    /// Upper edge, cycles/sample; the lower one is the upper one of the band below.
    upper: f32,
    width: f32,
    /// Density at once after a strike at the reference force.
    strike: f32,
    /// Share of the energy that is left after a tick.
    per_tick: f32,
    /// Density at the time for which the energies stand.
    density: f32,
    /// Density at the beginning of the last frame that was readied, and what is left after a quarter of that frame.
    next: f32,
    quarter: f32,
    /// Density in the frame that is being computed.
    frame: f32,
}

impl Band {
    const NONE: Self =
        Self { upper: 0.0, width: 0.0, strike: 0.0, per_tick: 0.0, density: 0.0, next: 0.0, quarter: 1.0, frame: 0.0 };
}

/// What a frame's window does to energy that decays meanwhile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// At once there, constant for eight ticks, out over two.
    Onset,
    /// In over a quarter of the wave, constant for three, out over two: the next wave is twice as long.
    Growing,
    /// In over a quarter of the wave, constant for two, out over one.
    Steady,
}

impl Shape {
    /// Energy under the window, in quarters of the wave, of a band of which `q` is left after each: by the trapezoidal rule.
    #[inline(always)]
    fn energy(self, q: f32) -> f32 {
        match self {
            Self::Onset => (0..8).fold(1.0 + 0.5 * q, |sum, _| 1.0 + q * sum) - 0.5,
            Self::Growing => q * (1.0 + q * (1.0 + q * (1.0 + q * (1.0 + q * 0.5)))),
            Self::Steady => q * (1.0 + q * (1.0 + q)),
        }
    }
}

/// When a frame begins, with respect to the time for which the bands' energies stand.
#[derive(Clone, Copy, Debug)]
pub(super) enum When {
    /// The first one that carries all after a strike: so many ticks after that time; from then on they stand for its beginning.
    AfterStrike(u32),
    /// After the one readied last, of that shape; from then on they stand for that one's beginning.
    After(Shape),
}

/// A frame's common part: energy and decay that all bands share as far as one number can say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Common {
    /// Power of the whole frame.
    pub(super) power: f32,
    /// Amplitude at the frame's beginning, for power 1 on average under the window.
    pub(super) gain: f32,
    /// Share of the amplitude that is left after a sample.
    pub(super) per_frame: f32,
}

/// Distances in ticks at which energy of strikes may wait for the next frame.
pub(super) const WAITING: usize = 9;

/// All bands of a stage.
#[derive(Clone, Debug)]
pub(super) struct Bands {
    bands: [Band; MAX_BANDS],
    count: usize,
    lower: f32,
    /// Power of a strike at the reference force.
    strike_power: f32,
}

impl Bands {
    pub(super) const NONE: Self = Self { bands: [Band::NONE; MAX_BANDS], count: 0, lower: 0.0, strike_power: 0.0 };

    /// Derives the bands for a rate; those beyond `MAX_BANDS` and those that have no width are left out.
    pub(super) fn new(laws: impl Iterator<Item = BandLaw>, rate: SampleRate) -> Self {
        let mut new = Self::NONE;
        for (law, band) in laws.zip(&mut new.bands) {
            let [lower, upper] = law.edges_hz.map(|edge| f64::from(edge) / rate.hz());
            if new.count == 0 {
                new.lower = lower as f32;
            }
            let tick_s = TICK_FRAMES as f64 / rate.hz();
            let power = f64::from(law.weight) * f64::from(law.weight);
            let bits = -f64::from(law.decay_db_per_s) * tick_s * (core::f64::consts::LOG2_10 / 10.0);
            *band = Band {
                upper: upper as f32,
                width: (upper - lower) as f32,
                strike: (power / (upper - lower).max(1e-9)) as f32,
                per_tick: exponential::power_of_two(bits) as f32,
                ..Band::NONE
            };
            new.count += 1;
            new.strike_power += power as f32;
        }
        new
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Power at once after a strike at the reference force.
    pub(super) fn strike_power(&self) -> f32 {
        self.strike_power
    }

    fn iter_mut(&mut self) -> impl Iterator<Item = &mut Band> {
        self.bands.iter_mut().take(self.count)
    }

    /// Forgets all energy.
    pub(super) fn clear(&mut self) {
        self.iter_mut().for_each(|band| (band.density, band.next) = (0.0, 0.0));
    }

    /// Readies a strike's own frame: the spectrum of a strike at the reference force.
    pub(super) fn ready_onset(&mut self) -> Common {
        let common = self.common(|band| band.strike, Shape::Onset, 0);
        let scale = common.gain * common.gain;
        self.iter_mut().for_each(|band| band.frame = band.strike * Shape::Onset.energy(band.per_tick) * scale);
        common
    }

    /// Brings the energies of some bands up to date for the frame after a strike: `ticks` after the time for which they stand, of which `kept` is the
    /// share that chokes have left. With [`add_waiting`](Self::add_waiting) they then stand for that frame's beginning. Gives how many still had energy.
    #[inline(never)]
    pub(super) fn update(&mut self, bands: core::ops::Range<usize>, ticks: u32, kept: f32) -> usize {
        let mut sounding = 0;
        for band in self.bands.get_mut(bands).unwrap_or(&mut []) {
            (band.next, band.quarter) = (0.0, band.per_tick * band.per_tick);
            if band.density > 0.0 {
                band.next = band.density * kept * power_of(band.per_tick, ticks);
                sounding += 1;
            }
        }
        sounding
    }

    /// Adds the energy of strikes, by their distance in ticks before the time for which the energies will stand next.
    #[inline(never)]
    pub(super) fn add_waiting(&mut self, waiting: &[f32; WAITING]) {
        let [e0, e1, e2, e3, e4, e5, e6, e7, e8] = *waiting;
        for band in self.iter_mut() {
            let tick = band.per_tick;
            let late = e4 + tick * (e5 + tick * (e6 + tick * (e7 + tick * e8)));
            let polynomial = e0 + tick * (e1 + tick * (e2 + tick * (e3 + tick * late)));
            band.next += band.strike * polynomial;
        }
    }

    /// Readies the frame of a number and shape. `after` is the shape of the frame readied last, whose beginning is then the time for which the energies
    /// stand; `None` for the first frame after a strike.
    #[inline(never)]
    pub(super) fn ready(&mut self, after: Option<Shape>, (number, shape): (usize, Shape)) -> Common {
        let (power, left) = match (after, shape) {
            (None, _) => self.ready_frame(|band| (band.density, band.quarter), Shape::Growing),
            (_, Shape::Growing | Shape::Onset) => self.ready_frame(grow, Shape::Growing),
            (Some(Shape::Steady), Shape::Steady) => self.ready_frame(stay, Shape::Steady),
            (_, Shape::Steady) => self.ready_frame(settle, Shape::Steady),
        };
        let common = Common::of(power, mean(left, power), shape, number);
        let scale = common.gain * common.gain;
        self.iter_mut().for_each(|band| band.frame *= scale);
        common
    }

    /// Readies every band for a frame, at the beginning of which `step` gives its density and what is left after a quarter of the frame; gives the power
    /// and what is left of it after a quarter.
    #[inline(always)]
    fn ready_frame(&mut self, step: impl Fn(&Band) -> (f32, f32), shape: Shape) -> (f32, f32) {
        let (mut power, mut left) = (0.0, 0.0);
        for band in self.bands.iter_mut().take(self.count) {
            band.density = if band.next > LEAST { band.next } else { 0.0 };
            let (next, quarter) = step(band);
            (band.next, band.quarter) = (next, quarter);
            let energy = next * band.width;
            power += energy;
            left += energy * quarter;
            band.frame = next * shape.energy(quarter);
        }
        (power, left)
    }

    fn common(&self, density: impl Fn(&Band) -> f32, shape: Shape, number: usize) -> Common {
        let (mut power, mut left) = (0.0, 0.0);
        for band in self.bands.iter().take(self.count) {
            let energy = density(band) * band.width;
            power += energy;
            left += energy * band.per_tick;
        }
        Common::of(power, mean(left, power), shape, number)
    }

    /// The amplitudes of a spectrum's lines (of a wave twice as long), in the real parts, from where `cursor` stands until they have cost about so many
    /// cycles: the bands' powers, shared among the lines by how much of a line's width is in the band. Gives the cycles.
    #[inline(never)]
    pub(super) fn fill_amplitudes(&self, spectrum: &mut [Complex], cursor: &mut Cursor, cycles: u32) -> u32 {
        let lines_per_cycle = 2.0 * spectrum.len() as f32;
        let line = 1.0 / lines_per_cycle;
        let Cursor { mut line_index, band: mut band_index, mut place } = *cursor;
        let Some(lines) = spectrum.get_mut(line_index..) else { return 0 };
        let mut lines = lines.iter_mut();
        let mut bands = self.bands.get(band_index..self.count).unwrap_or(&[]).iter();
        let (mut band, mut spent) = (bands.next(), 0);
        while spent < cycles
            && let Some(at_edge) = lines.next()
        {
            spent += LINE_CYCLES;
            let end = (line_index as f32 + 0.5) * line;
            line_index += 1;
            let mut power = 0.0;
            while let Some(inside) = band.filter(|band| band.upper <= end) {
                power += inside.frame * positive(inside.upper - place);
                place = if inside.upper > place { inside.upper } else { place };
                band_index += 1;
                band = bands.next();
                spent += EDGE_CYCLES;
            }
            if let Some(inside) = band {
                power += inside.frame * positive(end - place);
            }
            at_edge[0] = amplitude(power);
            if place > end {
                continue;
            }
            place = end;
            // Lines that a band, or nothing, fills are all alike.
            let (alike, inside) = match band {
                Some(band) => ((band.upper * lines_per_cycle + 0.5) as usize, band.frame),
                None => (usize::MAX, 0.0),
            };
            let alike = alike.saturating_sub(line_index).min(lines.len());
            if alike > 0 {
                let amplitude = amplitude(inside * line);
                lines.by_ref().take(alike).for_each(|line| line[0] = amplitude);
                line_index += alike;
                place = (line_index as f32 - 0.5) * line;
                spent += alike as u32 * ALIKE_CYCLES;
            }
        }
        *cursor = Cursor { line_index, band: band_index, place };
        spent
    }

    /// Where [`fill_amplitudes`](Self::fill_amplitudes) begins.
    pub(super) fn lowest(&self) -> Cursor {
        Cursor { line_index: 0, band: 0, place: self.lower }
    }
}

/// Of a line's power its amplitude in units of the noise; half the root, because a line beside its mirror image has 4 times the power of
/// each of its two parts.
#[inline(always)]
fn amplitude(power: f32) -> f32 {
    const SCALE: f32 = (0.5 / DEVIATION) as f32;
    square_root(power) * SCALE
}

/// How far the lines have come through the bands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor {
    line_index: usize,
    band: usize,
    /// Cycles/sample.
    place: f32,
}

impl Common {
    fn of(power: f32, quarter: f32, shape: Shape, number: usize) -> Self {
        // A quarter of the wave of that number has 32 · 2^number samples; the amplitude is the root of the energy.
        let mut per_frame = square_root(quarter);
        for _ in 0..5 + number {
            per_frame = square_root(per_frame);
        }
        Self { power, gain: 1.0 / square_root(shape.energy(quarter)), per_frame: per_frame.min(1.0) }
    }
}

impl Cursor {
    /// Lines that are behind.
    pub(super) fn lines(&self) -> usize {
        self.line_index
    }
}

/// Cycles of a line with an edge, of the edge, and of a line inside a band; measured on the virtual core.
const LINE_CYCLES: u32 = 75;
const EDGE_CYCLES: u32 = 60;
const ALIKE_CYCLES: u32 = 7;

/// Cycles of all lines of a spectrum of so many, with so many bands.
pub(super) fn amplitude_cycles(lines: usize, bands: usize) -> u32 {
    let edges = bands.min(lines) as u32;
    bands as u32 * EDGE_CYCLES + edges * LINE_CYCLES + (lines as u32 - edges) * ALIKE_CYCLES
}

#[inline(always)]
fn positive(x: f32) -> f32 {
    if x > 0.0 { x } else { 0.0 }
}

/// Density that is no sound, long before denormals.
const LEAST: f32 = 1e-24;

/// Past a growing frame, to one twice as long.
#[inline(always)]
fn grow(band: &Band) -> (f32, f32) {
    let square = band.quarter * band.quarter;
    (band.density * (square * square), square)
}

/// Past a growing frame, to one as long.
#[inline(always)]
fn settle(band: &Band) -> (f32, f32) {
    let square = band.quarter * band.quarter;
    (band.density * (square * square), band.quarter)
}

/// Past a steady frame.
#[inline(always)]
fn stay(band: &Band) -> (f32, f32) {
    (band.density * (band.quarter * band.quarter * band.quarter), band.quarter)
}

/// A share of energy on average over so much of it; never 0.
fn mean(left: f32, of: f32) -> f32 {
    let mean = if of > 0.0 { left / of } else { 1.0 };
    if mean > 1e-9 { mean } else { 1e-9 }
}

/// `base^exponent` by squaring.
fn power_of(base: f32, exponent: u32) -> f32 {
    let (mut square, mut rest, mut power) = (base, exponent, 1.0);
    while rest > 0 {
        if rest & 1 == 1 {
            power *= square;
        }
        square *= square;
        rest >>= 1;
    }
    power
}
