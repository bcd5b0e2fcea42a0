//! Shedding: the quietest register groups of all pads are left out until they are struck again.

use super::cost::CostItem;
use super::state::{Direct, Engine, direct_input};
use crate::resonator::{Audience, Shed, ShedChoice, ShedPlan, UpcomingRun, Use};
use crate::room::Sample;

/// Amount of work to shed.
#[derive(Clone, Copy, Debug)]
pub(super) enum ShedAmount {
    /// All register groups.
    All,
    /// A number of register groups, the quietest.
    Groups(u16),
    /// The quietest register groups, as many as free a number of cycles.
    Cycles(u32),
}

impl<S: Sample> Engine<'_, '_, S> {
    /// Sheds the quietest of the register groups that would run.
    #[inline(never)] // its tables must not lie on the stack beside those of the prediction
    pub(super) fn shed(&mut self, amount: ShedAmount, direct: Option<Direct<'_>>) -> Shed {
        self.listen(direct);
        let shed = match amount {
            ShedAmount::All => self.shed_chosen(ShedChoice::ALL),
            _ => self.shed_quietest(amount),
        };
        self.report.shed += shed;
        shed
    }

    /// Surveys all groups and sheds the quietest; [`ShedAmount::All`] needs no survey.
    #[inline(never)]
    fn shed_quietest(&mut self, amount: ShedAmount) -> Shed {
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
        let count = match amount {
            ShedAmount::All => u16::MAX,
            ShedAmount::Groups(count) => count,
            ShedAmount::Cycles(excess) => plan.quietest_that_free(excess),
        };
        let (choice, cycles_below) = plan.quietest(count);
        let mut shed = self.shed_chosen(choice);
        shed.cycles += cycles_below;
        self.levels = plan.into_levels();
        shed
    }

    /// Sheds the chosen register groups of all pads.
    #[inline(never)] // one copy for both callers
    fn shed_chosen(&mut self, mut choice: ShedChoice<'_>) -> Shed {
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

    /// Notes for each pad that sounds how it is heard and how it will run.
    #[inline(never)]
    fn listen(&mut self, direct: Option<Direct<'_>>) {
        let frames = self.frames_to_tick() as u8;
        self.listening.fill(None);
        for number in self.awake.pads() {
            let index = usize::from(number);
            let (Some(voice), Some(listening)) = (self.voices.get(index), self.listening.get_mut(index)) else { break };
            let (input, contact_samples) = self.contacts.ahead(number);
            let input = input + direct_input(direct, number);
            let used = if input > 0.0 { Use::Driven } else { Use::Free };
            *listening = (used == Use::Driven || voice.is_ringing()).then(|| {
                let guard = if voice.expects() { CostItem::GuardedGroup.cycles() as u16 } else { 0 };
                let audience = Audience::new(voice.unit(), input, contact_samples);
                (audience, UpcomingRun { used, frames, guard })
            });
        }
    }
}
