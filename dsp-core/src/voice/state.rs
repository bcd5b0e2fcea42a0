//! A voice's stages, and what happens to them between runs of frames.

use super::filters::Filters;
use super::residual::Residual;
use super::tables::{NO_CONTACT, PadTables};
use crate::SampleRate;
use crate::contact::law::{Impact, StrikerLaw};
use crate::fixed;
use crate::output::Panner;
use crate::radiation::Acceleration;
use crate::resonator::{Bank, BankWork, Place, Retirement};
use crate::table::ContactTable;
use crate::table::layout::STRIKERS_PER_PAD;

/// All stages of one pad, and their state.
#[derive(Debug)]
pub struct Voice<'k, 'm> {
    /// The pad's number, counted from 0.
    pub(crate) number: u8,
    /// The object's bank, and behind it those of the strikers up to the last one with modes.
    pub(crate) banks: &'m mut [Bank<'m>],
    /// Dynamic filter and biquads, where the object has any.
    pub(crate) filters: Option<&'m mut Filters<'m>>,
    /// The object's residual, where it has one.
    pub(crate) residual: Option<&'m mut Residual<'m>>,
    /// The contacts of its strikers, in place.
    pub(super) contacts: [Option<ContactTable<'k>>; STRIKERS_PER_PAD],
    pub(super) reference_force: f32,
    pub(super) striker_count: u8,
    pub(super) mode_count: u16,
    pub(super) acceleration: Acceleration,
    pub(super) panner: Panner,
    /// |force| that contacts which have just begun will bring, until the banks are guarded for it: in steps of [`EXPECTED_STEP`], rounded up.
    pub(super) expected: u32,
    /// Whether a hand is to lie on the pad from the next tick on, and whether one does.
    pub(super) is_hand_wanted: bool,
    pub(super) is_choked: bool,
    pub(super) struck: bool,
    /// The slot of the latest strike.
    pub(super) direct_slot: u8,
    /// Coming ticks in which no bank has anything to do, and those of them that have passed without the banks' knowing.
    pub(super) rest_ticks: u8,
    pub(super) passed_ticks: u8,
    /// Sum of the banks' retired amplitudes at the last tick that had something to do.
    pub(super) retired_amplitude: f32,
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
    /// True if a contact or a direct force acts on the pad.
    pub has_force: bool,
    /// Direct force for this pad, Q4.27.
    pub direct: Option<&'a [i32]>,
}

impl Voice<'_, '_> {
    /// A voice without object or strikers.
    pub const fn empty() -> Self {
        Self {
            number: 0,
            banks: &mut [],
            filters: None,
            residual: None,
            contacts: [None; STRIKERS_PER_PAD],
            reference_force: 0.0,
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
        }
    }

    /// Number of strikers.
    pub fn striker_count(&self) -> usize {
        usize::from(self.striker_count)
    }

    /// The object's bank and those of its strikers, up to the last one that sounds.
    #[inline(always)]
    pub fn banks(&self) -> &[Bank<'_>] {
        self.banks
    }

    /// True if any mode of the banks rings.
    #[inline(always)]
    pub fn is_ringing(&self) -> bool {
        self.banks.iter().any(Bank::is_ringing)
    }

    /// Number of register groups of all banks.
    pub fn group_count(&self) -> usize {
        self.banks.iter().map(|bank| bank.group_count() as usize).sum()
    }

    /// Gives the voice its pad's number.
    pub(crate) fn set_number(&mut self, number: u8) {
        self.number = number;
    }

