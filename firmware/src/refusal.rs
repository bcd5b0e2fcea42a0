//! Why a kit is refused, as the log tells it: dsp-core's errors, whose numbers leave the board as they are and become words on the PC. (Making the
//! words here would take 10 KB of flash, most of it for decimals.)

use defmt::Formatter;
use dsp_core::biquad::BiquadError;
use dsp_core::dynamic_filter::DynamicFilterError;
use dsp_core::engine::{Capacity, LoadError, Stage};
use dsp_core::resonator::{BankError, max_decay_per_s};
use dsp_core::room::RoomError;
use dsp_core::table::{Place, TableError};
use dsp_core::trigger::TriggerError;
use dsp_core::waveguide::LoopError;

/// Why a kit does not play.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// Its bytes are no kit.
    Table(TableError),
    /// It does not fit the engine, or not at this sample rate; or a stage of it does not, which is left out.
    Load(LoadError),
    /// Its inputs cannot be.
    Trigger(TriggerError),
}

impl From<TableError> for Refusal {
    fn from(error: TableError) -> Self {
        Self::Table(error)
    }
}

impl From<LoadError> for Refusal {
    fn from(error: LoadError) -> Self {
        Self::Load(error)
    }
}

impl From<TriggerError> for Refusal {
    fn from(error: TriggerError) -> Self {
        Self::Trigger(error)
    }
}

impl defmt::Format for Refusal {
    fn format(&self, f: Formatter<'_>) {
        match self {
            Self::Table(error) => table(f, *error),
            Self::Load(error) => load(f, *error),
            Self::Trigger(error) => trigger(f, *error),
        }
    }
}

struct At(Place);

impl defmt::Format for At {
    fn format(&self, f: Formatter<'_>) {
        match self.0 {
            Place::Kit => defmt::write!(f, "the kit"),
            Place::Object(object) => defmt::write!(f, "object {=usize}", object),
            Place::ObjectMode(object, mode) => defmt::write!(f, "object {=usize}, mode {=usize}", object, mode),
            Place::Striker(striker) => defmt::write!(f, "striker {=usize}", striker),
            Place::StrikerMode(striker, mode) => defmt::write!(f, "striker {=usize}, mode {=usize}", striker, mode),
            Place::Pad(pad) => defmt::write!(f, "pad {=usize}", pad),
            Place::ObjectResidual(object) => defmt::write!(f, "object {=usize}, residual", object),
            Place::ObjectEdge(object, edge) => {
                defmt::write!(f, "object {=usize}, residual, edge {=usize}", object, edge)
            }
            Place::ObjectBand(object, band) => {
                defmt::write!(f, "object {=usize}, residual, band {=usize}", object, band)
            }
            Place::ObjectFilter(object) | Place::ObjectBreakpoint(object, _) | Place::ObjectLoop(object, _) => {
                defmt::write!(f, "object {=usize}, dynamic filter", object)
            }
            Place::ObjectBiquads(object) | Place::ObjectChain(object, _) | Place::ObjectBiquad(object, _) => {
                defmt::write!(f, "object {=usize}, biquads", object)
            }
            Place::Background => defmt::write!(f, "background"),
            Place::BackgroundEdge(edge) => defmt::write!(f, "background, edge {=usize}", edge),
            Place::BackgroundBand(band) => defmt::write!(f, "background, band {=usize}", band),
            Place::Room => defmt::write!(f, "room"),
            Place::RoomBand(band) => defmt::write!(f, "room, band {=usize}", band),
        }
    }
}

