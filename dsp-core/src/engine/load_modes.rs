//! Loading of the pads' modes: each pad's form, its memory and its banks.

use super::error::LoadError;
use super::moving::Moved;
use super::setup::{Fitting, Skipping};
use super::stage::Stage;
use super::state::Engine;
use crate::built::Built;
use crate::frames::{FEWEST_MODES, FEWEST_MODES_OF_SEVERAL, FrameMixer};
use crate::memory::Memory;
use crate::room::Sample;
use crate::scrape::Contact;
use crate::voice::{Form, PadTables, Voice, VoiceSize};

/// Maximum number of pads: events name them by a byte.
const PADS: usize = 1 << u8::BITS;

impl<'k: 'm, 'm, S: Sample> Engine<'k, 'm, S> {
    #[inline(never)] // keeps its stack apart from that of the stages that follow
    pub(super) fn load_modes(
        &mut self,
        position_cycles: Option<u32>,
        memory: &mut Memory<'m>,
        fitting: &mut Fitting<'_>,
    ) -> Result<(), LoadError> {
        let (kit, rate) = (self.kit, self.rate);
        let mut in_frames = [false; PADS];
        let fewest = self.fewest_modes_in_frames();
        for (number, in_frames) in (0..kit.pads().len() as u8).zip(&mut in_frames) {
            let Some(tables) = PadTables::new(kit, usize::from(number)) else { continue };
            let refused = |(error, striker)| LoadError::Pad { pad: usize::from(number), striker, error, rate };
            let size = VoiceSize::new(&tables, rate).map_err(refused)?;
            let framed =
                size.in_frames(&tables, rate, fewest, self.can_scrape()).map_err(|error| refused((error, None)))?;
            let framed = framed.and_then(|framed| self.admit_to_frames(number, framed, memory));
            let (size, form) = framed.map_or_else(|reason| (size, reason), |framed| (framed, Form::Frames));
            let missing = |error| LoadError::Memory { stage: Stage::Modes(number), error };
            if form == Form::Frames {
                let is_direct = self.is_direct(number);
                *in_frames = true;
                if let Some(left) = &mut self.frame_cycles {
                    *left -= size.frame_cycles(is_direct);
                }
                if !self.has_mixer {
                    let retires = self.skipping == Skipping::On;
                    self.frames = FrameMixer::place(memory, retires).map_err(missing)?;
                    self.has_mixer = true;
                }
            }
            let has_positions = tables.object().position_count() > 1;
            let cycles = if has_positions { Moved::of_size(&size).cycles() } else { 0 };
            let left = position_cycles.filter(|&left| cycles > left);
            if let Some(left) = left {
                fitting.leave_out(LoadError::TooDear { stage: Stage::Positions(number), cycles, left })?;
            }
            let voice = Voice::take(memory, &size).map_err(missing)?;
            self.groups_built += size.groups() as u32;
            // A memory that only counts gives no slices.
            if let Some(slot) = self.voices.get_mut(usize::from(number)) {
                *slot = voice;
                slot.form = form;
                slot.moves = left.is_none();
                slot.set_number(number);
                slot.load(&tables, rate, self.frames.as_deref_mut()).map_err(refused)?;
            }
        }
        // Memory that is left then serves second positions.
        for (number, in_frames) in (0..kit.pads().len()).zip(in_frames) {
            let Some(tables) = PadTables::new(kit, number).filter(|_| !in_frames) else { continue };
            let modes = VoiceSize::new(&tables, rate).map_or(0, |size| size.second_modes(&tables));
            let mut none = Voice::empty();
            let voice = self.voices.get_mut(number).unwrap_or(&mut none);
            if modes > 0 && voice.take_second(memory, modes).is_err() {
                break;
            }
        }
        Ok(())
    }

    /// Fewest modes of a pad whose modes are played in frames.
    ///
    /// With a limit a pad must take fewer cycles there under any force. Without one it is the usual
    /// case that counts: pads that ring, and some strikes.
    fn fewest_modes_in_frames(&self) -> usize {
        if self.frame_cycles.is_some() {
            return FEWEST_MODES;
        }
        let framed = |number| {
            let tables = PadTables::new(self.kit, number)?;
            let size = VoiceSize::new(&tables, self.rate).ok()?;
            size.in_frames(&tables, self.rate, FEWEST_MODES_OF_SEVERAL, self.can_scrape()).ok()?.ok()
        };
        let modes: usize = (0..self.kit.pads().len()).filter_map(framed).map(|size| size.modes_in_frames()).sum();
        if modes < FEWEST_MODES { FEWEST_MODES } else { FEWEST_MODES_OF_SEVERAL }
    }

    /// True if a force may act on a pad that never rests: a sensor's signal itself, or a contact
    /// that goes on.
    fn is_direct(&self, number: u8) -> bool {
        let pad = usize::from(number);
        let strikers = 0..self.kit.pads().nth(pad).map_or(0, |pad| pad.striker_indices().count());
        let is_scraped = self.can_scrape()
            && strikers.into_iter().any(|striker| Contact::is_possible(&self.kit, pad, striker, false));
        is_scraped
            || self.kit.triggers().any(|trigger| trigger.pad_index() == usize::from(number) && trigger.is_direct())
    }

    /// True if the program and the setup have contacts that go on.
    pub(super) fn can_scrape(&self) -> bool {
        Built::HERE.scrapes && self.built.scrapes
    }

    /// Gives back the size of a pad in frames, or the reason why its modes stay in the bank:
    /// cycles, or memory beside the banks of the pads behind it.
    #[inline(never)]
    fn admit_to_frames(&self, number: u8, framed: VoiceSize, memory: &Memory<'m>) -> Result<VoiceSize, Form> {
        if self.frame_cycles.is_some_and(|left| framed.frame_cycles(self.is_direct(number)) > left) {
            return Err(Form::TooDear);
        }
        let mut count = memory.rest();
        let mut take = |size: &VoiceSize| Voice::take(&mut count, size).is_ok();
        let mut fits = take(&framed);
        for later in usize::from(number) + 1..self.kit.pads().len() {
            let tables = PadTables::new(self.kit, later);
            fits &= tables.and_then(|tables| VoiceSize::new(&tables, self.rate).ok()).is_none_or(|size| take(&size));
        }
        fits &= self.has_mixer || FrameMixer::place(&mut count, true).is_ok();
        if fits { Ok(framed) } else { Err(Form::NoMemory) }
    }
}
