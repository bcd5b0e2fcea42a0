//! Bands: their energies, their decays, and what all of them share in a frame.

use super::edges::retreats;
use super::slope::SLOPE_FRAMES;
use crate::SampleRate;
use crate::exponential;
use crate::memory::{Memory, OutOfMemory, Region};
use crate::sine;
use crate::square_root::{exact_root, square_root};
use crate::table::{ResidualBand, range};
use crate::time::TICK_FRAMES;

/// Maximum number of bands of one stage.
pub const MAX_BANDS: usize = range::NOISE_BANDS;

/// One band. Densities are power per (cycle/sample).
#[derive(Clone, Copy, Debug)]
pub(super) struct Band {
    /// Upper edge in cycles/sample; the lower edge is the upper one of the band below.
    pub(super) upper: f32,
    /// Density right after a strike at the reference force.
    pub(super) strike: f32,
    /// Shares of the energy that are left after a tick and after an eighth of a frame.
    pub(super) per_tick: f32,
    pub(super) per_eighth: f32,
    /// Energy in a strike's own frame at the reference force, as density times ticks.
    pub(super) in_onset: f32,
    /// Density at the beginning of the last frame that the band was brought up to.
    pub(super) density: f32,
    /// Distances that the band keeps from its lower and its upper edge if nothing lies beyond, in
    /// cycles/sample.
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
/// Number of distances before the next frame, in eighths of a frame, at which energy of strikes
/// waits for it.
pub(super) const WAITING: usize = 7;

/// The time from the bands' last update to a frame's beginning.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passage {
    pub(super) ticks: u32,
    /// Ticks of this time, and of earlier ones that were predicted wrongly, in which a hand lies on
    /// the object; below 0 after a hand was expected in vain.
    pub(super) choked_ticks: f32,
    /// True if a hand is expected at the frame's beginning.
    pub(super) is_choked: bool,
    /// Energy of strikes, by its distance before the frame.
    pub(super) waiting: [f32; WAITING],
    /// True if the energy belongs before the frame that the bands stand for: from strikes that came
    /// too late for it.
    pub(super) is_late: bool,
}

impl Passage {
    /// From one frame to the next.
    pub(super) const NEXT: Self =
        Self { ticks: FRAME_TICKS, choked_ticks: 0.0, is_choked: false, waiting: [0.0; WAITING], is_late: false };

    /// True if a strike adds to the energies.
    pub(super) fn is_struck(&self) -> bool {
        self.waiting.iter().any(|&energy| energy > 0.0)
    }

    /// Adds a strike's energy `ticks` before the frame, shared between the two eighths beside that
    /// time: linear interpolation between two values of the exponential.
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

/// The values that all bands of a frame share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Common {
    /// Power at the frame's beginning.
    pub(super) power: f32,
    /// Share of the power that is left after a quarter of the frame.
    pub(super) quarter: f32,
    /// Shares of the power that are left after a quarter of the frame, without a hand and with one.
    quarters: [f32; 2],
    /// Largest share of its energy that a band keeps under the hand after an eighth of the frame; 1
    /// without a hand.
    pub(super) eighth: f32,
    /// Energy of the window under the common decay, times the zeroth, first and second power of the
    /// tilt (see [`Common::of`]).
    pub(super) moments: [f32; 3],
    /// True if the frame is a strike's own, which has no tilts: it may be read from any place on.
    pub(super) is_onset: bool,
}

impl Common {
    pub(super) const NONE: Self =
        Self { power: 0.0, quarter: 1.0, quarters: [1.0; 2], eighth: 1.0, moments: [1.0, 0.0, 0.0], is_onset: false };

    /// Derives the values from the power at a frame's beginning and from the power that is left
    /// after a quarter, without a hand and with one. `hand` is the share that the hand leaves after
    /// an eighth, if it lies there.
    ///
    /// The window's squares at the eighths of a frame are 0, 1/2, 1, 1, 1, 1, 1, 1/2; a tilt is
    /// `1 + c sin 2πt`, t from 0 to 1 over the frame.
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

    /// Turns the values into those of a strike's own frame, of which the window leaves an energy in
    /// ticks.
    pub(super) fn of_onset(self, energy_ticks: f32) -> Self {
        Self { moments: [energy_ticks, 0.0, 0.0], is_onset: true, ..self }
    }

    /// Energy of a band in the frame, per (cycle/sample), in the window's units.
    pub(super) fn energy_of(&self, band: &Band) -> f32 {
        if self.is_onset { band.in_onset } else { band.density * under_window(least(band.per_eighth, self.eighth)) }
    }

    /// Shares of the amplitude that are left after a sample, without a hand and with one.
    pub(super) fn per_frame(&self) -> [f32; 2] {
        // A quarter has 256 samples; the amplitude is the root of the power.
        let root = |quarter: f32| (0..9).fold(quarter, |share, _| exact_root(share)).min(1.0);
        let [free, choked] = self.quarters;
        let per_frame = root(free);
        [per_frame, if choked == free { per_frame } else { root(choked) }]
    }

