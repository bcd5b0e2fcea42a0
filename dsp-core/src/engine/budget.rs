//! The budget: what a tick will cost is known before it is computed, and what does not fit is left out, the quietest first.
//!
//! Before each run of a tick that brings something new (the tick itself, an event) the engine adds up what the rest of the tick will cost,
//! from counts and from constants that were measured on the virtual core. Where that exceeds the budget it leaves out register
//! groups until the rest fits, and says so as an event [`Action::Shed`], so that a recording of all events plays to the same bits without
//! any budget.
//!
//! Events are looked at as far as the block holds them: with blocks of whole ticks nothing comes as a surprise within a tick.

use super::cost::{CYCLES, Counts, Part};
use super::{Direct, Engine};
use crate::event::{Action, Event, Time};
use crate::resonator::{Audience, LEVELS, Memory, SILENT, Shed, Step, Survey, TICK_FRAMES, Use};

impl<'k, const PADS: usize, const MODES: usize, const GROUPS: usize, const ORIGINS: usize, const CONTACTS: usize>
    Engine<'k, PADS, MODES, GROUPS, ORIGINS, CONTACTS>
{
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
        let Some(budget) = self.budget.filter(|_| self.skipping == super::Skipping::On) else { return false };
        // What a single tick may cost more than predicted.
        let budget = budget - budget / MARGIN;
        let mut rest = self.rest_of_tick(upcoming, direct);
        let predicted = self.report.predicted_cycles() + rest.cycles();
        if predicted > budget {
            let before = self.report.shed;
            let survey = self.survey_counts();
            let sheddable = rest.of(Part::KernelCycle) + rest.of(Part::GuardedGroup) * cycles_of(Part::GuardedGroup);
            if predicted + survey.cycles() - sheddable.min(predicted) > budget {
                // Where nothing can be kept there is nothing to choose.
                self.report.counts.add(Part::SurveyedGroup, self.group_count() / 3);
                let mut steps = [Step::default(); LEVELS];
                steps.iter_mut().take(1).for_each(|step| step.groups = u32::from(u16::MAX));
                self.shed_by_level(u16::MAX, &[0; GROUPS], &steps, direct);
            } else {
                self.report.counts += survey;
                let mut levels = [SILENT; GROUPS];
                let steps = self.survey(direct, &mut levels);
                let chosen = quietest_that_free(predicted + survey.cycles() - budget, &steps);
                self.shed_by_level(chosen, &levels, &steps, direct);
            }
            let chosen = (self.report.shed.groups - before.groups) as u16;
            // Pads of which nothing is left cost less still; the kernels' share is what was freed for certain.
            rest.remove(Part::KernelCycle, self.report.shed.cycles - before.cycles);
            rest.remove(Part::GuardedGroup, self.report.shed.groups - before.groups);
            log(&Event { time: Time::at_frame(self.now), action: Action::Shed(chosen), ..Event::NOTHING });
        }
        let end = self.now + u64::from(self.frames_to_tick());
        let surprised = upcoming.first().is_some_and(|event| event.time.first_frame() < end);
        if !surprised {
            self.report.counts += rest;
        }
        !surprised
    }

    /// Counts a run that [`keep_budget`](Self::keep_budget) has not.
    #[inline(never)]
    pub(super) fn count_run(&mut self, frames: u32, direct: Option<Direct<'_>>) {
        let counts = self.run_counts(frames, direct, &[false; PADS]);
        self.report.counts += counts;
    }

    fn group_count(&self) -> u32 {
        self.voices().iter().map(|voice| voice.pad.group_count()).sum()
    }

    /// Leaves out the `count` quietest register groups of those that would run.
    #[inline(never)]
    pub(super) fn shed_quietest(&mut self, count: u16, direct: Option<Direct<'_>>) {
        let mut levels = [SILENT; GROUPS];
        let steps = self.survey(direct, &mut levels);
        self.shed_by_level(count, &levels, &steps, direct);
    }

    #[inline(never)]
    fn shed_by_level(&mut self, count: u16, levels: &[u8; GROUPS], steps: &[Step; LEVELS], direct: Option<Direct<'_>>) {
        let (mut left, mut threshold) = (u32::from(count), LEVELS);
        for (level, step) in steps.iter().enumerate() {
            if step.groups > left {
                threshold = level;
                break;
            }
            left -= step.groups;
        }
        let mut shed = Shed::default();
        for number in 0..self.pad_count as u8 {
            let (audience, used) = (self.audience(number, direct), self.used(number, direct));
            let run = (used, self.frames_to_tick());
            let mut memory = Memory { modes: &mut self.modes, groups: &mut self.groups, origins: &mut self.origins };
            let Some(voice) = self.pads.get_mut(usize::from(number)) else { break };
            for bank in voice.pad.banks_mut() {
                shed += bank.shed(&mut memory, audience, run, levels, (threshold as u8, &mut left));
            }
        }
        self.report.shed += shed;
    }

    /// The loudness of every group, and what each level has and costs.
    #[inline(never)]
    fn survey(&self, direct: Option<Direct<'_>>, levels: &mut [u8; GROUPS]) -> [Step; LEVELS] {
        let mut survey = Survey { levels, steps: [Step::default(); LEVELS] };
        for (voice, number) in self.voices().iter().zip(0u8..) {
            let used = self.used(number, direct);
            if used == Use::Free && !voice.pad.is_ringing() {
                continue;
            }
            let guard = if voice.pad.expects() { cycles_of(Part::GuardedGroup) } else { 0 };
            let run = (used, self.frames_to_tick(), guard);
            let audience = self.audience(number, direct);
            for bank in voice.pad.banks() {
                bank.survey(&self.groups, &self.modes, audience, run, &mut survey);
            }
        }
        survey.steps
    }

    fn audience(&self, pad: u8, direct: Option<Direct<'_>>) -> Audience {
        let (input, contact_samples) = self.flight.ahead(pad);
        let unit = self.voices().get(usize::from(pad)).map_or(0.0, |voice| voice.pad.unit());
        Audience::new(unit, input + direct_input(direct, pad), contact_samples)
    }

    fn used(&self, pad: u8, direct: Option<Direct<'_>>) -> Use {
        if self.flight.count_on(pad) > 0 || direct_input(direct, pad) > 0.0 { Use::Driven } else { Use::Free }
    }

    /// What a tick's beginning does.
    #[inline(never)]
    pub(super) fn beginning(&self) -> Counts {
        let mut counts = Counts::NONE;
        counts.add(Part::Tick, 1);
        if self.idle {
            return counts;
        }
        counts.add(Part::Pad, self.pad_count as u32);
        for voice in self.voices().iter().filter(|voice| voice.pad.is_guard_due()) {
            counts.add(Part::DueGroup, voice.pad.group_count());
        }
        counts
    }

    /// What an event does.
    #[inline(never)]
    pub(super) fn event_counts(&self, event: &Event) -> Counts {
        let mut counts = Counts::NONE;
        match event.action {
            Action::Strike => counts.add(Part::Strike, 1),
            Action::Choke | Action::Release => {
                let modes = self.voices().get(usize::from(event.pad)).map_or(0, |voice| voice.pad.mode_count());
                counts.add(Part::Strike, 1);
                counts.add(Part::ChokedMode, modes as u32);
            }
            Action::Shed(_) => counts = self.survey_counts(),
        }
        counts
    }

    fn survey_counts(&self) -> Counts {
        let mut counts = Counts::NONE;
        counts.add(Part::Survey, 1);
        counts.add(Part::SurveyedGroup, self.group_count());
        counts
    }

    fn frames_to_tick(&self) -> u32 {
        (TICK_FRAMES as u64 - self.now % TICK_FRAMES as u64) as u32
    }

    /// From now to the end of the tick, with the events that are known.
    #[inline(never)]
    fn rest_of_tick(&self, upcoming: &[Event], direct: Option<Direct<'_>>) -> Counts {
        let end = self.now + u64::from(self.frames_to_tick());
        let (mut now, mut total) = (self.now, Counts::NONE);
        let mut struck = [false; PADS];
        let mut events = upcoming.iter().take_while(|event| event.time.first_frame() < end).peekable();
        while now < end {
            let next = events.peek().map_or(end, |event| event.time.first_frame());
            total += self.run_counts((next - now) as u32, direct, &struck);
            while let Some(event) = events.next_if(|event| event.time.first_frame() == next) {
                total += self.event_counts(event);
                if let (Action::Strike, Some(struck)) = (event.action, struck.get_mut(usize::from(event.pad))) {
                    *struck = true;
                }
            }
            now = next;
        }
        total
    }

    /// A run of frames. `struck` are pads that a known event will have struck by then.
    pub(super) fn run_counts(&self, frames: u32, direct: Option<Direct<'_>>, struck: &[bool; PADS]) -> Counts {
        let mut counts = Counts::NONE;
        if frames == 0 || self.idle && direct.is_none() && !struck.contains(&true) {
            return counts;
        }
        counts.add(Part::Run, 1);
        counts.add(Part::Frame, frames);
        for ((voice, number), &struck) in self.voices().iter().zip(0u8..).zip(struck) {
            let contact_frames = self.flight.frames_ahead(number, frames) + if struck { frames } else { 0 };
            let pad = &voice.pad;
            let is_driven = contact_frames > 0 || direct_input(direct, number) > 0.0;
            let used = if is_driven { Use::Driven } else { Use::Free };
            if !is_driven && !pad.is_ringing() {
                continue;
            }
            let (mut groups, mut banks) = (0, 0);
            for bank in pad.banks().filter(|bank| bank.mode_count() > 0) {
                let (cycles, running) = bank.cycles(&self.groups, used, frames);
                counts.add(Part::KernelCycle, cycles);
                counts.add(Part::PredictedGroup, bank.group_count());
                groups += running;
                banks += u32::from(running > 0);
                if is_driven && (pad.expects() || struck || bank.is_unguarded()) {
                    let part = if bank.is_ringing() { Part::GuardedRingingGroup } else { Part::GuardedGroup };
                    counts.add(part, running);
                }
            }
            counts.add(Part::StrikerBank, banks.max(1) - 1);
            if is_driven && groups == 0 {
                counts.add(Part::UnheardPad, 1);
            } else if is_driven {
                counts.add(Part::DrivenPad, 1);
                counts.add(Part::DrivenFrame, frames);
                counts.add(Part::ContactFrame, contact_frames);
            } else if pad.rings_quickly() {
                counts.add(Part::RingingPad, 1);
            } else {
                counts.add(Part::BusPad, 1);
                counts.add(Part::BusFrame, frames);
            }
        }
        counts
    }
}

/// A 32nd of the budget is kept free.
const MARGIN: u32 = 32;

fn cycles_of(part: Part) -> u32 {
    CYCLES.get(part as usize).copied().unwrap_or(0)
}

/// How many of the quietest register groups have to go to free so many cycles.
fn quietest_that_free(excess: u32, steps: &[Step; LEVELS]) -> u16 {
    let (mut total, mut chosen) = (0, 0);
    for step in steps {
        if total + step.cycles >= excess {
            // Of the step in which the excess ends, as many as are needed if the cheapest go first: a single mode costs a third of a full
            // group's share.
            let share = (excess - total).div_ceil((step.cycles / step.groups.max(1)).max(1));
            return (chosen + (share + share / 2 + 1).min(step.groups)) as u16;
        }
        (total, chosen) = (total + step.cycles, chosen + step.groups);
    }
    chosen as u16
}

/// Bound of what a direct force brings in the rest of the block, bus steps.
fn direct_input(direct: Option<Direct<'_>>, pad: u8) -> f32 {
    let Some(Direct { force, .. }) = direct.filter(|direct| direct.pad == pad) else { return 0.0 };
    force.iter().take(TICK_FRAMES).map(|x| x.unsigned_abs() as f32).sum()
}
