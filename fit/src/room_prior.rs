//! Conversion of the room that diffimpact's optimiser learns into bands of a table.
//!
//! In that paper (§3.4, eq. 19) the room's response is
//! `IR_e(t) = g_eᵀ [exp(-d_e t) ∘ filt(N(t), B_e)]`: white noise through B_e bands of equal width
//! up to half the rate. Raw values x of the optimiser set a gain and a decay of each:
//!
//! ```text
//! g = 2 sigmoid(x + b_gain)^ln 10 + 1e-7     (eq. 20)
//! d = 2 + exp(x + b_decay)                   (eq. 22)
//! ```
//!
//! The paper's gain is one a sample, the table's a power a second. The response to an impulse has
//! in a band the energy `Σ g² σ² e^{-2dn/fs} = g² σ² fs / 2d`, as a share of the band's energy in
//! the impulse. σ is the noise's rms and fs the rate of the response. A table's band has `gain²/2d`
//! (docs/kit-format.md, `[[room]]`). So
//!
//! ```text
//! gain = g σ √fs  in 1/√s
//! ```
//!
//! The noise in a band has the same density before `filt` and after it, so the width of a band does
//! not matter.

use dsp_core::table::range::{ROOM_DECAY_PER_S, ROOM_GAIN, Range};
use kit::RoomBand;
use kit::counting::counted;

/// Hyperparameters of eq. 19 to 22.
///
/// The paper prints none of them and points to its released code (appendix F). The defaults are the
/// values known from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scalings {
    /// Bias b_gain of eq. 20; finite. Default -4.
    ///
    /// Published evaluations that run the paper's reverb use that value (`gain_initial_bias`).
    pub gain_bias: f64,
    /// Bias b_decay of eq. 22; finite. Default 4, as in the paper's released notebook
    /// (`decay_initial_bias`).
    pub decay_bias: f64,
    /// Rms σ of the noise N(t), 0.001 to 1000. Default 1/√3: uniform noise between -1 and 1.
    ///
    /// DDSP, on which the paper's modules are built, uses such noise. The letter N may also stand
    /// for normal noise, whose rms is 1: 4.8 dB more.
    pub noise_rms: f64,
    /// Unit of t in eq. 19 in seconds, 0.001 to 1000: a decay of 1 is 1/`time_unit_s` per second.
    /// Default 1.
    ///
    /// If t runs from 0 to 1 over the response, as in DDSP's exponential reverb, the unit is the
    /// response's length: samples over rate.
    pub time_unit_s: f64,
}

impl Default for Scalings {
    fn default() -> Self {
        Self { gain_bias: -4.0, decay_bias: 4.0, noise_rms: 3f64.sqrt().recip(), time_unit_s: 1.0 }
    }
}

/// Reason why raw values cannot be converted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ScalingsError {
    /// The numbers of gains and decays differ.
    #[error(
        "{} and {} are given: give one of each for each band",
        counted(*gains, "raw gains"),
        counted(*decays, "raw decays")
    )]
    Lengths {
        /// Number of raw gains given.
        gains: usize,
        /// Number of raw decays given.
        decays: usize,
    },
    /// There is no band, or there are too many.
    #[error("there are {found} bands: give 1 to {MOST_BANDS}")]
    Bands {
        /// Number of bands given.
        found: usize,
    },
    /// A raw value is not finite.
    #[error("raw {what} of band {band} (counted from 0) is {value}: give a finite number")]
    NotFinite {
        /// Kind of value: "gain" or "decay".
        what: &'static str,
        /// Index of the band, from 0.
        band: usize,
        /// Value given.
        value: f64,
    },
    /// The sample rate is out of range.
    #[error("the response's rate is {rate_hz} Hz: give 4000 to 768000 Hz")]
    Rate {
        /// Rate given, in Hz.
        rate_hz: f64,
    },
    /// A hyperparameter is out of range.
    #[error("{name} is {value}: give a value that is {must}")]
    Setting {
        /// Name of the field of [`Scalings`].
        name: &'static str,
        /// Value given.
        value: f64,
        /// Range of valid values, in words.
        must: &'static str,
    },
}

/// Maximum number of bands that are accepted.
pub const MOST_BANDS: usize = 256;
/// Maximum number of bands of a table's room.
pub const MOST_ROOM_BANDS: usize = dsp_core::room::MAX_BANDS;
/// Lower edge in Hz from which a band is left out: every rate of 44.1 kHz and more plays the
/// others.
const HIGHEST_HZ: f64 = 20_000.0;

/// Bands of a table's room from raw values, with the default hyperparameters of [`Scalings`].
///
/// # Errors
/// [`ScalingsError`] for values that [`Scalings::room`] refuses.
pub fn room_of_scalings(raw_gain: &[f64], raw_decay: &[f64], rate_hz: f64) -> Result<Vec<RoomBand>, ScalingsError> {
    Scalings::default().room(raw_gain, raw_decay, rate_hz)
}

