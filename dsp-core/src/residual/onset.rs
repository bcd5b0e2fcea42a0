//! The frame of a strike: noise that is ready before the strike comes.

use super::bands::{Bands, Common, energy_in_onset, least};
use super::making::Making;
use crate::exponential;
use crate::fourier::{Complex, MAX_POINTS};
use crate::noise::Sfc32;

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
        let per_tick = exponential::power(f64::from(common.quarter), 1.0 / 8.0);
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
