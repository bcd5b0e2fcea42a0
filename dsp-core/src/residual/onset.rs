//! The frame of a strike: noise that is ready before the strike comes.

use super::bands::{Band, Bands, Common, FRAME_TICKS, least};
use super::making::Making;
use super::stream::SLOPE_FRAMES;
use super::twiddles::{Complex, MAX_POINTS};
use crate::noise::Sfc32;
use crate::time::TICK_FRAMES;

/// The noise with which strikes at the reference force begin.
#[derive(Clone, Debug)]
pub(super) struct Onset {
    common: Common,
    /// Region in which the noise of the next strike stands.
    pub(super) region: usize,
    /// Shares of the amplitude that are left after a sample, without a hand and with one.
    pub(super) per_frame: [f32; 2],
    /// True if a strike has had the noise. Until there is new noise, the next strike has it from
    /// another place on.
    pub(super) is_used: bool,
}

impl Onset {
    pub(super) const NONE: Self = Self { common: Common::NONE, region: 0, per_frame: [1.0; 2], is_used: false };

    /// Derives the noise in place, with that of the first strike in `wave`, which is the stage's
    /// region 0.
    pub(super) fn load(&mut self, bands: &Bands<'_>, wave: &mut [Complex; MAX_POINTS], noise: &mut Sfc32) {
        let (mut power, mut left, mut lower) = (0.0, [0.0; 2], bands.lower());
        for band in bands.all() {
            let energy = band.strike * (band.upper - lower);
            let choked = least(band.per_eighth, bands.hand_eighth());
            power += energy;
            left = [left[0] + energy * band.per_eighth * band.per_eighth, left[1] + energy * choked * choked];
            lower = band.upper;
        }
        let common = Common::of(power, left, None);
        let per_tick = libm::pow(f64::from(common.quarter), 1.0 / 8.0);
        *self = Self {
            common: common.of_onset(energy_in_onset(per_tick) as f32),
            per_frame: common.per_frame(),
            ..Self::NONE
        };
        self.renewal(0, bands).advance(bands, wave, noise, u32::MAX);
    }

    /// Begins new noise for the next strike.
    pub(super) fn renewal(&self, region: usize, bands: &Bands<'_>) -> Making {
        Making::new(region, bands, &self.common)
    }

    /// Takes over new noise that has been made.
    pub(super) fn renew(&mut self, renewal: &Making) {
        (self.region, self.is_used) = (renewal.region, false);
    }
}

impl Band {
    /// Derives the energy in a strike's own frame at the reference force, per (cycle/sample).
    pub(super) fn with_onset(self, per_tick: f64) -> Self {
        Self { in_onset: (f64::from(self.strike) * energy_in_onset(per_tick)) as f32, ..self }
    }
}

/// Energy under a strike's own frame, in ticks, of which `per_tick` is left after each: until the
/// next frame fades in, and while it does.
fn energy_in_onset(per_tick: f64) -> f64 {
    const FADE_TICKS: u32 = SLOPE_FRAMES / TICK_FRAMES as u32;
    // Mean over a tick: (1 - p) / -ln p.
    let within = if per_tick < 0.9999 { (1.0 - per_tick) / -libm::log(per_tick.max(1e-30)) } else { 1.0 };
    let (mut sum, mut left) = (0.0, within);
    for tick in 0..FRAME_TICKS + FADE_TICKS {
        let into = (f64::from(tick) + 0.5 - f64::from(FRAME_TICKS)) / f64::from(FADE_TICKS);
        let cosine = libm::cos(core::f64::consts::FRAC_PI_2 * into.max(0.0));
        sum += left * cosine * cosine;
        left *= per_tick;
    }
    sum
}
