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
use super::prediction::Counted;
use super::render::next_news;
use super::setup::Skipping;
use super::shedding::ShedAmount;
use super::state::{Direct, Engine};
use crate::event::{Action, Event, Shedding, Time};
use crate::resonator::Use;
use crate::room::Sample;

/// Prediction that exceeds the budget.
pub(super) struct Excess {
    pub(super) predicted: u32,
    pub(super) budget: u32,
    /// Part of the tick that the budget leaves free.
    pub(super) margin: u32,
    pub(super) sounding: Sounding,
}

/// Pads that sound in a tick's rest, or will by strikes that are known.
#[derive(Clone, Copy)]
pub(super) struct Sounding {
    pub(super) pads: u32,
    /// Number of their register groups, at rest or not.
    groups: u32,
    /// Cycles of the first group of each pad's object, as a prediction has them, with its guard.
    first_groups_cycles: u32,
}

impl Sounding {
    const NOTHING: Self = Self { pads: 0, groups: 0, first_groups_cycles: 0 };

    /// Cycles to leave all groups out.
    fn shed_cycles(&self) -> u32 {
        self.groups * CostItem::ShedGroup.cycles()
    }

    /// Cycles of [`Shedding::AllButFirst`] and of the groups that stay.
    fn rough_cycles(&self) -> u32 {
        CostItem::Survey.cycles() / 2 + self.shed_cycles() + self.first_groups_cycles
    }
}

impl Excess {
    /// Cycles for a decision and for what stays, where `sheddable` ones could be freed.
    ///
    /// A decision may take some of what is kept free: without it the strike would be silent.
    fn room(&self, sheddable: u32) -> u32 {
        (self.budget + self.margin / 2).saturating_sub(self.predicted - sheddable.min(self.predicted))
    }

    /// Cycles of a survey.
    fn survey_cycles(&self) -> u32 {
        CostItem::Survey.cycles() + self.sounding.groups * CostItem::SurveyedGroup.cycles()
    }

    /// Cycles to choose the quietest groups and to leave them out.
    fn choice_cycles(&self) -> u32 {
        self.survey_cycles() + self.sounding.shed_cycles()
    }

    /// True if there is time to choose the quietest groups, and for the first one of each pad.
    fn is_worth_a_survey(&self, sheddable: u32) -> bool {
        self.room(sheddable) >= self.choice_cycles() + self.sounding.first_groups_cycles
    }

    /// Cycles that lack for the first group of each pad. A tick that is cut may have to choose
    /// once more at the cut.
    pub(super) fn lacking_cycles(&self, sheddable: u32, is_cut: bool) -> u32 {
        let first = self.sounding.first_groups_cycles;
        let least = self.sounding.rough_cycles().min(self.choice_cycles() + first);
        (least + if is_cut { self.choice_cycles() } else { 0 }).saturating_sub(self.room(sheddable))
    }
}

/// Part of a budget that a tick leaves free.
pub(super) fn margin_of(budget: u32, is_idle: bool) -> u32 {
    let [idle, busy] = KEPT_FREE;
    budget / MARGIN + if is_idle { idle } else { busy }
}

impl<S: Sample> Engine<'_, '_, S> {
    /// Sets the cycles that a tick of 32 frames may take, or takes the limit away. 80 % of 168 MHz
    /// at 48 kHz are 89 600.
    ///
    /// Nothing is shed while [`Skipping`](super::Skipping) is off. The prediction's own cost is
    /// part of the budget: [`CostItem::Look`]. A kit whose modes
    /// are all in frames has nothing to shed: nothing is predicted then.
    pub fn set_budget(&mut self, cycles_per_tick: Option<u32>) {
        self.budget = cycles_per_tick.filter(|_| self.groups_built > 0);
    }