fn table(f: Formatter<'_>, error: TableError) {
    match error {
        TableError::Truncated { needed, found } => {
            defmt::write!(
                f,
                "truncated: {=usize} bytes are needed, {=usize} are there; write the whole file",
                needed,
                found
            )
        }
        TableError::WrongMagic { found } => {
            defmt::write!(f, "wrong magic: a kit begins with MALL, this with the bytes {=[u8; 4]:02x}", found)
        }
        TableError::NewerVersion { found } => {
            defmt::write!(
                f,
                "format version {=u32} is newer than this image: flash a newer one, or build the kit again",
                found
            )
        }
        TableError::WrongCrc { stored, computed } => defmt::write!(
            f,
            "CRC mismatch: the header says {=u32:08x}, the bytes give {=u32:08x}: damaged or half written; write the kit again",
            stored,
            computed
        ),
        TableError::TrailingBytes { offset } => defmt::write!(
            f,
            "bytes other than 0xFF follow the kit's end, at offset {=usize}: erase the sector before writing",
            offset
        ),
        TableError::SectionBounds { section, tag, offset, length, expected_offset, kit_length } => defmt::write!(
            f,
            "section {=usize} ({=[u8; 4]:a}) at offset {=usize}, {=usize} bytes: must begin at {=usize} and end within the kit's {=usize}",
            section,
            tag,
            offset,
            length,
            expected_offset,
            kit_length
        ),
        TableError::UnknownSection { tag } => {
            defmt::write!(
                f,
                "unknown section {=[u8; 4]:a}: this image does not know that stage; flash a newer one",
                tag
            )
        }
        TableError::NewerSection { tag, found } => {
            defmt::write!(
                f,
                "section {=[u8; 4]:a} of version {=u32} is newer than this image: flash a newer one",
                tag,
                found
            )
        }
        TableError::SectionCount { tag, found } => {
            defmt::write!(f, "{=usize} sections {=[u8; 4]:a}: there must be exactly one", found, tag)
        }
        TableError::LengthMismatch { place, expected, found } => defmt::write!(
            f,
            "{}: its head announces {=usize} bytes, the section has {=usize}",
            At(place),
            expected,
            found
        ),
        TableError::OutOfRange { place, field, value, allowed } => defmt::write!(
            f,
            "{}: {=str} = {=f32}: must be from {=f32} to {=f32}",
            At(place),
            field.key(),
            value,
            allowed.min,
            allowed.max
        ),
        TableError::Count { place, field, value, min, max } => defmt::write!(
            f,
            "{}: {=str}: {=usize}: must be from {=usize} to {=usize}",
            At(place),
            field.key(),
            value,
            min,
            max
        ),
        TableError::Dangling { place, field, index, count } => defmt::write!(
            f,
            "{}: {=str}: names number {=usize}, the kit has {=usize}",
            At(place),
            field.key(),
            index,
            count
        ),
        TableError::BadName { place } => defmt::write!(f, "{}: its name breaks the rules for names", At(place)),
        TableError::DuplicateName { place } => defmt::write!(f, "{}: another has the same name", At(place)),
        TableError::BadNote { place, note } => {
            defmt::write!(f, "{}: midi_notes: {=u8}: above 127, or another pad's", At(place), note)
        }
        TableError::SharedInput { place, field, input } => {
            defmt::write!(f, "{}: {=str}: {=u8} is in use already", At(place), field.key(), input)
        }
        TableError::EdgeOrder { place, field, below, above } => defmt::write!(
            f,
            "{}: {=str}: {=f32}: must be at least 1 Hz above the edge before it, {=f32}",
            At(place),
            field.key(),
            above,
            below
        ),
        TableError::UnstablePole { place, .. } => defmt::write!(f, "{}: an unstable pole", At(place)),
        TableError::TimeOrder { place, .. } => defmt::write!(f, "{}: its times do not rise", At(place)),
        TableError::GaussianRestitution { place, value } => {
            defmt::write!(f, "{}: restitution {=f32}: only a hertz pulse has one", At(place), value)
        }
        TableError::BadText { place } => defmt::write!(f, "{}: a text that is not UTF-8", At(place)),
        TableError::NotZero { place, field } => defmt::write!(f, "{}: {=str}: must be zero", At(place), field.key()),
    }
}

fn load(f: Formatter<'_>, error: LoadError) {
    match error {
        LoadError::NoPads => defmt::write!(f, "the kit has no pads"),
        LoadError::TooManyPads { pads, capacity } => {
            defmt::write!(f, "{=usize} pads: this board has room for {=usize}", pads, capacity)
        }
        LoadError::TooManyResiduals { pad, capacity } => {
            let stage = pad.map_or(Stage::Background, Stage::Residual);
            defmt::write!(
                f,
                "{}: this board has room for {=usize}, the background counting as one",
                Of(stage),
                capacity
            )
        }
        LoadError::BeyondNyquist { pad, edge_hz, .. } => {
            let stage = pad.map_or(Stage::Background, Stage::Residual);
            defmt::write!(f, "{}: edges_hz: {=f32}: beyond half this board's sample rate", Of(stage), edge_hz)
        }
        LoadError::Room(error) => defmt::write!(f, "{}: {}", Of(Stage::Room), Why::Room(error)),
        LoadError::TooManyFilters { pad, capacity } => defmt::write!(
            f,
            "pad {=u8}, dynamic filter and biquads: this board has room for those of {=usize} pads",
            pad,
            capacity
        ),
        LoadError::NoPlace { stage } => defmt::write!(f, "{}: this board plays none", Of(stage)),
        LoadError::TooDear { stage, cycles, left } => {
            defmt::write!(f, "{}: takes {=u32} cycles a tick, {=u32} are left", Of(stage), cycles, left)
        }
        LoadError::FilterTable(error) => table(f, error),
        LoadError::DynamicFilter { pad, error } => {
            defmt::write!(f, "{}: {}", Of(Stage::DynamicFilter(pad)), Why::DynamicFilter(error))
        }
        LoadError::Biquads { pad, error } => defmt::write!(f, "{}: {}", Of(Stage::Biquads(pad)), Why::Biquads(error)),
        LoadError::Pad { pad, striker: Some(striker), error, capacity, rate } => defmt::write!(
            f,
            "pad {=usize}, striker {=usize}: {}",
            pad,
            striker,
            Bank { error, capacity, max_decay_per_s: max_decay_per_s(rate) }
        ),
        LoadError::Pad { pad, striker: None, error, capacity, rate } => defmt::write!(
            f,
            "pad {=usize}, its object: {}",
            pad,
            Bank { error, capacity, max_decay_per_s: max_decay_per_s(rate) }
        ),
    }
}

struct Of(Stage);

