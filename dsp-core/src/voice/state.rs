//! State of a voice, and what happens to it between runs of frames.

use super::filters::Filters;
use super::form::Form;
use super::ongoing::{EXPECTED_STEP, Ongoing, bit_of};
use super::residual::Residual;
use super::tables::{NO_CONTACT, PadTables};
use crate::SampleRate;
use crate::contact::law::{Impact, LastPulse, StrikerLaw};
use crate::fixed;
use crate::frames::FrameBank;
use crate::output::Panner;
use crate::radiation::Acceleration;
use crate::resonator::{Bank, BankWork, Place, Retirement};
use crate::table::ContactTable;
use crate::table::layout::STRIKERS_PER_PAD;

/// Stages of one pad and their state.
#[derive(Debug)]
pub struct Voice<'k, 'm> {
    /// Number of the pad, counted from 0.
    pub(crate) number: u8,
    /// Bank of the object, and behind it those of the strikers up to the last one with modes.
    pub(crate) banks: &'m mut [Bank<'m>],
    /// Object's modes in frames; its bank among `banks` is empty then. `None` if they are there.
    pub(crate) frames: Option<&'m mut FrameBank<'m>>,
    pub(crate) form: Form,
    /// True if strikes may fall on any position; if false all fall on position 0.
    pub(crate) moves: bool,
    /// True if the pad has neither modes in frames nor filters.
    pub(crate) is_plain: bool,
    /// Dynamic filter and biquads; `None` if the object has neither.
    pub(crate) filters: Option<&'m mut Filters<'m>>,
    /// Residual of the object; `None` if it has none.
    pub(crate) residual: Option<&'m mut Residual<'m>>,
    /// Contacts of the strikers, as they lie in the kit.
    pub(super) contacts: [Option<ContactTable<'k>>; STRIKERS_PER_PAD],
    pub(super) last_pulse: LastPulse,
    pub(super) reference_force: f32,
    pub(super) striker_count: u8,
    pub(super) mode_count: u16,
    pub(super) group_count: u16,
    pub(super) acceleration: Acceleration,
    pub(super) panner: Panner,
    /// Sum of |force| of contacts that have just begun, until the banks are guarded for it, in
    /// units of [`EXPECTED_STEP`], rounded up.
    pub(super) expected: u32,
    /// Strikers of the contacts that have just begun: a bit for each.
    pub(super) expected_strikers: u8,
    /// Force of contacts that go on, in the tick that begins.
    pub(super) ongoing: Ongoing,
    /// True if the pad is to be choked.
    pub(super) is_choke_wanted: bool,
    pub(super) is_choked: bool,
    /// Number of ticks by which the choke or the release that is asked for is late.
    pub(super) choke_late_ticks: u8,
    pub(super) struck: bool,
    /// Slot of the latest strike.
    pub(super) direct_slot: u8,
    /// Number of coming ticks in which no bank has anything to do.
    pub(super) rest_ticks: u8,
    /// Number of ticks that have passed and that the banks have not been told of.
    pub(super) passed_ticks: u8,
    /// Sum of the banks' retired amplitudes at the last tick that had something to do.
    pub(super) retired_amplitude: f32,
}

/// Work of a pad over a run of frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PadWork {
    /// Work of the object's bank.
    pub object: BankWork,
    /// Work of all strikers' banks.
    pub strikers: BankWork,
    /// Frames for which the acceleration sound was computed.
    pub acceleration_frames: u32,
    /// Frames for which a direct force was taken in.
    pub direct_frames: u32,
    /// Frames in which contacts or a direct force drove the pad.
    pub force_frames: u32,
}

/// Run of frames, of at most a tick, as a pad renders it.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// Number of frames.
    pub frames: usize,
    /// True if the first frame's number, counted from the engine's start, is odd.
    pub odd_start: bool,
    /// True if work that cannot be heard may be skipped.
    pub skip: bool,
    /// True if a contact or a direct force acts on the pad.
    pub has_force: bool,
    /// Direct force on this pad, Q4.27; `None` if there is none.
    pub direct: Option<&'a [i32]>,
}

impl Voice<'_, '_> {
    /// Voice without object and strikers.
    pub const fn empty() -> Self {
        Self {
            number: 0,
            banks: &mut [],
            frames: None,
            form: Form::FewModes,
            moves: true,
            is_plain: true,
            filters: None,
            residual: None,
            contacts: [None; STRIKERS_PER_PAD],
            last_pulse: LastPulse::NONE,
            reference_force: 0.0,
            striker_count: 0,
            mode_count: 0,
            group_count: 0,
            acceleration: Acceleration::NONE,
            panner: Panner::SILENT,
            expected: 0,
            expected_strikers: 0,
            ongoing: Ongoing::NONE,
            is_choke_wanted: false,
            is_choked: false,
            choke_late_ticks: 0,
            struck: false,
            direct_slot: 0,
            rest_ticks: 0,
            passed_ticks: 0,
            retired_amplitude: 0.0,
        }
    }

