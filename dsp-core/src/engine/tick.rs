//! What happens within a tick: its beginning, events, runs of frames, its end.

use super::budget::LeaveOut;
use super::cost::Part;
use super::filters::{Sources, render_filtered};
use super::{Direct, Engine, FilterRoom, RoomStage, Skipping, Surroundings};
use crate::contact::Contact;
use crate::event::{Action, Event};
use crate::pad::{Pad, PadTables, Run, is_ringing};
use crate::resonator::{Memory, TICK_FRAMES};

impl<
    'k,
    const PADS: usize,
    const BANKS: usize,
    const MODES: usize,
    const GROUPS: usize,
    const ORIGINS: usize,
    const CONTACTS: usize,
    S: Surroundings,
> Engine<'k, PADS, BANKS, MODES, GROUPS, ORIGINS, CONTACTS, S>
{
    pub(super) fn begin_tick(&mut self, direct: Option<Direct<'_>>) {
        let hands = if core::mem::take(&mut self.hands_changed) { self.lay_hands() } else { [(Part::Hand, 0); 3] };
        if self.idle && self.was_idle {
            self.report.begin_idle(self.now);
        } else {
            self.report.begin(self.now);
        }
        self.was_idle = self.idle;
        if self.budget.is_some() {
            let counts = self.beginning();
            self.report.counts.add_all(counts);
            self.report.counts.add_all(hands);
        }
        if self.idle {
            return;
        }
        // A direct force has no strike that would be a new chance: each tick is.
        if let Some(direct) = direct {
            self.admit(direct.pad);
        }
        let skip = self.skipping == Skipping::On;
        let mut retired = None;
        for index in 0..self.pad_count {
            if self.pads.get_mut(index).is_none_or(Pad::pass_tick) {
                continue;
            }
            let all = retired.unwrap_or_else(|| self.pads().iter().fold(0.0, |sum, pad| sum + pad.retired_amplitude()));
            let mut memory = Memory { modes: &mut self.modes, groups: &mut self.groups, origins: &mut self.origins };
            let Some(pad) = self.pads.get_mut(index) else { break };
            let banks = pad.own_mut(&mut self.banks);
            let elsewhere = all - pad.retired_amplitude();
            let elsewhere = if elsewhere > 0.0 { elsewhere } else { 0.0 };
            self.report.retired_modes += pad.tick(&mut memory, banks, skip, elsewhere);
            retired = Some(elsewhere + pad.retired_amplitude());
        }
        self.retired_amplitude = retired.unwrap_or(self.retired_amplitude);
        self.report.retired_amplitude = self.retired_amplitude;
    }

    pub(super) fn apply(&mut self, event: &Event, direct: Option<Direct<'_>>) {
        if self.budget.is_some() {
            let counts = self.event_counts(event);
            self.report.counts.add_all(counts);
        }
        if let Action::Shed(count) = event.action {
            self.leave_out(LeaveOut::Groups(count), direct);
            return;
        }
        if event.is_of_hand() {
            let Some(pad) = self.pads.get_mut(usize::from(event.pad)) else { return };
            pad.want_hand(event.action == Action::Choke);
            self.hands_changed = true;
            return;
        }
        (self.idle, self.was_idle) = (false, false);
        self.admit(event.pad);
        let rate = self.rate();
        let Some(pad) = self.pads.get_mut(usize::from(event.pad)) else { return };
        let banks = pad.own_mut(&mut self.banks);
        let Some(impact) = pad.strike(event.velocity, event.striker, rate, banks) else { return };
        let place = pad.place(event.position, banks, |slot| self.flight.is_any_in(event.pad, slot));
        if self.noisy || self.filtered.may_have(event.pad) {
            self.strike_stages(event.pad, impact.peak);
        }
        self.expects = true;
        let contact = Contact::new(event.pad, event.striker, impact, event.time.early()).in_slot(place.slot);
        self.report.strikes += 1;
        self.report.displaced_contacts += u32::from(self.flight.begin(contact));
        self.report.merged_positions += u32::from(place.is_merged);
        if place.moves {
            self.set_position(event, place.slot);
        }
    }

    /// Hands that have come or gone since the last tick take effect: pads reach their first modes in the bookkeeping that
    /// follows. Gives what it costs.
    #[inline(never)] // rare
    fn lay_hands(&mut self) -> [(Part, u32); 3] {
        let (mut hands, mut guards, mut filter_cycles) = (0, 0, 0);
        for number in 0..self.pad_count as u8 {
            let Some(pad) = self.pads.get_mut(usize::from(number)).filter(|pad| pad.wants_change()) else { continue };
            let banks = pad.own_mut(&mut self.banks);
            let mut memory = Memory { modes: &mut self.modes, groups: &mut self.groups, origins: &mut self.origins };
            guards += pad.lay_hand(&mut memory, banks);
            hands += 1;
            let lies = pad.is_choked();
            (self.idle, self.was_idle) = (false, false);
            if self.noisy || self.filtered.may_have(number) {
                filter_cycles += self.filter_hand_cycles(number);
                self.lay_hand_on_stages(number, lies);
            }
        }
        [(Part::Hand, hands), (Part::DueGroup, guards), (Part::ResidualCycle, filter_cycles)]
    }

    #[inline(never)] // kits without have nothing of it
    fn lay_hand_on_stages(&mut self, number: u8, lies: bool) {
        let pad = self.kit.and_then(|kit| kit.pads().nth(usize::from(number)));
        let t60_s = pad.map_or(0.0, |pad| pad.choke_t60_s());
        let lies = lies && t60_s > 0.0;
        self.choke_noise(number, lies);
        self.choke_filters(number, lies.then_some(t60_s));
    }

    /// A strike at another position moves a slot of the object.
    #[inline(never)] // to look up the tables takes longer than a strike, and room on the stack
    fn set_position(&mut self, event: &Event, slot: u8) {
        let rate = self.rate();
        let Some(kit) = self.kit else { return };
        let Some(tables) = PadTables::new(kit, usize::from(event.pad)) else { return };
        let Some(pad) = self.pads.get_mut(usize::from(event.pad)) else { return };
        let banks = pad.own_mut(&mut self.banks);
        let mut memory = Memory { modes: &mut self.modes, groups: &mut self.groups, origins: &mut self.origins };
        Pad::set_position(slot, event.position, &tables, rate, &mut memory, banks);
    }

    /// Lets input reach again what was left out of a pad.
    fn admit(&mut self, pad: u8) {
        let Some(pad) = self.pads.get_mut(usize::from(pad)) else { return };
        let banks = pad.own_mut(&mut self.banks);
        pad.wake(banks);
        let mut memory = Memory { modes: &mut self.modes, groups: &mut self.groups, origins: &mut self.origins };
        banks.iter_mut().for_each(|bank| bank.admit(&mut memory));
    }

    pub(super) fn meet_expected(&mut self) {
        let mut memory = Memory { modes: &mut self.modes, groups: &mut self.groups, origins: &mut self.origins };
        for pad in self.pads.iter_mut().take(self.pad_count) {
            pad.meet_expected(&mut memory, pad.own_mut(&mut self.banks));
        }
    }

    pub(super) fn render_run(&mut self, direct: Option<Direct<'_>>, out: &mut [[i32; 2]]) {
        let mut memory = Memory { modes: &mut self.modes, groups: &mut self.groups, origins: &mut self.origins };
        (self.idle, self.was_idle) = (false, false);
        let (skip, odd_start) = (self.skipping == Skipping::On, self.now % 2 == 1);
        let contacts = self.flight.count() > 0;
        self.report.contact_frames += (self.flight.count() * out.len()) as u32;
        for (pad, number) in self.pads.iter_mut().take(self.pad_count).zip(0u8..) {
            let banks = pad.own_mut(&mut self.banks);
            // A force of exact zeros is no force: a quiet sensor costs nothing.
            let direct = direct
                .filter(|direct| direct.pad == number && !(skip && direct.force.iter().all(|&x| x == 0)))
                .map(|direct| direct.force);
            let has_force = direct.is_some() || (contacts && self.flight.count_on(number) > 0);
            if self.filtered.may_have(number) && self.filters.join_in(number, has_force, banks) {
                let run = Run { frames: out.len(), odd_start, skip, direct };
                let sources = Sources { has_force, flight: &mut self.flight, memory: &mut memory, banks };
                let place = (number, (self.now % TICK_FRAMES as u64) as usize);
                render_filtered(pad, place, run, sources, &mut self.filters, &mut self.report, out);
                continue;
            }
            if has_force && skip && !pad.responds(banks, memory.groups) {
                // Nobody would hear the force.
                self.flight.pass(number, out.len());
                self.report.add_ringing(pad, (0, 0), out.len());
                continue;
            }
            if has_force || !skip {
                let run = Run { frames: out.len(), odd_start, skip, direct };
                let work = pad.drive(number, run, &mut self.flight, &mut memory, banks, out);
                self.report.add(pad, &work, out.len());
            } else {
                let ringing = is_ringing(banks);
                let ran = if ringing { pad.ring(out.len(), odd_start, &mut memory, banks, out) } else { (0, 0) };
                self.report.add_ringing(pad, ran, out.len());
            }
        }
        if contacts {
            self.flight.clear_finished();
        }
        self.render_noise(out);
        self.render_room(out);
    }

    pub(super) fn end_tick(&mut self) {
        if self.idle {
            return;
        }
        self.end_noise_tick();
        self.report.filters = if self.filtered.is_empty() { 0 } else { self.filters.ringing() };
        self.report.contacts = self.flight.count() as u32;
        self.report.ringing_pads = self.pads().iter().filter(|pad| is_ringing(pad.own(&self.banks))).count() as u32;
        self.idle = self.skipping == Skipping::On
            && self.report.contacts == 0
            && self.report.ringing_pads == 0
            && self.report.residuals == 0
            && self.report.filters == 0
            && self.room.is_silent()
            && self
                .pads()
                .iter()
                .all(|pad| pad.retired_amplitude() == 0.0 && !Pad::is_being_reached(pad.own(&self.banks)));
        if self.idle {
            let unstruck = self.pads().iter().filter(|pad| !pad.was_struck());
            self.unstruck_modes = unstruck.map(|pad| pad.mode_count() as u32).sum();
        }
    }
}
