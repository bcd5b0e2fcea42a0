//! A pad: one struck object with its strikers (diffimpact eq. 1 without residual, background and room).
//!
//! ```text
//! contacts of striker s --> F_s --+--> η · striker bank s --+
//! direct force (counts as s = 0) -+                         |
//!                                 +-- F = Σ F_s --> object bank --+--> level, pan --> stereo
//!                                              \--> α · F --------+
//! ```
//!
//! A second strike adds energy to the same ringing banks.

mod filters;
mod hand;
mod render;
mod tables;

pub(crate) use filters::nepers;
pub use filters::{FilterWork, PadFilters};
pub use hand::Hand;
pub use tables::PadTables;

use crate::SampleRate;
use crate::contact::law::{Impact, StrikerLaw, typical_contact};
use crate::fixed;
use crate::output::Panner;
use crate::radiation::Acceleration;
use crate::resonator::{Bank, BankError, BankTable, BankWork, Group, Memory, Place, Retirement, Used};
use crate::table::ContactTable;
use crate::table::layout::STRIKERS_PER_PAD;
use tables::NO_CONTACT;

/// A pad's stages and their state, but for its banks: those of all pads lie together in the engine, so that a pad has room for the strikers
/// that sound and no others. What concerns them takes the pad's own part of them, [`Pad::own`].
#[derive(Clone, Debug)]
pub struct Pad<'k> {
    /// The contacts of its strikers, in place.
    contacts: [Option<ContactTable<'k>>; STRIKERS_PER_PAD],
    reference_force: f32,
    /// The object's bank, and behind it those of the strikers up to the last one with modes.
    first_bank: u16,
    bank_count: u8,
    striker_count: u8,
    mode_count: u16,
    acceleration: Acceleration,
    panner: Panner,
    /// |force| that contacts which have just begun will bring, until the banks are guarded for it: in steps of [`EXPECTED_STEP`], rounded up.
    expected: u32,
    /// Whether a hand is to lie on the pad from the next tick on, and whether one does.
    is_hand_wanted: bool,
    is_choked: bool,
    struck: bool,
    /// The slot of the latest strike.
    direct_slot: u8,
    /// Coming ticks in which no bank has anything to do, and those of them that have passed without the banks' knowing.
    rest_ticks: u8,
    passed_ticks: u8,
    /// Sum of the banks' retired amplitudes at the last tick that had something to do.
    retired_amplitude: f32,
}

/// Bus steps.
const EXPECTED_STEP: u64 = 256;

/// What a pad did over a run of frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PadWork {
    /// The object's bank.
    pub object: BankWork,
    /// All strikers' banks.
    pub strikers: BankWork,
    /// Frames for which the acceleration sound was computed.
    pub acceleration_frames: u32,
    /// Frames for which a direct force was taken in.
    pub direct_frames: u32,
    /// Frames in which a force was made or taken in.
    pub force_frames: u32,
}

/// A run of frames of at most a tick, as a pad renders it.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// Number of frames.
    pub frames: usize,
    /// Whether the first frame's absolute number is odd.
    pub odd_start: bool,
    /// Whether what is not needed may be left out.
    pub skip: bool,
    /// Direct force for this pad, Q4.27.
    pub direct: Option<&'a [i32]>,
}

impl<'k> Pad<'k> {
    /// A pad without object or strikers.
    pub const EMPTY: Self = Self {
        contacts: [None; STRIKERS_PER_PAD],
        reference_force: 0.0,
        first_bank: 0,
        bank_count: 0,
        striker_count: 0,
        mode_count: 0,
        acceleration: Acceleration::NONE,
        panner: Panner::SILENT,
        expected: 0,
        is_hand_wanted: false,
        is_choked: false,
        struck: false,
        direct_slot: 0,
        rest_ticks: 0,
        passed_ticks: 0,
        retired_amplitude: 0.0,
    };

