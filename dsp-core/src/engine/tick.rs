//! Work within a tick: its beginning, its events, its runs of frames, its end.

use super::cost::{CostItem, Counts};
use super::report::TickReport;
use super::setup::Skipping;
use super::shedding::ShedAmount;
use super::state::{Direct, Engine};
use crate::contact::{ActiveContacts, Contact};
use crate::event::{Action, Event, Shedding};
use crate::frames::{BLOCK_FRAMES, InFrames};
use crate::room::Sample;
use crate::time::TICK_FRAMES;
use crate::voice::{PadTables, Run, Voice};

impl<S: Sample> Engine<'_, '_, S> {
    /// Begins a tick: chokes and releases take effect, and voices do their bookkeeping.
    pub(super) fn begin_tick(&mut self, direct: Option<Direct<'_>>) {
        let chokes =
            if core::mem::take(&mut self.chokes_changed) { self.change_chokes(direct.is_some()) } else { Counts::NONE };
        let is_scraped = self.scrapes.are_due();
        if self.fader.is_over() || is_scraped {
            // The strikes that have waited make the tick one with sound, if any have.
            (self.idle, self.was_idle) = (false, false);
        }
        if self.idle && self.was_idle {
            self.report.begin_idle(self.now);
        } else {
            self.report.begin(self.now);
        }
        self.was_idle = self.idle;
        if self.fader.is_over() {
            let counts = self.end_silencing(direct);
            self.report.counts.add_all(counts);
        }
        if is_scraped {
            self.scrape();
        }
        if self.frames.is_some() {
            self.begin_frames_tick();
        }
        if self.budget.is_some() && self.idle {
            self.report.counts.add(CostItem::IdleTick, 1);
        } else if self.budget.is_some() {
            let mut counts = chokes;
            self.add_beginning(&mut counts);
            self.report.counts += &counts;
        }
        let ahead = core::mem::take(&mut self.cycles_ahead);
        if ahead > 0 {
            self.report.counts.add(CostItem::ResidualCycle, ahead);
        }
        if self.idle {
            return;
        }
        // A direct force brings no strike that would admit its pad: each tick does.
        if let Some(direct) = direct {
            self.admit(direct.pad);
        }
        let skip = self.skipping == Skipping::On;
        let mut retired = None;
        for number in self.awake.pads() {
            let index = usize::from(number);
            if self.voices.get_mut(index).is_none_or(Voice::pass_tick) {
                continue;
            }
            // Nothing is left out of a pad that sleeps.
            let of_pad = |pad: u8| self.voices.get(usize::from(pad)).map_or(0.0, Voice::retired_amplitude);
            let all = retired.unwrap_or_else(|| self.awake.pads().fold(0.0, |sum, pad| sum + of_pad(pad)));
            let Some(voice) = self.voices.get_mut(index) else { break };
            let elsewhere = all - voice.retired_amplitude();
            let elsewhere = if elsewhere > 0.0 { elsewhere } else { 0.0 };
            self.report.retired_modes += voice.tick(skip, elsewhere + self.retired_in_frames);
            retired = Some(elsewhere + voice.retired_amplitude());
        }
        self.retired_amplitude = retired.unwrap_or(self.retired_amplitude);
        self.report.retired_amplitude = self.retired_amplitude + self.retired_in_frames;
    }

    /// Applies an event.
    pub(super) fn apply(&mut self, event: &Event, direct: Option<Direct<'_>>) {
        if let Action::Shed(shedding) = event.action {
            let amount = match shedding {
                Shedding::Quietest(count) => ShedAmount::Groups(count),
                Shedding::AllButFirst => ShedAmount::AllButFirst,
            };
            self.shed(amount, direct);
            return;
        }
        if event.is_choke_or_release() {
            let Some(voice) = self.voices.get_mut(usize::from(event.pad)) else { return };
            voice.want_choke(event.action == Action::Choke);
            self.chokes_changed = true;
            return;
        }
        if event.is_motion() {
            return self.scrapes.note(event);
        }
        match event.action {
            Action::Level => return self.fader.set_level(event.velocity, !self.idle, self.rate),
            // What is silent already has nothing to end.
            Action::Silence if self.idle => return,
            Action::Silence => return self.fader.end(self.rate),
            _ if self.fader.is_ending() => return self.held.push(event),
            _ => {}
        }
        (self.idle, self.was_idle) = (false, false);
        self.admit(event.pad);
        if self.chokes_changed {
            self.change_late_choke(event.pad);
        }
        let rate = self.rate;
        let Some(voice) = self.voices.get_mut(usize::from(event.pad)) else { return };
        let Some(impact) = voice.strike(event.velocity, event.striker, rate) else { return };
        let place = voice.place(event.position, |slot| {
            self.contacts.is_any_in(event.pad, slot) || self.scrapes.hold(event.pad, slot)
        });
        if voice.residual.is_some() || voice.filters.is_some() {
            self.strike_stages(event.pad, impact.peak);
        }
        self.expects = true;
        let contact = Contact::new(event.pad, event.striker, impact, event.time.early()).in_slot(place.slot);
        self.report.strikes += 1;
        self.report.displaced_contacts += u32::from(self.contacts.begin(contact));
        self.report.merged_positions += u32::from(place.is_merged);
        if place.moves {
            self.set_position(event.pad, place.slot, event.position);
        }
    }

