//! The budget: what a tick will cost is known before it is computed, and what does not fit is left out, the quietest first.
//!
//! Before each run of a tick that brings something new (the tick itself, an event) the engine adds up what the rest of the tick will cost,
//! from counts and from constants that were measured on the virtual core. Where that exceeds the budget it leaves out register
//! groups until the rest fits, and says so as an event [`Action::Shed`], so that a recording of all events plays to the same bits without
//! any budget.
//!
//! Events are looked at as far as the block holds them: with blocks of whole ticks nothing comes as a surprise within a tick.

use super::{Direct, Engine};
use crate::event::{Action, Event, Time};
use crate::pad::Pad;
use crate::resonator::{Audience, Bank, LEVELS, Memory, SILENT, Shed, Step, Survey, TICK_FRAMES, Use};

/// Cycles of the parts of a tick, nominal, without flash waits: fitted to the virtual core over the bench's scenes, held to 3 % by
/// `cargo test --release -p host-tests --test virtual_budget`.
mod cycles {
    pub(super) const TICK: u32 = 500;
    pub(super) const TICK_PAD: u32 = 60;
    pub(super) const RUN: u32 = 250;
    pub(super) const RUN_FRAME: u32 = 22;
    pub(super) const QUIET_PAD: u32 = 60;
    pub(super) const RINGING_PAD: u32 = 560;
    pub(super) const RINGING_FRAME: u32 = 12;
    pub(super) const DRIVEN_PAD: u32 = 1200;
    pub(super) const DRIVEN_FRAME: u32 = 85;
    pub(super) const CONTACT_FRAME: u32 = 58;
    pub(super) const UNHEARD_PAD: u32 = 300;
    pub(super) const PREDICTED_GROUP: u32 = 40;
    pub(super) const GUARD: u32 = 500;
    pub(super) const GUARD_GROUP: u32 = 440;
    pub(super) const DUE_GROUP: u32 = 430;
    pub(super) const STRIKE: u32 = 900;
    pub(super) const SHED: u32 = 4000;
    pub(super) const SHED_GROUP: u32 = 400;
}

