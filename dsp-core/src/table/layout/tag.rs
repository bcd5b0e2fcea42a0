//! The registry of section tags.

/// [`MetaRecord`](super::MetaRecord): the kit's name. Exactly one section.
pub const META: [u8; 4] = *b"META";
/// Object: [`ObjectHeader`](super::ObjectHeader), modes, gains, texts. One section for each
/// object.
pub const OBJECT: [u8; 4] = *b"OBJT";
/// Striker: [`StrikerHeader`](super::StrikerHeader), modes, gains, texts. One section for each
/// striker.
pub const STRIKER: [u8; 4] = *b"STRK";
/// [`PadRecord`](super::PadRecord)s of all pads. Exactly one section.
pub const PADS: [u8; 4] = *b"PADS";
/// [`TriggerRecord`](super::TriggerRecord)s of the pads that have some. At most one section; a
/// reader may skip it.
pub const TRIGGER: [u8; 4] = *b"trig";
/// Residual of an object: [`ResidualHeader`](super::ResidualHeader), edges,
/// [`ResidualBandRecord`](super::ResidualBandRecord)s. At most one section for each object, in
/// their order; a reader may skip it.
pub const RESIDUAL: [u8; 4] = *b"resi";
/// Background: [`BackgroundHeader`](super::BackgroundHeader), edges, weights. At most one
/// section; a reader may skip it.
pub const BACKGROUND: [u8; 4] = *b"bgnd";
/// Room: [`RoomBandRecord`](super::RoomBandRecord)s, from the lowest up. At most one section; a
/// reader may skip it.
pub const ROOM: [u8; 4] = *b"room";
/// Dynamic filter of an object: [`DynamicFilterHeader`](super::DynamicFilterHeader),
/// [`BreakpointRecord`](super::BreakpointRecord)s, [`LoopRecord`](super::LoopRecord)s, levels.
/// At most one section for each object, in their order; a reader may skip it.
pub const DYNAMIC_FILTER: [u8; 4] = *b"dynf";
/// Biquad bank of an object: [`BiquadsHeader`](super::BiquadsHeader),
/// [`BiquadRecord`](super::BiquadRecord)s, chain by chain. At most one section for each object,
/// in their order; a reader may skip it.
pub const BIQUADS: [u8; 4] = *b"biqd";
/// Restitution of each striker as [`F32`](super::F32), in their order. At most one section;
/// without it each striker has
/// [`DEFAULT_RESTITUTION`](crate::table::range::DEFAULT_RESTITUTION). A reader may skip it.
pub const RESTITUTION: [u8; 4] = *b"rest";
/// Objects whose acceleration sound is derived: a [`U16`](super::U16) count, then that number
/// of object numbers, then zeros up to a multiple of 4. At most one section; a reader that
/// skips it plays the acceleration sound in [`ObjectHeader`](super::ObjectHeader).
pub const BALANCE: [u8; 4] = *b"bala";
/// Volume of a board's headphones in dB as [`F32`](super::F32). At most one section; without it
/// they play at [`DEFAULT_HEADPHONE_DB`](crate::table::range::DEFAULT_HEADPHONE_DB). A reader
/// may skip it.
pub const HEADPHONE: [u8; 4] = *b"head";
/// Surface; one section for each, which a reader may skip. It holds a
/// [`SurfaceHeader`](super::SurfaceHeader), then heights, curvature, slopes and texts.
pub const SURFACE: [u8; 4] = *b"surf";
/// Surfaces of objects: [`ObjectSurfaceRecord`](super::ObjectSurfaceRecord)s in the order of their
/// objects. At most one section; a reader may skip it.
pub const OBJECT_SURFACES: [u8; 4] = *b"osur";
/// Strikers that scrape: [`ScrapeRecord`](super::ScrapeRecord)s in their order. At most one
/// section; a reader may skip it.
pub const SCRAPE: [u8; 4] = *b"scrp";
/// Strikers that roll: [`RollRecord`](super::RollRecord)s in their order. At most one section; a
/// reader may skip it.
pub const ROLL: [u8; 4] = *b"roll";
/// All tags that this crate knows.
pub const KNOWN: [[u8; 4]; 17] = [
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
    HEADPHONE,
    SURFACE,
    OBJECT_SURFACES,
    SCRAPE,
    ROLL,
];
