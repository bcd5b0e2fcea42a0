//! Reasons for which a kit is refused, in the form in which the log tells them.
//!
//! The log carries the errors of dsp-core by defmt's derived format: only their numbers leave the
//! board. Sentences made on the board would take 10 KB of flash, most of it for decimals.
//! `malleus kit check` prints the sentences.

use dsp_core::engine::LoadError;
use dsp_core::table::TableError;
use dsp_core::trigger::TriggerError;

/// Reason for which a kit, or a stage of it, does not play.
#[derive(Clone, Copy, Debug, PartialEq, defmt::Format)]
pub enum Refusal {
    /// The bytes are not a valid kit.
    Table(TableError),
    /// The engine refuses the kit, or leaves out one of its stages, at the board's sample rate.
    Load(LoadError),
    /// The settings of the kit's triggers or buttons are invalid.
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
