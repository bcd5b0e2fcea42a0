//! The records of a kit's bytes, in the order in which they stand, and the registry of section
//! tags.
//!
//! All records have alignment 1, so that a kit may lie at any address. Sections are padded to 4
//! bytes all the same.

mod surface;
pub mod tag;

use zerocopy::byteorder::little_endian::{F32, U16, U32};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

pub use surface::{
    CURVATURES, GRID_MULTIPLE, GUARD, LIMITS, MapHeader, OCTAVES, ObjectSurfaceRecord, RollRecord, ScrapeRecord,
    SurfaceHeader,
};

/// First four bytes of a kit.
pub const MAGIC: [u8; 4] = *b"MALL";
/// Format version that this crate reads and the crate `kit` writes.
pub const FORMAT_VERSION: u32 = 1;
/// Version of each section that this crate knows.
pub const SECTION_VERSION: u32 = 1;
/// Length of a name in bytes, zeros at its end included.
pub const NAME_BYTES: usize = 24;
/// Maximum number of strikers of a pad.
pub const STRIKERS_PER_PAD: usize = 4;
/// Maximum number of MIDI notes that play a pad.
pub const MIDI_NOTES_PER_PAD: usize = 4;
/// Filler for unused places in a pad's list of strikers.
pub const NO_STRIKER: u16 = 0xFFFF;
/// Filler for unused places in a pad's list of MIDI notes.
pub const NO_NOTE: u8 = 0xFF;
/// Value that stands for no channel or no button.
pub const NO_INPUT: u8 = 0xFF;

/// Head of a kit.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct FileHeader {
    /// [`MAGIC`].
    pub magic: [u8; 4],
    /// [`FORMAT_VERSION`].
    pub version: U32,
    /// Length of the kit in bytes, this header included.
    pub length: U32,
    /// CRC-32/ISO-HDLC of the bytes from the end of this header to `length`.
    pub crc: U32,
}

/// Entry of the directory, which begins with the number of entries as a [`U32`].
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct SectionEntry {
    /// Kind of the section, from [`tag`].
    pub tag: [u8; 4],
    /// [`SECTION_VERSION`].
    pub version: U32,
    /// Offset of the section from the beginning of the kit in bytes, a multiple of 4.
    pub offset: U32,
    /// Length of the section in bytes, a multiple of 4.
    pub length: U32,
}

/// Record of the `META` section.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct MetaRecord {
    /// Name of the kit.
    pub name: [u8; NAME_BYTES],
}

/// Head of an `OBJT` section. Behind it stand `mode_count` [`ModeRecord`]s, `mode_count ·
/// position_count` [`GainRecord`]s (all positions of the first mode, then of the second ...),
/// source and licence as UTF-8, and zeros up to a multiple of 4.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct ObjectHeader {
    /// Name of the object.
    pub name: [u8; NAME_BYTES],
    /// Force in newtons that 1.0 on the force bus stands for; 1 if the object is not calibrated.
    pub reference_force: F32,
    /// Acceleration sound α, output per newton. For an object in [`tag::BALANCE`] it is the derived
    /// value at 48 kHz and the first position, for readers that do not know that section.
    pub acceleration: F32,
    /// Number of modes.
    pub mode_count: U16,
    /// Number of positions along the object at which gains are given, at least 1.
    pub position_count: U16,
    /// Length of the source text in bytes.
    pub source_bytes: U16,
    /// Length of the licence text in bytes.
    pub licence_bytes: U16,
}

/// Head of a `STRK` section. Behind it stand `mode_count` [`ModeRecord`]s, `mode_count`
/// [`GainRecord`]s, source and licence as UTF-8, and zeros up to a multiple of 4.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct StrikerHeader {
    /// Name of the striker.
    pub name: [u8; NAME_BYTES],
    /// Shape of the contact pulse: 0 Hertz, 1 Gaussian.
    pub pulse: U32,
    /// Peak force m1 at velocity 1, in newtons.
    pub peak_force: F32,
    /// Exponent a of the peak force, `m = m1 v^a`.
    pub peak_exponent: F32,
    /// Contact time τ1 at velocity 1, in seconds.
    pub contact_time_s: F32,
    /// Exponent b of the contact time, `τ = τ1 v^b`.
    pub contact_exponent: F32,
    /// Number of the striker's own modes.
    pub mode_count: U16,
    /// Length of the source text in bytes.
    pub source_bytes: U16,
    /// Length of the licence text in bytes.
    pub licence_bytes: U16,
    /// Reserved; must be 0.
    pub reserved: U16,
}

