//! Places and fields of a kit, for error messages.

use core::fmt;

use super::range::CHAIN_DEPTH;

/// Place in a kit at which a field stands. Indices count from 0 in the order of the kit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Place {
    /// The kit as a whole.
    Kit,
    /// The object of this index.
    Object(usize),
    /// A mode of an object: (object, mode).
    ObjectMode(usize, usize),
    /// The striker of this index.
    Striker(usize),
    /// A mode of a striker: (striker, mode).
    StrikerMode(usize, usize),
    /// The pad of this index.
    Pad(usize),
    /// The residual of the object of this index.
    ObjectResidual(usize),
    /// An edge of the bands of an object's residual: (object, edge).
    ObjectEdge(usize, usize),
    /// A band of an object's residual: (object, band).
    ObjectBand(usize, usize),
    /// The dynamic filter of the object of this index.
    ObjectFilter(usize),
    /// A breakpoint of the path of an object's dynamic filter: (object, breakpoint).
    ObjectBreakpoint(usize, usize),
    /// A loop round an object's dynamic filter: (object, loop).
    ObjectLoop(usize, usize),
    /// The biquad bank of the object of this index.
    ObjectBiquads(usize),
    /// A chain of an object's biquad bank: (object, chain).
    ObjectChain(usize, usize),
    /// A biquad of an object's biquad bank: (object, [`CHAIN_DEPTH`] times the chain plus the
    /// biquad in the chain).
    ObjectBiquad(usize, usize),
    /// The background.
    Background,
    /// The edge of this index of the background's bands.
    BackgroundEdge(usize),
    /// The band of this index of the background.
    BackgroundBand(usize),
    /// The room.
    Room,
    /// The band of this index of the room.
    RoomBand(usize),
    /// The surface of this index.
    Surface(usize),
    /// The scraping or rolling of the striker of this index.
    StrikerScrape(usize),
}

/// Field of a kit, named by its key in the text form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[expect(missing_docs, reason = "each variant is the key of the same name in the text form")]
pub enum Field {
    A1,
    A2,
    Acceleration,
    B0,
    B1,
    B2,
    Noise,
    BandwidthHz,
    Biquads,
    Button,
    ButtonVelocity,
    Chains,
    Channel,
    ChokeButton,
    ChokeT60S,
    ContactExponent,
    ContactTimeS,
    CrosstalkDb,
    DecayDbPerS,
    DecayPerS,
    DelayS,
    DirectGain,
    EdgesHz,
    Exciter,
    Exponent,
    FrequencyHz,
    FromHz,
    FullScale,
    Gain,
    GainCosine,
    GainSine,
    HeadphoneDb,
    HighHz,
    LevelDb,
    Loops,
    LowHz,
    MaskDecayPerS,
    MaskTimeS,
    MidiNotes,
    Mode,
    Modes,
    Object,
    Order,
    TriggerPad,
    Padding,
    Pan,
    Path,
    PeakExponent,
    PeakForce,
    Pole,
    Positions,
    Pulse,
    RateHz,
    ReferenceForce,
    Restitution,
    RimChannel,
    RimDb,
    RimStriker,
    ScanTimeS,
    StrikerWeight,
    Strikers,
    Threshold,
    TimeS,
    VelocityExponent,
    Weight,
    AlphaExponent,
    AlphaMaxM,
    AlphaMinM,
    Dissipation,
    Friction,
    Heights,
    MassKg,
    Modulation,
    Slip,
    OffsetM,
    RadiusM,
    Rows,
    Scrape,
    ShortestM,
    SizeM,
    SurfaceLevelDb,
    SlopeExponent,
    SlopeGain,
    SmoothingS,
    StepM,
    Stiffness,
    Surface,
    TiltRad,
    UnitM,
    Zero,
}