    /// Sheds register groups that do not fit. `upcoming` are the events behind those that have been
    /// applied, and all that there will be before `known_until`. Returns what is counted by then.
    #[inline(never)] // its tables must not weigh on ticks without a budget
    pub(super) fn keep_budget(
        &mut self,
        upcoming: &[Event],
        known_until: u64,
        direct: Option<Direct<'_>>,
        log: &mut impl FnMut(&Event),
    ) -> Counted {
        let Some(budget) = self.budget.filter(|_| self.skipping == Skipping::On) else { return Counted::Nothing };
        let margin = margin_of(budget, self.report.counts.is_idle);
        let mut of_next_run = Counts::NONE;
        let mut rest = self.rest_of_tick(upcoming, direct, &mut of_next_run);
        // One choke is paid from the time between the budget and the tick's end, and sheds nothing.
        let Counts { chokes, choked_modes, .. } = self.report.counts;
        let choke = choked_modes.min(FREE_CHOKED_MODES) * CostItem::ChokedMode.cycles();
        let choke = choke + chokes.min(1) * CostItem::Choke.cycles();
        let budget = budget.saturating_sub(margin) + choke;
        let mut predicted = self.report.predicted_cycles() + rest.cycles();
        let end = self.now + u64::from(self.frames_to_tick());
        let is_last = || next_news(upcoming).is_none_or(|event| event.time.first_frame() >= end);
        let is_counted = end <= known_until && (predicted <= budget || is_last());
        if !is_counted {
            // The next event will call for another prediction. The run before it is looked at once,
            // here or behind a choice.
            predicted += predictions_ahead(&rest);
            self.report.counts.add(CostItem::Look, rest.looks - u32::from(!is_last()) + LOOKS_OF_A_PREDICTION);
        }
        // Each strike reaches all groups of its pad again. So the choice waits for it, if shedding
        // from then on suffices: a choice of now would be made twice. With several strikes to come
        // each of them would have to choose.
        let is_above = predicted > budget;
        let sounding = if is_above { self.sounding(upcoming, direct) } else { Sounding::NOTHING };
        let waits = is_above && rest.looks == 2 && !is_last() && {
            let later = rest.sheddable_cycles() - of_next_run.sheddable_cycles();
            predicted + sounding.rough_cycles() <= budget + margin / 2 + later
        };
        let excess = Excess { predicted, budget, margin, sounding };
        if is_above
            && !waits
            && let Some(chosen) = self.shed_excess(&excess, &mut rest, direct)
        {
            log(&Event { time: Time::at_frame(self.now), action: Action::Shed(chosen), ..Event::NOTHING });
        }
        if is_counted {
            self.report.counts += &rest;
            Counted::Tick
        } else if !is_last() && (!is_above || waits) {
            self.report.counts += &of_next_run;
            Counted::Run
        } else {
            Counted::Nothing
        }
    }

    /// Pads that sound until the tick's end. A hand wakes pads that stay silent: those cost a
    /// choice next to nothing.
    #[inline(never)] // rare
    pub(super) fn sounding(&self, upcoming: &[Event], direct: Option<Direct<'_>>) -> Sounding {
        let frames = self.frames_to_tick();
        let end = self.now + u64::from(frames);
        let known = || upcoming.iter().take_while(|event| event.time.first_frame() < end);
        let mut sounding = Sounding::NOTHING;
        for number in self.awake.pads() {
            let Some(voice) = self.voices.get(usize::from(number)) else { break };
            let is_struck = || known().any(|event| event.pad == number && event.action == Action::Strike);
            let is_driven = || self.contacts.is_any_on(number) || direct.is_some_and(|direct| direct.pad == number);
            if !voice.is_ringing() && !is_driven() && !is_struck() {
                continue;
            }
            sounding.pads += 1;
            sounding.groups += voice.group_count() as u32;
            let Some(object) = voice.banks().first() else { continue };
            let cycles = object.cycles(Use::Driven, frames) / object.running_groups(Use::Driven).max(1);
            sounding.first_groups_cycles += cycles * self.loop_percent / 100 + CostItem::GuardedGroup.cycles();
        }
        sounding
    }