/// Pole of a mode.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct ModeRecord {
    /// Frequency f in Hz.
    pub frequency_hz: F32,
    /// Decay rate d in 1/s; T60 = ln(1000)/d.
    pub decay_per_s: F32,
}

/// Gain of a mode at one position: `h(t) = e^{-d t} (sine · sin 2πft + cosine · cos 2πft)`, output
/// per newton-second.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct GainRecord {
    /// Gain gs of the sine phase.
    pub sine: F32,
    /// Gain gc of the cosine phase.
    pub cosine: F32,
}

/// Pad of a kit.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct PadRecord {
    /// Name of the pad.
    pub name: [u8; NAME_BYTES],
    /// Number of the object, counted from 0 in the order of the `OBJT` sections.
    pub object: U16,
    /// Effect of a MIDI note's end: 0 nothing, 1 chokes the pad.
    pub note_off: u8,
    /// Reserved; must be 0.
    pub reserved: u8,
    /// Numbers of the strikers, counted from 0 in the order of the `STRK` sections, the default one
    /// first. [`NO_STRIKER`] fills unused places.
    pub strikers: [U16; STRIKERS_PER_PAD],
    /// Level in dB.
    pub level_db: F32,
    /// Constant-power pan, -1 (left) to 1 (right).
    pub pan: F32,
    /// Weight η of the strikers' own banks.
    pub striker_weight: F32,
    /// T60 in seconds that a choke imposes; 0 if the pad cannot be choked.
    pub choke_t60_s: F32,
    /// MIDI notes that play the pad. [`NO_NOTE`] fills unused places.
    pub midi_notes: [u8; MIDI_NOTES_PER_PAD],
}

/// Trigger settings of one pad.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct TriggerRecord {
    /// Number of the pad, counted from 0.
    pub pad: U16,
    /// Mode of the trigger: 0 velocity, 1 direct, 2 off.
    pub mode: u8,
    /// ADC channel of the piezo.
    pub channel: u8,
    /// ADC channel of the second sensor, or [`NO_INPUT`].
    pub rim_channel: u8,
    /// Number of the striker that the second sensor plays, counted from 0 in the pad's list.
    pub rim_striker: u8,
    /// Button that strikes the pad, or [`NO_INPUT`].
    pub button: u8,
    /// Button that chokes the pad, or [`NO_INPUT`].
    pub choke_button: u8,
    /// Softest peak that is a strike, as a fraction of half the ADC's range.
    pub threshold: F32,
    /// Scan time in seconds.
    pub scan_time_s: F32,
    /// Mask time in seconds.
    pub mask_time_s: F32,
    /// Decay of the mask's amplitude in 1/s.
    pub mask_decay_per_s: F32,
    /// Peak of a strike of velocity 1, as a fraction of half the ADC's range.
    pub full_scale: F32,
    /// Exponent of the velocity curve.
    pub velocity_exponent: F32,
    /// Ratio of a peak to the sum of the other pads' peaks below which it is crosstalk, in dB.
    pub crosstalk_db: F32,
    /// Gain of the second sensor in dB.
    pub rim_db: F32,
    /// Force of a full-scale signal in direct mode.
    pub direct_gain: F32,
    /// Velocity of the button's strikes.
    pub button_velocity: F32,
}

/// Head of a `resi` section. Behind it stand `band_count + 1` edges in Hz as [`F32`], then
/// `band_count` [`ResidualBandRecord`]s.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct ResidualHeader {
    /// Number of the object, counted from 0 in the order of the `OBJT` sections.
    pub object: U16,
    /// Number of bands.
    pub band_count: U16,
    /// Seed of the noise.
    pub seed: U32,
}

/// Band of a residual.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct ResidualBandRecord {
    /// Rms w at t = 0 (1.0 = full scale) of a strike whose peak force is the object's reference
    /// force.
    pub weight: F32,
    /// Decay γ in dB/s.
    pub decay_db_per_s: F32,
}

/// Head of a `bgnd` section. Behind it stand `band_count + 1` edges in Hz as [`F32`], then
/// `band_count` weights (rms, 1.0 = full scale).
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct BackgroundHeader {
    /// Number of bands.
    pub band_count: U16,
    /// Reserved; must be 0.
    pub reserved: U16,
    /// Seed of the noise.
    pub seed: U32,
}