    /// Derives a pad from its tables for a sample rate; its banks go to the beginning of `banks`, the first of which has the number `first_bank`.
    /// `which` names, in case of an error, the bank: `None` the object's, or a striker's.
    ///
    /// # Errors
    /// A [`BankError`] and the bank that it concerns.
    pub fn load(
        tables: &PadTables<'k>,
        rate: SampleRate,
        memory: &mut Memory<'_>,
        used: &mut Used,
        banks: &mut [Bank],
    ) -> Result<Self, (BankError, Option<usize>)> {
        let (pad, object) = (tables.pad(), tables.object());
        let mut loaded = Self {
            reference_force: object.reference_force(),
            first_bank: used.banks as u16, // pads are at most 255, with five banks each
            acceleration: match tables.is_balanced() {
                // It is in the banks.
                true => Acceleration::NONE,
                false => Acceleration::new(object.acceleration(), object.reference_force()),
            },
            panner: Panner::new(pad.level_db(), pad.pan()),
            ..Self::EMPTY
        };
        let mut sounding = 0;
        for (index, (slot, striker)) in loaded.contacts.iter_mut().zip(tables.strikers()).enumerate() {
            *slot = Some(striker.contact());
            loaded.striker_count += 1;
            sounding = if striker.modes().is_empty() || pad.striker_weight() == 0.0 { sounding } else { index + 1 };
        }
        let first = loaded.contacts.first().copied().flatten();
        let typical = first.map_or((0.0, 0.0), |contact| typical_contact(&contact, loaded.reference_force));
        let mut load = |table: &BankTable<'_>, which| {
            let slot = banks.get_mut(used.banks).ok_or((BankError::TooManyBanks, which))?;
            *slot = Bank::load(table, rate, memory, used).map_err(|error| (error, which))?;
            used.banks += 1;
            loaded.bank_count += 1;
            loaded.mode_count += slot.mode_count() as u16; // all banks count in 16 bits
            Ok(())
        };
        load(&tables.object_table(typical), None)?;
        for (index, contact) in loaded.contacts.iter().flatten().take(sounding).enumerate() {
            let typical = typical_contact(contact, loaded.reference_force);
            if let Some(table) = tables.striker_table(index, typical) {
                load(&table, Some(index))?;
            }
        }
        Ok(loaded)
    }

    /// Number of strikers.
    pub fn striker_count(&self) -> usize {
        usize::from(self.striker_count)
    }

    /// The pad's own of all banks: the object's and, behind it, those of the strikers up to the last one that sounds.
    #[inline(always)]
    pub fn own<'b>(&self, banks: &'b [Bank]) -> &'b [Bank] {
        banks.get(self.range()).unwrap_or(&[])
    }

    /// The same to be changed.
    #[inline(always)]
    pub fn own_mut<'b>(&self, banks: &'b mut [Bank]) -> &'b mut [Bank] {
        banks.get_mut(self.range()).unwrap_or(&mut [])
    }

    #[inline(always)]
    fn range(&self) -> core::ops::Range<usize> {
        let first = usize::from(self.first_bank);
        first..first + usize::from(self.bank_count)
    }

    /// Output (1.0 = full scale) that a bus step of a bank makes on the louder side.
    pub fn unit(&self) -> f32 {
        self.panner.loudest() / fixed::ONE_Q27 as f32
    }

    /// Modes of the object's bank and of all strikers' banks.
    #[inline(always)]
    pub fn mode_count(&self) -> usize {
        usize::from(self.mode_count)
    }

    /// Whether the pad has been struck, or driven, since it was loaded.
    #[inline(always)]
    pub fn was_struck(&self) -> bool {
        self.struck
    }

    /// Bound of the amplitude that retirement leaves out, output units (1.0 = full scale).
    #[inline(always)]
    pub fn retired_amplitude(&self) -> f32 {
        self.retired_amplitude
    }

    /// The impact of a strike. `None` where the strike does nothing.
    pub fn strike(&mut self, velocity: f32, striker: u8, rate: SampleRate, banks: &mut [Bank]) -> Option<Impact> {
        let contact = self.contacts.get(usize::from(striker))?.as_ref()?;
        let impact = StrikerLaw::new(contact, self.reference_force, rate).impact(velocity)?;
        let steps = u32::try_from(impact.sum().div_ceil(EXPECTED_STEP)).unwrap_or(u32::MAX);
        self.expected = self.expected.saturating_add(steps);
        self.struck = true;
        self.wake(banks);
        Some(impact)
    }

    /// A hand is laid on or lets go, at the next tick.
    pub fn want_hand(&mut self, lies: bool) {
        self.is_hand_wanted = lies;
    }

    /// True if a hand has come or gone since the last tick.
    pub fn wants_change(&self) -> bool {
        self.is_hand_wanted != self.is_choked
    }

    /// True if a hand lies on the pad.
    pub fn is_choked(&self) -> bool {
        self.is_choked
    }

    /// Lays the hand on, or lets go: each [`Pad::tick`] that follows reaches some modes. Gives how many groups were guarded.
    pub fn lay_hand(&mut self, memory: &mut Memory<'_>, banks: &mut [Bank]) -> u32 {
        self.is_choked = self.is_hand_wanted;
        self.wake(banks);
        banks.iter_mut().map(|bank| bank.lay_hand(self.is_choked, memory)).sum()
    }

    /// True if a hand comes or goes that has not reached all modes yet.
    pub fn is_being_reached(banks: &[Bank]) -> bool {
        banks.iter().any(Bank::is_being_reached)
    }

    /// The slot of a strike at a position; `is_driven` says which slots contacts drive. A direct force acts there from now on.
    pub fn place(&mut self, position: f32, banks: &[Bank], is_driven: impl Fn(u8) -> bool) -> Place {
        let place = banks.first().map_or(Place::FIRST, |object| object.place(position, is_driven));
        self.direct_slot = place.slot;
        place
    }

    /// The slot at whose position a direct force acts: that of the latest strike.
    #[inline(always)]
    pub(crate) fn direct_slot(&self) -> u8 {
        self.direct_slot
    }

    /// Moves a slot of the object to the position of a strike.
    pub fn set_position(
        slot: u8,
        position: f32,
        tables: &PadTables<'_>,
        rate: SampleRate,
        memory: &mut Memory<'_>,
        banks: &mut [Bank],
    ) {
        if let Some(object) = banks.first_mut() {
            object.set_position(slot, position, &tables.object_table(NO_CONTACT), rate, memory);
        }
    }

    /// Whether [`Pad::ring`] goes straight to the stereo bus.
    pub fn rings_quickly(&self, banks: &[Bank]) -> bool {
        let Some((object, strikers)) = banks.split_first() else { return true };
        self.panner.gains(object.mix_shift().is_loud).is_some() && !is_ringing(strikers)
    }

    /// Whether a run under a force, which may be loud, goes straight to the stereo bus.
    pub fn drives_quickly(&self, banks: &[Bank]) -> bool {
        let [object] = banks else { return false };
        let is_loud = object.mix_shift().is_loud || self.expects();
        let Some(gains) = self.panner.gains(is_loud).filter(|_| !self.acceleration.is_built()) else { return false };
        !object.has_onset() || !self.expects() && object.can_add_onset(gains.shift)
    }

    /// Whether a contact has begun that the banks are not guarded for yet.
    pub fn expects(&self) -> bool {
        self.expected > 0
    }

    /// Whether a force would be heard: some group is not left out, or there is an acceleration sound.
    pub fn responds(&self, banks: &[Bank], groups: &[Group]) -> bool {
        self.acceleration.is_built() || banks.iter().any(|bank| bank.has_admitted(groups))
    }

    /// Guards the banks for the contacts that have just begun. Before the run in which they do.
    pub fn meet_expected(&mut self, memory: &mut Memory<'_>, banks: &mut [Bank]) {
        let expected = u64::from(core::mem::take(&mut self.expected)) * EXPECTED_STEP;
        if expected > 0 {
            self.wake(banks);
            // What is left out altogether needs no guard.
            for bank in banks {
                if bank.has_admitted(memory.groups) {
                    bank.expect(memory, expected);
                }
            }
        }
    }

    /// Whether the next tick guards any group, if no more force comes before it.
    pub fn is_guard_due(&self, banks: &[Bank]) -> bool {
        self.rest_ticks == 0 && banks.iter().any(|bank| bank.is_guard_due(self.passed_ticks))
    }

    /// Whether no bank has anything to do at the coming tick.
    pub fn rests(&self) -> bool {
        self.rest_ticks > 0
    }

    /// Lets a tick pass in which no bank has anything to do; false, and nothing happens, where one has: then [`Pad::tick`] must follow.
    #[inline(always)]
    pub fn pass_tick(&mut self) -> bool {
        let rests = self.rest_ticks > 0;
        if rests {
            self.rest_ticks -= 1;
            self.passed_ticks += 1;
        }
        rests
    }

    /// Tells the banks of the ticks that have passed, before anything happens to them.
    #[inline(always)]
    pub fn wake(&mut self, banks: &mut [Bank]) {
        self.rest_ticks = 0;
        if self.passed_ticks > 0 {
            self.catch_up(banks);
        }
    }

    #[inline(never)]
    fn catch_up(&mut self, banks: &mut [Bank]) {
        let passed = core::mem::take(&mut self.passed_ticks);
        banks.iter_mut().for_each(|bank| bank.pass(passed));
    }

    /// The bookkeeping of a tick; gives how many modes retired. `retired_elsewhere` is what other pads leave out, output units.
    #[inline(never)]
    pub fn tick(&mut self, memory: &mut Memory<'_>, banks: &mut [Bank], skip: bool, retired_elsewhere: f32) -> u32 {
        self.wake(banks);
        let mut already = retired_elsewhere;
        banks.iter().for_each(|bank| already += bank.retired_amplitude());
        // 1.0 on the bus is full scale, so that a bus step is 2^-27 of it.
        let mut retirement = Retirement::new(already, self.unit());
        let (mut rest_ticks, mut retired_amplitude) = (if skip { u8::MAX } else { 0 }, 0.0);
        for bank in banks {
            if bank.is_being_reached() {
                bank.reach(memory);
            }
            bank.tick(memory, skip.then_some(&mut retirement));
            rest_ticks = rest_ticks.min(bank.rest_ticks());
            retired_amplitude += bank.retired_amplitude();
        }
        (self.rest_ticks, self.retired_amplitude) = (rest_ticks, retired_amplitude);
        retirement.retired_modes()
    }
}

/// Whether any mode of a pad's own banks rings.
#[inline(always)]
pub fn is_ringing(banks: &[Bank]) -> bool {
    banks.iter().any(Bank::is_ringing)
}

/// Register groups of banks.
pub fn group_count(banks: &[Bank]) -> u32 {
    banks.iter().map(Bank::group_count).sum()
}
