//! The `trig` section: the trigger settings of pads.

use zerocopy::FromBytes;

use super::check::{check_count, check_ranges};
use super::error::TableError;
use super::layout::{NO_INPUT, NO_STRIKER, PadRecord, TriggerRecord};
use super::place::{Field, Place};
use super::range::{self, Range};

/// Trigger settings of one pad of a [`Kit`](super::Kit).
#[derive(Clone, Copy, Debug)]
pub struct Trigger<'a> {
    record: &'a TriggerRecord,
}

pub(super) fn read(body: Option<&[u8]>) -> Result<&[TriggerRecord], TableError> {
    let Some(body) = body else { return Ok(&[]) };
    <[TriggerRecord]>::ref_from_bytes(body).map_err(|_| TableError::LengthMismatch {
        place: Place::Kit,
        expected: body.len() / size_of::<TriggerRecord>() * size_of::<TriggerRecord>(),
        found: body.len(),
    })
}

/// Checks every record by itself, the order of the pads, and that no two pads claim one input.
pub(super) fn check(records: &[TriggerRecord], pads: &[PadRecord]) -> Result<(), TableError> {
    let mut next_pad = 0;
    let mut channels = [false; range::LAST_CHANNEL + 1];
    let mut buttons = [false; range::LAST_BUTTON + 1];
    for record in records {
        let trigger = Trigger { record };
        let place = Place::Pad(trigger.pad_index());
        let Some(pad) = pads.get(trigger.pad_index()) else {
            let (index, count) = (trigger.pad_index(), pads.len());
            return Err(TableError::Dangling { place: Place::Kit, field: Field::TriggerPad, index, count });
        };
        check_count(place, Field::TriggerPad, trigger.pad_index(), next_pad, pads.len().saturating_sub(1))?;
        next_pad = trigger.pad_index() + 1;
        trigger.check(place, pad)?;
        if !trigger.is_off() {
            claim(&mut channels, Some(trigger.channel()), place, Field::Channel)?;
            claim(&mut channels, trigger.rim_channel(), place, Field::RimChannel)?;
        }
        claim(&mut buttons, trigger.button(), place, Field::Button)?;
    }
    Ok(())
}

fn claim(taken: &mut [bool], input: Option<u8>, place: Place, field: Field) -> Result<(), TableError> {
    let Some(input) = input else { return Ok(()) };
    match taken.get_mut(usize::from(input)) {
        Some(taken) if !*taken => {
            *taken = true;
            Ok(())
        }
        _ => Err(TableError::SharedInput { place, field, input }),
    }
}

fn present(input: u8) -> Option<u8> {
    (input != NO_INPUT).then_some(input)
}

const RANGES: [(Field, Range); 10] = [
    (Field::Threshold, range::THRESHOLD),
    (Field::ScanTimeS, range::SCAN_TIME_S),
    (Field::MaskTimeS, range::MASK_TIME_S),
    (Field::MaskDecayPerS, range::MASK_DECAY_PER_S),
    (Field::FullScale, range::FULL_SCALE),
    (Field::VelocityExponent, range::VELOCITY_EXPONENT),
    (Field::CrosstalkDb, range::CROSSTALK_DB),
    (Field::RimDb, range::RIM_DB),
    (Field::DirectGain, range::DIRECT_GAIN),
    (Field::ButtonVelocity, range::BUTTON_VELOCITY),
];

impl<'a> Trigger<'a> {
    pub(super) fn new(record: &'a TriggerRecord) -> Self {
        Self { record }
    }

    fn check(&self, place: Place, pad: &PadRecord) -> Result<(), TableError> {
        check_count(place, Field::Mode, usize::from(self.record.mode), 0, 2)?;
        check_count(place, Field::Channel, usize::from(self.channel()), 0, range::LAST_CHANNEL)?;
        for (field, input, last) in [
            (Field::RimChannel, self.rim_channel(), range::LAST_CHANNEL),
            (Field::Button, self.button(), range::LAST_BUTTON),
            (Field::ChokeButton, self.choke_button(), range::LAST_BUTTON),
        ] {
            check_count(place, field, usize::from(input.unwrap_or(0)), 0, last)?;
        }
        let strikers = pad.strikers.iter().filter(|striker| striker.get() != NO_STRIKER).count();
        if self.rim_channel().is_some() {
            check_count(place, Field::RimStriker, usize::from(self.rim_striker()), 0, strikers.saturating_sub(1))?;
        }
        let values = [
            self.threshold(),
            self.scan_time_s(),
            self.mask_time_s(),
            self.mask_decay_per_s(),
            self.full_scale(),
            self.velocity_exponent(),
            self.crosstalk_db(),
            self.rim_db(),
            self.direct_gain(),
            self.button_velocity(),
        ];
        check_ranges(place, &RANGES, &values)
    }

    /// Number of the pad, counted from 0.
    pub fn pad_index(&self) -> usize {
        usize::from(self.record.pad.get())
    }

    /// True if the piezo's signal itself is the force.
    pub fn is_direct(&self) -> bool {
        self.record.mode == 1
    }

    /// True if the pad has no piezo.
    pub fn is_off(&self) -> bool {
        self.record.mode == 2
    }

    /// ADC channel of the piezo.
    pub fn channel(&self) -> u8 {
        self.record.channel
    }

    /// ADC channel of the second sensor; `None` if the pad has only one.
    pub fn rim_channel(&self) -> Option<u8> {
        present(self.record.rim_channel)
    }

    /// Number of the striker that the second sensor plays, counted from 0 in the pad's list.
    pub fn rim_striker(&self) -> u8 {
        self.record.rim_striker
    }

    /// Button that strikes the pad; `None` if no button does.
    pub fn button(&self) -> Option<u8> {
        present(self.record.button)
    }

    /// Button that chokes the pad while it is held; `None` if no button does.
    pub fn choke_button(&self) -> Option<u8> {
        present(self.record.choke_button)
    }

    /// Softest peak that is a strike, as a fraction of half the ADC's range.
    pub fn threshold(&self) -> f32 {
        self.record.threshold.get()
    }

    /// Scan time in seconds.
    pub fn scan_time_s(&self) -> f32 {
        self.record.scan_time_s.get()
    }

    /// Mask time in seconds.
    pub fn mask_time_s(&self) -> f32 {
        self.record.mask_time_s.get()
    }

    /// Decay of the mask's amplitude in 1/s.
    pub fn mask_decay_per_s(&self) -> f32 {
        self.record.mask_decay_per_s.get()
    }

    /// Peak of a strike of velocity 1, as a fraction of half the ADC's range.
    pub fn full_scale(&self) -> f32 {
        self.record.full_scale.get()
    }

    /// Exponent of the velocity curve.
    pub fn velocity_exponent(&self) -> f32 {
        self.record.velocity_exponent.get()
    }

    /// Ratio of a peak to the sum of the other pads' peaks below which it is crosstalk, in dB.
    pub fn crosstalk_db(&self) -> f32 {
        self.record.crosstalk_db.get()
    }

    /// Gain of the second sensor in dB.
    pub fn rim_db(&self) -> f32 {
        self.record.rim_db.get()
    }

    /// Force of a full-scale signal in direct mode.
    pub fn direct_gain(&self) -> f32 {
        self.record.direct_gain.get()
    }

    /// Velocity of the button's strikes.
    pub fn button_velocity(&self) -> f32 {
        self.record.button_velocity.get()
    }
}
