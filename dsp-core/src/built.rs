//! Stages that a program contains.

/// Optional stages that a program contains. Each takes flash whether a kit uses it or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Built {
    /// True if biquads can be loaded: 35 KB on a Cortex-M4.
    pub biquads: bool,
    /// True if a room can be loaded: 34 KB on a Cortex-M4.
    pub room: bool,
    /// True if contacts can scrape and roll: 41 KB on a Cortex-M4.
    pub scrapes: bool,
}

impl Built {
    /// Stages of this build: its cargo features `biquads`, `room` and `scrapes`.
    pub const HERE: Self =
        Self { biquads: cfg!(feature = "biquads"), room: cfg!(feature = "room"), scrapes: cfg!(feature = "scrapes") };
}
