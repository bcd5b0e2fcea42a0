//! The budget: what a tick will cost is known before it is computed, and what does not fit is left out, the quietest first.
//!
//! Before each run of a tick that brings something new (the tick itself, an event) the engine adds up what the rest of the tick will cost,
//! from counts and from constants that were measured on the virtual core. Where that exceeds the budget it leaves out register
//! groups until the rest fits, and says so as an event [`Action::Shed`], so that a recording of all events plays to the same bits without
//! any budget.
//!
//! Events are looked at as far as the block holds them: with blocks of whole ticks nothing comes as a surprise within a tick.

use super::cost::{CYCLES, Counts, Part};
use super::render::next_news;
use super::setup::Skipping;
use super::state::{Direct, Engine};
use crate::event::{Action, Event, Time};
use crate::resonator::{Audience, Bank, Shed, ShedChoice, ShedPlan, UpcomingRun, Use};
use crate::room::Sample;
use crate::time::TICK_FRAMES;
use crate::voice::Voice;

/// How much to leave out.
#[derive(Clone, Copy, Debug)]
pub(super) enum LeaveOut {
    /// Everything.
    All,
    /// So many register groups, the quietest.
    Groups(u16),
    /// As many as free so many cycles.
    Cycles(u32),
}

impl<S: Sample> Engine<'_, '_, S> {
    /// Sets how many cycles a tick of 32 frames may take, or takes the limit away. For 80 % of 168 MHz at 48 kHz: 89 600.
    ///
    /// Nothing is left out while [`Skipping`](super::Skipping) is off. What the look-up itself costs is among [`CYCLES`], [`Part::PredictedGroup`].
    pub fn set_budget(&mut self, cycles_per_tick: Option<u32>) {
        self.budget = cycles_per_tick;
    }

    /// Leaves out what does not fit. `upcoming` are the events behind those that have been applied. Says whether it has counted the rest of
    /// the tick, because no event is known to come in it.
    #[inline(never)] // its tables must not weigh on ticks without a budget
    pub(super) fn keep_budget(
        &mut self,
        upcoming: &[Event],
        direct: Option<Direct<'_>>,
        log: &mut impl FnMut(&Event),
    ) -> bool {
        let Some(budget) = self.budget.filter(|_| self.skipping == Skipping::On) else { return false };
        let [idle, busy] = KEPT_FREE;
        let margin = budget / MARGIN + if self.report.counts.of(Part::IdleTick) > 0 { idle } else { busy };
        let mut rest = self.rest_of_tick(upcoming, direct);
        let end = self.now + u64::from(self.frames_to_tick());
        let surprised = next_news(upcoming).is_some_and(|event| event.time.first_frame() < end);
        if surprised {
            // The event will call for another look.
            for part in [Part::Look, Part::PredictedGroup] {
                self.report.counts.add(part, rest.of(part));
            }
        }
        // What a single tick may cost more than predicted is kept free, and pays for a hand: so that of one pad sheds nothing.
        let modes = self.report.counts.of(Part::ChokedMode);
        let hands = modes.min(HANDS) * cycles_of(Part::ChokedMode);
        let hands = hands + self.report.counts.of(Part::Hand).min(1) * cycles_of(Part::Hand);
        let budget = budget.saturating_sub(margin) + hands;
        let predicted = self.report.predicted_cycles() + rest.cycles();
        if predicted > budget {
            let survey = self.survey_counts();
            let survey_cycles: u32 = survey.iter().map(|&(part, count)| cycles_of(part) * count).sum();
            let guards = rest.of(Part::GuardedGroup) * cycles_of(Part::GuardedGroup);
            let sheddable = rest.of(Part::KernelCycle) + guards;
            let leave_out = if predicted + survey_cycles - sheddable.min(predicted) > budget {
                // Where nothing can be kept there is nothing to choose.
                self.report.counts.add_all([(Part::Survey, 1), (Part::SurveyedGroup, self.groups_built / 3)]);
                LeaveOut::All
            } else {
                self.report.counts.add_all(survey);
                LeaveOut::Cycles(predicted + survey_cycles - budget)
            };
            let shed = self.leave_out(leave_out, direct);
            // Pads of which nothing is left cost less still; the groups' own share is what was freed for certain.
            let kernels = match leave_out {
                LeaveOut::All => u32::MAX,
                _ => shed.cycles.saturating_sub(shed.unguarded_groups * cycles_of(Part::GuardedGroup)),
            };
            rest.remove(Part::KernelCycle, kernels);
            rest.remove(Part::GuardedGroup, shed.unguarded_groups);
            let chosen = shed.groups as u16;
            log(&Event { time: Time::at_frame(self.now), action: Action::Shed(chosen), ..Event::NOTHING });
        }
        if !surprised {
            self.report.counts += &rest;
        }
        !surprised
    }

