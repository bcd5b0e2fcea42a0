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

mod apart;
mod budget;
mod check;
mod cost;
mod filters;
mod fitting;
mod load;
mod noise;
mod pad_set;
mod report;
mod surroundings;
mod tick;

pub use apart::Apart;
pub use cost::{CYCLES, Counts, PARTS, Part};
pub use filters::{FilterRoom, Filters, NoFilters, Place as FilterPlace};
pub use fitting::{Fitting, Left, Stage};
pub use load::{Capacity, LoadError};
pub use noise::{NoResiduals, Place as ResidualPlace, ResidualRoom, Residuals};
pub use report::{Cause, TickReport};
pub use surroundings::{NoRoom, RoomStage, Surroundings};

use crate::SampleRate;
use crate::contact::Flight;
use crate::event::{Event, EventError};
use crate::output;
use crate::pad::{Pad, is_ringing};
use crate::resonator::{Bank, Group, Mode, Origin, TICK_FRAMES};
use crate::table::Kit;
use pad_set::PadSet;

/// Contacts under way at once in every engine that is meant to give the same bits as the others: one more displaces the one nearest to
/// its end. 64 are 1000 strikes a second on each of eight pads with contacts of 8 ms.
pub const STANDARD_CONTACTS: usize = 64;

/// What an engine leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Skipping {
    /// Everything that cannot be heard: pads at rest, input work without force, modes that have decayed.
    On,
    /// Nothing that was built: every mode runs with its input in every frame. For measuring.
    Off,
}

/// A force that excites a pad directly, sample by sample.
#[derive(Clone, Copy, Debug)]
pub struct Direct<'a> {
    /// Which pad.
    pub pad: u8,
    /// The force, as long as the block, Q4.27: 1.0 = the object's reference force.
    pub force: &'a [i32],
}

/// Fixed memory for a whole instrument, sized at compile time.
///
/// | parameter | counts | bytes each |
/// | --- | --- | --- |
/// | `PADS` | pads of the kit | 76 |
/// | `BANKS` | a pad's object, and its strikers up to the last one with modes, of all pads | 88 |
/// | `MODES` | modes below Nyquist of all pads, their strikers' included | 24 |
/// | `GROUPS` | register groups: modes/6, and up to six more a bank | 24 |
/// | `ORIGINS` | modes of pads that can be choked or have several positions; with several positions as many again, if there is room | 16 |
/// | `CONTACTS` | contacts under way at once | 32 |
/// | `S` | [`Surroundings`]: [`Residuals`] for so many pads with a residual, the background counting as one, a [`Room`](crate::room::Room), and [`Filters`]; none unless said otherwise | 24 KB a residual; a room as long as its lines; filters as their delay lines and biquads |
#[derive(Debug)]
pub struct Engine<
    'k,
    const PADS: usize,
    const BANKS: usize,
    const MODES: usize,
    const GROUPS: usize,
    const ORIGINS: usize,
    const CONTACTS: usize,
    S: Surroundings = NoResiduals,
