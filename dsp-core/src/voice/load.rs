//! Loading of a voice: from a kit's tables to its banks.

use super::form::Form;
use super::state::Voice;
use super::tables::{NO_CONTACT, PadTables};
use crate::SampleRate;
use crate::contact::law::typical_contact;
use crate::frames::{FrameBank, FrameBankSize, FrameMixer};
use crate::memory::{Memory, OutOfMemory, Region};
use crate::output::Panner;
use crate::radiation::Acceleration;
use crate::resonator::{Bank, BankError, BankSize, BankTable};
use crate::table::layout::STRIKERS_PER_PAD;

/// Sizes of a voice's banks: of the object's, and of the strikers' up to the last one with modes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VoiceSize {
    banks: [BankSize; 1 + STRIKERS_PER_PAD],
    count: usize,
    /// Size of the object's bank if its modes are in frames.
    frames: Option<FrameBankSize>,
}

impl VoiceSize {
    /// Sizes of the banks of a pad at a sample rate.
    ///
    /// # Errors
    /// A [`BankError`] with the striker that it concerns, or `None` for the object.
    #[inline(never)] // the engine's load asks for it in four places
    pub fn new(tables: &PadTables<'_>, rate: SampleRate) -> Result<Self, (BankError, Option<usize>)> {
        let mut size = Self::default();
        for (slot, (which, table)) in size.banks.iter_mut().zip(tables.banks()) {
            *slot = Bank::size(&table, rate).map_err(|error| (error, which))?;
            size.count += 1;
        }
        Ok(size)
    }

    /// Sizes with the modes of an object that has at least `fewest` in frames, or the reason why
    /// they stay in the bank. `is_scraped` says that the engine plays contacts that go on.
    ///
    /// # Errors
    /// A [`BankError`] for a table that no bank can hold.
    #[inline(never)]
    pub fn in_frames(
        mut self,
        tables: &PadTables<'_>,
        rate: SampleRate,
        fewest: usize,
        is_scraped: bool,
    ) -> Result<Result<Self, Form>, BankError> {
        let table = tables.object_table(NO_CONTACT);
        if FrameBank::mode_count_of(&table, rate) < fewest {
            return Ok(Err(Form::FewModes));
        }
        if tables.filter_takes_modes() {
            return Ok(Err(Form::Filtered));
        }
        if is_scraped && tables.is_scraped_along() {
            return Ok(Err(Form::Scraped));
        }
        if !FrameBank::can_choke(&table, rate) {
            return Ok(Err(Form::FastChoke));
        }
        let contact_frames = tables.longest_contact_s() * rate.hz_f32();
        self.frames = Some(FrameBankSize { contact_frames: contact_frames as u32, ..FrameBank::size(&table, rate)? });
        if let Some(object) = self.banks.first_mut() {
            *object = BankSize::default();
        }
        Ok(Ok(self))
    }

    /// Sizes of the banks, the object's first.
    pub fn banks(&self) -> &[BankSize] {
        self.banks.get(..self.count).unwrap_or(&[])
    }

    /// Number of modes of all banks.
    pub fn modes(&self) -> usize {
        self.banks().iter().map(|bank| bank.modes).sum::<usize>() + self.frames.map_or(0, |frames| frames.modes)
    }

    /// True if the object's modes are in frames.
    pub fn is_in_frames(&self) -> bool {
        self.frames.is_some()
    }

    /// Nominal cycles a frame of the modes in frames: in the dearest tick of a strike, or under a
    /// force that never rests if a sensor's signal itself is the force (`is_direct`).
    pub fn frame_cycles(&self, is_direct: bool) -> u32 {
        self.frames.map_or(0, |size| size.cycles(is_direct))
    }

    /// Number of modes in frames.
    pub fn modes_in_frames(&self) -> usize {
        self.frames.map_or(0, |size| size.modes)
    }

    /// Number of register groups of all banks.
    pub fn groups(&self) -> usize {
        self.banks().iter().map(|bank| bank.groups).sum()
    }

    /// Number of modes that the object's second slot has gains for; 0 if it has one position only.
    pub fn second_modes(&self, tables: &PadTables<'_>) -> usize {
        if tables.object().position_count() > 1 { self.banks().first().map_or(0, |bank| bank.modes) } else { 0 }
    }
}