    /// Counts a run that [`keep_budget`](Self::keep_budget) has not.
    #[inline(never)]
    pub(super) fn count_run(&mut self, frames: u32, direct: Option<Direct<'_>>) {
        let mut counts = Counts::NONE;
        self.add_run(frames, direct, &[], &mut counts);
        self.report.counts += &counts;
    }

    /// Leaves out the quietest register groups of those that would run.
    #[inline(never)] // its tables must not lie on the stack beside what looks ahead
    pub(super) fn leave_out(&mut self, what: LeaveOut, direct: Option<Direct<'_>>) -> Shed {
        self.listen(direct);
        let shed = match what {
            LeaveOut::All => self.shed(ShedChoice::ALL),
            _ => self.leave_out_quietest(what),
        };
        self.report.shed += shed;
        shed
    }

    /// Surveys all groups first, which everything does without.
    #[inline(never)]
    fn leave_out_quietest(&mut self, what: LeaveOut) -> Shed {
        let levels = core::mem::take(&mut self.levels);
        let mut plan = ShedPlan::new(levels);
        for (voice, listening) in self.voices.iter().zip(&*self.listening) {
            match listening {
                Some((audience, run)) => {
                    voice.banks().iter().for_each(|bank| bank.plan_shedding(audience, *run, &mut plan))
                }
                None => plan.pass_over(voice.group_count()),
            }
        }
        let count = match what {
            LeaveOut::All => u16::MAX,
            LeaveOut::Groups(count) => count,
            LeaveOut::Cycles(excess) => plan.quietest_that_free(excess),
        };
        let (choice, cycles_below) = plan.quietest(count);
        let mut shed = self.shed(choice);
        shed.cycles += cycles_below;
        self.levels = plan.into_levels();
        shed
    }

    #[inline(never)] // one for both
    fn shed(&mut self, mut choice: ShedChoice<'_>) -> Shed {
        let mut shed = Shed::default();
        for (voice, listening) in self.voices.iter_mut().zip(&*self.listening) {
            let Some((audience, run)) = listening else {
                choice.pass_over(voice.group_count());
                continue;
            };
            voice.wake();
            for bank in &mut *voice.banks {
                shed += bank.shed(audience, *run, &mut choice);
            }
        }
        shed
    }

    /// How each pad that sounds is heard, and how it will run.
    #[inline(never)]
    fn listen(&mut self, direct: Option<Direct<'_>>) {
        let frames = self.frames_to_tick() as u8;
        for ((voice, listening), number) in self.voices.iter().zip(&mut *self.listening).zip(0u8..) {
            let (input, contact_samples) = self.contacts.ahead(number);
            let input = input + direct_input(direct, number);
            let used = if input > 0.0 { Use::Driven } else { Use::Free };
            *listening = (used == Use::Driven || voice.is_ringing()).then(|| {
                let guard = if voice.expects() { cycles_of(Part::GuardedGroup) as u16 } else { 0 };
                let audience = Audience::new(voice.unit(), input, contact_samples);
                (audience, UpcomingRun { used, frames, guard })
            });
        }
    }

    /// What a tick's beginning does.
    #[inline(never)]
    pub(super) fn beginning(&self) -> [(Part, u32); 5] {
        if self.idle {
            let nothing = (Part::WakingPad, 0);
            return [(Part::IdleTick, 1), nothing, nothing, nothing, nothing];
        }
        let due = self.voices.iter().filter(|voice| voice.is_guard_due());
        let groups = due.map(Voice::group_count).sum::<usize>() as u32;
        let pads = self.voices.iter().filter(|voice| !voice.rests()).count();
        let noise = (Part::ResidualCycle, self.stage_cycles_ahead());
        let (modes, guards) = self.reached();
        let hand = (Part::ChokedMode, modes);
        [(Part::Tick, 1), (Part::WakingPad, pads as u32), (Part::DueGroup, groups + guards), noise, hand]
    }

