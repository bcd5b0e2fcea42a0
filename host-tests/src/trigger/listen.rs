//! The trigger of `dsp-core` and that of the reference, with their defaults, on ADC counts.

use dsp_core::SampleRate;
use dsp_core::trigger::{Report, Settings, Trigger, TriggerError};
use reference::trigger::{PiezoSettings, detect};

use super::Found;
use super::set::CHANNELS;

/// Trigger for as many pads as there are channels, all with their defaults, at 48 kHz.
///
/// # Errors
/// None: the defaults are valid.
pub fn usual_trigger() -> Result<Trigger<CHANNELS>, TriggerError> {
    Trigger::new((0..CHANNELS as u8).map(Settings::of_unset_pad), SampleRate::HZ_48000)
}

/// Strikes that `dsp-core` finds.
pub fn on_pc(counts: &[[u16; CHANNELS]]) -> Vec<Found> {
    let mut found = Vec::new();
    if let Ok(mut trigger) = usual_trigger() {
        for block in counts.chunks(48) {
            trigger.process(block, |report| found.extend(strike(&report)));
        }
    }
    found
}

/// Strike of a report; `None` for a report of another kind.
pub fn strike(report: &Report<'_>) -> Option<Found> {
    match report {
        Report::Strike(strike) => {
            Some(Found { frame: strike.frame, pad: strike.pad.into(), velocity: strike.velocity.into() })
        }
        _ => None,
    }
}

/// Settings of the reference for those of a pad.
pub fn twin_of(settings: &Settings) -> PiezoSettings {
    PiezoSettings {
        channel: settings.channel.into(),
        rim: None,
        threshold: settings.threshold.into(),
        scan_time_s: settings.scan_time_s.into(),
        mask_time_s: settings.mask_time_s.into(),
        mask_decay_per_s: settings.mask_decay_per_s.into(),
        full_scale: settings.full_scale.into(),
        velocity_exponent: settings.velocity_exponent.into(),
        crosstalk_db: settings.crosstalk_db.into(),
    }
}

/// Strikes that the reference finds.
pub fn reference(counts: &[[u16; CHANNELS]]) -> Vec<Found> {
    let pads: Vec<_> = (0..CHANNELS as u8).map(|pad| twin_of(&Settings::of_unset_pad(pad))).collect();
    let frames: Vec<_> = counts.iter().map(|frame| frame.to_vec()).collect();
    let rate = reference::SampleRate { numerator: 48_000, denominator: 1 };
    let strikes = detect(&frames, &pads, rate).into_iter();
    strikes.map(|strike| Found { frame: strike.frame as u64, pad: strike.pad, velocity: strike.velocity }).collect()
}
