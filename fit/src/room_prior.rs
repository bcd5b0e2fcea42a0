//! The room that diffimpact's optimiser learns, as bands that a table holds.
//!
//! There (§3.4, eq. 19) the room's response is `IR_e(t) = g_eᵀ [exp(-d_e t) ∘ filt(N(t), B_e)]`: white noise through B_e bands of equal width up to half the rate,
//! each with a gain and a decay that raw values x of the optimiser set:
//!
//! ```text
//! g = 2 sigmoid(x + b_gain)^ln 10 + 1e-7     (eq. 20)
//! d = 2 + exp(x + b_decay)                   (eq. 22)
//! ```
//!
//! Theirs is a gain a sample, ours a power a second. An impulse's answer holds in a band `Σ g² σ² e^{-2dn/fs} = g² σ² fs / 2d` of the energy that the band was
//! given, where σ is the noise's rms and fs the rate of the response; a table's band holds `gain²/2d` (docs/kit-format.md, `[[room]]`). So
//!
//! ```text
//! gain = g σ √fs  in 1/√s
//! ```
//!
//! What lies in the band of noise before `filt` and after it has the same density, so the width of a band does not matter.

use dsp_core::table::range::{ROOM_DECAY_PER_S, ROOM_GAIN, Range};
use kit::RoomBand;

/// Hyperparameters of eq. 19 to 22.
///
/// The paper prints none of them and points to its released code (appendix F). The default is what is known of that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scalings {
    /// b_gain of eq. 20; finite. Default -4, as published evaluations that run the paper's reverb set it (`gain_initial_bias`).
    pub gain_bias: f64,
    /// b_decay of eq. 22; finite. Default 4, as in the paper's released notebook (`decay_initial_bias`).
    pub decay_bias: f64,
    /// Rms σ of the noise N(t), 0.001 to 1000. Default 1/√3: noise even between -1 and 1, as in DDSP, on which the paper's modules are built. Read as normal noise, as
    /// the letter N may be, it is 1: 4.8 dB more.
    pub noise_rms: f64,
    /// What the t of eq. 19 counts in, seconds, 0.001 to 1000: a decay of 1 is one of 1/`time_unit_s` per second. Default 1. Where t runs from 0 to 1 over the response, as in
    /// DDSP's exponential reverb, it is the response's length: samples over rate.
    pub time_unit_s: f64,
}

impl Default for Scalings {
    fn default() -> Self {
        Self { gain_bias: -4.0, decay_bias: 4.0, noise_rms: 3f64.sqrt().recip(), time_unit_s: 1.0 }
    }
}

/// Why raw values are no room: what, where, and what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ScalingsError {
    /// Gains and decays do not belong together.
    #[error("{gains} raw gains and {decays} raw decays: give one of each for each band")]
    Lengths {
        /// Raw gains given.
        gains: usize,
        /// Raw decays given.
        decays: usize,
    },
    /// No band, or too many.
    #[error("{found} bands: give 1 to {MOST_BANDS}")]
    Bands {
        /// Bands given.
        found: usize,
    },
    /// A value that is no number.
    #[error("raw {what} of band {band} (counted from 0) is {value}: must be finite")]
    NotFinite {
        /// "gain" or "decay".
        what: &'static str,
        /// Which band.
        band: usize,
        /// What was given.
        value: f64,
    },
    /// A rate that cannot be.
    #[error("the response's rate is {rate_hz} Hz: must be from 4000 to 768000")]
    Rate {
        /// What was given.
        rate_hz: f64,
    },
    /// A hyperparameter that cannot be.
    #[error("{name} = {value}: must be {must}")]
    Setting {
        /// Field of [`Scalings`].
        name: &'static str,
        /// What was given.
        value: f64,
        /// What it may be.
        must: &'static str,
    },
}

/// Most bands that are taken in.
pub const MOST_BANDS: usize = 256;
/// Most bands of a table's room.
pub const MOST_ROOM_BANDS: usize = dsp_core::room::MAX_BANDS;
/// Bands that begin here or higher are left out, Hz: any rate of 44.1 kHz and more plays what is left.
const HIGHEST_HZ: f64 = 20_000.0;

/// [`Scalings::room`] with the default hyperparameters.
///
/// # Errors
/// As there.
pub fn room_of_scalings(raw_gain: &[f64], raw_decay: &[f64], rate_hz: f64) -> Result<Vec<RoomBand>, ScalingsError> {
    Scalings::default().room(raw_gain, raw_decay, rate_hz)
}

impl Scalings {
    /// g_e of a raw value (eq. 20), for noise of rms [`Self::noise_rms`]: 1e-7 to 2.
    pub fn gain(&self, raw: f64) -> f64 {
        let sigmoid = (1.0 + (-(raw + self.gain_bias)).exp()).recip();
        2.0 * sigmoid.powf(std::f64::consts::LN_10) + 1e-7
    }

    /// d_e of a raw value (eq. 22), per [`Self::time_unit_s`]: 2 and more.
    pub fn decay(&self, raw: f64) -> f64 {
        2.0 + (raw + self.decay_bias).exp()
    }

