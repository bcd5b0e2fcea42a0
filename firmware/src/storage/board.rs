//! The board as the cable sees it ([`cable::Store`]).

use boards::Board;
use cable::{Content, Identity, Job, Key, LeftOut, Refusal, Store, Text, Value};

use super::slots;
use super::state::Storage;
use crate::board::sector::Sector;
use crate::board::{CLOCKS, Memory, NAME, SLOTS};
use crate::{audio, dfu};

impl Storage {
    /// Erases a sector, behind a fade. If its kit plays, the built-in kit plays from then on.
    fn erase_sector(&mut self, sector: Sector) -> Result<(), Refusal> {
        if self.playing.sector == Some(sector) {
            self.play(None)?;
        }
        let _hushed = audio::hush();
        self.flash.erase(sector).map_err(|error| slots::refusal(error, sector))
    }
}

/// Returns the refusal of a slot that the board does not have.
fn no_slot(slot: u8) -> Refusal {
    Refusal::NoSuchSlot { slot, slots: SLOTS }
}

impl Store for Storage {
    fn identity(&self) -> Identity {
        Identity {
            firmware: Text::new(env!("CARGO_PKG_VERSION")),
            revision: Text::new(env!("GIT_REVISION")),
            board: Text::new(NAME),
            rate: CLOCKS.sample_rate(),
        }
    }

    fn playing(&self) -> Option<u8> {
        self.playing.slot
    }

    fn slots(&self) -> u8 {
        SLOTS
    }

    fn bytes(&self, slot: u8) -> Option<&[u8]> {
        self.slots.sector(slot).map(|sector| sector.read())
    }

    fn uploaded(&self, slot: u8) -> Option<&[u8]> {
        self.slots.upload_sector(slot).map(|sector| sector.read())
    }

    fn content(&self, bytes: &[u8], tell: &mut dyn FnMut(LeftOut)) -> Content {
        Content::of(bytes, |kit, tell| Memory::plan(kit, tell).map(drop), tell)
    }

    fn longest_ms(&self, job: Job) -> u16 {
        match job {
            // An erase of 128 KB takes 2 s, and loading the built-in kit before it 0.4 s.
            Job::Prepare(_) | Job::Erase(_) => 3000,
            // A setting may ask for an erase of 16 KB, 0.5 s. The checks of a kit of 128 KB take
            // 0.5 s, and loading one of many filters 1.5 s.
            Job::Set(_) => 1000,
            Job::Finish(_) => 2000,
            Job::Start(_) => 3000,
            Job::EnterDfu => 0,
        }
    }

    fn erase(&mut self, slot: u8) -> Result<(), Refusal> {
        let sector = self.slots.sector(slot).ok_or(no_slot(slot))?;
        self.erase_sector(sector)
    }

    fn prepare(&mut self, slot: u8) -> Result<(), Refusal> {
        let sector = self.slots.upload_sector(slot).ok_or(no_slot(slot))?;
        self.erase_sector(sector)
    }

    fn commit(&mut self, slot: u8) -> Result<(), Refusal> {
        self.slots.commit(&mut self.flash, slot)
    }

    fn write(&mut self, slot: u8, offset: usize, bytes: &[u8]) -> Result<(), Refusal> {
        let sector = self.slots.upload_sector(slot).ok_or(no_slot(slot))?;
        let offset = offset as u32;
        if !offset.is_multiple_of(4) || bytes.len() > sector.bytes.saturating_sub(offset) as usize {
            return Err(Refusal::BadMessage);
        }
        self.flash.program(sector.address + offset, bytes).map_err(|error| slots::refusal(error, sector))
    }

    fn setting(&self, key: Key) -> Result<Option<Value>, Refusal> {
        self.settings.get(key)
    }

    fn set(&mut self, key: Key, value: Option<Value>) -> Result<(), Refusal> {
        if let (Key::StartSlot, Some(Value::Count(SLOTS..))) = (key, value) {
            return Err(Refusal::SettingRange { key: key.parts().0 });
        }
        if self.settings.get(key)? == value {
            return Ok(());
        }
        self.settings.set(&mut self.flash, key, value)?;
        match key {
            Key::StartSlot => Ok(()),
            _ => self.apply_settings(),
        }
    }

    fn start(&mut self, slot: Option<u8>) -> Result<(), Refusal> {
        self.play(slot)
    }

    fn enter_dfu(&mut self) {
        // The answer leaves while the sound fades.
        let _hushed = audio::hush();
        dfu::enter()
    }
}
