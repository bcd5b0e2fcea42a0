//! Kit that plays: the one of the start, and others in its place.

use cable::Refusal as CableRefusal;
use dsp_core::table::Kit;
use dsp_core::table::range::DEFAULT_HEADPHONE_DB;

use super::flash::Flash;
use super::settings::Settings;
use super::slots::Slots;
use super::state::{Playing, Storage};
use crate::audio::instrument::Instrument;
use crate::audio::{self, BUDGET_CYCLES};
use crate::board::sector::Sector;
use crate::faults::{self, Fault};
use crate::input::Overrides;
use crate::refusal::Refusal;
use crate::{input, journal, kits, volume, watchdog};

/// Kit that a board plays after its start.
pub struct Started {
    /// Kit, which the instrument has loaded.
    pub kit: Kit<'static>,
    /// Settings that go before those of the kit's triggers.
    pub overrides: Overrides,
    /// MIDI channel, counted from 0; `None` for all channels.
    pub channel: Option<u8>,
}

impl Storage {
    /// Reads settings and slots.
    ///
    /// # Safety
    /// This is called once.
    pub unsafe fn open() -> Self {
        // SAFETY: the caller promises to call this once.
        let mut flash = unsafe { Flash::take_over() };
        let settings = Settings::read(&mut flash);
        let slots = Slots::read(&mut flash);
        Self { flash, settings, slots, playing: Playing { kit: None, slot: None, sector: None } }
    }

    /// Loads the kit of the start's slot if it is good, else the built-in one.
    ///
    /// Returns `None` if neither plays.
    // Not inlined: its stack must not add to that of the whole program.
    #[inline(never)]
    pub fn load_first(&mut self, instrument: &mut Instrument) -> Option<Started> {
        instrument.set_gain(self.settings.gain());
        let slot = self.settings.start_slot();
        let loaded = match self.read(slot) {
            Ok(Some((kit, sector))) => match self.load(instrument, &kit) {
                Ok(()) => {
                    defmt::info!("slot {=u8}: {=str} plays", slot, kit.name());
                    self.playing = Playing { kit: Some(kit), slot: Some(slot), sector: Some(sector) };
                    Some(kit)
                }
                Err(refusal) => refuse(slot, refusal),
            },
            Ok(None) => {
                defmt::info!("slot {=u8}: empty, the built-in kit plays", slot);
                None
            }
            Err(refusal) => refuse(slot, refusal),
        };
        let kit = match loaded {
            Some(kit) => kit,
            None => {
                let kit = Kit::parse(kits::BUILT_IN).ok()?;
                self.load(instrument, &kit).ok()?;
                self.playing.kit = Some(kit);
                kit
            }
        };
        Some(Started { kit, overrides: self.settings.overrides(), channel: self.settings.channel() })
    }

    /// Kit of a slot and its sector; `None` if the slot is empty.
    fn read(&self, slot: u8) -> Result<Option<(Kit<'static>, Sector)>, Refusal> {
        let Some(sector) = self.slots.sector(slot) else { return Ok(None) };
        Ok(kits::read(sector.read())?.map(|kit| (kit, sector)))
    }

    /// Loads a kit into the instrument, if its inputs can be set.
    fn load(&self, instrument: &mut Instrument, kit: &Kit<'static>) -> Result<(), Refusal> {
        input::Settings::check(kit, &self.settings.overrides())?;
        let tell = |error| {
            defmt::warn!("left out: {}", Refusal::Load(error));
            // A large kit of which much is left out takes long to load.
            watchdog::feed();
        };
        Ok(instrument.load(kit, BUDGET_CYCLES, tell)?)
    }

    /// Plays the kit of a slot in place of the one that plays, after a fade; `None` is the built-in
    /// kit.
    ///
    /// # Errors
    /// A refusal by name. The kit that played goes on.
    // Not inlined: its stack must not add to that of the task's other work.
    #[inline(never)]
    pub fn play(&mut self, slot: Option<u8>) -> Result<(), CableRefusal> {
        let next = match slot {
            Some(slot) => match self.read(slot) {
                Ok(Some((kit, sector))) => Playing { kit: Some(kit), slot: Some(slot), sector: Some(sector) },
                Ok(None) => return Err(CableRefusal::EmptySlot { slot }),
                Err(Refusal::Table(error)) => return Err(error.into()),
                Err(_) => return Err(CableRefusal::NotLoadable),
            },
            None => Playing { kit: Kit::parse(kits::BUILT_IN).ok(), slot: None, sector: None },
        };
        let Some(mut hushed) = audio::hush() else { return Err(CableRefusal::Working) };
        let before = core::mem::replace(&mut self.playing, next);
        let changed = self.change(&mut hushed);
        if changed.is_err() {
            self.playing = before;
            // It played before.
            let _ = self.change(&mut hushed);
        }
        match self.playing.kit {
            Some(kit) if changed.is_ok() => match slot {
                Some(slot) => defmt::info!("slot {=u8}: {=str} plays", slot, kit.name()),
                None => defmt::info!("the built-in kit plays"),
            },
            _ => {}
        }
        faults::set(Fault::Kit, false);
        changed
    }

    /// Applies settings that have changed to the kit that plays, after a fade.
    pub(super) fn apply_settings(&mut self) -> Result<(), CableRefusal> {
        let (Some(kit), Some(mut hushed)) = (self.playing.kit, audio::hush()) else { return Ok(()) };
        hushed.set_inputs(&kit, &self.settings.overrides()).map_err(|_| CableRefusal::NotLoadable)?;
        hushed.set_keyboard(kit, self.settings.channel());
        hushed.instrument().set_gain(self.settings.gain());
        Ok(())
    }

    /// Plays the kit of `self.playing`.
    fn change(&self, hushed: &mut audio::Hushed) -> Result<(), CableRefusal> {
        let Some(kit) = self.playing.kit else { return Err(CableRefusal::NotLoadable) };
        // Lines of before the change name the pads of the old kit.
        journal::pass_on(Some(kit));
        self.load(hushed.instrument(), &kit).map_err(|refusal| {
            defmt::error!("the kit is refused: {}", refusal);
            CableRefusal::NotLoadable
        })?;
        hushed.set_inputs(&kit, &self.settings.overrides()).map_err(|_| CableRefusal::NotLoadable)?;
        hushed.set_keyboard(kit, self.settings.channel());
        volume::set_db(kit.headphone_db().unwrap_or(DEFAULT_HEADPHONE_DB));
        Ok(())
    }
}

/// Logs that the kit of a slot is refused, and shows the fault.
fn refuse<T>(slot: u8, refusal: Refusal) -> Option<T> {
    faults::set(Fault::Kit, true);
    defmt::error!("slot {=u8}: {}; the built-in kit plays", slot, refusal);
    None
}