    /// Share of the amplitude that is left at the frame's beginning after a hand lay there for
    /// `choked_ticks` more ticks than predicted, or fewer if negative.
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

/// Energy under a frame's window, in eighths of the frame, of a band of which `e` is left after
/// each eighth: by the trapezoidal rule.
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
    /// Largest shares of the energy that a hand leaves, after a tick and after an eighth of a
    /// frame.
    hand: [f32; 2],
}

impl<'m> Bands<'m> {
    /// A stage without bands.
    pub(super) const fn none() -> Self {
        Self { bands: &mut [], lower: 0.0, strike_power: 0.0, hand: [1.0; 2] }
    }

    /// Takes memory for `count` bands.
    pub(super) fn take(memory: &mut Memory<'m>, count: usize) -> Result<Self, OutOfMemory> {
        Ok(Self { bands: memory.take(Region::Bulk, count, || Band::NONE)?, ..Self::none() })
    }

    /// Derives the bands for a rate. Under a hand they fall by at least `hand_db_per_s`; 0 if the
    /// pad cannot be choked.
    pub(super) fn load(&mut self, laws: impl Iterator<Item = ResidualBand>, hand_db_per_s: f64, rate: SampleRate) {
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
            let strike = (power / (upper - lower).max(1e-9)) as f32;
            *band = Band {
                upper: upper as f32,
                strike,
                per_tick: per_tick as f32,
                per_eighth: exponential::power_of_two(bits * f64::from(EIGHTH_TICKS)) as f32,
                retreats: retreats([lower, upper], f64::from(law.decay_db_per_s) / rate.hz()),
                in_onset: (f64::from(strike) * energy_in_onset(per_tick)) as f32,
                ..Band::NONE
            };
            self.strike_power += power as f32;
        }
    }

    pub(super) fn count(&self) -> usize {
        self.bands.len()
    }

    /// Power right after a strike at the reference force.
    pub(super) fn strike_power(&self) -> f32 {
        self.strike_power
    }

    /// Largest share of the energy that a hand leaves after an eighth of a frame.
    pub(super) fn hand_eighth(&self) -> f32 {
        let [_, eighth] = self.hand;
        eighth
    }

    /// Lower edge of the lowest band, in cycles/sample.
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

    /// Brings the energies of some bands up to a frame's beginning. Gives their power there, and
    /// the power that is left after a quarter of the frame without a hand and with one; none of it
    /// unless `counts`.
    #[inline(never)]
    pub(super) fn advance(
        &mut self,
        bands: core::ops::Range<usize>,
        passage: &Passage,
        counts: bool,
    ) -> (f32, [f32; 2]) {
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
            if counts {
                let energy = band.density * (band.upper - lower);
                lower = band.upper;
                power += energy;
                left = [left[0] + energy * square, left[1] + energy * choked * choked];
            }
        }
        (power, left)
    }
}

/// Energy under a strike's own frame, in ticks, of which `per_tick` is left after each: until the
/// next frame fades in, and while it does.
pub(super) fn energy_in_onset(per_tick: f64) -> f64 {
    const FADE_TICKS: u32 = (SLOPE_FRAMES / TICK_FRAMES) as u32;
    // Mean over a tick: (1 - p) / -ln p.
    let within = if per_tick < 0.9999 { (1.0 - per_tick) / -libm::log(per_tick.max(1e-30)) } else { 1.0 };
    let (mut sum, mut left) = (0.0, within);
    for tick in 0..FRAME_TICKS + FADE_TICKS {
        let into = (f64::from(tick) + 0.5 - f64::from(FRAME_TICKS)) / f64::from(FADE_TICKS);
        let cosine = sine::cos(core::f64::consts::FRAC_PI_2 * into.max(0.0));
        sum += left * cosine * cosine;
        left *= per_tick;
    }
    sum
}

/// Smaller of two numbers, by a compare and a move: the library's function takes more.
#[inline(always)]
pub(super) fn least(x: f32, y: f32) -> f32 {
    if x < y { x } else { y }
}

/// Power of a share of energy for a number of ticks, which may have a fraction (interpolated
/// between whole ticks) or be negative.
#[inline(always)] // each band takes one in a frame
fn choke(per_tick: f32, ticks: f32) -> f32 {
    let size = ticks.abs();
    let whole = size as u32;
    let part = size - whole as f32;
    let left = power_of(per_tick, whole) * (1.0 - part + part * per_tick);
    // A band that has fallen so far does not come back.
    if ticks < 0.0 { 1.0 / left.max(1e-20) } else { left }
}

/// Density below which a band is silent, long before denormals.
const LEAST: f32 = 1e-24;

/// Mean share of energy, at least 1e-9.
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
