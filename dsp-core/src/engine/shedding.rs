//! Shedding: the quietest register groups of all pads are left out until they are struck again.

use super::cost::CostItem;
use super::state::{Direct, Engine, Hearing, direct_input};
use crate::contact::ActiveContacts;
use crate::resonator::{Audience, Bank, Shed, ShedChoice, ShedPlan, UpcomingRun, Use};
use crate::room::Sample;

/// Amount of work to shed.
#[derive(Clone, Copy, Debug)]
pub(super) enum ShedAmount {
    /// All register groups.
    All,
    /// All register groups but the first of each pad's object.
    AllButFirst,
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
        let (choice, cycles) = match amount {
            ShedAmount::All | ShedAmount::AllButFirst => (ShedChoice::ALL, 0),
            ShedAmount::Groups(count) => (self.survey().quietest(count), 0),
            ShedAmount::Cycles(excess) => self.survey().quietest_that_free(excess),
        };
        let shed = Shed { cycles, ..self.shed_chosen(choice, matches!(amount, ShedAmount::AllButFirst)) };
        self.report.shed += shed;
        shed
    }

    /// Surveys all groups that would run.
    #[inline(never)] // two callers
    fn survey(&self) -> ShedPlan {
        let mut plan = ShedPlan::EMPTY;
        let frames = self.frames_to_tick() as u8;
        for index in self.awake.pads().map(usize::from) {
            let (Some(voice), Some(Some(hearing))) = (self.voices.get(index), self.hearings.get(index)) else {
                continue;
            };
            for (number, bank) in (0u8..).zip(voice.banks()).filter(|(_, bank)| bank.group_count() > 0) {
                let run = hearing.run_of(bank, number, voice.number, &self.contacts, frames);
                bank.plan_shedding(&hearing.audience, run, &mut plan);
            }
        }
        plan
    }

    /// Sheds the chosen register groups of all pads, of which the first of each object may stay.
    #[inline(never)]
    fn shed_chosen(&mut self, mut choice: ShedChoice, first_stays: bool) -> Shed {
        let mut shed = Shed::NOTHING;
        let takes_all = choice == ShedChoice::ALL && !first_stays;
        let frames = self.frames_to_tick() as u8;
        for index in self.awake.pads().map(usize::from) {
            let (Some(voice), Some(Some(hearing))) = (self.voices.get_mut(index), self.hearings.get(index)) else {
                continue;
            };
            voice.wake();
            let pad = voice.number;
            for (number, bank) in (0u8..).zip(&mut *voice.banks).filter(|(_, bank)| bank.group_count() > 0) {
                let mut run = hearing.run_of(bank, number, pad, &self.contacts, frames);
                if hearing.is_driven && takes_all {
                    // A pad without any group takes less time, so those at rest go too.
                    run.used = Use::Driven;
                }
                shed += bank.shed(&hearing.audience, run, &mut choice, first_stays && number == 0);
            }
        }
        shed
    }

    /// Notes for each pad that is awake how it is heard, `None` if it will not sound.
    #[inline(never)]
    fn listen(&mut self, direct: Option<Direct<'_>>) {
        for number in self.awake.pads() {
            let index = usize::from(number);
            let (Some(voice), Some(hearing)) = (self.voices.get(index), self.hearings.get_mut(index)) else { break };
            let (input, contact_samples) = self.contacts.ahead(number);
            let direct = direct_input(direct, number);
            let is_driven = input + direct > 0.0;
            *hearing = (is_driven || voice.is_ringing()).then(|| Hearing {
                audience: Audience::new(voice.unit(), input + direct, contact_samples),
                is_driven,
                is_direct: direct > 0.0,
                expects: voice.expects(),
            });
        }
    }
}

impl Hearing {
    /// Run of one of the pad's banks in the tick's rest.
    #[inline(always)]
    fn run_of(&self, bank: &Bank<'_>, number: u8, pad: u8, contacts: &ActiveContacts<'_>, frames: u8) -> UpcomingRun {
        // A force acts on the object, whose bank is 0, and on the striker that brings it.
        let is_by = |striker| contacts.is_any_by(pad, striker) || self.is_direct && striker == 0;
        let is_driven = self.is_driven && number.checked_sub(1).is_none_or(is_by);
        let guards = is_driven && self.expects && !bank.is_ringing();
        UpcomingRun {
            used: if is_driven { Use::Driven } else { Use::Free },
            frames,
            guard: if guards { CostItem::GuardedGroup.cycles() as u16 } else { 0 },
        }
    }
}
