//! Prediction of a tick's cost, from counts of the work ahead.

use super::cost::{CostItem, Counts};
use super::state::{Direct, Engine, direct_input};
use crate::event::{Action, Event};
use crate::frames::InFrames;
use crate::resonator::{Bank, Use};
use crate::room::Sample;
use crate::time::TICK_FRAMES;
use crate::voice::Voice;

/// Work that a prediction has counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Counted {
    /// None: what is to come is not known, or sheds.
    Nothing,
    /// The run that follows.
    Run,
    /// The tick's rest: no other prediction is due in it.
    Tick,
}

impl<S: Sample> Engine<'_, '_, S> {
    /// Counts a run that [`keep_budget`](Self::keep_budget) has not counted.
    #[inline(never)]
    pub(super) fn count_run(&mut self, frames: u32, direct: Option<Direct<'_>>) {
        let mut counts = Counts::NONE;
        self.add_run(frames, direct, &[], &mut counts);
        if self.frames.is_some() {
            self.add_heads(frames, direct, &[], &mut counts);
        }
        self.report.counts += &counts;
    }

    /// Adds the counts of the beginning of a tick in which anything is to be done.
    #[inline(never)]
    pub(super) fn add_beginning(&self, counts: &mut Counts) {
        let (mut waking, mut due_groups, mut driven_groups, mut reached) = (0, 0, 0, 0);
        let awake = self.awake.pads().filter_map(|pad| self.voices.get(usize::from(pad)));
        for voice in awake.filter(|voice| !voice.rests()) {
            waking += 1;
            let groups = |bank: &Bank<'_>| if bank.is_driven_guard_due() { bank.group_count() } else { 0 };
            let driven: u32 = voice.banks().iter().map(groups).sum();
            due_groups += if driven == 0 && voice.is_guard_due() { voice.group_count() as u32 } else { 0 };
            driven_groups += driven;
            for bank in voice.banks().iter().filter(|bank| bank.is_being_reached()) {
                reached += bank.modes_to_reach() as u32; // banks count in 16 bits
                due_groups += if bank.hand_is_guarded() { bank.group_count() } else { 0 };
            }
        }
        let noise = self.stage_cycles_ahead();
        counts.add(CostItem::Tick, 1);
        counts.add(CostItem::WakingPad, waking);
        counts.add(CostItem::DueGroup, due_groups);
        counts.add(CostItem::GuardedRingingGroup, driven_groups);
        counts.add(CostItem::ResidualCycle, noise);
        counts.add(CostItem::ChokedMode, reached);
    }

    /// Counts an event that no prediction of its tick has counted.
    #[inline(never)] // two callers
    pub(super) fn count_event(&mut self, event: &Event) {
        if self.budget.is_some() {
            let mut counts = Counts::NONE;
            self.add_event(event, &mut counts);
            self.report.counts += &counts;
        }
    }

    /// Adds the counts of a choke or a release that a strike on its pad does not wait for.
    #[inline(never)] // rare
    fn add_late_choke(&self, pad: u8, counts: &mut Counts) {
        if let Some(voice) = self.voices.get(usize::from(pad)).filter(|voice| voice.is_choke_late()) {
            counts.add_all([(CostItem::Choke, 1), (CostItem::ChokedMode, voice.late_choke_modes())]);
        }
    }

    /// Adds the counts of an event.
    fn add_event(&self, event: &Event, counts: &mut Counts) {
        match event.action {
            Action::Strike => {
                counts.add(CostItem::Strike, 1);
                counts.add(CostItem::ResidualStrike, u32::from(self.has_noise(event.pad)));
                counts.add(CostItem::ResidualCycle, self.filter_strike_cycles(event.pad));
                counts.add_all(self.moved(event.pad, event.position).counts());
                if self.chokes_changed {
                    self.add_late_choke(event.pad, counts);
                }
            }
            // Decisions of a log count as free: boards play none.
            Action::Shed(_) => {}
            // Counted at the tick at which they act.
            Action::Choke | Action::Release | Action::Level | Action::Silence => {}
            #[cfg(feature = "scrapes")]
            Action::Touch { .. } | Action::Move(_) | Action::Lift => {}
        }
    }

    pub(super) fn frames_to_tick(&self) -> u32 {
        (TICK_FRAMES as u64 - self.now % TICK_FRAMES as u64) as u32
    }

    /// True if a force drives the second slot of a pad, or may by a known strike.
    fn has_second(&self, number: u8, is_direct: bool, struck: bool, bank: &Bank<'_>) -> bool {
        let is_driven = self.contacts.is_any_in(number, 1) || struck && self.contacts.is_any_in(number, 0);
        let direct_slot = self.voices.get(usize::from(number)).map_or(0, Voice::direct_slot);
        is_driven || bank.has_second_gains() && is_direct && direct_slot == 1
    }