/// Band of the room; bands stand from the lowest up.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct RoomBandRecord {
    /// Lower edge of the band in Hz; 0 for the first band. The band ends at the next one's lower
    /// edge, the last band at Nyquist.
    pub from_hz: F32,
    /// Initial gain g in 1/√s.
    pub gain: F32,
    /// Decay rate d in 1/s; T60 = ln(1000)/d.
    pub decay_per_s: F32,
}

/// Head of a `dynf` section. Behind it stand `breakpoint_count` [`BreakpointRecord`]s, then
/// `loop_count` [`LoopRecord`]s, then, if [`HAS_LEVELS`] is set, `breakpoint_count` levels as
/// [`F32`].
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct DynamicFilterHeader {
    /// Number of the object, counted from 0 in the order of the `OBJT` sections.
    pub object: U16,
    /// Order of the filter, 1 or 2.
    pub order: u8,
    /// Bits [`MODES_THROUGH`], [`HAS_EXCITER`] and [`HAS_LEVELS`].
    pub flags: u8,
    /// Seed of the noise.
    pub seed: U32,
    /// Sample rate in Hz that the coefficients are for.
    pub rate_hz: F32,
    /// Number of breakpoints.
    pub breakpoint_count: U16,
    /// Number of loops.
    pub loop_count: U16,
    /// Lower edge of the exciter's band in Hz; 0 if there is no exciter.
    pub low_hz: F32,
    /// Upper edge of the exciter's band in Hz; 0 if there is no exciter.
    pub high_hz: F32,
    /// Exponent with which both edges follow the strike's peak force; 0 if there is no exciter.
    pub exponent: F32,
}

/// Bit 0 of [`DynamicFilterHeader::flags`]: the object's modes go through the filter.
pub const MODES_THROUGH: u8 = 1;
/// Bit 1 of [`DynamicFilterHeader::flags`]: there is an exciter.
pub const HAS_EXCITER: u8 = 2;
/// Bit 2 of [`DynamicFilterHeader::flags`]: each breakpoint has a level of the noise.
pub const HAS_LEVELS: u8 = 4;

/// Coefficients of the dynamic filter at a time after the strike:
/// `s(n) = b0 e(n) + b1 e(n-1) + b2 e(n-2) - a1 s(n-1) - a2 s(n-2)`.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct BreakpointRecord {
    /// Time in seconds after the strike.
    pub time_s: F32,
    /// Coefficient a1.
    pub a1: F32,
    /// Coefficient a2; 0 in a filter of first order.
    pub a2: F32,
    /// Coefficient b0.
    pub b0: F32,
    /// Coefficient b1.
    pub b1: F32,
    /// Coefficient b2; 0 in a filter of first order.
    pub b2: F32,
}

/// Loop round the dynamic filter: a banded waveguide (dynamic-filter eq. 8 to 13).
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct LoopRecord {
    /// Middle frequency f_c of the loop's band-pass in Hz.
    pub frequency_hz: F32,
    /// Width Δf of the loop's band-pass at -3 dB in Hz.
    pub bandwidth_hz: F32,
    /// Gain γ_s of the loop at f_c.
    pub gain: F32,
    /// Delay d_s of the loop in seconds.
    pub delay_s: F32,
}

/// Head of a `biqd` section. Behind it stand `chain_count · depth` [`BiquadRecord`]s, chain by
/// chain.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct BiquadsHeader {
    /// Number of the object, counted from 0 in the order of the `OBJT` sections.
    pub object: U16,
    /// Number of chains side by side.
    pub chain_count: U16,
    /// Number of biquads in each chain.
    pub depth: U16,
    /// Reserved; must be 0.
    pub reserved: U16,
    /// Sample rate in Hz that poles and zeros are for.
    pub rate_hz: F32,
}

/// Biquad `k (1 - 2 Re q z⁻¹ + |q|² z⁻²) / (1 - 2 Re p z⁻¹ + |p|² z⁻²)` (diffmodal eq. 2).
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct BiquadRecord {
    /// Real part of the pole p.
    pub pole_re: F32,
    /// Imaginary part of the pole p.
    pub pole_im: F32,
    /// Real part of the zero q. If both parts are 0, the biquad has no zero.
    pub zero_re: F32,
    /// Imaginary part of the zero q.
    pub zero_im: F32,
    /// Gain k.
    pub gain: F32,
}
