//! The budget: the cost of a tick is predicted, and what does not fit is shed, the quietest first.
//!
//! The engine predicts before each run that brings something new, at a tick or at an event. It adds
//! up the cost of the rest of the tick, from counts and from constants that were measured on the
//! virtual core. If the sum exceeds the budget, it sheds register groups until the rest fits, and
//! logs this as an event [`Action::Shed`]: a recording of all events plays to the same bits without
//! any budget.
//!
//! The prediction sees the events of the block: with blocks of whole ticks no event comes as a
//! surprise within a tick.

use super::cost::{CostItem, Counts};
use super::render::next_news;
use super::setup::Skipping;
use super::shedding::ShedAmount;
use super::state::{Direct, Engine, direct_input};
use crate::event::{Action, Event, Time};
use crate::frames::InFrames;
use crate::resonator::{Bank, Use};
use crate::room::Sample;
use crate::time::TICK_FRAMES;
use crate::voice::Voice;

impl<S: Sample> Engine<'_, '_, S> {
    /// Sets the cycles that a tick of 32 frames may take, or takes the limit away. 80 % of 168 MHz
    /// at 48 kHz are 89 600.
    ///
    /// Nothing is shed while [`Skipping`](super::Skipping) is off. The prediction's own cost is
    /// part of the budget: [`CostItem::Look`] and [`CostItem::PredictedGroup`]. A kit whose modes
    /// are all in frames has nothing to shed: nothing is predicted then.
    pub fn set_budget(&mut self, cycles_per_tick: Option<u32>) {
        self.budget = cycles_per_tick.filter(|_| self.groups_built > 0);
    }

    /// Sheds register groups that do not fit. `upcoming` are the events behind those that have been
    /// applied, and all that there will be before `known_until`.
    ///
    /// True if it has counted the rest of the tick: no other prediction is due in it.
    #[inline(never)] // its tables must not weigh on ticks without a budget
    pub(super) fn keep_budget(
        &mut self,
        upcoming: &[Event],
        known_until: u64,
        direct: Option<Direct<'_>>,
        log: &mut impl FnMut(&Event),
    ) -> bool {
        let Some(budget) = self.budget.filter(|_| self.skipping == Skipping::On) else { return false };
        let [idle, busy] = KEPT_FREE;
        let margin = budget / MARGIN + if self.report.counts.of(CostItem::IdleTick) > 0 { idle } else { busy };
        let mut rest = self.rest_of_tick(upcoming, direct);
        // One choke is paid from the time between the budget and the tick's end, and sheds nothing.
        let modes = self.report.counts.of(CostItem::ChokedMode);
        let choke = modes.min(FREE_CHOKED_MODES) * CostItem::ChokedMode.cycles();
        let choke = choke + self.report.counts.of(CostItem::Choke).min(1) * CostItem::Choke.cycles();
        let budget = budget.saturating_sub(margin) + choke;
        let mut predicted = self.report.predicted_cycles() + rest.cycles();
        let end = self.now + u64::from(self.frames_to_tick());
        let is_last = || next_news(upcoming).is_none_or(|event| event.time.first_frame() >= end);
        let is_counted = end <= known_until && (predicted <= budget || is_last());
        if !is_counted {
            // The next event will call for another prediction.
            predicted += predictions_ahead(&rest);
            for item in [CostItem::Look, CostItem::PredictedGroup] {
                self.report.counts.add(item, rest.of(item));
            }
        }
        if predicted > budget
            && let Some(chosen) = self.shed_excess(predicted, budget, margin, &mut rest, direct)
        {
            log(&Event { time: Time::at_frame(self.now), action: Action::Shed(chosen), ..Event::NOTHING });
        }
        if is_counted {
            self.report.counts += &rest;
        }
        is_counted
    }

    /// Sheds what a prediction exceeds the budget by, and takes it out of the counts of the `rest`.
    /// Gives the number of groups, `None` if a choice would take longer than what it frees.
    #[inline(never)] // rare, and its tables must not lie on the stack beside those of the prediction
    fn shed_excess(
        &mut self,
        predicted: u32,
        budget: u32,
        margin: u32,
        rest: &mut Counts,
        direct: Option<Direct<'_>>,
    ) -> Option<u16> {
        let survey = self.survey_counts();
        let survey_cycles: u32 = survey.iter().map(|&(item, count)| item.cycles() * count).sum();
        let guards = rest.of(CostItem::GuardedGroup) * CostItem::GuardedGroup.cycles();
        let sheddable = (rest.of(CostItem::KernelCycle) + guards).min(predicted);
        let least = predicted + survey_cycles - sheddable;
        // If no group can be kept, there is nothing to choose. A choice may take some of what is
        // kept free: without it the strike would be silent.
        let sheds_all = least > budget + margin / 2;
        // A choice that takes longer than what it frees would lengthen the tick: a strike late in a
        // tick keeps its modes, and the next tick sheds.
        if sheddable + if sheds_all { cycles_of_forces(rest) } else { 0 } <= survey_cycles {
            return None;
        }
        let amount = if sheds_all {
            self.report.counts.add_all([(CostItem::Survey, 1), (CostItem::SurveyedGroup, self.awake_groups() / 3)]);
            ShedAmount::All
        } else {
            self.report.counts.add_all(survey);
            // Groups free what they take, of which the prediction has a part.
            ShedAmount::Cycles((predicted + survey_cycles - budget) * 100 / self.loop_percent.max(1))
        };
        let shed = self.shed(amount, direct);
        // Pads without any group left cost less still; only the groups' own share is certain.
        let kernels = match amount {
            ShedAmount::All => u32::MAX,
            _ => {
                let guards = shed.unguarded_groups * CostItem::GuardedGroup.cycles();
                shed.cycles.saturating_sub(guards) * self.loop_percent / 100
            }
        };
        rest.remove(CostItem::KernelCycle, kernels);
        rest.remove(CostItem::GuardedGroup, shed.unguarded_groups);
        Some(shed.groups as u16)
    }

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

