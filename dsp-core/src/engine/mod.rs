//! The engine: pads, events and time.
//!
//! ```text
//! caller's block: |----------- 33 frames ------------|
//! ticks:          |     |     every 32 frames, counted from the engine's start
//! events:         |        |  at their frame
//! runs:           [----][--][------][----------------]   what the stages render at once
//! ```
//!
//! A block is cut at ticks and at events, but for those of hands, which act on ticks; all bookkeeping happens on ticks, so that
//! the block size cannot change a bit. What ran and what was skipped in each tick is told by a [`TickReport`].

mod budget;
mod check;
mod cost;
mod error;
mod load;
mod report;
mod setup;
mod stages;
mod tick;

pub use cost::{CYCLES, Counts, PARTS, Part};
pub use error::LoadError;
pub use load::Plan;
pub use report::TickReport;
pub use setup::{Setup, Skipping, Stage};

use crate::SampleRate;
use crate::contact::ActiveContacts;
use crate::event::{Event, EventError};
use crate::memory::Words;
use crate::output::{self, Panner};
use crate::resonator::Bank;
use crate::room::{Room, Sample};
use crate::table::Kit;
use crate::time::TICK_FRAMES;
use crate::voice::{Residual, Voice};
use budget::Listening;

/// Contacts under way at once, in every engine: one more displaces the one nearest to its end. 64 are 1000 strikes a second on
/// each of eight pads with contacts of 8 ms.
pub const STANDARD_CONTACTS: usize = 64;

/// A force that excites a pad directly, sample by sample.
#[derive(Clone, Copy, Debug)]
pub struct Direct<'a> {
    /// Which pad.
    pub pad: u8,
    /// The force, as long as the block, Q4.27: 1.0 = the object's reference force.
    pub force: &'a [i32],
}

/// A whole instrument with its kit, in lent memory ([`Engine::new`]). `S` is the sample type of the room's delay lines: `i16` on
/// boards, `i32` where memory is cheap.
#[derive(Debug)]
pub struct Engine<'k, 'm, S: Sample = i16> {
    kit: Kit<'k>,
    /// A voice for each pad of the kit.
    voices: &'m mut [Voice<'k, 'm>],
    contacts: ActiveContacts<'m>,
    background: Option<&'m mut Residual<'m>>,
    /// Level and pan of the background.
    centre: Panner,
    room: Option<&'m mut Room<'m, S>>,
    /// Scratch of the budget: how each pad is heard, pads that known events will have struck, the level of each register group.
    listening: &'m mut [Listening],
    struck: &'m mut [bool],
    levels: &'m mut [u8],
    rate: SampleRate,
    skipping: Skipping,
    room_samples: usize,
    words: Words,
    now: u64,
    /// Cycles that a tick may take.
    budget: Option<u32>,
    /// Cycles that stages which strikes begin may take together.
    stage_cycles: Option<u32>,
    /// True if any residual or background has been loaded: kits without take no cycle for them.
    noisy: bool,
    /// True if any pad has filters.
    filtered: bool,
    report: TickReport,
    /// True if nothing rings, no contact is under way and nothing retired may still be missing: until an event or a direct force, a tick
    /// has nothing to do.
    idle: bool,
    /// True if the last tick was idle too, so that the report has nothing to forget.
    was_idle: bool,
    modes_built: u32,
    groups_built: u32,
    /// True if a contact has begun that some pad is not guarded for yet.
    expects: bool,
    /// True if a hand has come or gone since the last tick.
    hands_changed: bool,
    /// Modes of pads that have not been struck since the load; kept for idle ticks.
    unstruck_modes: u32,
    /// Sum of the pads' retired amplitudes.
    retired_amplitude: f32,
}

impl<S: Sample> Engine<'_, '_, S> {
    /// The frame that the next block begins with, counted from the load.
    pub fn now(&self) -> u64 {
        self.now
    }

    /// The sample rate.
    pub fn rate(&self) -> SampleRate {
        self.rate
    }

    /// Words of memory that the engine has taken.
    pub fn words(&self) -> Words {
        self.words
    }

    /// Number of pads loaded.
    pub fn pad_count(&self) -> usize {
        self.voices.len()
    }

    /// Modes that a pad renders, its strikers' included; those at or above Nyquist are not among them.
    pub fn mode_count(&self, pad: usize) -> usize {
        self.voices.get(pad).map_or(0, Voice::mode_count)
    }

