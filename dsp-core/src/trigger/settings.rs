//! What a kit says about how a pad is triggered, in physical units.

use crate::table::{self, Kit};

/// How a pad's piezo plays it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Each strike is found, its peak is searched for over the scan time, and its velocity starts a contact.
    #[default]
    Velocity,
    /// The conditioned signal itself is the contact force, sample by sample, with no scan time.
    Direct,
    /// The pad has no piezo; buttons and MIDI may still play it.
    Off,
}

/// Trigger settings of one pad. Valid ranges are those of [`crate::table::range`]; the text form is in `docs/kit-format.md`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// How the piezo plays the pad.
    pub mode: Mode,
    /// The ADC channel of the pad's piezo, counted from 0.
    pub channel: u8,
    /// The ADC channel of a second sensor, such as a rim's, that plays another striker. Not heard in direct mode.
    pub rim_channel: Option<u8>,
    /// Which of the pad's strikers the second sensor plays, counted from 0.
    pub rim_striker: u8,
    /// The softest peak that is a strike, as a fraction of half the ADC's range (2048 counts).
    pub threshold: f32,
    /// How long a strike's peak is searched for, in seconds from its onset; the strike is decided then.
    pub scan_time_s: f32,
    /// How long after an onset the same pad cannot be struck again, in seconds.
    pub mask_time_s: f32,
    /// How fast the mask that a strike leaves behind decays, in 1/s of amplitude.
    pub mask_decay_per_s: f32,
    /// The peak of velocity 1, as a fraction of half the ADC's range.
    pub full_scale: f32,
    /// Exponent of the velocity curve, `velocity = (peak / full_scale)^exponent`.
    pub velocity_exponent: f32,
    /// A peak this far below the sum of the other pads' is taken for crosstalk, in dB (negative).
    pub crosstalk_db: f32,
    /// How much the second sensor's signal is amplified before it is compared with the first's, in dB: the louder one plays.
    pub rim_db: f32,
    /// Force of a full-scale signal in direct mode (2048 counts), on the force bus' scale.
    pub direct_gain: f32,
    /// The button that strikes the pad, counted from 0.
    pub button: Option<u8>,
    /// The velocity of a strike by the button.
    pub button_velocity: f32,
    /// The button that chokes the pad while it is held, counted from 0.
    pub choke_button: Option<u8>,
}

impl Settings {
    /// The settings of a pad whose kit says nothing: velocity mode on the channel of the pad's number; button 0 strikes pad 0.
    pub const fn of_unset_pad(pad: u8) -> Self {
        Self {
            mode: Mode::Velocity,
            channel: pad,
            rim_channel: None,
            rim_striker: 1,
            threshold: 0.006,
            scan_time_s: 0.001_5,
            mask_time_s: 0.008,
            mask_decay_per_s: 60.0,
            full_scale: 1.0,
            velocity_exponent: 1.0,
            crosstalk_db: -16.0,
            rim_db: 0.0,
            direct_gain: 1.0,
            button: if pad == 0 { Some(0) } else { None },
            button_velocity: 0.8,
            choke_button: None,
        }
    }

    /// The settings of every pad of a kit. In a kit without trigger settings each pad is [unset](Self::of_unset_pad); in one with some,
    /// the pads without have neither piezo nor button.
    pub fn of_kit<'k>(kit: &Kit<'k>) -> impl Iterator<Item = Self> + Clone + use<'k> {
        let kit = *kit;
        (0..=u8::MAX).zip(kit.pads()).map(move |(pad, _)| Self::of_pad(&kit, pad))
    }

    /// The settings of one pad of a kit, as [`of_kit`](Self::of_kit) gives them.
    pub fn of_pad(kit: &Kit<'_>, pad: u8) -> Self {
        match kit.triggers().find(|trigger| trigger.pad_index() == usize::from(pad)) {
            Some(trigger) => Self::of_table(&trigger),
            None if kit.triggers().len() == 0 => Self::of_unset_pad(pad),
            None => Self { mode: Mode::Off, button: None, ..Self::of_unset_pad(pad) },
        }
    }

    /// The settings that a kit gives a pad.
    pub fn of_table(trigger: &table::Trigger<'_>) -> Self {
        Self {
            mode: match (trigger.is_direct(), trigger.is_off()) {
                (true, _) => Mode::Direct,
                (_, true) => Mode::Off,
                _ => Mode::Velocity,
            },
            channel: trigger.channel(),
            rim_channel: trigger.rim_channel(),
            rim_striker: trigger.rim_striker(),
            threshold: trigger.threshold(),
            scan_time_s: trigger.scan_time_s(),
            mask_time_s: trigger.mask_time_s(),
            mask_decay_per_s: trigger.mask_decay_per_s(),
            full_scale: trigger.full_scale(),
            velocity_exponent: trigger.velocity_exponent(),
            crosstalk_db: trigger.crosstalk_db(),
            rim_db: trigger.rim_db(),
            direct_gain: trigger.direct_gain(),
            button: trigger.button(),
            button_velocity: trigger.button_velocity(),
            choke_button: trigger.choke_button(),
        }
    }
}