    /// Counts of the beginning of a tick in which anything is to be done.
    #[inline(never)]
    pub(super) fn beginning(&self) -> [(CostItem, u32); 6] {
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
        let noise = (CostItem::ResidualCycle, self.stage_cycles_ahead());
        let choke = (CostItem::ChokedMode, reached);
        let due = [(CostItem::DueGroup, due_groups), (CostItem::GuardedRingingGroup, driven_groups)];
        [(CostItem::Tick, 1), (CostItem::WakingPad, waking), due[0], due[1], noise, choke]
    }

    /// Counts an event that no prediction of its tick has counted.
    #[inline(never)] // two callers
    pub(super) fn count_event(&mut self, event: &Event) {
        if self.budget.is_some() {
            let counts = self.event_counts(event);
            self.report.counts.add_all(counts);
        }
    }

    /// Counts of an event.
    fn event_counts(&self, event: &Event) -> [(CostItem, u32); 5] {
        let nothing = (CostItem::Choke, 0);
        match event.action {
            Action::Strike => {
                let filters = (CostItem::ResidualCycle, self.filter_strike_cycles(event.pad));
                let noise = (CostItem::ResidualStrike, u32::from(self.has_noise(event.pad)));
                let [modes, groups] = self.moved(event.pad, event.position).counts();
                [(CostItem::Strike, 1), noise, filters, modes, groups]
            }
            Action::Shed(_) => {
                let [survey, groups] = self.survey_counts();
                [survey, groups, nothing, nothing, nothing]
            }
            // Counted at the tick at which they act.
            Action::Choke | Action::Release | Action::Level | Action::Silence => [nothing; 5],
            #[cfg(feature = "scrapes")]
            Action::Touch { .. } | Action::Move(_) | Action::Lift => [nothing; 5],
        }
    }

    fn survey_counts(&self) -> [(CostItem, u32); 2] {
        [(CostItem::Survey, 1), (CostItem::SurveyedGroup, self.awake_groups())]
    }

