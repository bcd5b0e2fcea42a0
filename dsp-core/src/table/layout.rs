//! The records of a kit's bytes, in the order in which they stand, and the registry of section tags.
//!
//! All records have alignment 1, so that a kit may lie at any address; sections are padded to 4 bytes all the same.

use zerocopy::byteorder::little_endian::{F32, U16, U32};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

/// The first four bytes of a kit.
pub const MAGIC: [u8; 4] = *b"MALL";
/// The format version that this crate reads and `kit` writes.
pub const FORMAT_VERSION: u32 = 1;
/// The version of each section that this crate knows.
pub const SECTION_VERSION: u32 = 1;
/// Bytes in a name, padded with zeros.
pub const NAME_BYTES: usize = 24;
/// Strikers that one pad may be played with.
pub const STRIKERS_PER_PAD: usize = 4;
/// MIDI notes that may play one pad.
pub const MIDI_NOTES_PER_PAD: usize = 4;
/// Fills an unused place in a pad's list of strikers.
pub const NO_STRIKER: u16 = 0xFFFF;
/// Fills an unused place in a pad's list of MIDI notes.
pub const NO_NOTE: u8 = 0xFF;
/// Stands for a channel or a button that is not there.
pub const NO_INPUT: u8 = 0xFF;

/// The registry of section tags.
pub mod tag {
    /// The kit's name, once.
    pub const META: [u8; 4] = *b"META";
    /// A struck object: [`ObjectHeader`](super::ObjectHeader), modes, gains, texts. One section an object.
    pub const OBJECT: [u8; 4] = *b"OBJT";
    /// A striker: [`StrikerHeader`](super::StrikerHeader), modes, gains, texts. One section a striker.
    pub const STRIKER: [u8; 4] = *b"STRK";
    /// [`PadRecord`](super::PadRecord)s, all in one section.
    pub const PADS: [u8; 4] = *b"PADS";
    /// [`TriggerRecord`](super::TriggerRecord)s, all in one section; a kit may do without, and a reader may skip it.
    pub const TRIGGER: [u8; 4] = *b"trig";
    /// The residual of an object: [`ResidualHeader`](super::ResidualHeader), edges, [`ResidualBandRecord`](super::ResidualBandRecord)s. One section
    /// an object that has one, in their order; a reader may skip it.
    pub const RESIDUAL: [u8; 4] = *b"resi";
    /// The background: [`BackgroundHeader`](super::BackgroundHeader), edges, weights. At most one; a reader may skip it.
    pub const BACKGROUND: [u8; 4] = *b"bgnd";
    /// The room: [`RoomBandRecord`](super::RoomBandRecord)s, from the lowest up. At most one; a reader may skip it.
    pub const ROOM: [u8; 4] = *b"room";
    /// The dynamic filter of an object: [`DynamicFilterHeader`](super::DynamicFilterHeader), [`BreakpointRecord`](super::BreakpointRecord)s,
    /// [`LoopRecord`](super::LoopRecord)s. One section an object that has one, in their order; a reader may skip it.
    pub const DYNAMIC_FILTER: [u8; 4] = *b"dynf";
    /// The biquad bank of an object: [`BiquadsHeader`](super::BiquadsHeader), [`BiquadRecord`](super::BiquadRecord)s, chain by chain. One section
    /// an object that has one, in their order; a reader may skip it.
    pub const BIQUADS: [u8; 4] = *b"biqd";
    /// The restitution of each striker as [`F32`](super::F32), in their order. At most one; without it each has
    /// [`DEFAULT_RESTITUTION`](crate::table::range::DEFAULT_RESTITUTION). A reader may skip it.
    pub const RESTITUTION: [u8; 4] = *b"rest";
    /// The objects whose acceleration sound is derived: a [`U16`](super::U16) count, as many object numbers, zeros up to a
    /// multiple of 4. At most one; a reader that skips it plays the number in [`ObjectHeader`](super::ObjectHeader).
    pub const BALANCE: [u8; 4] = *b"bala";
    /// All of them.
    pub const KNOWN: [[u8; 4]; 12] = [
        META,
        OBJECT,
        STRIKER,
        PADS,
        TRIGGER,
        RESIDUAL,
        BACKGROUND,
        ROOM,
        DYNAMIC_FILTER,
        BIQUADS,
        RESTITUTION,
        BALANCE,
    ];
}

/// The head of a kit.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct FileHeader {
    /// [`MAGIC`].
    pub magic: [u8; 4],
    /// [`FORMAT_VERSION`].
    pub version: U32,
    /// Bytes of the kit, this header included.
    pub length: U32,
    /// CRC-32/ISO-HDLC of the bytes from the end of this header to `length`.
    pub crc: U32,
}

