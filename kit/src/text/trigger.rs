//! Table `[pad.trigger]`: it is read and written.

use std::fmt::{self, Display, Formatter};

use dsp_core::trigger::{Mode, Settings};
use serde::de::{self, Deserialize, Deserializer};

use super::number::shortest_decimal;

/// Table `[pad.trigger]`, key by key.
///
/// A missing key has the default of a pad without the table. A missing `rim_channel`, `button` or
/// `choke_button` means that the pad has no such input.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TriggerTable {
    #[serde(default, deserialize_with = "mode")]
    mode: Mode,
    channel: Option<u8>,
    rim_channel: Option<u8>,
    rim_striker: Option<u8>,
    threshold: Option<f32>,
    scan_time_s: Option<f32>,
    mask_time_s: Option<f32>,
    mask_decay_per_s: Option<f32>,
    full_scale: Option<f32>,
    velocity_exponent: Option<f32>,
    crosstalk_db: Option<f32>,
    rim_db: Option<f32>,
    direct_gain: Option<f32>,
    button: Option<u8>,
    button_velocity: Option<f32>,
    choke_button: Option<u8>,
}

/// Trigger modes with their words in the text form.
const MODES: [(Mode, &str); 3] = [(Mode::Velocity, "velocity"), (Mode::Direct, "direct"), (Mode::Off, "off")];

fn mode<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Mode, D::Error> {
    let word = String::deserialize(deserializer)?;
    let found = MODES.into_iter().find(|(_, key)| *key == word);
    found.map(|(mode, _)| mode).ok_or_else(|| {
        let known = MODES.map(|(_, key)| format!("{key:?}")).join(", ");
        de::Error::custom(format!("mode = {word:?}: must be one of {known}"))
    })
}

impl TriggerTable {
    /// Converts the table to the settings of the pad with index `pad`, counted from 0.
    pub(super) fn settings(self, pad: usize) -> Settings {
        // The binary form refuses a kit of 256 pads or more.
        let usual = Settings::of_unset_pad(u8::try_from(pad).unwrap_or(u8::MAX));
        Settings {
            mode: self.mode,
            channel: self.channel.unwrap_or(usual.channel),
            rim_channel: self.rim_channel,
            rim_striker: self.rim_striker.unwrap_or(usual.rim_striker),
            threshold: self.threshold.unwrap_or(usual.threshold),
            scan_time_s: self.scan_time_s.unwrap_or(usual.scan_time_s),
            mask_time_s: self.mask_time_s.unwrap_or(usual.mask_time_s),
            mask_decay_per_s: self.mask_decay_per_s.unwrap_or(usual.mask_decay_per_s),
            full_scale: self.full_scale.unwrap_or(usual.full_scale),
            velocity_exponent: self.velocity_exponent.unwrap_or(usual.velocity_exponent),
            crosstalk_db: self.crosstalk_db.unwrap_or(usual.crosstalk_db),
            rim_db: self.rim_db.unwrap_or(usual.rim_db),
            direct_gain: self.direct_gain.unwrap_or(usual.direct_gain),
            button: self.button,
            button_velocity: self.button_velocity.unwrap_or(usual.button_velocity),
            choke_button: self.choke_button,
        }
    }
}

/// Wrapper of settings that are written as TOML.
pub(super) struct Text<'a>(pub(super) &'a Settings);

impl Display for Text<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let settings = self.0;
        let mode = MODES.iter().find(|(mode, _)| *mode == settings.mode).map_or("", |(_, key)| key);
        writeln!(f, "\n[pad.trigger]\nmode = \"{mode}\"\nchannel = {}", settings.channel)?;
        if let Some(channel) = settings.rim_channel {
            writeln!(f, "rim_channel = {channel}")?;
        }
        writeln!(f, "rim_striker = {}", settings.rim_striker)?;
        for (key, value) in [
            ("threshold", settings.threshold),
            ("scan_time_s", settings.scan_time_s),
            ("mask_time_s", settings.mask_time_s),
            ("mask_decay_per_s", settings.mask_decay_per_s),
            ("full_scale", settings.full_scale),
            ("velocity_exponent", settings.velocity_exponent),
            ("crosstalk_db", settings.crosstalk_db),
            ("rim_db", settings.rim_db),
            ("direct_gain", settings.direct_gain),
            ("button_velocity", settings.button_velocity),
        ] {
            writeln!(f, "{key} = {}", shortest_decimal(value))?;
        }
        for (key, input) in [("button", settings.button), ("choke_button", settings.choke_button)] {
            if let Some(input) = input {
                writeln!(f, "{key} = {input}")?;
            }
        }
        Ok(())
    }
}
