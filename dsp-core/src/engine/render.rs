//! Blocks of any length, cut at ticks and at events.

use super::prediction::Counted;
use super::report::TickReport;
use super::state::{Direct, Engine};
use crate::event::{Action, Event, EventError};
use crate::output;
use crate::room::Sample;
use crate::time::TICK_FRAMES;

impl<S: Sample> Engine<'_, '_, S> {
    /// Renders a block of 24-bit stereo samples, as [`render_observed`](Self::render_observed)
    /// does, without reports.
    ///
    /// # Errors
    /// An [`EventError`] for the first invalid event; then nothing is rendered and time stands
    /// still.
    pub fn render(
        &mut self,
        events: &[Event],
        direct: Option<Direct<'_>>,
        out: &mut [[i32; 2]],
    ) -> Result<(), EventError> {
        self.render_observed(events, direct, out, |_| {})
    }

    /// Renders a block of signed 24-bit stereo samples (full scale 2^23), of any length, and passes
    /// each tick's report to `observe` as the tick ends.
    ///
    /// `events` are those that take effect within the block, in order of time. A `direct` force
    /// excites its pad for the whole block.
    ///
    /// # Errors
    /// An [`EventError`] for the first invalid event; then nothing is rendered and time stands
    /// still.
    pub fn render_observed(
        &mut self,
        events: &[Event],
        direct: Option<Direct<'_>>,
        out: &mut [[i32; 2]],
        observe: impl FnMut(&TickReport),
    ) -> Result<(), EventError> {
        self.render_blocks(events, direct, out, observe, |_| {}, output::to_24_bit)
    }

    /// Renders a block as [`render_observed`](Self::render_observed) does, and passes each decision
    /// to shed ([`Action::Shed`](crate::event::Action::Shed)) to `log`.
    ///
    /// In a list of all events, a decision belongs behind the events of its frame.
    ///
    /// # Errors
    /// An [`EventError`] for the first invalid event; then nothing is rendered and time stands
    /// still.
    pub fn render_logged(
        &mut self,
        events: &[Event],
        direct: Option<Direct<'_>>,
        out: &mut [[i32; 2]],
        observe: impl FnMut(&TickReport),
        log: impl FnMut(&Event),
    ) -> Result<(), EventError> {
        self.render_blocks(events, direct, out, observe, log, output::to_24_bit)
    }

    /// Renders a block as [`render_observed`](Self::render_observed) does, but of stereo bus
    /// samples, Q4.27, before the step to 24 bits. For measuring.
    ///
    /// # Errors
    /// An [`EventError`] for the first invalid event; then nothing is rendered and time stands
    /// still.
    pub fn render_bus(
        &mut self,
        events: &[Event],
        direct: Option<Direct<'_>>,
        out: &mut [[i32; 2]],
        observe: impl FnMut(&TickReport),
    ) -> Result<(), EventError> {
        self.render_bus_logged(events, direct, out, observe, |_| {})
    }

    /// Renders a block as [`render_logged`](Self::render_logged) does, but of stereo bus samples,
    /// Q4.27, before the step to 24 bits. For measuring.
    ///
    /// # Errors
    /// An [`EventError`] for the first invalid event; then nothing is rendered and time stands
    /// still.
    pub fn render_bus_logged(
        &mut self,
        events: &[Event],
        direct: Option<Direct<'_>>,
        out: &mut [[i32; 2]],
        observe: impl FnMut(&TickReport),
        log: impl FnMut(&Event),
    ) -> Result<(), EventError> {
        self.render_blocks(events, direct, out, observe, log, |_| {})
    }

    /// Renders a block; `finish` takes each run of the bus that is not exact silence.
    fn render_blocks(
        &mut self,
        events: &[Event],
        direct: Option<Direct<'_>>,
        out: &mut [[i32; 2]],
        mut observe: impl FnMut(&TickReport),
        mut log: impl FnMut(&Event),
        finish: impl Fn(&mut [[i32; 2]]),
    ) -> Result<(), EventError> {
        let frames = out.len();
        self.check(events, direct, frames)?;
        out.fill([0, 0]);
        let end = self.now.saturating_add(frames as u64);
        let (mut events, mut out, mut direct) = (events, out, direct);
        let mut counted = Counted::Nothing;
        while !out.is_empty() {
            direct.iter().for_each(|direct| self.wake(direct.pad));
            let begins_tick = self.now.is_multiple_of(TICK_FRAMES as u64);
            let mut news = begins_tick;
            if begins_tick {
                counted = Counted::Nothing;
                if cfg!(feature = "scrapes") && (!events.is_empty() || self.scrapes.are_told()) {
                    self.tell_due_motions(events);
                }
                self.begin_tick(direct);
            }
            while let Some((event, later)) =
                events.split_first().filter(|(event, _)| event.time.first_frame() <= self.now)
            {
                if cfg!(feature = "scrapes") && !begins_tick && event.action == Action::Silence {
                    self.end_contacts();
                }
                if counted != Counted::Tick {
                    self.count_event(event);
                }
                if !(begins_tick && event.is_motion()) {
                    self.apply(event, direct);
                }
                events = later;
                news |= !event.acts_on_tick();
            }
            if news && !self.idle {
                if self.budget.is_some() && counted != Counted::Tick {
                    counted = self.keep_budget(events, end, direct, &mut log);
                }
                if core::mem::take(&mut self.expects) {
                    self.meet_expected();
                }
                if begins_tick && self.contacts.ongoing.has_places() {
                    self.meet_ongoing();
                }
            }
            let to_tick = TICK_FRAMES as u64 - self.now % TICK_FRAMES as u64;
            let to_event = next_news(events).map_or(u64::MAX, |event| event.time.first_frame() - self.now);
            // A run is at most a tick long, hence its length fits a usize.
            let length = to_tick.min(to_event).min(end - self.now) as usize;
            let Some((now, later)) = core::mem::take(&mut out).split_at_mut_checked(length) else { break };
            let direct_now =
                direct.and_then(|direct| Some(Direct { pad: direct.pad, force: direct.force.get(..length)? }));
            let passes_idle = self.idle && direct_now.is_none();
            if self.budget.is_some() && !passes_idle && counted == Counted::Nothing {
                self.count_run(length as u32, direct_now);
            } else if counted == Counted::Run {
                counted = Counted::Nothing;
            }
            if passes_idle {
                self.report.pass_asleep(self.unstruck_modes, self.modes_built, length);
                self.pass_room_silence(length);
            } else {
                self.render_run(direct_now, now);
                finish(now);
            }
            direct = direct.and_then(|direct| Some(Direct { pad: direct.pad, force: direct.force.get(length..)? }));
            out = later;
            self.now += length as u64;
            while let Some((event, later)) =
                events.split_first().filter(|(event, _)| event.acts_on_tick() && event.time.first_frame() < self.now)
            {
                self.apply(event, direct);
                events = later;
            }
            if self.now.is_multiple_of(TICK_FRAMES as u64) {
                self.end_tick();
                observe(&self.report);
            }
        }
        Ok(())
    }
}

/// Next event at which a run of frames ends: one that acts on a tick ends none.
pub(super) fn next_news(events: &[Event]) -> Option<&Event> {
    events.iter().find(|event| !event.acts_on_tick())
}