    /// Gain of the louder side.
    pub(crate) fn loudest(&self) -> f32 {
        self.panner.loudest()
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
    pub fn strike(&mut self, velocity: f32, striker: u8, rate: SampleRate) -> Option<Impact> {
        let contact = self.contacts.get(usize::from(striker))?.as_ref()?;
        let impact = StrikerLaw::new(contact, self.reference_force, rate).impact(velocity)?;
        let steps = u32::try_from(impact.sum().div_ceil(EXPECTED_STEP)).unwrap_or(u32::MAX);
        self.expected = self.expected.saturating_add(steps);
        self.struck = true;
        self.wake();
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

    /// Lays the hand on, or lets go: each [`Voice::tick`] that follows reaches some modes. Gives how many groups were guarded.
    pub fn lay_hand(&mut self) -> u32 {
        self.is_choked = self.is_hand_wanted;
        self.wake();
        let is_choked = self.is_choked;
        self.banks.iter_mut().map(|bank| bank.lay_hand(is_choked)).sum()
    }

    /// True if a hand comes or goes that has not reached all modes yet.
    pub fn is_being_reached(&self) -> bool {
        self.banks.iter().any(Bank::is_being_reached)
    }

    /// The slot of a strike at a position; `is_driven` says which slots contacts drive. A direct force acts there from now on.
    pub fn place(&mut self, position: f32, is_driven: impl Fn(u8) -> bool) -> Place {
        let place = self.banks.first().map_or(Place::FIRST, |object| object.place(position, is_driven));
        self.direct_slot = place.slot;
        place
    }

    /// The slot at whose position a direct force acts: that of the latest strike.
    #[inline(always)]
    pub(crate) fn direct_slot(&self) -> u8 {
        self.direct_slot
    }

    /// Moves a slot of the object to the position of a strike.
    pub fn set_position(&mut self, slot: u8, position: f32, tables: &PadTables<'_>, rate: SampleRate) {
        if let Some(object) = self.banks.first_mut() {
            object.set_position(slot, position, &tables.object_table(NO_CONTACT), rate);
        }
    }

    /// True if [`Voice::ring`] goes straight to the stereo bus.
    pub fn rings_quickly(&self) -> bool {
        let Some((object, strikers)) = self.banks.split_first() else { return true };
        self.panner.gains(object.mix_shift().is_loud).is_some() && !strikers.iter().any(Bank::is_ringing)
    }

    /// True if a run under a force, which may be loud, goes straight to the stereo bus.
    pub fn drives_quickly(&self) -> bool {
        let [object] = &*self.banks else { return false };
        let is_loud = object.mix_shift().is_loud || self.expects();
        let Some(gains) = self.panner.gains(is_loud).filter(|_| !self.acceleration.is_built()) else { return false };
        !object.has_onset() || !self.expects() && object.can_add_onset(gains.shift)
    }

    /// Whether a contact has begun that the banks are not guarded for yet.
    pub fn expects(&self) -> bool {
        self.expected > 0
    }

    /// Whether a force would be heard: some group is not left out, or there is an acceleration sound.
    pub fn responds(&self) -> bool {
        self.acceleration.is_built() || self.banks.iter().any(Bank::has_admitted)
    }

    /// Lets input reach again what was left out.
    pub fn admit(&mut self) {
        self.wake();
        self.banks.iter_mut().for_each(Bank::admit);
    }

    /// Guards the banks for the contacts that have just begun. Before the run in which they do.
    pub fn meet_expected(&mut self) {
        let expected = u64::from(core::mem::take(&mut self.expected)) * EXPECTED_STEP;
        if expected > 0 {
            self.wake();
            // What is left out altogether needs no guard.
            for bank in &mut *self.banks {
                if bank.has_admitted() {
                    bank.expect(expected);
                }
            }
        }
    }

    /// Whether the next tick guards any group, if no more force comes before it.
    pub fn is_guard_due(&self) -> bool {
        self.rest_ticks == 0 && self.banks.iter().any(|bank| bank.is_guard_due(self.passed_ticks))
    }

    /// Whether no bank has anything to do at the coming tick.
    pub fn rests(&self) -> bool {
        self.rest_ticks > 0
    }

    /// Lets a tick pass in which no bank has anything to do; false, and nothing happens, where one has: then [`Voice::tick`] must follow.
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
    pub fn wake(&mut self) {
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

    /// The bookkeeping of a tick; gives how many modes retired. `retired_elsewhere` is what other pads leave out, output units.
    #[inline(never)]
    pub fn tick(&mut self, skip: bool, retired_elsewhere: f32) -> u32 {
        self.wake();
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
