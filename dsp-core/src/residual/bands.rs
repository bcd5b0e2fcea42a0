//! The bands: how much energy each has, how it decays, and what spectrum a frame needs for it.

use super::fourier::Complex;
use super::square_root::square_root;
use crate::SampleRate;
use crate::exponential;
use crate::noise::PAIR_DEVIATION;
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
    /// Density now.
    density: f32,
    /// Density in the frame that is being computed.
    frame: f32,
}

impl Band {
    const NONE: Self = Self { upper: 0.0, width: 0.0, strike: 0.0, per_tick: 0.0, density: 0.0, frame: 0.0 };
}

/// What a frame's window does to energy that decays meanwhile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// At once there, constant for four ticks, out over two.
    Onset,
    /// In over a quarter of the wave, constant for half of it, out over another half.
    Growing,
    /// In over half of the wave and out over the other.
    Steady,
}

impl Shape {
    /// Energy under the window, in quarters of the wave, of a band of which `q` is left after each: by the trapezoidal rule.
    #[inline(always)]
    fn energy(self, q: f32) -> f32 {
        match self {
            Self::Onset => 0.5 + q * (1.0 + q * (1.0 + q * (1.0 + q * (1.0 + q * 0.5)))),
            Self::Growing => q * (1.0 + q * (1.0 + q * (1.0 + q * 0.5))),
            Self::Steady => q * (0.5 + q * (1.0 + q * 0.5)),
        }
    }
}

/// When a frame begins, with respect to the time for which the bands' energies stand.
#[derive(Clone, Copy, Debug)]
pub(super) enum When {
    /// The first one that carries all after a strike: so many ticks after that time; from then on they stand for its beginning.
    AfterStrike(u32),
    /// After a frame of that number (0: 64 points, 3: 512) and shape, which began `since` ticks after the time; from then on they stand for its
    /// beginning.
    After { since: Option<(usize, Shape)>, frame: (usize, Shape) },
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
pub(super) const WAITING: usize = 6;

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
        self.iter_mut().for_each(|band| band.density = 0.0);
    }

    /// Readies a strike's own frame: the spectrum of a strike at the reference force.
    pub(super) fn ready_onset(&mut self) -> Common {
        let common = self.common(|band| band.strike, Shape::Onset, 0);
        let scale = common.gain * common.gain;
        self.iter_mut().for_each(|band| band.frame = band.strike * Shape::Onset.energy(band.per_tick) * scale);
        common
    }

    /// Brings all energies up to date, adds that of `waiting` strikes (by their distance in ticks before the time for which energies then stand), and
    /// readies the frame of a number and shape. `kept` is the share of the old energy that chokes have left.
    #[inline(never)]
    pub(super) fn ready(&mut self, when: When, frame: (usize, Shape), waiting: &[f32; WAITING], kept: f32) -> Common {
        let is_waiting = waiting.iter().any(|&energy| energy > 0.0);
        let (mut power, mut left, mut total) = (0.0, 0.0, 0.0);
        for band in self.bands.iter_mut().take(self.count) {
            let tick = band.per_tick;
            let mut density = band.density;
            let squares = squares(tick);
            if let When::AfterStrike(ticks) = when {
                density *= kept * power_of(tick, ticks);
            }
            if is_waiting {
                // Not a fold: the coefficients stay in registers.
                let [e0, e1, e2, e3, e4, e5] = *waiting;
                let polynomial = e0 + tick * (e1 + tick * (e2 + tick * (e3 + tick * (e4 + tick * e5))));
                density += band.strike * polynomial;
            }
            let mut ahead = 1.0;
            if let When::After { since, frame } = when {
                if let Some(since) = since {
                    density *= duration(&squares, since);
                }
                ahead = duration(&squares, frame);
            }
            // Far below what can be heard, and before denormals.
            band.density = if density > 1e-24 { density.min(1e24) } else { 0.0 };
            let begins = band.density * ahead;
            let energy = begins * band.width;
            power += energy;
            let quarter = squares.get(frame.0).copied().unwrap_or(1.0);
            let shaped = frame.1.energy(quarter);
            left += energy * quarter;
            total += energy;
            band.frame = begins * shaped;
        }
        let mean = if total > 0.0 { (left / total).clamp(1e-9, 1.0) } else { 1.0 };
        let common = Common::of(power, mean, frame.1, frame.0);
        let scale = common.gain * common.gain;
        self.iter_mut().for_each(|band| band.frame *= scale);
        common
    }

    fn common(&self, density: impl Fn(&Band) -> f32, shape: Shape, number: usize) -> Common {
        let (mut power, mut left) = (0.0, 0.0);
        for band in self.bands.iter().take(self.count) {
            let energy = density(band) * band.width;
            power += energy;
            left += energy * band.per_tick;
        }
        let mean = if power > 0.0 { (left / power).clamp(1e-9, 1.0) } else { 1.0 };
        Common::of(power, mean, shape, number)
    }

    /// The amplitude of every line of a spectrum of so many lines (of a wave twice as long), in the real parts: the band's powers, shared among
    /// the lines by how much of a line's width is in the band. Lines `from` to `to`.
    pub(super) fn fill_amplitudes(&self, spectrum: &mut [Complex], from: usize, to: usize, cursor: &mut Cursor) {
        let line = 0.5 / spectrum.len().max(1) as f32;
        let mut bands = self.bands.iter().take(self.count).skip(cursor.band);
        let mut band = bands.next();
        for (index, amplitude) in spectrum.iter_mut().enumerate().take(to).skip(from) {
            let end = (index as f32 + 0.5) * line;
            let mut power = 0.0;
            while let Some(inside) = band.filter(|band| band.upper <= end) {
                power += inside.frame * positive(inside.upper - cursor.place);
                cursor.place = if inside.upper > cursor.place { inside.upper } else { cursor.place };
                cursor.band += 1;
                band = bands.next();
            }
            if let Some(inside) = band.filter(|_| end > cursor.place) {
                power += inside.frame * (end - cursor.place);
                cursor.place = end;
            }
            // Half the root: a line beside its mirror image has 4 times the power of each of its two parts.
            amplitude[0] = square_root(power) * LINE_SCALE;
        }
    }

    /// Where [`fill_amplitudes`](Self::fill_amplitudes) begins.
    pub(super) fn lowest(&self) -> Cursor {
        Cursor { band: 0, place: self.lower }
    }
}

const LINE_SCALE: f32 = (0.5 / PAIR_DEVIATION) as f32;

/// How far the lines have come through the bands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor {
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

#[inline(always)]
fn positive(x: f32) -> f32 {
    if x > 0.0 { x } else { 0.0 }
}

/// What is left after a quarter of each wave: 1, 2, 4 and 8 ticks.
#[inline(always)]
fn squares(tick: f32) -> [f32; 4] {
    let (two, four) = (tick * tick, (tick * tick) * (tick * tick));
    [tick, two, four, four * four]
}

/// What is left after the time from a frame's beginning to the next one's.
#[inline(always)]
fn duration(squares: &[f32; 4], (number, shape): (usize, Shape)) -> f32 {
    let quarter = squares.get(number).copied().unwrap_or(1.0);
    match shape {
        Shape::Onset => (quarter * quarter) * (quarter * quarter),
        Shape::Growing => quarter * quarter * quarter,
        Shape::Steady => quarter * quarter,
    }
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
