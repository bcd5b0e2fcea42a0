//! The bands: how much energy each has, how it decays, and what a frame needs of it.

use super::edges::retreats;
use super::square_root::{exact_root, square_root};
use crate::SampleRate;
use crate::exponential;
use crate::memory::{Lender, OutOfMemory, Region};
use crate::time::TICK_FRAMES;

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
pub(super) struct Band {
    /// Upper edge, cycles/sample; the lower one is the upper one of the band below.
    pub(super) upper: f32,
    /// Density at once after a strike at the reference force.
    pub(super) strike: f32,
    /// Share of the energy that is left after a tick, and after an eighth of a frame.
    pub(super) per_tick: f32,
    pub(super) per_eighth: f32,
    /// Energy in a strike's own frame at the reference force, per (cycle/sample): its density times ticks.
    pub(super) in_onset: f32,
    /// Density at the beginning of the last frame for which it was brought up to date.
    pub(super) density: f32,
    /// How far it keeps away from its lower and its upper edge where there is nothing beyond, cycles/sample.
    pub(super) retreats: [f32; 2],
}

impl Band {
    const NONE: Self = Self {
        upper: 0.0,
        strike: 0.0,
        per_tick: 0.0,
        per_eighth: 0.0,
        in_onset: 0.0,
        density: 0.0,
        retreats: [0.0; 2],
    };
}

/// Ticks of an eighth of a frame.
pub(super) const EIGHTH_TICKS: u32 = 4;
/// Ticks from one frame's beginning to the next one's: three quarters of a frame.
pub(super) const FRAME_TICKS: u32 = 6 * EIGHTH_TICKS;
/// Energy of strikes waits for the next frame by its distance from it, in eighths of a frame.
pub(super) const WAITING: usize = 7;

/// The way to a frame's beginning from the time for which the bands' energies stand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passage {
    pub(super) ticks: u32,
    /// Over how many of them, and of those that were reckoned wrongly before, a hand lies on the object; below 0 where it was expected in vain.
    pub(super) choked_ticks: f32,
    /// Whether the hand lies there at the frame's beginning, as far as is known.
    pub(super) is_choked: bool,
    /// Energy of strikes, by its distance before the frame.
    pub(super) waiting: [f32; WAITING],
    /// Whether it is that before the frame for whose beginning the energies stand: of strikes that came too late for it.
    pub(super) is_late: bool,
}

impl Passage {
    /// From one frame to the next.
    pub(super) const NEXT: Self =
        Self { ticks: FRAME_TICKS, choked_ticks: 0.0, is_choked: false, waiting: [0.0; WAITING], is_late: false };

    /// Whether a strike adds to the energies.
    pub(super) fn is_struck(&self) -> bool {
        self.waiting.iter().any(|&energy| energy > 0.0)
    }

    /// Adds a strike's energy so many ticks before the frame, shared between the two eighths beside that time: the line between two values of the
    /// exponential.
    pub(super) fn add(&mut self, energy: f32, ticks: f32) {
        let eighths = ticks / EIGHTH_TICKS as f32;
        let below = (eighths as usize).min(WAITING - 1);
        let part = eighths - below as f32;
        for (place, energy) in [(below, energy * (1.0 - part)), (below + 1, energy * part)] {
            if let Some(waiting) = self.waiting.get_mut(place) {
                *waiting += energy;
            }
        }
    }
}

/// What all bands of a frame share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Common {
    /// Power at the frame's beginning.
    pub(super) power: f32,
    /// Share of the power that is left after a quarter of the frame.
    pub(super) quarter: f32,
    /// The same without a hand and with one.
    quarters: [f32; 2],
    /// Share of the energy that the hand leaves of a band after an eighth of the frame, at most; 1 without one.
    pub(super) eighth: f32,
    /// Energy of the window under the common decay, times the zeroth, first and second power of the tilt: see [`Common::of`].
    pub(super) moments: [f32; 3],
    /// Whether the frame is a strike's own, which has no tilts: it may be read from anywhere.
    pub(super) is_onset: bool,
}

impl Common {
    pub(super) const NONE: Self =
        Self { power: 0.0, quarter: 1.0, quarters: [1.0; 2], eighth: 1.0, moments: [1.0, 0.0, 0.0], is_onset: false };