impl<'k, const PADS: usize, const MODES: usize, const GROUPS: usize, const ORIGINS: usize, const CONTACTS: usize>
    Engine<'k, PADS, MODES, GROUPS, ORIGINS, CONTACTS>
{
    /// Sets how many cycles a tick of 32 frames may take, or takes the limit away. For 80 % of 168 MHz at 48 kHz: 89 600.
    ///
    /// Nothing is left out while [`Skipping`](super::Skipping) is off. Costs some 15 cycles a register group and run.
    pub fn set_budget(&mut self, cycles_per_tick: Option<u32>) {
        self.budget = cycles_per_tick;
    }

    /// Leaves out what does not fit. `upcoming` are the events behind those that have been applied. Gives the cycles of the rest of the tick
    /// if no event is known to come in it.
    pub(super) fn keep_budget(
        &mut self,
        upcoming: &[Event],
        direct: Option<Direct<'_>>,
        log: &mut impl FnMut(&Event),
    ) -> Option<u32> {
        let budget = self.budget.filter(|_| self.skipping == super::Skipping::On)?;
        let mut rest = self.rest_of_tick(upcoming, direct);
        if self.report.predicted_cycles + rest > budget {
            self.report.predicted_cycles += cycles::SHED + cycles::SHED_GROUP * self.group_count();
            let mut levels = [SILENT; GROUPS];
            let steps = self.survey(direct, &mut levels);
            let chosen = quietest_that_free(self.report.predicted_cycles + rest - budget, &steps);
            self.shed_by_level(chosen, &levels, &steps, direct);
            rest = self.rest_of_tick(upcoming, direct);
            log(&Event { time: Time::at_frame(self.now), action: Action::Shed(chosen), ..Event::NOTHING });
        }
        let end = self.now + u64::from(self.frames_to_tick());
        let surprised = upcoming.first().is_some_and(|event| event.time.first_frame() < end);
        (!surprised).then_some(rest)
    }

    fn group_count(&self) -> u32 {
        self.voices().iter().map(|voice| voice.pad.group_count()).sum()
    }

    /// Leaves out the `count` quietest register groups of those that would run.
    pub(super) fn shed_quietest(&mut self, count: u16, direct: Option<Direct<'_>>) {
        let mut levels = [SILENT; GROUPS];
        let steps = self.survey(direct, &mut levels);
        self.shed_by_level(count, &levels, &steps, direct);
    }

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
            let audience = self.audience(number, direct);
            let mut memory = Memory { modes: &mut self.modes, groups: &mut self.groups, origins: &mut self.origins };
            let Some(voice) = self.pads.get_mut(usize::from(number)) else { break };
            for bank in voice.pad.banks_mut() {
                shed += bank.shed(&mut memory, audience, levels, threshold as u8, &mut left);
            }
        }
        self.report.shed += shed;
    }

    /// The loudness of every group, and what each level has and costs.
    fn survey(&self, direct: Option<Direct<'_>>, levels: &mut [u8; GROUPS]) -> [Step; LEVELS] {
        let mut survey = Survey { levels, steps: [Step::default(); LEVELS] };
        for (voice, number) in self.voices().iter().zip(0u8..) {
            let used = self.used(number, direct);
            if used == Use::Free && !voice.pad.is_ringing() {
                continue;
            }
            let guard = if voice.pad.expects() { cycles::GUARD_GROUP } else { 0 };
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

    /// Cycles of what a tick's beginning does.
    pub(super) fn beginning(&self) -> u32 {
        let due = |pad: &Pad| if pad.is_guard_due() { pad.group_count() * cycles::DUE_GROUP } else { 0 };
        cycles::TICK + self.voices().iter().map(|voice| cycles::TICK_PAD + due(&voice.pad)).sum::<u32>()
    }

    /// Cycles of an event.
    pub(super) fn event_cycles(&self, event: &Event) -> u32 {
        match event.action {
            Action::Strike => cycles::STRIKE,
            Action::Choke | Action::Release => {
                let modes = self.voices().get(usize::from(event.pad)).map_or(0, |voice| voice.pad.mode_count());
                cycles::STRIKE + 600 * modes as u32
            }
            Action::Shed(_) => cycles::SHED + cycles::SHED_GROUP * self.group_count(),
        }
    }

    fn frames_to_tick(&self) -> u32 {
        (TICK_FRAMES as u64 - self.now % TICK_FRAMES as u64) as u32
    }

    /// Cycles from now to the end of the tick, with the events that are known.
    fn rest_of_tick(&self, upcoming: &[Event], direct: Option<Direct<'_>>) -> u32 {
        let end = self.now + u64::from(self.frames_to_tick());
        let (mut now, mut total) = (self.now, 0);
        let mut struck = [false; PADS];
        let mut events = upcoming.iter().take_while(|event| event.time.first_frame() < end).peekable();
        while now < end {
            let next = events.peek().map_or(end, |event| event.time.first_frame());
            total += self.run_cycles((next - now) as u32, direct, &struck);
            while let Some(event) = events.next_if(|event| event.time.first_frame() == next) {
                total += self.event_cycles(event);
                if let (Action::Strike, Some(struck)) = (event.action, struck.get_mut(usize::from(event.pad))) {
                    *struck = true;
                }
            }
            now = next;
        }
        total
    }

    /// Cycles of a run of frames. `struck` are pads that a known event will have struck by then.
    pub(super) fn run_cycles(&self, frames: u32, direct: Option<Direct<'_>>, struck: &[bool; PADS]) -> u32 {
        if frames == 0 {
            return 0;
        }
        let mut total = cycles::RUN + cycles::RUN_FRAME * frames;
        for ((voice, number), &struck) in self.voices().iter().zip(0u8..).zip(struck) {
            let contact_frames = self.flight.frames_ahead(number, frames) + if struck { frames } else { 0 };
            let pad = &voice.pad;
            let is_direct = direct_input(direct, number) > 0.0;
            let used = if contact_frames > 0 || is_direct { Use::Driven } else { Use::Free };
            if used == Use::Free && !pad.is_ringing() {
                total += cycles::QUIET_PAD;
                continue;
            }
            let (banks, groups) = pad.banks().fold((0, 0), |(total, count), bank| {
                let (cycles, groups) = bank.cycles(&self.groups, used, frames);
                (total + cycles, count + groups)
            });
            total += banks + cycles::PREDICTED_GROUP * pad.group_count();
            total += match used {
                Use::Driven if groups == 0 => cycles::UNHEARD_PAD,
                Use::Driven => {
                    let is_unguarded = pad.expects() || struck || pad.banks().any(Bank::is_unguarded);
                    let guards = if is_unguarded { cycles::GUARD + cycles::GUARD_GROUP * groups } else { 0 };
                    cycles::DRIVEN_PAD + cycles::DRIVEN_FRAME * frames + cycles::CONTACT_FRAME * contact_frames + guards
                }
                Use::Free => cycles::RINGING_PAD + cycles::RINGING_FRAME * frames,
            };
        }
        total
    }
}

/// How many of the quietest register groups have to go to free so many cycles.
fn quietest_that_free(excess: u32, steps: &[Step; LEVELS]) -> u16 {
    let (mut total, mut chosen) = (0, 0);
    for step in steps {
        if total + step.cycles >= excess {
            // Of the step in which the excess ends, as many as are needed if the cheapest go first: a single mode costs a third of a full
            // group's share.
            let share = (u64::from(excess - total) * u64::from(step.groups)).div_ceil(u64::from(step.cycles.max(1))) as u32;
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