    /// Number of a pad's modes that are left out for want of time until the pad's next strike.
    pub fn shed_mode_count(&self, pad: usize) -> usize {
        let banks = self.voices.get(pad).map_or(&[] as &[Bank<'_>], Voice::banks);
        banks.iter().map(Bank::shed_mode_count).sum()
    }

    /// Whether nothing rings and no contact is under way: until the next event or direct force, output is exact silence and a core may sleep.
    pub fn is_silent(&self) -> bool {
        self.contacts.count() == 0
            && !self.voices.iter().any(Voice::is_ringing)
            && self.noises() == 0
            && self.ringing_filters() == 0
            && self.room_is_silent()
    }

    /// Lets a tick of silence pass without a block to write to: what rendering it without events and direct force would do, but for the report.
    /// `false`, and nothing done, where something sounds or a tick is under way.
    pub fn pass_silent_tick(&mut self) -> bool {
        let passes = self.idle && !self.hands_changed && self.now.is_multiple_of(TICK_FRAMES as u64);
        if passes {
            self.now += TICK_FRAMES as u64;
            self.pass_room_silence(TICK_FRAMES);
        }
        passes
    }

    /// Renders a block of 24-bit stereo samples. See [`render_observed`](Self::render_observed).
    ///
    /// # Errors
    /// An [`EventError`] for the first event that cannot be; then nothing was rendered and time stands still.
    pub fn render(
        &mut self,
        events: &[Event],
        direct: Option<Direct<'_>>,
        out: &mut [[i32; 2]],
    ) -> Result<(), EventError> {
        self.render_observed(events, direct, out, |_| {})
    }

    /// Renders a block of signed 24-bit stereo samples (full scale 2^23), of any length, and shows each tick's report as it ends.
    ///
    /// `events` are those that take effect within the block, in order of time. A `direct` force excites its pad for the whole block.
    ///
    /// # Errors
    /// An [`EventError`] for the first event that cannot be; then nothing was rendered and time stands still.
    pub fn render_observed(
        &mut self,
        events: &[Event],
        direct: Option<Direct<'_>>,
        out: &mut [[i32; 2]],
        observe: impl FnMut(&TickReport),
    ) -> Result<(), EventError> {
        self.render_blocks(events, direct, out, observe, |_| {}, output::to_24_bit)
    }

    /// The same, and tells each decision to leave something out ([`Action::Shed`](crate::event::Action::Shed)) at the place in the list of events where it belongs: behind
    /// the events of its frame.
    ///
    /// # Errors
    /// As [`render_observed`](Self::render_observed).
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

    /// The same before the step to 24 bits: stereo bus samples, Q4.27. For measuring.
    ///
    /// # Errors
    /// As [`render_observed`](Self::render_observed).
    pub fn render_bus(
        &mut self,
        events: &[Event],
        direct: Option<Direct<'_>>,
        out: &mut [[i32; 2]],
        observe: impl FnMut(&TickReport),
    ) -> Result<(), EventError> {
        self.render_bus_logged(events, direct, out, observe, |_| {})
    }

    /// Renders stereo bus samples, Q4.27, and tells each decision to leave something out, as
    /// [`render_logged`](Self::render_logged) does.
    ///
    /// # Errors
    /// As [`render_observed`](Self::render_observed).
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

    /// `finish` takes each run of the bus that is not exact silence.
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
        while !out.is_empty() {
            let mut news = self.now.is_multiple_of(TICK_FRAMES as u64);
            if news {
                self.begin_tick(direct);
            }
            while let Some((event, later)) =
                events.split_first().filter(|(event, _)| event.time.first_frame() <= self.now)
            {
                self.apply(event, direct);
                events = later;
                news |= !event.is_of_hand();
            }
            let mut counted = false;
            if news && !self.idle {
                counted = self.budget.is_some() && self.keep_budget(events, direct, &mut log);
                if core::mem::take(&mut self.expects) {
                    self.meet_expected();
                }
            }
            let to_tick = TICK_FRAMES as u64 - self.now % TICK_FRAMES as u64;
            let to_event = next_news(events).map_or(u64::MAX, |event| event.time.first_frame() - self.now);
            // At most a tick, hence it fits a usize.
            let length = to_tick.min(to_event).min(end - self.now) as usize;
            let Some((now, later)) = core::mem::take(&mut out).split_at_mut_checked(length) else { break };
            let direct_now =
                direct.and_then(|direct| Some(Direct { pad: direct.pad, force: direct.force.get(..length)? }));
            let passes_idle = self.idle && direct_now.is_none();
            if self.budget.is_some() && !passes_idle && !(counted && length as u64 == to_tick) {
                self.count_run(length as u32, direct_now);
            }
            if passes_idle {
                self.report.pass_idle(self.unstruck_modes, self.modes_built, length);
                self.pass_room_silence(length);
            } else {
                self.render_run(direct_now, now);
                finish(now);
            }
            direct = direct.and_then(|direct| Some(Direct { pad: direct.pad, force: direct.force.get(length..)? }));
            out = later;
            self.now += length as u64;
            while let Some((event, later)) =
                events.split_first().filter(|(event, _)| event.is_of_hand() && event.time.first_frame() < self.now)
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

/// The next event at which a run of frames ends.
fn next_news(events: &[Event]) -> Option<&Event> {
    events.iter().find(|event| !event.is_of_hand())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Contact;
    use crate::resonator::{Group, Mode, Origin};

    #[test]
    fn a_mode_takes_24_bytes_and_a_group_of_six_as_many() {
        std::println!(
            "voice {}, bank {}, mode {}, group {}, origin {}, contact {}, engine {}",
            size_of::<Voice<'_, '_>>(),
            size_of::<Bank<'_>>(),
            size_of::<Mode>(),
            size_of::<Group>(),
            size_of::<Origin>(),
            size_of::<Contact>(),
            size_of::<Engine<'_, '_>>(),
        );
        assert_eq!(
            (size_of::<Mode>(), size_of::<Group>(), size_of::<Origin>(), size_of::<Contact>()),
            (24, 24, 16, 32)
        );
    }
}