    /// Number of strikers.
    pub fn striker_count(&self) -> usize {
        usize::from(self.striker_count)
    }

    /// Bank of the object, and behind it those of the strikers up to the last one with modes.
    #[inline(always)]
    pub fn banks(&self) -> &[Bank<'_>] {
        self.banks
    }

    /// True if any mode of the fixed-point banks rings.
    #[inline(always)]
    pub fn is_ringing(&self) -> bool {
        self.banks.iter().any(Bank::is_ringing)
    }

    /// True if the object's modes are in frames and sound.
    #[inline(always)]
    pub(crate) fn sounds_in_frames(&self) -> bool {
        self.frames.as_deref().is_some_and(FrameBank::is_active)
    }

    /// Number of register groups of all banks.
    #[inline(always)]
    pub fn group_count(&self) -> usize {
        usize::from(self.group_count)
    }

    /// Gives the voice its pad's number.
    pub(crate) fn set_number(&mut self, number: u8) {
        self.number = number;
    }

    /// Gain from the pad's bus to the louder side.
    pub(crate) fn loudest(&self) -> f32 {
        self.panner.loudest()
    }

    /// Output of a bus step of a bank on the louder side, 1.0 = full scale.
    pub fn unit(&self) -> f32 {
        self.panner.loudest() / fixed::ONE_Q27 as f32
    }

    /// Number of modes of all banks.
    #[inline(always)]
    pub fn mode_count(&self) -> usize {
        usize::from(self.mode_count)
    }

    /// True if the pad has been struck or driven since the load.
    #[inline(always)]
    pub fn was_struck(&self) -> bool {
        self.struck
    }

    /// Bound of the amplitude that retired modes of the fixed-point banks leave out, 1.0 = full
    /// scale.
    #[inline(always)]
    pub fn retired_amplitude(&self) -> f32 {
        self.retired_amplitude
    }

    /// Bound of the amplitude that retired modes in frames leave out, 1.0 = full scale.
    pub(crate) fn retired_in_frames(&self) -> f32 {
        self.frames.as_deref().map_or(0.0, FrameBank::retired_amplitude)
    }

    /// Begins a strike and gives its impact; `None` if the strike does nothing.
    pub fn strike(&mut self, velocity: f32, striker: u8, rate: SampleRate) -> Option<Impact> {
        let contact = self.contacts.get(usize::from(striker))?.as_ref()?;
        let pulse = self.last_pulse.of(contact);
        let impact = StrikerLaw::new(contact, pulse, self.reference_force, rate).impact(velocity)?;
        let steps = u32::try_from(impact.sum().div_ceil(EXPECTED_STEP)).unwrap_or(u32::MAX);
        self.expected = self.expected.saturating_add(steps);
        self.expected_strikers |= bit_of(striker);
        self.struck = true;
        self.wake();
        Some(impact)
    }

    /// Chooses the slot of a strike at a position, where a direct force acts from now on as well.
    /// `is_driven` says of a slot if contacts drive it.
    pub fn place(&mut self, position: f32, is_driven: impl Fn(u8) -> bool) -> Place {
        let place = self.place_of(position, is_driven);
        self.direct_slot = place.slot;
        place
    }

    /// Slot that a strike at a position would take.
    pub(crate) fn place_of(&self, position: f32, is_driven: impl Fn(u8) -> bool) -> Place {
        let position = if self.moves { position } else { 0.0 };
        match self.frames.as_deref() {
            Some(frames) => frames.place(position, is_driven),
            None => self.banks.first().map_or(Place::FIRST, |object| object.place(position, is_driven)),
        }
    }

    /// Slot at whose position a direct force acts: that of the latest strike.
    #[inline(always)]
    pub(crate) fn direct_slot(&self) -> u8 {
        self.direct_slot
    }

    /// Moves a slot of the object to the position of a strike.
    pub fn set_position(&mut self, slot: u8, position: f32, tables: &PadTables<'_>, rate: SampleRate) {
        if let Some(frames) = self.frames.as_deref_mut() {
            frames.set_position(slot, position);
        } else if let Some(object) = self.banks.first_mut() {
            object.set_position(slot, position, &tables.object_table(NO_CONTACT), rate);
        }
    }

    /// True if [`Voice::ring`] adds to the stereo bus without a bus of its own.
    pub fn rings_quickly(&self) -> bool {
        let Some((object, strikers)) = self.banks.split_first() else { return true };
        self.panner.gains(object.mix_shift().is_loud).is_some() && !strikers.iter().any(Bank::is_ringing)
    }