impl<'k: 'm, 'm> Voice<'k, 'm> {
    /// Takes the memory of a voice's banks.
    ///
    /// # Errors
    /// [`OutOfMemory`] if too little is left.
    pub fn take(memory: &mut Memory<'m>, size: &VoiceSize) -> Result<Self, OutOfMemory> {
        let banks = memory.take(Region::Fast, size.banks().len(), Bank::empty)?;
        for (index, &size) in size.banks().iter().enumerate() {
            let bank = Bank::take(memory, size)?;
            // A memory that only counts gives no slices.
            if let Some(slot) = banks.get_mut(index) {
                *slot = bank;
            }
        }
        let mut frames = None;
        if let Some(size) = size.frames {
            let bank = FrameBank::take(memory, size)?;
            let place = memory.take(Region::Fast, 1, FrameBank::empty)?;
            frames = place.first_mut();
            if let Some(slot) = &mut frames {
                **slot = bank;
            }
        }
        Ok(Self { banks, is_plain: frames.is_none(), frames, ..Self::empty() })
    }

    /// Takes the memory of the object's second slot.
    ///
    /// # Errors
    /// [`OutOfMemory`] if too little is left; contacts at a second position are then merged.
    pub fn take_second(&mut self, memory: &mut Memory<'m>, modes: usize) -> Result<(), OutOfMemory> {
        match self.banks.first_mut() {
            Some(object) => object.take_second(memory, modes),
            None => Bank::empty().take_second(memory, modes),
        }
    }

    /// Derives the banks and the rest of the pad from its tables, in memory taken for their size.
    /// Modes in frames need the engine's `mixer`.
    ///
    /// # Errors
    /// A [`BankError`] with the striker that it concerns, or `None` for the object.
    pub fn load(
        &mut self,
        tables: &PadTables<'k>,
        rate: SampleRate,
        mixer: Option<&mut FrameMixer<'m>>,
    ) -> Result<(), (BankError, Option<usize>)> {
        let (pad, object) = (tables.pad(), tables.object());
        self.reference_force = object.reference_force();
        self.acceleration = match tables.is_balanced() {
            // The banks hold it.
            true => Acceleration::NONE,
            false => Acceleration::new(object.acceleration(), object.reference_force()),
        };
        self.panner = Panner::new(pad.level_db(), pad.pan());
        for (slot, striker) in self.contacts.iter_mut().zip(tables.strikers()) {
            *slot = Some(striker.contact());
            self.striker_count += 1;
        }
        if let Some(first) = self.contacts.iter().flatten().next() {
            self.last_pulse.of(first);
        }
        let in_frames = usize::from(self.frames.is_some());
        if let (Some(frames), Some(mixer)) = (self.frames.as_deref_mut(), mixer) {
            let table = tables.object_table(NO_CONTACT);
            frames.load(&table, rate, self.panner.factors(), mixer).map_err(|error| (error, None))?;
            self.mode_count += frames.mode_count() as u16;
        }
        for (bank, (which, table)) in self.banks.iter_mut().zip(tables.banks()).skip(in_frames) {
            bank.load(&table, rate).map_err(|error| (error, which))?;
            self.mode_count += bank.mode_count() as u16; // all banks count in 16 bits
            self.group_count += bank.group_count() as u16; // at most as many
        }
        Ok(())
    }
}

impl<'a> PadTables<'a> {
    /// Tables of the pad's banks, each with the number of its striker, or `None` for the object:
    /// the object's first, then those of the strikers up to the last one with modes that sound.
    fn banks(&self) -> impl Iterator<Item = (Option<usize>, BankTable<'_>)> + use<'_, 'a> {
        let reference_force = self.object().reference_force();
        let typical = move |contact| typical_contact(&contact, reference_force);
        let first = self.strikers().next().map_or((0.0, 0.0), |striker| typical(striker.contact()));
        let weight = self.pad().striker_weight();
        let sounds = self.strikers().map(move |striker| !striker.modes().is_empty() && weight != 0.0);
        let sounding = sounds.enumerate().filter(|(_, sounds)| *sounds).map(|(index, _)| index + 1).last().unwrap_or(0);
        let strikers = self.strikers().take(sounding).enumerate();
        let strikers = strikers.filter_map(move |(index, striker)| {
            Some((Some(index), self.striker_table(index, typical(striker.contact()))?))
        });
        core::iter::once((None, self.object_table(first))).chain(strikers)
    }
}