    /// Counts of the tick's rest, with the events that are known; if there are any, also of the run
    /// before the first of them.
    #[inline(never)]
    pub(super) fn rest_of_tick(
        &mut self,
        upcoming: &[Event],
        direct: Option<Direct<'_>>,
        of_next_run: &mut Counts,
    ) -> Counts {
        let end = self.now + u64::from(self.frames_to_tick());
        if upcoming.first().is_none_or(|event| event.time.first_frame() >= end) {
            return self.count_rest_of_tick(&[], direct, &mut [], of_next_run);
        }
        for event in upcoming.iter().take_while(|event| event.time.first_frame() < end) {
            if event.action == Action::Strike {
                self.wake(event.pad);
            }
        }
        let struck = core::mem::take(&mut self.struck);
        struck.fill(0);
        let total = self.count_rest_of_tick(upcoming, direct, struck, of_next_run);
        self.struck = struck;
        total
    }

    fn count_rest_of_tick(
        &self,
        upcoming: &[Event],
        direct: Option<Direct<'_>>,
        struck: &mut [u8],
        of_next_run: &mut Counts,
    ) -> Counts {
        let end = self.now + u64::from(self.frames_to_tick());
        let (mut now, mut total) = (self.now, Counts::NONE);
        let news = upcoming.iter().filter(|event| !event.acts_on_tick());
        let mut events = news.take_while(|event| event.time.first_frame() < end).peekable();
        while now < end {
            let next = events.peek().map_or(end, |event| event.time.first_frame());
            self.add_run((next - now) as u32, direct, struck, &mut total);
            if self.frames.is_some() {
                self.add_heads((next - now) as u32, direct, struck, &mut total);
            }
            if now == self.now && next < end {
                *of_next_run = total;
            }
            while let Some(event) = events.next_if(|event| event.time.first_frame() == next) {
                self.add_event(event, &mut total);
                if let (Action::Strike, Some(struck)) = (event.action, struck.get_mut(usize::from(event.pad))) {
                    *struck |= 1 << (event.striker & 7);
                }
            }
            now = next;
        }
        total
    }

    /// Adds the counts of a run of frames. `struck` has for each pad a bit for each striker by
    /// which a known event will have struck it by then; if empty, none will.
    ///
    /// The loop over pads that ring is short: code beyond the 1 KB of the flash's cache would be
    /// fetched again for each pad.
    #[inline(never)] // one for all
    fn add_run(&self, frames: u32, direct: Option<Direct<'_>>, struck: &[u8], counts: &mut Counts) {
        let may_strike = struck.iter().any(|&strikers| strikers != 0);
        if frames == 0 || self.idle && direct.is_none() && !may_strike {
            return;
        }
        counts.add(CostItem::Look, 1);
        if self.noisy {
            let begun =
                struck.iter().zip(0u8..).filter(|(strikers, pad)| **strikers != 0 && self.has_noise(*pad)).count();
            let noises = (self.noises() + begun) as u32;
            counts.add(CostItem::ResidualRun, noises);
            counts.add(CostItem::ResidualFrame, noises * frames);
        }
        let may_be_driven = may_strike || direct.is_some() || self.contacts.is_any();
        for number in self.awake.pads() {
            let Some(voice) = self.voices.get(usize::from(number)) else { break };
            // The cycles of a pad in frames are counted with its head.
            counts.add(CostItem::Pad, u32::from(voice.frames().is_none()));
            let strikers = struck.get(usize::from(number)).copied().unwrap_or(0);
            if may_be_driven && self.add_driven(voice, frames, direct, strikers, counts) || !voice.is_ringing() {
                continue;
            }
            let ringing = voice.banks().iter().filter(|bank| bank.is_ringing());
            let (cycles, banks) =
                ringing.fold((0, 0), |(cycles, banks), bank| (cycles + bank.cycles(Use::Free, frames), banks + 1));
            counts.add(CostItem::KernelCycle, cycles * self.loop_percent / 100);
            counts.add(CostItem::StrikerBank, banks - 1);
            counts.add(CostItem::BusFrame, (banks - 1) * frames);
            if voice.rings_quickly() && !voice.filters_join_in(false) {
                counts.add(CostItem::RingingPad, 1);
            } else {
                counts.add(CostItem::BusPad, 1);
                counts.add(CostItem::BusFrame, frames);
            }
        }
    }