    /// True if [`Voice::drive`] adds to the stereo bus without a bus of its own, however loud the
    /// expected force is.
    pub fn drives_quickly(&self) -> bool {
        let [object] = &*self.banks else { return false };
        let is_loud = object.mix_shift().is_loud || self.expects();
        let Some(gains) = self.panner.gains(is_loud).filter(|_| !self.acceleration.is_built()) else { return false };
        !object.has_onset() || !self.expects() && object.can_add_onset(gains.shift)
    }

    /// True if a contact has begun that the banks are not guarded for yet.
    pub fn expects(&self) -> bool {
        self.expected > 0
    }

    /// True if the force itself sounds, whatever is shed.
    #[inline(always)]
    pub fn has_acceleration_sound(&self) -> bool {
        self.acceleration.is_built()
    }

    /// True if a force would be heard: not all groups are shed, or there is an acceleration sound.
    pub fn responds(&self) -> bool {
        self.has_acceleration_sound() || self.banks.iter().any(Bank::has_admitted)
    }

    /// Ends all sound at once. A hand stays.
    pub fn rest(&mut self) {
        self.wake();
        self.banks.iter_mut().for_each(Bank::rest);
        if let Some(frames) = &mut self.frames {
            frames.rest();
        }
        if let Some(residual) = self.residual.as_deref_mut() {
            residual.rest();
        }
        if let Some(filters) = self.filters.as_deref_mut() {
            filters.rest();
        }
        (self.expected, self.expected_strikers, self.ongoing) = (0, 0, Ongoing::NONE);
        self.retired_amplitude = 0.0;
    }

    /// Lets forces reach groups again that were shed.
    pub fn admit(&mut self) {
        self.wake();
        self.banks.iter_mut().for_each(Bank::admit);
    }

    /// True if the next tick guards any group, provided that no more force comes before it.
    pub fn is_guard_due(&self) -> bool {
        self.rest_ticks == 0 && self.banks.iter().any(|bank| bank.is_guard_due(self.passed_ticks))
    }

    /// True if a pad that no force acts on has nothing to do: neither sound nor books.
    pub(crate) fn can_sleep(&self) -> bool {
        let is_silent = self.frames.is_none() && !self.is_ringing() && !self.filters_join_in(false);
        is_silent && self.retired_amplitude == 0.0 && !self.is_being_reached()
    }

    /// True if no bank has anything to do at the coming tick.
    pub fn rests(&self) -> bool {
        self.rest_ticks > 0
    }

    /// Lets a tick pass in which no bank has anything to do. False, with nothing done, if one has:
    /// then [`Voice::tick`] must follow.
    #[inline(always)]
    pub fn pass_tick(&mut self) -> bool {
        let rests = self.rest_ticks > 0;
        if rests {
            self.rest_ticks -= 1;
            self.passed_ticks += 1;
        }
        rests
    }

    /// Tells the banks of the ticks that have passed; call it before anything happens to them.
    #[inline(always)]
    pub fn wake(&mut self) {
        // Of modes in frames the voice keeps no books.
        if self.frames.is_none() || self.banks.len() > 1 {
            self.wake_banks();
        }
    }

    /// As [`Voice::wake`], whether the banks have modes or not.
    #[inline(always)]
    pub(super) fn wake_banks(&mut self) {
        self.rest_ticks = 0;
        if self.passed_ticks > 0 {
            self.catch_up();
        }
    }

    #[inline(never)]
    fn catch_up(&mut self) {
        let passed = core::mem::take(&mut self.passed_ticks);
        self.banks.iter_mut().for_each(|bank| bank.pass(passed));
    }

    /// Does the bookkeeping of a tick and gives the number of modes that retired.
    /// `retired_elsewhere` is the retired amplitude of all other pads, 1.0 = full scale.
    #[inline(never)]
    pub fn tick(&mut self, skip: bool, retired_elsewhere: f32) -> u32 {
        self.wake_banks();
        let mut already = retired_elsewhere;
        self.banks.iter().for_each(|bank| already += bank.retired_amplitude());
        // 1.0 on the bus is full scale, so that a bus step is 2^-27 of it.
        let mut retirement = Retirement::new(already, self.unit());
        let (mut rest_ticks, mut retired_amplitude) = (if skip { u8::MAX } else { 0 }, 0.0);
        for bank in &mut *self.banks {
            if bank.is_being_reached() {
                bank.reach();
            }
            bank.tick(skip.then_some(&mut retirement));
            rest_ticks = rest_ticks.min(bank.rest_ticks());
            retired_amplitude += bank.retired_amplitude();
        }
        (self.rest_ticks, self.retired_amplitude) = (rest_ticks, retired_amplitude);
        retirement.retired_modes()
    }
}