impl Scalings {
    /// Gain g_e of a raw value (eq. 20), for noise of rms [`Self::noise_rms`]: 1e-7 to 2.
    pub fn gain(&self, raw: f64) -> f64 {
        let sigmoid = (1.0 + (-(raw + self.gain_bias)).exp()).recip();
        2.0 * sigmoid.powf(std::f64::consts::LN_10) + 1e-7
    }

    /// Decay d_e of a raw value (eq. 22), per [`Self::time_unit_s`]: 2 or more.
    pub fn decay(&self, raw: f64) -> f64 {
        2.0 + (raw + self.decay_bias).exp()
    }

    /// The bands of a table's `[[room]]` from raw values.
    ///
    /// One gain and one decay are given for each of 1 to [`MOST_BANDS`] bands of equal width from 0
    /// Hz to half of `rate_hz`. `rate_hz` is the rate of the response (4 to 768 kHz), in the paper
    /// twice that of the sound (appendix C.2).
    ///
    /// Bands that begin at 20 kHz or above are left out. If more than eight remain, neighbours are
    /// merged until there are eight: each time the two whose merging costs least, in the squared
    /// error of the powers `gain² e^{-2dt}` over time and frequency. So the loud bands, which hold
    /// the room's energy, stay apart where they differ. A merged band has the initial power and the
    /// energy of its parts (their means over frequency). Its decay is therefore their mean weighted
    /// by energy.
    ///
    /// Decays are then clamped to 0.3 to 150 1/s with the energy kept, and gains to 0 to 100 1/√s,
    /// the ranges of a kit.
    ///
    /// # Errors
    /// [`ScalingsError`] for lengths that differ, no or too many bands, values that are not finite,
    /// a rate or a hyperparameter out of range.
    pub fn room(&self, raw_gain: &[f64], raw_decay: &[f64], rate_hz: f64) -> Result<Vec<RoomBand>, ScalingsError> {
        self.check(raw_gain, raw_decay, rate_hz)?;
        let width_hz = 0.5 * rate_hz / raw_gain.len() as f64;
        let bands = raw_gain.iter().zip(raw_decay).enumerate().map(|(band, (&gain, &decay))| {
            let gain = self.gain(gain) * self.noise_rms * rate_hz.sqrt();
            DecayingBand {
                from_hz: band as f64 * width_hz,
                power_per_s: gain * gain,
                decay_per_s: self.decay(decay) / self.time_unit_s,
            }
        });
        let mut groups: Vec<Vec<DecayingBand>> =
            bands.take_while(|band| band.from_hz < HIGHEST_HZ).map(|band| vec![band]).collect();
        while groups.len() > MOST_ROOM_BANDS {
            join_cheapest(&mut groups);
        }
        Ok(groups.iter().filter_map(|group| merged(group)).map(|band| band.band()).collect())
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

/// Power `power_per_s e^{-2 decay_per_s t}` of a band's response; an infinite decay stands for
/// silence.
#[derive(Clone, Copy)]
struct DecayingBand {
    from_hz: f64,
    power_per_s: f64,
    decay_per_s: f64,
}

impl DecayingBand {
    fn energy(&self) -> f64 {
        self.power_per_s / (2.0 * self.decay_per_s)
    }

    /// Squared error between two powers:
    /// `∫ (p e^{-2at} - q e^{-2bt})² dt = p²/4a - pq/(a + b) + q²/4b`.
    fn squared_error(&self, other: &Self) -> f64 {
        let (p, a, q, b) = (self.power_per_s, self.decay_per_s, other.power_per_s, other.decay_per_s);
        p * p / (4.0 * a) - p * q / (a + b) + q * q / (4.0 * b)
    }

    /// The band clamped to the ranges of the format.
    ///
    /// A clamped decay keeps the energy, as far as the gain's range allows.
    fn band(&self) -> RoomBand {
        let within = |value: f64, range: Range| value.clamp(range.min.into(), range.max.into());
        let decay_per_s = within(self.decay_per_s, ROOM_DECAY_PER_S);
        let gain = within((2.0 * decay_per_s * self.energy()).sqrt(), ROOM_GAIN);
        RoomBand { from_hz: self.from_hz as f32, gain: gain as f32, decay_per_s: decay_per_s as f32 }
    }
}

/// One band with the power and the energy of a group of equally wide neighbours.
fn merged(group: &[DecayingBand]) -> Option<DecayingBand> {
    let first = group.first()?;
    if group.len() == 1 {
        return Some(*first);
    }
    let power: f64 = group.iter().map(|band| band.power_per_s).sum();
    let energy: f64 = group.iter().map(DecayingBand::energy).sum();
    Some(DecayingBand { power_per_s: power / group.len() as f64, decay_per_s: power / (2.0 * energy), ..*first })
}

/// Squared error of a group that becomes one band.
fn misfit(group: &[DecayingBand]) -> f64 {
    merged(group).map_or(0.0, |one| group.iter().map(|band| band.squared_error(&one)).sum())
}

/// Merges the two neighbours whose merging costs least; of equals the lowest.
fn join_cheapest(groups: &mut Vec<Vec<DecayingBand>>) {
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