    /// Adds the counts of a pad's run if a force acts on it; false, with nothing added, if none
    /// does. `strikers` has a bit for each striker that will have struck it by then.
    #[inline(never)] // must not weigh on pads that ring
    fn add_driven(
        &self,
        voice: &Voice<'_, '_>,
        frames: u32,
        direct: Option<Direct<'_>>,
        strikers: u8,
        counts: &mut Counts,
    ) -> bool {
        let (number, struck) = (voice.number, strikers != 0);
        let is_direct = direct.is_some() && direct_input(direct, number) > 0.0;
        let contact_frames = self.contacts.frames_ahead(number, frames) + if struck { frames } else { 0 };
        let ongoing_frames = self.contacts.ongoing.frames_ahead(number, frames);
        if contact_frames == 0 && ongoing_frames == 0 && !is_direct {
            return false;
        }
        let (mut cycles, mut banks, mut driven_banks, mut guarded, mut guarded_ringing) = (0, 0, 0, 0, 0);
        let (mut groups, mut second_groups) = (0, 0);
        let expects = voice.expects() || struck;
        for (index, bank) in (0u8..).zip(voice.banks()).filter(|(_, bank)| bank.mode_count() > 0) {
            // Bank 0 is the object's.
            let is_struck_by = || strikers >> ((index - 1) & 7) & 1 == 1;
            let by = || is_struck_by() || is_direct && index == 1 || self.contacts.is_any_by(number, index - 1);
            let is_driven = index == 0 || by();
            let used = match is_driven {
                false => Use::Free,
                true if struck => Use::Struck,
                true => Use::Driven,
            };
            let running = bank.running_groups(used);
            cycles += bank.cycles(used, frames);
            let has_second = bank.can_take_second() && self.has_second(number, is_direct, struck, bank);
            second_groups += if has_second { running } else { 0 };
            groups += running;
            banks += u32::from(running > 0);
            driven_banks += u32::from(running > 0 && is_driven);
            if is_driven && (expects || ongoing_frames == 0 && bank.is_unguarded()) {
                *if bank.is_ringing() { &mut guarded_ringing } else { &mut guarded } += running;
            }
        }
        if ongoing_frames > 0 && !expects {
            guarded += voice.groups_to_guard_for_ongoing();
        }
        counts.add(CostItem::KernelCycle, cycles * self.loop_percent / 100);
        counts.add(CostItem::SecondFrame, second_groups * frames);
        counts.add(CostItem::GuardedGroup, guarded);
        counts.add(CostItem::GuardedRingingGroup, guarded_ringing);
        let (own_banks, driven_banks) = (banks.max(1) - 1, driven_banks.max(1) - 1);
        counts.add(CostItem::DrivenStrikerBank, driven_banks);
        counts.add(CostItem::StrikerBank, own_banks - driven_banks);
        let on_bus = second_groups > 0 || voice.filters_join_in(true) || !voice.drives_quickly();
        let mut bus_frames = own_banks * frames;
        // Else nothing answers the force.
        if groups > 0 || voice.has_acceleration_sound() {
            if on_bus {
                counts.add(CostItem::BusDrivenPad, 1);
                bus_frames += frames;
            } else {
                counts.add(CostItem::DrivenPad, 1);
                let has_onset = voice.banks().iter().any(Bank::has_onset);
                counts.add(CostItem::OnsetFrame, if has_onset { frames } else { 0 });
            }
            counts.add(CostItem::DrivenFrame, frames);
            counts.add(CostItem::ContactFrame, contact_frames);
            counts.add(CostItem::DirectFrame, ongoing_frames + if is_direct { frames } else { 0 });
        }
        counts.add(CostItem::BusFrame, bus_frames);
        true
    }

    /// Adds what pads in frames take of a run: their heads, and the buses of those whose strikers
    /// have no modes that sound.
    #[inline(never)] // must not weigh on kits without frames
    fn add_heads(&self, frames: u32, direct: Option<Direct<'_>>, struck: &[u8], counts: &mut Counts) {
        for (voice, number) in self.voices.iter().zip(0u8..) {
            let Some(object) = voice.frames() else { continue };
            let struck = struck.get(usize::from(number)).is_some_and(|&strikers| strikers != 0);
            let contact_frames = self.contacts.frames_ahead(number, frames) + if struck { frames } else { 0 };
            let is_direct = direct_input(direct, number) > 0.0;
            let ongoing_frames = self.contacts.ongoing.frames_ahead(number, frames);
            let is_driven = contact_frames > 0 || ongoing_frames > 0 || is_direct;
            let cycles = object.head_cycles(frames, is_driven) * self.loop_percent / 100;
            counts.add(CostItem::ResidualCycle, cycles);
            if voice.group_count() > 0 {
                // Its strikers' banks have been counted with their bus.
            } else if is_driven {
                counts.add(CostItem::BusDrivenPad, 1);
                counts.add(CostItem::BusFrame, frames);
                counts.add(CostItem::DrivenFrame, frames);
                counts.add(CostItem::ContactFrame, contact_frames);
                counts.add(CostItem::DirectFrame, ongoing_frames + if is_direct { frames } else { 0 });
            } else if cycles > 0 {
                counts.add(CostItem::BusPad, 1);
                counts.add(CostItem::BusFrame, frames);
            }
        }
    }
}