    /// Of a power at a frame's beginning, what is left of it after a quarter without a hand and with one, and what the hand leaves after an eighth, if it
    /// lies there.
    ///
    /// The window's squares at the eighths of a frame are 0, 1/2, 1, 1, 1, 1, 1, 1/2; a tilt is `1 + c sin 2πt`, t from 0 to 1 over the frame.
    pub(super) fn of(power: f32, left: [f32; 2], hand: Option<f32>) -> Self {
        let quarters = left.map(|left| mean(left, power));
        let [free, choked] = quarters;
        let quarter = if hand.is_some() { choked } else { free };
        let e = square_root(quarter);
        let (e2, e4) = (quarter, quarter * quarter);
        let (e3, e6) = (e * e2, e4 * e2);
        let (early, late) = (e * (1.0 + e2), e4 * e * (1.0 + e2));
        let first = core::f32::consts::FRAC_1_SQRT_2 * (0.5 * e + e3 - e4 * e - 0.5 * e6 * e) + e2 - e6;
        let second = 0.5 * (early - 0.5 * e + late - 0.5 * e6 * e) + e2 + e6;
        let moments = [under_window(e), first, second];
        Self { power, quarter, quarters, eighth: hand.unwrap_or(1.0), moments, is_onset: false }
    }

    /// The same for a strike's own frame, whose window leaves so much energy, in ticks.
    pub(super) fn of_onset(self, energy_ticks: f32) -> Self {
        Self { moments: [energy_ticks, 0.0, 0.0], is_onset: true, ..self }
    }

    /// Energy of a band in the frame, per (cycle/sample), in the window's units.
    pub(super) fn energy_of(&self, band: &Band) -> f32 {
        if self.is_onset { band.in_onset } else { band.density * under_window(least(band.per_eighth, self.eighth)) }
    }

    /// Share of the amplitude that is left after a sample, without a hand and with one.
    pub(super) fn per_frame(&self) -> [f32; 2] {
        // A quarter has 256 samples; the amplitude is the root of the power.
        let root = |quarter: f32| (0..9).fold(quarter, |share, _| exact_root(share)).min(1.0);
        let [free, choked] = self.quarters;
        let per_frame = root(free);
        [per_frame, if choked == free { per_frame } else { root(choked) }]
    }

    /// What of the amplitude is left at the frame's beginning where a hand lay there for so many ticks more than was reckoned with, or fewer.
    pub(super) fn kept(&self, choked_ticks: f32) -> f32 {
        let [free, choked] = self.quarters;
        if choked_ticks == 0.0 || choked >= free {
            return 1.0;
        }
        // A quarter has eight ticks.
        let per_tick = (0..3).fold(choked / free, |share, _| exact_root(share));
        square_root(choke(per_tick, choked_ticks))
    }
}

/// Energy under a frame's window, in eighths of the frame, of a band of which `e` is left after each: by the trapezoidal rule.
#[inline(always)]
fn under_window(e: f32) -> f32 {
    let square = e * e;
    let cube = square * e;
    e * ((1.0 + e + square) * (1.0 + cube) + 0.5 * (cube * cube - 1.0))
}

/// All bands of a stage.
#[derive(Debug)]
pub(super) struct Bands<'m> {
    bands: &'m mut [Band],
    lower: f32,
    /// Power of a strike at the reference force.
    strike_power: f32,
    /// Share of the energy that a hand leaves at most, after a tick and after an eighth of a frame.
    hand: [f32; 2],
}

impl<'m> Bands<'m> {
    /// No bands.
    pub(super) const fn none() -> Self {
        Self { bands: &mut [], lower: 0.0, strike_power: 0.0, hand: [1.0; 2] }
    }

    /// Takes memory for `count` bands.
    pub(super) fn take(lender: &mut impl Lender<'m>, count: usize) -> Result<Self, OutOfMemory> {
        Ok(Self { bands: lender.take(Region::Bulk, count, || Band::NONE)?, ..Self::none() })
    }

    /// Derives the bands for a rate. A choke makes them fall by at least `hand_db_per_s`, 0 where none can.
    pub(super) fn load(&mut self, laws: impl Iterator<Item = BandLaw>, hand_db_per_s: f64, rate: SampleRate) {
        (self.lower, self.strike_power) = (0.0, 0.0);
        let hand_bits = -hand_db_per_s * (TICK_FRAMES as f64 / rate.hz()) * (core::f64::consts::LOG2_10 / 10.0);
        self.hand = [1.0, f64::from(EIGHTH_TICKS)].map(|ticks| exponential::power_of_two(hand_bits * ticks) as f32);
        for (index, (law, band)) in laws.zip(&mut *self.bands).enumerate() {
            let [lower, upper] = law.edges_hz.map(|edge| f64::from(edge) / rate.hz());
            if index == 0 {
                self.lower = lower as f32;
            }
            let tick_s = TICK_FRAMES as f64 / rate.hz();
            let power = f64::from(law.weight) * f64::from(law.weight);
            let bits = -f64::from(law.decay_db_per_s) * tick_s * (core::f64::consts::LOG2_10 / 10.0);
            let per_tick = exponential::power_of_two(bits);
            *band = Band {
                upper: upper as f32,
                strike: (power / (upper - lower).max(1e-9)) as f32,
                per_tick: per_tick as f32,
                per_eighth: exponential::power_of_two(bits * f64::from(EIGHTH_TICKS)) as f32,
                retreats: retreats([lower, upper], f64::from(law.decay_db_per_s) / rate.hz()),
                ..Band::NONE
            }
            .with_onset(per_tick);
            self.strike_power += power as f32;
        }
    }

