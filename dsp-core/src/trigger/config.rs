//! The configuration of a channel, derived on load from seconds and decibels at the ADC's actual
//! rate.

use super::curve::Curve;
use super::error::TriggerError;
use super::mask::MaskDecay;
use super::settings::{Mode, Settings};
use super::units::FULL_UNITS;
use crate::SampleRate;
use crate::exponential;
use crate::table::range::{self, Range};
use crate::time::TICK_FRAMES;

/// Part that one channel plays in one pad.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChannelConfig {
    pub(super) pad: u8,
    pub(super) striker: u8,
    /// Channel of the pad's other sensor; `None` if the pad has only one.
    pub(super) partner: Option<u8>,
    /// Factor of the signal before it is compared with the partner's.
    pub(super) rivalry: f32,
    /// Envelope of the softest strike in signal units: half of its peak, since the envelope of a
    /// sine is 0.64 of the peak and rises slowly.
    pub(super) threshold_envelope: i32,
    /// Peak of the softest strike in signal units.
    pub(super) threshold_peak: i32,
    /// Number of frames from an onset to the decision.
    pub(super) scan_frames: u32,
    /// Ticks from the decision to the end of the mask time.
    pub(super) masked_ticks: u16,
    pub(super) mask_decay: MaskDecay,
    pub(super) curve: Curve,
    /// Ratio of a peak to the sum of the other pads' peaks below which it is crosstalk.
    pub(super) crosstalk: f32,
    /// Q16 factor from signal units to the force in Q4.27; `None` if the pad is not in direct mode.
    pub(super) direct_gain_q16: Option<i32>,
}

/// Derives the channels of a pad: its piezo, and its second sensor if it has one.
pub(super) fn derive(
    pad: u8,
    settings: &Settings,
    rate: SampleRate,
) -> Result<(ChannelConfig, Option<ChannelConfig>), TriggerError> {
    check(pad, settings)?;
    let frames = |seconds: f32| (f64::from(seconds) * rate.hz() + 0.5) as u32;
    let threshold = f64::from(settings.threshold) * f64::from(FULL_UNITS);
    let scan_frames = frames(settings.scan_time_s);
    let masked_ticks = frames(settings.mask_time_s).saturating_sub(scan_frames) / TICK_FRAMES as u32 + 1;
    let is_direct = settings.mode == Mode::Direct;
    // 1.0 of force is 2^27, full scale is 2^19 units.
    let direct_gain_q16 = (f64::from(settings.direct_gain) * f64::from(1 << (27 - 19 + 16))) as i32;
    let rim_channel = settings.rim_channel.filter(|_| !is_direct);
    let head = ChannelConfig {
        pad,
        striker: 0,
        partner: rim_channel,
        rivalry: 1.0,
        threshold_envelope: (threshold * 0.5) as i32,
        threshold_peak: threshold as i32,
        scan_frames,
        masked_ticks: u16::try_from(masked_ticks).unwrap_or(u16::MAX),
        mask_decay: MaskDecay::new(settings.mask_decay_per_s, rate),
        curve: Curve::new(settings.full_scale, settings.velocity_exponent),
        crosstalk: from_db(settings.crosstalk_db),
        direct_gain_q16: is_direct.then_some(direct_gain_q16),
    };
    let rim = rim_channel.map(|_| ChannelConfig {
        striker: settings.rim_striker,
        partner: Some(settings.channel),
        rivalry: from_db(settings.rim_db),
        ..head
    });
    Ok((head, rim))
}

fn from_db(db: f32) -> f32 {
    exponential::power(10.0, f64::from(db) / 20.0) as f32
}

fn check(pad: u8, settings: &Settings) -> Result<(), TriggerError> {
    let ranges: [(&'static str, f32, Range); 10] = [
        ("threshold", settings.threshold, range::THRESHOLD),
        ("scan_time_s", settings.scan_time_s, range::SCAN_TIME_S),
        ("mask_time_s", settings.mask_time_s, range::MASK_TIME_S),
        ("mask_decay_per_s", settings.mask_decay_per_s, range::MASK_DECAY_PER_S),
        ("full_scale", settings.full_scale, range::FULL_SCALE),
        ("velocity_exponent", settings.velocity_exponent, range::VELOCITY_EXPONENT),
        ("crosstalk_db", settings.crosstalk_db, range::CROSSTALK_DB),
        ("rim_db", settings.rim_db, range::RIM_DB),
        ("direct_gain", settings.direct_gain, range::DIRECT_GAIN),
        ("button_velocity", settings.button_velocity, range::BUTTON_VELOCITY),
    ];
    match ranges.into_iter().find(|(_, value, allowed)| !allowed.holds(*value)) {
        Some((key, value, allowed)) => Err(TriggerError::OutOfRange { pad, key, value, allowed }),
        None => Ok(()),
    }
}
