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
use super::state::{Direct, Engine};
use crate::event::{Action, Event, Time};
use crate::room::Sample;

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
        let margin = budget / MARGIN + if self.report.counts.is_idle { idle } else { busy };
        let mut rest = self.rest_of_tick(upcoming, direct);
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
            // The next event will call for another prediction.
            predicted += predictions_ahead(&rest);
            self.report.counts.add(CostItem::Look, rest.looks);
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
        let survey_cycles = survey.cycles();
        let guards = rest.guarded_groups * CostItem::GuardedGroup.cycles();
        let sheddable = (rest.kernel_cycles + guards).min(predicted);
        let least = predicted + survey_cycles - sheddable;
        // If no group can be kept, there is nothing to choose. A choice may take some of what is
        // kept free: without it the strike would be silent.
        let sheds_all = least > budget + margin / 2;
        // A choice that takes longer than what it frees would lengthen the tick: a strike late in a
        // tick keeps its modes, and the next tick sheds.
        if sheddable + if sheds_all { rest.force_cycles } else { 0 } <= survey_cycles {
            return None;
        }
        let amount = if sheds_all {
            self.report.counts.add_all([(CostItem::Survey, 1), (CostItem::SurveyedGroup, self.awake_groups() / 3)]);
            ShedAmount::All
        } else {
            self.report.counts += &survey;
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
        rest.free(kernels, shed.unguarded_groups);
        Some(shed.groups as u16)
    }
}

/// Cycles of the predictions that a tick of several runs still makes: about as many of the runs
/// behind each event as there are runs, and one of each run as it ends.
fn predictions_ahead(rest: &Counts) -> u32 {
    (rest.looks * CostItem::Look.cycles() + rest.pads * PREDICTED_PAD_CYCLES) * rest.looks.saturating_sub(1)
}

/// Share of [`CostItem::Pad`] that its prediction takes.
const PREDICTED_PAD_CYCLES: u32 = 120;

/// Share of the budget that is kept free, as its inverse.
const MARGIN: u32 = 32;

/// Cycles kept free beyond [`MARGIN`], in a tick that begins idle and in another one. They cover
/// the waits of flash and the interrupts of the boards. The dearest half takes 80 % of the time to
/// its deadline on the F407 board and 86 % on the BlackPill
/// (`cargo test -p virtual-board --test boards load`).
const KEPT_FREE: [u32; 2] = [635, 1670];

/// Maximum number of modes a tick whose choke is paid from beyond the budget: those of one object's
/// bank and one striker's. A board's tick is at least twice as long as its budget.
const FREE_CHOKED_MODES: u32 = 32;
