//! Plan of a kit: the memory and time that an engine of it takes.

use super::error::LoadError;
use super::setup::{Fitting, Setup};
use super::state::Engine;
use crate::memory::{Memory, Words};
use crate::room::Sample;
use crate::table::Kit;

/// Memory and time that a kit takes, counted without either.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// Words of memory that the engine takes.
    pub words: Words,
    /// Worst cycles a tick that pads, room, background and filters that modes go through leave for
    /// stages that strikes begin; `None` without a limit.
    pub stage_cycles_left: Option<u32>,
}

impl Plan {
    /// Plans a whole kit; [`Engine::new`] takes exactly these words. `S` is the sample type of the
    /// room.
    ///
    /// # Errors
    /// A [`LoadError`] for the first stage that [`Engine::new`] would refuse.
    pub fn of<S: Sample>(kit: &Kit<'_>, setup: Setup) -> Result<Self, LoadError> {
        Self::build::<S>(kit, setup, Words::MAX, Fitting::ALL)
    }

    /// Plans what fits into a number of words, and of cycles a tick; [`Engine::new_within`] takes
    /// exactly these words. `tell` hears of each stage that is left out.
    ///
    /// # Errors
    /// A [`LoadError`] for modes that [`Engine::new_within`] would refuse.
    pub fn within<S: Sample>(
        kit: &Kit<'_>,
        setup: Setup,
        words: Words,
        stage_cycles: u32,
        tell: &mut dyn FnMut(LoadError),
    ) -> Result<Self, LoadError> {
        Self::build::<S>(kit, setup, words, Fitting::within(stage_cycles, kit.pads().len(), tell))
    }

    fn build<S: Sample>(kit: &Kit<'_>, setup: Setup, words: Words, fitting: Fitting<'_>) -> Result<Self, LoadError> {
        let mut memory = Memory::count(words);
        let engine = Engine::<S>::build(kit, setup, &mut memory, fitting)?;
        Ok(Self { words: memory.used(), stage_cycles_left: engine.stage_cycles })
    }
}
