//! Tables of modes, as banks are loaded from them.

use crate::table::layout::{GainRecord, ModeRecord};

/// Modes of a table, as a bank is loaded from them.
#[derive(Clone, Copy, Debug)]
pub struct BankTable<'a> {
    /// Frequencies and decays.
    pub modes: &'a [ModeRecord],
    /// Gains: all positions of the first mode, then of the second ...
    pub gains: &'a [GainRecord],
    /// Number of positions, at least 1.
    pub positions: usize,
    /// Factor of all gains: reference force, and η for a striker.
    pub weight: f64,
    /// T60 of its choke in seconds, or 0 if it cannot be choked.
    pub choke_t60_s: f64,
    /// True if the force itself takes away the modes' static response (`acceleration = "balance"`),
    /// beside half of `h[0]`.
    pub is_balanced: bool,
    /// A typical contact, (impulse in bus units of force times seconds, contact time in s). It
    /// decides the order of modes, not their sound.
    pub typical_contact: (f32, f32),
}

/// Reason for which a bank cannot be loaded.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BankError {
    /// A mode decays faster than [`super::coefficient::max_decay_per_s`] at this rate.
    DecayTooFast {
        /// Index of the mode in the table.
        mode: usize,
        /// Its decay in 1/s.
        decay_per_s: f32,
    },
    /// Gains times reference force times weight are beyond the range of the fixed-point form (2^14
    /// times the rate).
    GainTooLarge,
}