    /// Carries out the chokes and releases that are due; gives their cost. Pads reach their first
    /// modes in the bookkeeping that follows. Of pads that are silent one is changed a tick: all at
    /// once, they would take the time of the pads that sound. None waits for a direct force, for a
    /// scrape, or for a strike on its pad.
    #[inline(never)] // rare
    fn change_chokes(&mut self, has_direct: bool) -> Counts {
        let mut counts = Counts::NONE;
        let may_wait = !has_direct && !self.scrapes.are_due();
        let mut has_changed_silent = false;
        for number in 0..self.voices.len() as u8 {
            let Some(voice) = self.voices.get_mut(usize::from(number)).filter(|voice| voice.is_choke_due()) else {
                continue;
            };
            let is_silent = voice.can_choke_later() && !self.contacts.is_any_on(number);
            if may_wait && is_silent && core::mem::replace(&mut has_changed_silent, true) {
                voice.choke_later();
                self.chokes_changed = true;
            } else {
                self.change_choke(number, &mut counts);
            }
        }
        counts
    }

    /// Carries out a pad's choke or release if it is late; predictions count it with the strike.
    #[inline(never)] // rare
    fn change_late_choke(&mut self, number: u8) {
        if self.voices.get(usize::from(number)).is_some_and(Voice::is_choke_late) {
            let mut counts = Counts::NONE;
            self.change_choke(number, &mut counts);
        }
    }

    /// Carries out a pad's choke or release; counts its cost.
    #[inline(never)] // rare
    fn change_choke(&mut self, number: u8, counts: &mut Counts) {
        self.wake(number);
        let Some(voice) = self.voices.get_mut(usize::from(number)) else { return };
        let late_modes = voice.late_choke_modes();
        let guards = voice.change_choke();
        let is_choked = voice.is_choked();
        let has_stages = voice.residual.is_some() || voice.filters.is_some();
        (self.idle, self.was_idle) = (false, false);
        if has_stages {
            counts.add(CostItem::ResidualCycle, self.filter_choke_cycles(number));
            self.choke_stages(number, is_choked);
        }
        counts.add_all([(CostItem::Choke, 1), (CostItem::ChokedMode, late_modes), (CostItem::DueGroup, guards)]);
    }

    /// Moves a slot of a pad's object to a position.
    #[inline(never)] // looking up the tables takes longer than a strike, and more of the stack
    pub(super) fn set_position(&mut self, pad: u8, slot: u8, position: f32) {
        let Some(tables) = PadTables::new(self.kit, usize::from(pad)) else { return };
        let Some(voice) = self.voices.get_mut(usize::from(pad)) else { return };
        voice.set_position(slot, position, &tables, self.rate);
    }

    /// Wakes a pad that something is about to happen to.
    pub(super) fn wake(&mut self, pad: u8) {
        let Some(voice) = self.voices.get(usize::from(pad)) else { return };
        if self.awake.wake(pad) {
            self.asleep_modes -= voice.mode_count() as u32;
            self.asleep_unstruck_modes -= if voice.was_struck() { 0 } else { voice.mode_count() as u32 };
        }
    }

    /// Lays pads to sleep that have nothing to do; gives the number of pads that ring.
    pub(super) fn lay_to_sleep(&mut self) -> u32 {
        let (mut ringing, is_skipping) = (0, self.skipping == Skipping::On);
        self.awake.retain(|pad| {
            let Some(voice) = self.voices.get(usize::from(pad)) else { return true };
            if voice.is_ringing() {
                ringing += 1;
                return true;
            }
            let sleeps = is_skipping && voice.can_sleep() && !self.contacts.is_any_on(pad);
            if sleeps {
                self.asleep_modes += voice.mode_count() as u32;
                self.asleep_unstruck_modes += if voice.was_struck() { 0 } else { voice.mode_count() as u32 };
            }
            !sleeps
        });
        ringing
    }