> {
    /// The first `pad_count` are the kit's.
    pads: [Pad<'k>; PADS],
    pad_count: usize,
    kit: Option<Kit<'k>>,
    banks: [Bank; BANKS],
    modes: [Mode; MODES],
    groups: [Group; GROUPS],
    origins: [Origin; ORIGINS],
    flight: Flight<CONTACTS>,
    residuals: S::Residuals,
    room: S::Room,
    filters: S::Filters,
    /// `None` before a load, so that an engine in a `static` is all zeros and costs no flash.
    rate: Option<SampleRate>,
    skipping: Skipping,
    now: u64,
    /// Cycles that a tick may take.
    budget: Option<u32>,
    /// Cycles that stages which strikes begin may take together.
    stage_cycles: Option<u32>,
    /// Whether any residual or background has been loaded, and pads that have filters: kits without take no cycle for them.
    noisy: bool,
    filtered: PadSet,
    report: TickReport,
    /// Whether nothing rings, no contact is under way and nothing retired may still be missing: until an event or a direct force, a tick
    /// has nothing to do.
    idle: bool,
    /// Whether the last tick was idle too, so that the report has nothing to forget.
    was_idle: bool,
    modes_built: u32,
    groups_built: u32,
    /// Whether a contact has begun that some pad is not guarded for yet.
    expects: bool,
    /// Whether a hand has come or gone since the last tick.
    hands_changed: bool,
    /// Modes of pads that have not been struck since the load; kept for idle ticks.
    unstruck_modes: u32,
    /// Sum of the pads' retired amplitudes.
    retired_amplitude: f32,
}

impl<
    'k,
    const PADS: usize,
    const BANKS: usize,
    const MODES: usize,
    const GROUPS: usize,
    const ORIGINS: usize,
    const CONTACTS: usize,
    S: Surroundings,
> Default for Engine<'k, PADS, BANKS, MODES, GROUPS, ORIGINS, CONTACTS, S>
{
    fn default() -> Self {
        Self::new()
    }
}

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
    /// An engine without a kit, silent. `const`, so that it can lie in a `static` and never on a stack.
    pub const fn new() -> Self {
        Self::with_stages(S::Residuals::EMPTY, S::Room::EMPTY, S::Filters::EMPTY)
    }

    /// The same with stages that are made already, such as those that lie [`Apart`].
    pub const fn with_stages(residuals: S::Residuals, room: S::Room, filters: S::Filters) -> Self {
        Self {
            pads: [const { Pad::EMPTY }; PADS],
            pad_count: 0,
            kit: None,
            banks: [const { Bank::EMPTY }; BANKS],
            modes: [Mode::SILENT; MODES],
            groups: [Group::EMPTY; GROUPS],
            origins: [Origin::NONE; ORIGINS],
            flight: Flight::EMPTY,
            residuals,
            room,
            filters,
            rate: None,
            skipping: Skipping::On,
            now: 0,
            budget: None,
            stage_cycles: None,
            noisy: false,
            filtered: PadSet::NONE,
            report: TickReport::EMPTY,
            idle: false,
            was_idle: false,
            modes_built: 0,
            groups_built: 0,
            expects: false,
            hands_changed: false,
            unstruck_modes: 0,
            retired_amplitude: 0.0,
        }
    }

    /// The frame that the next block begins with, counted from the load.
    pub fn now(&self) -> u64 {
        self.now
    }

    /// The sample rate; 48 kHz before a load.
    pub fn rate(&self) -> SampleRate {
        self.rate.unwrap_or(SampleRate::HZ_48000)
    }

    /// Number of pads loaded.
    pub fn pad_count(&self) -> usize {
        self.pad_count
    }

    fn pads(&self) -> &[Pad<'k>] {
        self.pads.get(..self.pad_count).unwrap_or(&[])
    }

    /// Modes that a pad renders, its strikers' included; those at or above Nyquist are not among them.
    pub fn mode_count(&self, pad: usize) -> usize {
        self.pads().get(pad).map_or(0, Pad::mode_count)
    }

    /// Number of a pad's modes that are left out for want of time until the pad's next strike.
    pub fn shed_mode_count(&self, pad: usize) -> usize {
        let banks = self.pads().get(pad).map_or(&[] as &[Bank], |pad| pad.own(&self.banks));
        banks.iter().map(|bank| bank.shed_mode_count(&self.groups)).sum()
    }

    /// Whether nothing rings and no contact is under way: until the next event or direct force, output is exact silence and a core may sleep.
    pub fn is_silent(&self) -> bool {
        self.flight.count() == 0
            && !is_ringing(&self.banks)
            && self.noises() == 0
            && (self.filtered.is_empty() || self.filters.ringing() == 0)
            && self.room.is_silent()
    }

    /// Lets a tick of silence pass without a block to write to: what rendering it without events and direct force would do, but for the report.
    /// `false`, and nothing done, where something sounds or a tick is under way.
    pub fn pass_silent_tick(&mut self) -> bool {
        let passes = self.idle && !self.hands_changed && self.now.is_multiple_of(TICK_FRAMES as u64);
        if passes {
            self.now += TICK_FRAMES as u64;
            self.room.pass_silence(TICK_FRAMES);
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
                self.room.pass_silence(length);
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

    #[test]
    fn memory_is_what_the_table_above_says() {
        std::println!(
            "pad {}, bank {}, mode {}, group {}, origin {}, contact {}",
            size_of::<Pad<'_>>(),
            size_of::<Bank>(),
            size_of::<Mode>(),
            size_of::<Group>(),
            size_of::<Origin>(),
            size_of::<Contact>()
        );
        assert_eq!(
            (size_of::<Mode>(), size_of::<Group>(), size_of::<Origin>(), size_of::<Contact>()),
            (24, 24, 16, 32)
        );
        assert_eq!(size_of::<Bank>(), 88);
        // Four pointers, each beside an f32, which are twice as wide on a PC as on the board.
        let pointers = 8 * (size_of::<usize>() - 4);
        assert_eq!(size_of::<Pad<'_>>(), (76 + pointers).next_multiple_of(size_of::<usize>()));
    }
}
