//! The trigger settings of a pad in physical units.

use crate::table::{self, Kit};

/// Way in which a piezo plays its pad.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Each strike is found, and its peak in the scan time decides the velocity of a contact.
    #[default]
    Velocity,
    /// The conditioned signal itself is the contact force, sample by sample, without a scan time.
    Direct,
    /// The pad has no piezo; buttons and MIDI may still play it.
    Off,
}

/// Trigger settings of one pad. The valid ranges stand in [`crate::table::range`], the text form in
/// `docs/kit-format.md`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Way in which the piezo plays the pad.
    pub mode: Mode,
    /// ADC channel of the pad's piezo, counted from 0.
    pub channel: u8,
    /// ADC channel of a second sensor, such as a rim's, that plays another striker. It is not heard
    /// in direct mode.
    pub rim_channel: Option<u8>,
    /// Number of the striker that the second sensor plays, counted from 0 in the pad's list.
    pub rim_striker: u8,
    /// Softest peak that is a strike, as a fraction of half the ADC's range (2048 counts).
    pub threshold: f32,
    /// Scan time in seconds: the peak is sought from the onset to its end, at which the strike is
    /// decided.
    pub scan_time_s: f32,
    /// Mask time in seconds: the time after an onset in which the pad cannot be struck again.
    pub mask_time_s: f32,
    /// Decay of the mask's amplitude after a strike, in 1/s.
    pub mask_decay_per_s: f32,
    /// Peak of a strike of velocity 1, as a fraction of half the ADC's range.
    pub full_scale: f32,
    /// Exponent of the velocity curve, `velocity = (peak / full_scale)^exponent`.
    pub velocity_exponent: f32,
    /// Ratio of a peak to the sum of the other pads' peaks below which it is crosstalk, in dB
    /// (negative).
    pub crosstalk_db: f32,
    /// Gain of the second sensor in dB before it is compared with the piezo: the louder of the two
    /// plays.
    pub rim_db: f32,
    /// Force of a full-scale signal (2048 counts) in direct mode, on the force bus' scale.
    pub direct_gain: f32,
    /// Button that strikes the pad, counted from 0.
    pub button: Option<u8>,
    /// Velocity of a strike by the button, 0 to 1.
    pub button_velocity: f32,
    /// Button that chokes the pad while it is held, counted from 0.
    pub choke_button: Option<u8>,
}

impl Settings {
    /// Settings of a pad of a kit without trigger settings: velocity mode on the channel of the
    /// pad's number. Button 0 strikes pad 0.
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

    /// Settings of every pad of a kit, pad 0 first.
    ///
    /// In a kit without trigger settings each pad is [unset](Self::of_unset_pad). In a kit with
    /// some, the pads without settings have neither piezo nor button.
    pub fn of_kit<'k>(kit: &Kit<'k>) -> impl Iterator<Item = Self> + Clone + use<'k> {
        let kit = *kit;
        (0..=u8::MAX).zip(kit.pads()).map(move |(pad, _)| Self::of_pad(&kit, pad))
    }

    /// Settings of one pad of a kit, as [`of_kit`](Self::of_kit) gives them.
    pub fn of_pad(kit: &Kit<'_>, pad: u8) -> Self {
        match kit.triggers().find(|trigger| trigger.pad_index() == usize::from(pad)) {
            Some(trigger) => Self::of_table(&trigger),
            None if kit.triggers().len() == 0 => Self::of_unset_pad(pad),
            None => Self { mode: Mode::Off, button: None, ..Self::of_unset_pad(pad) },
        }
    }

    /// Settings that a kit's `trig` section gives a pad.
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