/// One line of the directory, which begins with the number of entries as a [`U32`].
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct SectionEntry {
    /// Which kind of section, from [`tag`].
    pub tag: [u8; 4],
    /// [`SECTION_VERSION`].
    pub version: U32,
    /// Where it begins, in bytes from the beginning of the kit; a multiple of 4.
    pub offset: U32,
    /// Its length in bytes, a multiple of 4.
    pub length: U32,
}

/// The `META` section.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct MetaRecord {
    /// The kit's name.
    pub name: [u8; NAME_BYTES],
}

/// The head of an `OBJT` section; behind it `mode_count` [`ModeRecord`]s, `mode_count · position_count` [`GainRecord`]s (all
/// positions of the first mode, then of the second ...), source and licence as UTF-8, zeros up to a multiple of 4.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct ObjectHeader {
    /// The object's name.
    pub name: [u8; NAME_BYTES],
    /// The force in newtons (1 where uncalibrated) that 1.0 on the force bus stands for.
    pub reference_force: F32,
    /// Acceleration sound α, output per newton. Of an object in [`tag::BALANCE`] it is what the derivation gives at 48 kHz
    /// at the first position, for readers that do not know that section.
    pub acceleration: F32,
    /// Number of modes.
    pub mode_count: U16,
    /// Number of positions along the object at which gains are given, at least 1.
    pub position_count: U16,
    /// Bytes of the source text.
    pub source_bytes: U16,
    /// Bytes of the licence text.
    pub licence_bytes: U16,
}

/// The head of a `STRK` section; behind it modes, gains (one position) and texts as in [`ObjectHeader`].
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct StrikerHeader {
    /// The striker's name.
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
    /// Number of modes of the striker itself.
    pub mode_count: U16,
    /// Bytes of the source text.
    pub source_bytes: U16,
    /// Bytes of the licence text.
    pub licence_bytes: U16,
    /// 0.
    pub reserved: U16,
}

/// One mode's pole.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct ModeRecord {
    /// Frequency f in Hz.
    pub frequency_hz: F32,
    /// Decay rate d in 1/s; T60 = ln(1000)/d.
    pub decay_per_s: F32,
}

/// One mode's gain at one position: `h(t) = e^{-d t} (sine · sin 2πft + cosine · cos 2πft)`, output per newton-second.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct GainRecord {
    /// Gain gs of the sine phase.
    pub sine: F32,
    /// Gain gc of the cosine phase.
    pub cosine: F32,
}

/// One pad.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct PadRecord {
    /// The pad's name.
    pub name: [u8; NAME_BYTES],
    /// Which object, counted from 0 in the order of the `OBJT` sections.
    pub object: U16,
    /// 0.
    pub reserved: U16,
    /// Which strikers, counted from 0 in the order of the `STRK` sections; the first is the default, [`NO_STRIKER`] fills up.
    pub strikers: [U16; STRIKERS_PER_PAD],
    /// Level in dB.
    pub level_db: F32,
    /// Constant-power pan, -1 (left) to 1 (right).
    pub pan: F32,
    /// Weight η of the strikers' own banks.
    pub striker_weight: F32,
    /// T60 in seconds that a choke imposes, or 0 for a pad that cannot be choked.
    pub choke_t60_s: F32,
    /// MIDI notes that play the pad, [`NO_NOTE`] fills up.
    pub midi_notes: [u8; MIDI_NOTES_PER_PAD],
}

/// How one pad is triggered.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct TriggerRecord {
    /// Which pad, counted from 0.
    pub pad: U16,
    /// 0 velocity, 1 direct, 2 off.
    pub mode: u8,
    /// ADC channel of the piezo.
    pub channel: u8,
    /// ADC channel of the second sensor, or [`NO_INPUT`].
    pub rim_channel: u8,
    /// Which of the pad's strikers the second sensor plays.
    pub rim_striker: u8,
    /// Button that strikes the pad, or [`NO_INPUT`].
    pub button: u8,
    /// Button that chokes the pad, or [`NO_INPUT`].
    pub choke_button: u8,
    /// Softest peak that is a strike, of half the ADC's range.
    pub threshold: F32,
    /// Scan time in seconds.
    pub scan_time_s: F32,
    /// Mask time in seconds.
    pub mask_time_s: F32,
    /// Decay of the mask in 1/s.
    pub mask_decay_per_s: F32,
    /// Peak of velocity 1, of half the ADC's range.
    pub full_scale: F32,
    /// Exponent of the velocity curve.
    pub velocity_exponent: F32,
    /// What is taken for crosstalk, in dB.
    pub crosstalk_db: F32,
    /// Gain of the second sensor in dB.
    pub rim_db: F32,
    /// Force of a full-scale signal in direct mode.
    pub direct_gain: F32,
    /// Velocity of the button's strikes.
    pub button_velocity: F32,
}