    /// Number of register groups of the pads that are awake.
    fn awake_groups(&self) -> u32 {
        let awake = self.awake.pads().filter_map(|pad| self.voices.get(usize::from(pad)));
        awake.map(|voice| voice.group_count() as u32).sum()
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

    /// Counts of the tick's rest, with the events that are known.
    #[inline(never)]
    fn rest_of_tick(&mut self, upcoming: &[Event], direct: Option<Direct<'_>>) -> Counts {
        let end = self.now + u64::from(self.frames_to_tick());
        for event in upcoming.iter().take_while(|event| event.time.first_frame() < end) {
            if event.action == Action::Strike {
                self.wake(event.pad);
            }
        }
        let struck = core::mem::take(&mut self.struck);
        struck.fill(0);
        let total = self.count_rest_of_tick(upcoming, direct, struck);
        self.struck = struck;
        total
    }

    fn count_rest_of_tick(&self, upcoming: &[Event], direct: Option<Direct<'_>>, struck: &mut [u8]) -> Counts {
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
            while let Some(event) = events.next_if(|event| event.time.first_frame() == next) {
                total.add_all(self.event_counts(event));
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
    fn add_run(&self, frames: u32, direct: Option<Direct<'_>>, struck: &[u8], counts: &mut Counts) {
        if frames == 0 || self.idle && direct.is_none() && struck.iter().all(|&strikers| strikers == 0) {
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
        for number in self.awake.pads() {
            let Some(voice) = self.voices.get(usize::from(number)) else { break };
            // The cycles of a pad in frames are counted with its head.
            counts.add(CostItem::Pad, u32::from(voice.frames().is_none()));
            let strikers = struck.get(usize::from(number)).copied().unwrap_or(0);
            let struck = strikers != 0;
            let is_direct = direct.is_some() && direct_input(direct, number) > 0.0;
            let pad_banks = voice.banks();
            let contact_frames = self.contacts.frames_ahead(number, frames) + if struck { frames } else { 0 };
            let ongoing_frames = self.contacts.ongoing.frames_ahead(number, frames);
            let is_driven = contact_frames > 0 || ongoing_frames > 0 || is_direct;
            if !is_driven && !voice.is_ringing() {
                continue;
            }
            let (mut groups, mut banks, mut driven_banks) = (0, 0, 0);
            let mut on_bus = false;
            let with_modes = (0u8..).zip(pad_banks).filter(|(_, bank)| bank.mode_count() > 0);
            for (index, bank) in with_modes {
                // Bank 0 is the object's.
                let is_struck_by = || strikers >> ((index - 1) & 7) & 1 == 1;
                let by = || is_struck_by() || is_direct && index == 1 || self.contacts.is_any_by(number, index - 1);
                let is_driven = is_driven && (index == 0 || by());
                let used = match is_driven {
                    false => Use::Free,
                    true if struck => Use::Struck,
                    true => Use::Driven,
                };
                let (cycles, running) = bank.cycles(used, frames);
                let has_second = bank.can_take_second() && self.has_second(number, is_direct, struck, bank);
                counts.add(CostItem::KernelCycle, cycles * self.loop_percent / 100);
                counts.add(CostItem::SecondFrame, if has_second { running * frames } else { 0 });
                on_bus |= has_second;
                // The prediction of a driven bank takes twice as long.
                counts.add(CostItem::PredictedGroup, bank.group_count() * (1 + u32::from(is_driven)));
                groups += running;
                banks += u32::from(running > 0);
                driven_banks += u32::from(running > 0 && is_driven);
                let is_unguarded = voice.expects() || struck || ongoing_frames == 0 && bank.is_unguarded();
                if is_driven && is_unguarded {
                    let item = if bank.is_ringing() { CostItem::GuardedRingingGroup } else { CostItem::GuardedGroup };
                    counts.add(item, running);
                }
            }
            if ongoing_frames > 0 && !(voice.expects() || struck) {
                counts.add(CostItem::GuardedGroup, voice.groups_to_guard_for_ongoing());
            }
            let (own_banks, driven_banks) = (banks.max(1) - 1, driven_banks.max(1) - 1);
            counts.add(CostItem::DrivenStrikerBank, driven_banks);
            counts.add(CostItem::StrikerBank, own_banks - driven_banks);
            counts.add(CostItem::BusFrame, own_banks * frames);
            if is_driven && groups == 0 {
                // Nothing answers the force.
                continue;
            }
            on_bus |= voice.filters_join_in(is_driven);
            if is_driven {
                if voice.drives_quickly() && !on_bus {
                    counts.add(CostItem::DrivenPad, 1);
                    counts.add(CostItem::OnsetFrame, if pad_banks.iter().any(Bank::has_onset) { frames } else { 0 });
                } else {
                    counts.add(CostItem::BusDrivenPad, 1);
                    counts.add(CostItem::BusFrame, frames);
                }
                counts.add(CostItem::DrivenFrame, frames);
                counts.add(CostItem::ContactFrame, contact_frames);
                counts.add(CostItem::DirectFrame, ongoing_frames + if is_direct { frames } else { 0 });
            } else if voice.rings_quickly() && !on_bus {
                counts.add(CostItem::RingingPad, 1);
            } else {
                counts.add(CostItem::BusPad, 1);
                counts.add(CostItem::BusFrame, frames);
            }
        }
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

/// Cycles of the predictions that a tick of several runs still makes: about as many of the runs
/// behind each event as there are runs, and one of each run as it ends.
fn predictions_ahead(rest: &Counts) -> u32 {
    let runs = rest.of(CostItem::Look);
    let groups = rest.of(CostItem::PredictedGroup);
    (runs * CostItem::Look.cycles() + groups * CostItem::PredictedGroup.cycles()) * runs.saturating_sub(1)
}

/// Cycles that forces take beside the groups that answer them; they take none if no group does.
fn cycles_of_forces(rest: &Counts) -> u32 {
    let of = |item: CostItem| rest.of(item) * item.cycles();
    of(CostItem::BusDrivenPad) + of(CostItem::DrivenPad) + of(CostItem::DrivenStrikerBank) + of(CostItem::ContactFrame)
}

/// Share of the budget that is kept free, as its inverse.
const MARGIN: u32 = 32;

/// Cycles kept free beyond [`MARGIN`], in a tick that begins idle and in another one. They cover
/// the waits of flash and the interrupts of the boards. The dearest half takes 83 % of the time to
/// its deadline on the F407 board and 90 % on the BlackPill
/// (`cargo test -p virtual-board --test boards load`).
const KEPT_FREE: [u32; 2] = [635, 1670];

/// Maximum number of modes a tick whose choke is paid from beyond the budget: those of one object's
/// bank and one striker's. A board's tick is at least twice as long as its budget.
const FREE_CHOKED_MODES: u32 = 32;