    pub(super) fn count(&self) -> usize {
        self.bands.len()
    }

    /// Power at once after a strike at the reference force.
    pub(super) fn strike_power(&self) -> f32 {
        self.strike_power
    }

    /// Share of the energy that a hand leaves at most after an eighth of a frame.
    pub(super) fn hand_eighth(&self) -> f32 {
        let [_, eighth] = self.hand;
        eighth
    }

    /// The lowest band's lower edge, cycles/sample.
    pub(super) fn lower(&self) -> f32 {
        self.lower
    }

    /// The bands, lowest first.
    pub(super) fn all(&self) -> &[Band] {
        self.bands
    }

    /// Forgets all energy.
    pub(super) fn clear(&mut self) {
        self.bands.iter_mut().for_each(|band| band.density = 0.0);
    }

    /// Brings the energies of some bands up to a frame's beginning; gives their power there, and what is left of it after a quarter of the frame
    /// without a hand and with one.
    #[inline(never)]
    pub(super) fn advance(&mut self, bands: core::ops::Range<usize>, passage: &Passage) -> (f32, [f32; 2]) {
        let below = bands.start.checked_sub(1).and_then(|below| self.bands.get(below));
        let mut lower = below.map_or(self.lower, |band| band.upper);
        let (mut power, mut left) = (0.0, [0.0; 2]);
        let [hand_tick, hand_eighth] = self.hand;
        let [e0, e1, e2, e3, e4, e5, e6] = passage.waiting;
        let is_next = passage.ticks == FRAME_TICKS;
        let is_struck = passage.is_struck();
        for band in self.bands.get_mut(bands).unwrap_or(&mut []) {
            let e = band.per_eighth;
            let square = e * e;
            let share = square * square * square;
            let mut density = band.density;
            let choked = least(e, hand_eighth);
            if passage.choked_ticks != 0.0 && density > 0.0 && choked < e {
                density *= choke(hand_tick / band.per_tick, passage.choked_ticks);
            }
            if is_next && !is_struck {
                density *= share;
            } else {
                let w = if passage.is_choked { choked } else { e };
                let waiting = e0 + w * (e1 + w * (e2 + w * (e3 + w * (e4 + w * (e5 + w * e6)))));
                let struck = band.strike * waiting;
                if passage.is_late {
                    density = (density + struck) * share;
                } else {
                    if density > 0.0 {
                        density *= power_of(band.per_tick, passage.ticks);
                    }
                    density += struck;
                }
            }
            band.density = if density > LEAST { density } else { 0.0 };
            let energy = band.density * (band.upper - lower);
            lower = band.upper;
            power += energy;
            left = [left[0] + energy * square, left[1] + energy * choked * choked];
        }
        (power, left)
    }
}

/// The smaller one: in a compare and a move, which the library's is not.
#[inline(always)]
pub(super) fn least(x: f32, y: f32) -> f32 {
    if x < y { x } else { y }
}

/// A share of energy to the power of a number of ticks, which may have a fraction (on a line between whole ones) or be below 0.
fn choke(per_tick: f32, ticks: f32) -> f32 {
    let size = ticks.abs();
    let whole = size as u32;
    let part = size - whole as f32;
    let left = power_of(per_tick, whole) * (1.0 - part + part * per_tick);
    // What has fallen so far comes back no more.
    if ticks < 0.0 { 1.0 / left.max(1e-20) } else { left }
}

/// Density that is no sound, long before denormals.
const LEAST: f32 = 1e-24;

/// A share of energy on average over so much of it; never 0.
fn mean(left: f32, of: f32) -> f32 {
    let mean = if of > 0.0 { left / of } else { 1.0 };
    if mean > 1.0 {
        1.0
    } else if mean > 1e-9 {
        mean
    } else {
        1e-9
    }
}

/// `base^exponent` by squaring.
pub(super) fn power_of(base: f32, exponent: u32) -> f32 {
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