    /// The bands of a table's `[[room]]` out of raw values, one gain and one decay for each of 1 to [`MOST_BANDS`] bands of equal width from 0 Hz to half of
    /// `rate_hz`. That is the rate of the response (4 to 768 kHz), in the paper twice that of the sound (appendix C.2).
    ///
    /// Bands that begin at 20 kHz or above are left out. More than eight become eight: again and again those two neighbours become one whose becoming one costs
    /// least, in the squared error of the power laws `gain² e^{-2dt}` over time and frequency. So the loud bands, which hold the room's energy, stay apart
    /// where they differ. A joint band has the initial power and the energy of its parts (their means over frequency), hence as decay their mean weighted by energy.
    ///
    /// Decays are then held within 0.3 to 150 1/s, the energy kept, and gains within 0 to 100 1/√s, what a kit accepts.
    ///
    /// # Errors
    /// [`ScalingsError`] for lengths that differ, no or too many bands, values that are not finite, a rate or a hyperparameter out of range.
    pub fn room(&self, raw_gain: &[f64], raw_decay: &[f64], rate_hz: f64) -> Result<Vec<RoomBand>, ScalingsError> {
        self.check(raw_gain, raw_decay, rate_hz)?;
        let width_hz = 0.5 * rate_hz / raw_gain.len() as f64;
        let laws = raw_gain.iter().zip(raw_decay).enumerate().map(|(band, (&gain, &decay))| {
            let gain = self.gain(gain) * self.noise_rms * rate_hz.sqrt();
            Law {
                from_hz: band as f64 * width_hz,
                power_per_s: gain * gain,
                decay_per_s: self.decay(decay) / self.time_unit_s,
            }
        });
        let mut groups: Vec<Vec<Law>> = laws.take_while(|law| law.from_hz < HIGHEST_HZ).map(|law| vec![law]).collect();
        while groups.len() > MOST_ROOM_BANDS {
            join_cheapest(&mut groups);
        }
        Ok(groups.iter().filter_map(|group| joint(group)).map(|law| law.band()).collect())
    }

    fn check(&self, raw_gain: &[f64], raw_decay: &[f64], rate_hz: f64) -> Result<(), ScalingsError> {
        let (gains, decays) = (raw_gain.len(), raw_decay.len());
        if gains != decays {
            return Err(ScalingsError::Lengths { gains, decays });
        }
        if !(1..=MOST_BANDS).contains(&gains) {
            return Err(ScalingsError::Bands { found: gains });
        }
        if !(4_000.0..=768_000.0).contains(&rate_hz) {
            return Err(ScalingsError::Rate { rate_hz });
        }
        for (name, value) in [("gain_bias", self.gain_bias), ("decay_bias", self.decay_bias)] {
            if !value.is_finite() {
                return Err(ScalingsError::Setting { name, value, must: "finite" });
            }
        }
        for (name, value) in [("noise_rms", self.noise_rms), ("time_unit_s", self.time_unit_s)] {
            if !(1e-3..=1e3).contains(&value) {
                return Err(ScalingsError::Setting { name, value, must: "from 0.001 to 1000" });
            }
        }
        for (what, raw) in [("gain", raw_gain), ("decay", raw_decay)] {
            if let Some((band, &value)) = raw.iter().enumerate().find(|(_, value)| !value.is_finite()) {
                return Err(ScalingsError::NotFinite { what, band, value });
            }
        }
        Ok(())
    }
}

/// A band's power `power_per_s e^{-2 decay_per_s t}`, of what it is given; the decay may be infinite, and is then silence.
#[derive(Clone, Copy)]
struct Law {
    from_hz: f64,
    power_per_s: f64,
    decay_per_s: f64,
}

impl Law {
    fn energy(&self) -> f64 {
        self.power_per_s / (2.0 * self.decay_per_s)
    }

    /// `∫ (p e^{-2at} - q e^{-2bt})² dt = p²/4a - pq/(a + b) + q²/4b`.
    fn squared_error(&self, other: &Self) -> f64 {
        let (p, a, q, b) = (self.power_per_s, self.decay_per_s, other.power_per_s, other.decay_per_s);
        p * p / (4.0 * a) - p * q / (a + b) + q * q / (4.0 * b)
    }

    /// Within what the format accepts: a decay at an end of its range keeps the energy, as far as the gain's range goes.
    fn band(&self) -> RoomBand {
        let within = |value: f64, range: Range| value.clamp(range.min.into(), range.max.into());
        let decay_per_s = within(self.decay_per_s, ROOM_DECAY_PER_S);
        let gain = within((2.0 * decay_per_s * self.energy()).sqrt(), ROOM_GAIN);
        RoomBand { from_hz: self.from_hz as f32, gain: gain as f32, decay_per_s: decay_per_s as f32 }
    }
}

/// One law with the power and the energy of a group of equally wide neighbours.
fn joint(group: &[Law]) -> Option<Law> {
    let first = group.first()?;
    if group.len() == 1 {
        return Some(*first);
    }
    let power: f64 = group.iter().map(|law| law.power_per_s).sum();
    let energy: f64 = group.iter().map(Law::energy).sum();
    Some(Law { power_per_s: power / group.len() as f64, decay_per_s: power / (2.0 * energy), ..*first })
}

/// What a group loses by being one band.
fn misfit(group: &[Law]) -> f64 {
    joint(group).map_or(0.0, |one| group.iter().map(|law| law.squared_error(&one)).sum())
}

/// Makes one of the two neighbours that lose least by it; of equals the lowest.
fn join_cheapest(groups: &mut Vec<Vec<Law>>) {
    let costs =
        groups.windows(2).map(|pair| misfit(&pair.concat()) - pair.iter().map(|group| misfit(group)).sum::<f64>());
    let cheapest = costs.enumerate().min_by(|(_, a), (_, b)| a.total_cmp(b));
    if let Some((lower, _)) = cheapest {
        let upper = groups.remove(lower + 1);
        if let Some(group) = groups.get_mut(lower) {
            group.extend(upper);
        }
    }
}