    /// Lets forces reach the shed groups of a pad again, and wakes it.
    pub(super) fn admit(&mut self, pad: u8) {
        self.wake(pad);
        if let Some(voice) = self.voices.get_mut(usize::from(pad)) {
            voice.admit();
        }
    }

    /// Guards all voices for the contacts that have just begun.
    pub(super) fn meet_expected(&mut self) {
        for pad in self.awake.pads() {
            self.voices.get_mut(usize::from(pad)).into_iter().for_each(Voice::meet_expected);
        }
    }

    /// Renders a run of frames and adds it to the stereo bus.
    pub(super) fn render_run(&mut self, direct: Option<Direct<'_>>, out: &mut [[i32; 2]]) {
        (self.idle, self.was_idle) = (false, false);
        let (skip, odd_start) = (self.skipping == Skipping::On, self.now % 2 == 1);
        let has_contacts = self.contacts.is_any();
        self.report.contact_frames += (self.contacts.count() * out.len()) as u32;
        self.report.pass_asleep(self.asleep_unstruck_modes, self.asleep_modes, out.len());
        for number in self.awake.pads() {
            let Some(voice) = self.voices.get_mut(usize::from(number)) else { break };
            // A force of exact zeros is no force: a quiet sensor costs nothing.
            let direct = direct
                .filter(|direct| direct.pad == number && !(skip && direct.force.iter().all(|&x| x == 0)))
                .map(|direct| direct.force);
            let has_force = direct.is_some() || (has_contacts && self.contacts.is_any_on(number));
            let run = Run { frames: out.len(), odd_start, skip, has_force, direct };
            if !voice.is_plain && render_joined(voice, self.now, run, &mut self.contacts, &mut self.report, out) {
                continue;
            }
            if has_force && skip && !voice.responds() {
                // Nothing would answer the force.
                self.contacts.pass(number, out.len());
                self.report.add_ringing(voice, (0, 0), out.len());
                continue;
            }
            if has_force || !skip {
                let work = voice.drive(run, &mut self.contacts, out);
                self.report.add(voice, &work, out.len());
            } else {
                let ran = if voice.is_ringing() { voice.ring(out.len(), odd_start, out) } else { (0, 0) };
                self.report.add_ringing(voice, ran, out.len());
            }
        }
        if has_contacts {
            self.contacts.clear_finished();
        }
        self.render_bus_stages(out);
    }

    /// Ends a tick: works on noise to come, completes the report, and looks whether all is silent.
    pub(super) fn end_tick(&mut self) {
        if self.idle {
            return;
        }
        self.end_noise_tick();
        self.report.filters = self.active_filters();
        self.report.contacts = self.contacts.count() as u32;
        self.report.ringing_pads = self.lay_to_sleep();
        if self.frames.is_some() {
            self.end_frames_tick();
        }
        self.idle = self.skipping == Skipping::On
            && self.report.contacts == 0
            && self.report.ringing_pads == 0
            && self.report.residuals == 0
            && self.report.filters == 0
            && self.bus_stages_are_silent()
            && self.held.is_empty()
            && !self.scrapes.are_due()
            && self.retired_in_frames == 0.0
            && self.voices.iter().all(|voice| voice.retired_amplitude() == 0.0 && !voice.is_being_reached());
        if self.idle {
            self.fader.settle();
            let unstruck = self.voices.iter().filter(|voice| !voice.was_struck());
            self.unstruck_modes = unstruck.map(|voice| voice.mode_count() as u32).sum();
        }
    }
}

/// Renders a run of a pad with filters or with modes in frames. False, with nothing done, if the
/// pad has filters alone and they do not take part in the run.
#[inline(never)] // its registers must not weigh on other pads
fn render_joined(
    voice: &mut Voice<'_, '_>,
    now: u64,
    run: Run<'_>,
    contacts: &mut ActiveContacts<'_>,
    report: &mut TickReport,
    out: &mut [[i32; 2]],
) -> bool {
    if let Some(object) = voice.frames_mut() {
        object.begin_run((now % BLOCK_FRAMES as u64) as usize);
    }
    if voice.filters_join_in(run.has_force) {
        let work = voice.render_filtered((now % TICK_FRAMES as u64) as usize, run, contacts, out);
        report.add_filtered(voice, work, out.len());
        return true;
    }
    if voice.frames().is_none() {
        return false;
    }
    let ran = voice.render_beside_frames(run, contacts, out);
    report.add_ran(voice, ran, out.len());
    true
}