    /// What an event does.
    pub(super) fn event_counts(&self, event: &Event) -> [(Part, u32); 4] {
        let nothing = (Part::Hand, 0);
        match event.action {
            Action::Strike => {
                let filters = (Part::ResidualCycle, self.filter_strike_cycles(event.pad));
                let noise = (Part::ResidualStrike, u32::from(self.has_noise(event.pad)));
                [(Part::Strike, 1), noise, filters, (Part::MovedMode, self.moved_modes(event))]
            }
            Action::Shed(_) => {
                let [survey, groups] = self.survey_counts();
                [survey, groups, nothing, nothing]
            }
            // At the tick at which they act.
            Action::Choke | Action::Release => [nothing; 4],
        }
    }

    /// Modes whose gains a strike has derived anew.
    fn moved_modes(&self, event: &Event) -> u32 {
        let object = self.voices.get(usize::from(event.pad)).and_then(|voice| voice.banks().first());
        let moves =
            |object: &&Bank<'_>| object.place(event.position, |slot| self.contacts.is_any_in(event.pad, slot)).moves;
        object.filter(moves).map_or(0, |object| object.mode_count() as u32)
    }

    /// Modes that hands reach in this tick, and groups that are guarded for them.
    fn reached(&self) -> (u32, u32) {
        self.voices.iter().flat_map(|voice| voice.banks()).filter(|bank| bank.is_being_reached()).fold(
            (0, 0),
            |(modes, groups), bank| {
                let guards = if bank.hand_is_guarded() { bank.group_count() } else { 0 };
                (modes + bank.modes_to_reach() as u32, groups + guards) // banks count in 16 bits
            },
        )
    }

    fn survey_counts(&self) -> [(Part, u32); 2] {
        [(Part::Survey, 1), (Part::SurveyedGroup, self.groups_built)]
    }

    fn frames_to_tick(&self) -> u32 {
        (TICK_FRAMES as u64 - self.now % TICK_FRAMES as u64) as u32
    }

    /// True if a force is, or by a known strike may be, in the second slot of a pad.
    fn has_second(&self, number: u8, is_direct: bool, struck: bool, bank: &Bank<'_>) -> bool {
        let is_driven = self.contacts.is_any_in(number, 1) || struck && self.contacts.is_any_in(number, 0);
        let direct_slot = self.voices.get(usize::from(number)).map_or(0, Voice::direct_slot);
        is_driven || bank.has_second_gains() && is_direct && direct_slot == 1
    }

    /// From now to the end of the tick, with the events that are known.
    #[inline(never)]
    fn rest_of_tick(&mut self, upcoming: &[Event], direct: Option<Direct<'_>>) -> Counts {
        let struck = core::mem::take(&mut self.struck);
        struck.fill(false);
        let total = self.count_rest_of_tick(upcoming, direct, struck);
        self.struck = struck;
        total
    }

    fn count_rest_of_tick(&self, upcoming: &[Event], direct: Option<Direct<'_>>, struck: &mut [bool]) -> Counts {
        let end = self.now + u64::from(self.frames_to_tick());
        let (mut now, mut total) = (self.now, Counts::NONE);
        let news = upcoming.iter().filter(|event| !event.is_of_hand());
        let mut events = news.take_while(|event| event.time.first_frame() < end).peekable();
        while now < end {
            let next = events.peek().map_or(end, |event| event.time.first_frame());
            self.add_run((next - now) as u32, direct, struck, &mut total);
            while let Some(event) = events.next_if(|event| event.time.first_frame() == next) {
                total.add_all(self.event_counts(event));
                if let (Action::Strike, Some(struck)) = (event.action, struck.get_mut(usize::from(event.pad))) {
                    *struck = true;
                }
            }
            now = next;
        }
        total
    }

