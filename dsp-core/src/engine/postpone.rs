//! Strikes for whose tick there is no time: they wait for the next one.

use super::budget::{Excess, PREDICTED_PAD_CYCLES, margin_of};
use super::cost::{CostItem, Counts};
use super::setup::Skipping;
use super::state::{Direct, Engine};
use crate::event::{Action, Event, Time};
use crate::room::Sample;
use crate::time::TICK_FRAMES;

/// Most ticks one behind the other in which all strikes wait.
const MOST_TICKS: u32 = 4;
/// Most strikes of a tick, and most contacts under way, beside which a strike waits.
const MOST_STRIKES: usize = 2;
/// Cycles of a strike and of its pad under the force for a tick, without its modes.
const STRIKE_CYCLES: u32 = 10_000;
/// Cycles by which a prediction is too low for each strike to come: its force may send its pad by
/// way of the pad's own bus.
const BUS_CYCLES: u32 = CostItem::BusDrivenPad.const_cycles() - CostItem::DrivenPad.const_cycles()
    + (CostItem::BusFrame.const_cycles() - CostItem::OnsetFrame.const_cycles()) * TICK_FRAMES as u32;

impl<S: Sample> Engine<'_, '_, S> {
    /// Lets strikes wait for the tick behind the coming one, if the budget would leave a pad
    /// without any mode in the coming one. Gives their number.
    ///
    /// A tick that is cut at strikes takes longer than one that begins with them. So all strikes
    /// within the tick wait for the next one's first frame. If all are at the tick's first frame,
    /// the last one waits. A lone strike waits only while contacts are under way. A strike waits up
    /// to a tick, 0.67 ms at 48 kHz, and at a tick's first frame for at most four more. Three
    /// strikes or more in a tick do not wait, nor does any beside three contacts: a chord of ten
    /// would be drawn apart.
    ///
    /// `events` are those of the coming tick, in order of time, and maybe later ones. Those that
    /// wait get the time at which they then happen, and so do the tick's other events behind them:
    /// the order stays. The caller passes them with the next tick. A list of all events with these
    /// times plays to the same bits without any budget. `direct` is the force that will act on a
    /// pad.
    ///
    /// Nothing waits without a [budget](Self::set_budget), or within a tick.
    ///
    /// Cost: a prediction if the tick before and the strikes might exceed the budget, 425 nominal
    /// cycles for each run and 120 for each pad in it; the tick counts them.
    #[inline(never)] // runs at strikes alone
    pub fn postpone(&mut self, events: &mut [Event], direct: Option<Direct<'_>>) -> u32 {
        let Some(budget) = self.budget.filter(|_| self.skipping == Skipping::On) else { return 0 };
        let end = self.now + TICK_FRAMES as u64;
        let is_strike = |event: &&Event| event.action == Action::Strike;
        let is_coming = |event: &&Event| event.time.first_frame() < end;
        // Of a chord no more are looked at than need be.
        let count = events.iter().filter(is_strike).take(MOST_STRIKES + 1).take_while(is_coming).count();
        let waited = core::mem::take(&mut self.ticks_without_strike);
        let contacts = self.contacts.count();
        let are_many = count > MOST_STRIKES || contacts > MOST_STRIKES;
        if count == 0 || are_many || !self.now.is_multiple_of(TICK_FRAMES as u64) {
            return 0;
        }
        let due = events.iter().take_while(is_coming).count();
        let coming = events.get(..due).unwrap_or(&[]);
        let at_begin =
            coming.iter().filter(is_strike).take_while(|strike| strike.time.first_frame() <= self.now).count();
        // A lone strike waits for the end of the contacts under way, if for anything.
        let is_lone = count == 1 && contacts == 0;
        let is_due = waited >= MOST_TICKS && at_begin < 2;
        let before = self.report.predicted_cycles();
        if is_lone || is_due || before + count as u32 * STRIKE_CYCLES <= budget / 2 {
            return 0;
        }
        let is_cut = at_begin < count;
        let lacking = self.lacking_cycles(budget, coming, direct, is_cut);
        if lacking == 0 {
            return 0;
        }
        let stay = if is_cut { at_begin } else { count - 1 };
        let first = coming.iter().enumerate().filter(|(_, event)| is_strike(event)).nth(stay);
        let first = first.map_or(due, |(index, _)| index);
        events.iter_mut().take(due).skip(first).for_each(|event| event.time = Time::at_frame(end));
        if stay == 0 {
            self.ticks_without_strike = waited + 1;
        }
        (count - stay) as u32
    }

    /// Cycles that a tick with these events lacks for the first group of each pad that sounds in
    /// it; 0 if one pad alone sounds.
    #[inline(never)] // its tables must not weigh on ticks without strikes
    fn lacking_cycles(&mut self, budget: u32, events: &[Event], direct: Option<Direct<'_>>, is_cut: bool) -> u32 {
        let mut of_next_run = Counts::NONE;
        let rest = self.rest_of_tick(events, direct, &mut of_next_run);
        self.cycles_ahead = (rest.looks + 1) * CostItem::Look.cycles() + rest.pads * PREDICTED_PAD_CYCLES;
        let mut beginning = Counts::NONE;
        if self.idle {
            beginning.add(CostItem::IdleTick, 1);
        } else {
            self.add_beginning(&mut beginning);
        }
        let strikes = events.iter().filter(|event| event.action == Action::Strike).count() as u32;
        let predicted = beginning.cycles() + rest.cycles() + self.cycles_ahead + strikes * BUS_CYCLES;
        let margin = margin_of(budget, self.idle);
        let budget = budget.saturating_sub(margin);
        if predicted <= budget {
            return 0;
        }
        let sounding = self.sounding(events, direct);
        let excess = Excess { predicted, budget, margin, sounding };
        if excess.sounding.pads <= 1 { 0 } else { excess.lacking_cycles(rest.sheddable_cycles(), is_cut) }
    }
}