impl Field {
    /// Key of the field in the text form.
    pub const fn key(self) -> &'static str {
        match self {
            Self::A1 => "a1",
            Self::A2 => "a2",
            Self::Acceleration => "acceleration",
            Self::B0 => "b0",
            Self::B1 => "b1",
            Self::B2 => "b2",
            Self::Noise => "noise",
            Self::BandwidthHz => "bandwidth_hz",
            Self::Biquads => "biquads",
            Self::Button => "button",
            Self::ButtonVelocity => "button_velocity",
            Self::Chains => "chains",
            Self::Channel => "channel",
            Self::ChokeButton => "choke_button",
            Self::ChokeT60S => "choke_t60_s",
            Self::ContactExponent => "contact_exponent",
            Self::ContactTimeS => "contact_time_s",
            Self::CrosstalkDb => "crosstalk_db",
            Self::DecayDbPerS => "decay_db_per_s",
            Self::DecayPerS => "decay_per_s",
            Self::DelayS => "delay_s",
            Self::DirectGain => "direct_gain",
            Self::EdgesHz => "edges_hz",
            Self::Exciter => "exciter",
            Self::Exponent => "exponent",
            Self::FrequencyHz => "frequency_hz",
            Self::FromHz => "from_hz",
            Self::FullScale => "full_scale",
            Self::Gain => "gain",
            Self::GainCosine => "gain_cosine",
            Self::GainSine => "gain_sine",
            Self::HeadphoneDb => "headphone_db",
            Self::HighHz => "high_hz",
            Self::LevelDb => "level_db",
            Self::Loops => "loops",
            Self::LowHz => "low_hz",
            Self::MaskDecayPerS => "mask_decay_per_s",
            Self::MaskTimeS => "mask_time_s",
            Self::MidiNotes => "midi_notes",
            Self::Mode => "mode",
            Self::Modes => "modes",
            Self::Object => "object",
            Self::Order => "order",
            Self::TriggerPad => "pad",
            Self::Padding => "padding",
            Self::Pan => "pan",
            Self::Path => "path",
            Self::PeakExponent => "peak_exponent",
            Self::PeakForce => "peak_force",
            Self::Pole => "pole",
            Self::Positions => "positions",
            Self::Pulse => "pulse",
            Self::RateHz => "rate_hz",
            Self::ReferenceForce => "reference_force",
            Self::Restitution => "restitution",
            Self::RimChannel => "rim_channel",
            Self::RimDb => "rim_db",
            Self::RimStriker => "rim_striker",
            Self::ScanTimeS => "scan_time_s",
            Self::StrikerWeight => "striker_weight",
            Self::Strikers => "strikers",
            Self::Threshold => "threshold",
            Self::TimeS => "time_s",
            Self::VelocityExponent => "velocity_exponent",
            Self::Weight => "weight",
            Self::AlphaExponent => "alpha_exponent",
            Self::AlphaMaxM => "alpha_max_m",
            Self::AlphaMinM => "alpha_min_m",
            Self::Dissipation => "dissipation",
            Self::Friction => "friction",
            Self::Heights => "heights",
            Self::MassKg => "mass_kg",
            Self::Modulation => "modulation",
            Self::Slip => "slip",
            Self::OffsetM => "offset_m",
            Self::RadiusM => "radius_m",
            Self::Rows => "rows",
            Self::Scrape => "scrape",
            Self::ShortestM => "shortest_m",
            Self::SizeM => "size_m",
            Self::SurfaceLevelDb => "surface_level_db",
            Self::SlopeExponent => "slope_exponent",
            Self::SlopeGain => "slope_gain",
            Self::SmoothingS => "smoothing_s",
            Self::StepM => "step_m",
            Self::Stiffness => "stiffness",
            Self::Surface => "surface",
            Self::TiltRad => "tilt_rad",
            Self::UnitM => "unit_m",
            Self::Zero => "zero",
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Kit => write!(f, "the kit"),
            Self::Object(object) => write!(f, "object {object}"),
            Self::ObjectMode(object, mode) => write!(f, "object {object}, mode {mode}"),
            Self::Striker(striker) => write!(f, "striker {striker}"),
            Self::StrikerMode(striker, mode) => write!(f, "striker {striker}, mode {mode}"),
            Self::Pad(pad) => write!(f, "pad {pad}"),
            Self::ObjectResidual(object) => write!(f, "object {object}, residual"),
            Self::ObjectEdge(object, edge) => write!(f, "object {object}, residual, edge {edge}"),
            Self::ObjectBand(object, band) => write!(f, "object {object}, residual, band {band}"),
            Self::ObjectFilter(object) => write!(f, "object {object}, dynamic filter"),
            Self::ObjectBreakpoint(object, breakpoint) => {
                write!(f, "object {object}, dynamic filter, breakpoint {breakpoint}")
            }
            Self::ObjectLoop(object, index) => write!(f, "object {object}, dynamic filter, loop {index}"),
            Self::ObjectBiquads(object) => write!(f, "object {object}, biquads"),
            Self::ObjectChain(object, chain) => write!(f, "object {object}, biquads, chain {chain}"),
            Self::ObjectBiquad(object, number) => {
                let (chain, biquad) = (number / CHAIN_DEPTH, number % CHAIN_DEPTH);
                write!(f, "object {object}, biquads, chain {chain}, biquad {biquad}")
            }
            Self::Background => write!(f, "background"),
            Self::BackgroundEdge(edge) => write!(f, "background, edge {edge}"),
            Self::BackgroundBand(band) => write!(f, "background, band {band}"),
            Self::Room => write!(f, "room"),
            Self::RoomBand(band) => write!(f, "room, band {band}"),
            Self::Surface(surface) => write!(f, "surface {surface}"),
            Self::StrikerScrape(striker) => write!(f, "striker {striker}, scrape"),
        }
    }
}