    /// Sheds what a prediction exceeds the budget by, and takes it out of the counts of the `rest`.
    /// Gives the decision, `None` if it would take longer than what it frees.
    #[inline(never)] // rare, and its tables must not lie on the stack beside those of the prediction
    fn shed_excess(&mut self, excess: &Excess, rest: &mut Counts, direct: Option<Direct<'_>>) -> Option<Shedding> {
        let Excess { predicted, budget, sounding, .. } = *excess;
        let first = sounding.first_groups_cycles;
        let (survey_cycles, choice_cycles) = (excess.survey_cycles(), excess.choice_cycles());
        let sheddable = rest.sheddable_cycles().min(predicted);
        let rough_cycles = sounding.rough_cycles();
        let room = excess.room(sheddable);
        // A decision that takes longer than what it frees would lengthen the tick: a strike late in
        // a tick keeps its modes, and the next tick sheds.
        let amount = if !excess.is_worth_a_survey(sheddable) && room >= rough_cycles {
            (sheddable > rough_cycles).then_some(ShedAmount::AllButFirst)
        } else if room >= choice_cycles + first / sounding.pads.max(1) {
            // One group stays in any case.
            let excess = predicted + survey_cycles - budget;
            let groups = sounding.groups * excess.min(sheddable) / sheddable.max(1);
            // Groups free what they take, of which the prediction has a part.
            let cycles = (excess + groups * CostItem::ShedGroup.cycles()) * 100 / self.loop_percent.max(1);
            (sheddable > choice_cycles).then_some(ShedAmount::Cycles(cycles))
        } else {
            (sheddable + rest.force_cycles > choice_cycles).then_some(ShedAmount::All)
        };
        let amount = amount?;
        let shed = self.shed(amount, direct);
        // Pads without any group left cost less still; only the groups' own share is certain.
        let kernels = match amount {
            ShedAmount::All => u32::MAX,
            ShedAmount::AllButFirst => rest.kernel_cycles.saturating_sub(first),
            _ => {
                let guards = shed.unguarded_groups * CostItem::GuardedGroup.cycles();
                shed.cycles.saturating_sub(guards) * self.loop_percent / 100
            }
        };
        rest.free(kernels, shed.unguarded_groups);
        self.report.counts.add_all([(CostItem::Survey, 1), (CostItem::ShedGroup, shed.groups)]);
        if let ShedAmount::Cycles(_) = amount {
            self.report.counts.add(CostItem::SurveyedGroup, sounding.groups);
        }
        Some(match amount {
            ShedAmount::AllButFirst => Shedding::AllButFirst,
            _ => Shedding::Quietest(shed.groups as u16),
        })
    }
}

/// Cycles of the predictions that a tick of several runs still makes: one of each run behind each
/// event.
fn predictions_ahead(rest: &Counts) -> u32 {
    let looks = rest.looks / 2 + LOOKS_OF_A_PREDICTION;
    (looks * CostItem::Look.cycles() + rest.pads * PREDICTED_PAD_CYCLES / 2) * rest.looks.saturating_sub(1)
}

/// Number of [`CostItem::Look`]s that a tick's second prediction takes beside its runs; a tick has
/// the first one.
const LOOKS_OF_A_PREDICTION: u32 = 2;

/// Share of [`CostItem::Pad`] that its prediction takes.
pub(super) const PREDICTED_PAD_CYCLES: u32 = 120;

/// Share of the budget that is kept free, as its inverse.
const MARGIN: u32 = 32;

/// Cycles kept free beyond [`MARGIN`], in a tick that begins idle and in another one. They cover
/// the waits of flash and the interrupts of the boards. The dearest half takes 79 % of the time to
/// its deadline on the F407 board and 87 % on the BlackPill
/// (`cargo test -p virtual-board --test boards load`).
const KEPT_FREE: [u32; 2] = [635, 1670];

/// Maximum number of modes a tick whose choke is paid from beyond the budget: those of one object's
/// bank and one striker's. A board's tick is at least twice as long as its budget.
const FREE_CHOKED_MODES: u32 = 32;