/// The head of a `resi` section; behind it `band_count + 1` edges in Hz as [`F32`], then `band_count` [`ResidualBandRecord`]s.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct ResidualHeader {
    /// Which object, counted from 0 in the order of the `OBJT` sections.
    pub object: U16,
    /// Number of bands.
    pub band_count: U16,
    /// Seed of the noise.
    pub seed: U32,
}

/// One band of a residual.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct ResidualBandRecord {
    /// Rms w at t = 0 (1.0 = full scale) of a strike whose peak force is the object's reference force.
    pub weight: F32,
    /// Decay γ in dB/s.
    pub decay_db_per_s: F32,
}

/// The head of a `bgnd` section; behind it `band_count + 1` edges in Hz as [`F32`], then `band_count` weights (rms, 1.0 = full scale).
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct BackgroundHeader {
    /// Number of bands.
    pub band_count: U16,
    /// 0.
    pub reserved: U16,
    /// Seed of the noise.
    pub seed: U32,
}

/// One band of the room; bands stand from the lowest up.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct RoomBandRecord {
    /// Where the band begins, in Hz; 0 for the first. It ends where the next one begins, the last one at Nyquist.
    pub from_hz: F32,
    /// Initial gain g, 1/√s.
    pub gain: F32,
    /// Decay rate d in 1/s; T60 = ln(1000)/d.
    pub decay_per_s: F32,
}

/// The head of a `dynf` section; behind it `breakpoint_count` [`BreakpointRecord`]s, then `loop_count` [`LoopRecord`]s, then, where there are
/// levels, `breakpoint_count` [`F32`]s.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct DynamicFilterHeader {
    /// Which object, counted from 0 in the order of the `OBJT` sections.
    pub object: U16,
    /// Order of the filter, 1 or 2.
    pub order: u8,
    /// Bit 0: the object's modes go through the filter. Bit 1: there is an exciter. Bit 2: each breakpoint has a level of the noise.
    pub flags: u8,
    /// Seed of the noise.
    pub seed: U32,
    /// The rate in Hz that the coefficients are for.
    pub rate_hz: F32,
    /// Number of breakpoints.
    pub breakpoint_count: U16,
    /// Number of loops.
    pub loop_count: U16,
    /// Lower edge of the exciter's band in Hz; 0 without an exciter.
    pub low_hz: F32,
    /// Upper edge of the exciter's band in Hz; 0 without an exciter.
    pub high_hz: F32,
    /// Exponent by which both edges follow the strike's peak force; 0 without an exciter.
    pub exponent: F32,
}

/// Bit 0 of [`DynamicFilterHeader::flags`].
pub const MODES_THROUGH: u8 = 1;
/// Bit 1 of [`DynamicFilterHeader::flags`].
pub const HAS_EXCITER: u8 = 2;
/// Bit 2 of [`DynamicFilterHeader::flags`].
pub const HAS_LEVELS: u8 = 4;

/// The dynamic filter's coefficients at a time after the strike: `s(n) = b0 e(n) + b1 e(n-1) + b2 e(n-2) - a1 s(n-1) - a2 s(n-2)`.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct BreakpointRecord {
    /// Seconds after the strike.
    pub time_s: F32,
    /// a1.
    pub a1: F32,
    /// a2; 0 in a filter of first order.
    pub a2: F32,
    /// b0.
    pub b0: F32,
    /// b1.
    pub b1: F32,
    /// b2; 0 in a filter of first order.
    pub b2: F32,
}

/// A banded waveguide round the dynamic filter (dynamic-filter eq. 8 to 13).
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct LoopRecord {
    /// Middle f_c of its band-pass in Hz.
    pub frequency_hz: F32,
    /// Width Δf of its band-pass at -3 dB in Hz.
    pub bandwidth_hz: F32,
    /// Gain γ_s at f_c.
    pub gain: F32,
    /// Delay d_s in seconds.
    pub delay_s: F32,
}

/// The head of a `biqd` section; behind it `chain_count · depth` [`BiquadRecord`]s, chain by chain.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct BiquadsHeader {
    /// Which object, counted from 0 in the order of the `OBJT` sections.
    pub object: U16,
    /// Number of chains side by side.
    pub chain_count: U16,
    /// Number of biquads in each chain, one behind the other.
    pub depth: U16,
    /// 0.
    pub reserved: U16,
    /// The rate in Hz that poles and zeros are for.
    pub rate_hz: F32,
}

/// A biquad `k (1 - 2 Re q z⁻¹ + |q|² z⁻²) / (1 - 2 Re p z⁻¹ + |p|² z⁻²)` (diffmodal eq. 2).
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct BiquadRecord {
    /// Real part of the pole p.
    pub pole_re: F32,
    /// Imaginary part of the pole p.
    pub pole_im: F32,
    /// Real part of the zero q; 0 with `zero_im` 0 stands for none.
    pub zero_re: F32,
    /// Imaginary part of the zero q.
    pub zero_im: F32,
    /// Gain k.
    pub gain: F32,
}