impl defmt::Format for Of {
    fn format(&self, f: Formatter<'_>) {
        match self.0 {
            Stage::Residual(pad) => defmt::write!(f, "pad {=u8}, residual", pad),
            Stage::Background => defmt::write!(f, "background"),
            Stage::DynamicFilter(pad) => defmt::write!(f, "pad {=u8}, dynamic filter", pad),
            Stage::Biquads(pad) => defmt::write!(f, "pad {=u8}, biquads", pad),
            Stage::Room => defmt::write!(f, "room"),
        }
    }
}

/// What hinders a stage; where and how much are for `malleus kit check` to tell.
enum Why {
    Room(RoomError),
    DynamicFilter(DynamicFilterError),
    Biquads(BiquadError),
}

impl defmt::Format for Why {
    fn format(&self, f: Formatter<'_>) {
        match *self {
            Self::Room(RoomError::TooFewSamples { needed, capacity }) => {
                defmt::write!(f, "{=usize} samples of delay needed, this board has {=usize}", needed, capacity)
            }
            Self::Room(RoomError::EdgeAboveNyquist { band, from_hz, .. }) => {
                defmt::write!(f, "band {=usize}: from_hz = {=f32}: above 0.49 of the sample rate", band, from_hz)
            }
            Self::DynamicFilter(DynamicFilterError::Loop(LoopError::Count { given, room })) => {
                defmt::write!(f, "{=usize} loops, this board has room for {=usize}", given, room)
            }
            Self::DynamicFilter(DynamicFilterError::Loop(LoopError::Delay { index, room, .. })) => {
                defmt::write!(f, "loop {=usize}: longer than {=usize} frames", index, room)
            }
            Self::DynamicFilter(DynamicFilterError::Loop(LoopError::Unstable { frequency_hz, gain })) => {
                defmt::write!(f, "unstable near {=f64} Hz, where a round has a gain of {=f64}", frequency_hz, gain)
            }
            Self::Biquads(BiquadError::Full { sections, room }) => {
                defmt::write!(f, "{=usize} biquads, this board has room for {=usize} pairs", sections, room)
            }
            Self::Biquads(BiquadError::BeyondNyquist { biquad, .. }) => {
                defmt::write!(f, "biquad {=usize}: its pole would be beyond half this board's sample rate", biquad)
            }
            Self::Room(_) | Self::DynamicFilter(_) | Self::Biquads(_) => {
                defmt::write!(f, "its table cannot be played at this board's rate: `malleus kit check` says why")
            }
        }
    }
}

struct Bank {
    error: BankError,
    capacity: Capacity,
    max_decay_per_s: f64,
}

impl defmt::Format for Bank {
    fn format(&self, f: Formatter<'_>) {
        let Capacity { banks, modes, groups, origins } = self.capacity;
        match self.error {
            BankError::TooManyModes => {
                defmt::write!(f, "more modes than the {=usize} that this board has room for", modes)
            }
            BankError::TooManyGroups => {
                defmt::write!(f, "more modes than the {=usize} register groups that this board has room for", groups)
            }
            BankError::TooManyOrigins => defmt::write!(
                f,
                "more than {=usize} modes in all of pads that can be choked or have several positions",
                origins
            ),
            BankError::TooManyBanks => {
                defmt::write!(
                    f,
                    "more than the {=usize} banks (objects, and strikers with modes) that this board has room for",
                    banks
                )
            }
            BankError::DecayTooFast { mode, decay_per_s } => defmt::write!(
                f,
                "mode {=usize}: decay_per_s = {=f32}: must be at most {=f64} at this board's sample rate",
                mode,
                decay_per_s,
                self.max_decay_per_s
            ),
            BankError::GainTooLarge => {
                defmt::write!(f, "gain times reference_force (and striker_weight): must be below 2^14 times the rate")
            }
        }
    }
}

fn trigger(f: Formatter<'_>, error: TriggerError) {
    match error {
        TriggerError::Rate { rate } => {
            let (numerator, denominator) = rate.ratio();
            defmt::write!(f, "ADC rate {=u32}/{=u32} Hz: not one that the trigger is made for", numerator, denominator)
        }
        TriggerError::Ratio { adc, output } => defmt::write!(
            f,
            "ADC rate {=f64} Hz to output rate {=f64} Hz: not a ratio of two 31-bit numbers",
            adc.hz(),
            output.hz()
        ),
        TriggerError::Delay { frames, min, max } => {
            defmt::write!(f, "resampler delay of {=u32} frames: must be from {=u32} to {=u32}", frames, min, max)
        }
        TriggerError::SharedChannel { pad, channel } => {
            defmt::write!(f, "pad {=u8}: channel {=u8} is another sensor's already", pad, channel)
        }
        TriggerError::SharedButton { pad, button } => {
            defmt::write!(f, "pad {=u8}: button {=u8} strikes another pad already", pad, button)
        }
        TriggerError::OutOfRange { pad, key, value, allowed } => defmt::write!(
            f,
            "pad {=u8}: {=str} = {=f32}: must be from {=f32} to {=f32}",
            pad,
            key,
            value,
            allowed.min,
            allowed.max
        ),
    }
}