    /// Adds what a run of frames does. `struck` are pads that a known event will have struck by then; empty: none.
    fn add_run(&self, frames: u32, direct: Option<Direct<'_>>, struck: &[bool], counts: &mut Counts) {
        if frames == 0 || self.idle && direct.is_none() && !struck.contains(&true) {
            return;
        }
        counts.add(Part::Look, 1);
        counts.add(Part::Pad, self.voices.len() as u32);
        if self.noisy {
            let begun = struck.iter().zip(0u8..).filter(|(is, pad)| **is && self.has_noise(*pad)).count();
            let noises = (self.noises() + begun) as u32;
            counts.add(Part::ResidualRun, noises);
            counts.add(Part::ResidualFrame, noises * frames);
        }
        for (voice, number) in self.voices.iter().zip(0u8..) {
            let struck = struck.get(usize::from(number)).copied().unwrap_or(false);
            let pad_banks = voice.banks();
            let contact_frames = self.contacts.frames_ahead(number, frames) + if struck { frames } else { 0 };
            let is_direct = direct_input(direct, number) > 0.0;
            let is_driven = contact_frames > 0 || is_direct;
            let used = if is_driven { Use::Driven } else { Use::Free };
            if !is_driven && !voice.is_ringing() {
                continue;
            }
            let (mut groups, mut banks) = (0, 0);
            let mut on_bus = false;
            for bank in pad_banks.iter().filter(|bank| bank.mode_count() > 0) {
                let (cycles, running) = bank.cycles(used, frames);
                let has_second = bank.can_take_second() && self.has_second(number, is_direct, struck, bank);
                counts.add(Part::KernelCycle, cycles);
                counts.add(Part::SecondFrame, if has_second { running * frames } else { 0 });
                on_bus |= has_second;
                // Of a driven bank all are looked at closely.
                counts.add(Part::PredictedGroup, bank.group_count() * (1 + u32::from(is_driven)));
                groups += running;
                banks += u32::from(running > 0);
                if is_driven && (voice.expects() || struck || bank.is_unguarded()) {
                    let part = if bank.is_ringing() { Part::GuardedRingingGroup } else { Part::GuardedGroup };
                    counts.add(part, running);
                }
            }
            counts.add(Part::StrikerBank, banks.max(1) - 1);
            if is_driven && groups == 0 {
                // Nobody hears the force, and nothing is done.
                continue;
            }
            on_bus |= voice.filters_join_in(is_driven);
            if is_driven {
                let is_quick = voice.drives_quickly() && !on_bus;
                counts.add(if is_quick { Part::DrivenPad } else { Part::BusDrivenPad }, 1);
                if is_quick && pad_banks.iter().any(Bank::has_onset) {
                    counts.add(Part::OnsetFrame, frames);
                }
                counts.add(Part::DrivenFrame, frames);
                counts.add(Part::ContactFrame, contact_frames);
                counts.add(Part::DirectFrame, if is_direct { frames } else { 0 });
            } else if voice.rings_quickly() && !on_bus {
                counts.add(Part::RingingPad, 1);
            } else {
                counts.add(Part::BusPad, 1);
                counts.add(Part::BusFrame, frames);
            }
        }
    }
}

/// A 32nd of the budget is kept free.
const MARGIN: u32 = 32;

/// Cycles kept free beyond [`MARGIN`], in a tick that begins idle and in another one. They cover the
/// waits of flash and the interrupts of the boards: with them the busiest half of the BlackPill ends
/// at 96 % of its time (`cargo test -p virtual-board --test boards load`).
const KEPT_FREE: [u32; 2] = [635, 1670];

/// Largest number of modes a tick whose choke is paid from beyond the budget: those of one object's
/// bank and one striker's. A board's tick is at least twice as long as its budget.
const HANDS: u32 = 32;

fn cycles_of(part: Part) -> u32 {
    CYCLES.get(part as usize).copied().unwrap_or(0)
}

/// Bound of what a direct force brings in the rest of the block, bus steps.
fn direct_input(direct: Option<Direct<'_>>, pad: u8) -> f32 {
    let Some(Direct { force, .. }) = direct.filter(|direct| direct.pad == pad) else { return 0.0 };
    force.iter().take(TICK_FRAMES).map(|x| x.unsigned_abs() as f32).sum()
}
