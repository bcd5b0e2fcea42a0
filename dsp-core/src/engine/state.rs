//! An engine's parts, and questions to it between blocks.

use super::report::TickReport;
use super::setup::Skipping;
use crate::SampleRate;
use crate::contact::ActiveContacts;
use crate::limiter::Limiter;
use crate::memory::Words;
use crate::output::Panner;
use crate::resonator::{Audience, Bank, UpcomingRun};
use crate::room::{Room, Sample};
use crate::table::Kit;
use crate::time::TICK_FRAMES;
use crate::voice::{Residual, Voice};

/// Audience of a pad and its coming run; `None` for a pad that does not run.
pub(super) type Listening = Option<(Audience, UpcomingRun)>;

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
    pub(super) kit: Kit<'k>,
    /// A voice for each pad of the kit.
    pub(super) voices: &'m mut [Voice<'k, 'm>],
    pub(super) contacts: ActiveContacts<'m>,
    pub(super) background: Option<&'m mut Residual<'m>>,
    /// Level and pan of the background.
    pub(super) centre: Panner,
    pub(super) room: Option<&'m mut Room<'m, S>>,
    pub(super) limiter: Option<&'m mut Limiter>,
    /// Scratch of the budget: how each pad is heard, pads that known events will have struck, the level of each register group.
    pub(super) listening: &'m mut [Listening],
    pub(super) struck: &'m mut [bool],
    pub(super) levels: &'m mut [u8],
    pub(super) rate: SampleRate,
    pub(super) skipping: Skipping,
    pub(super) room_samples: usize,
    pub(super) words: Words,
    pub(super) now: u64,
    /// Cycles that a tick may take.
    pub(super) budget: Option<u32>,
    /// Cycles that stages which strikes begin may take together.
    pub(super) stage_cycles: Option<u32>,
    /// True if any residual or background has been loaded: kits without take no cycle for them.
    pub(super) noisy: bool,
    /// True if any pad has filters.
    pub(super) filtered: bool,
    pub(super) report: TickReport,
    /// True if nothing rings, no contact is under way and nothing retired may still be missing: until an event or a direct force, a tick
    /// has nothing to do.
    pub(super) idle: bool,
    /// True if the last tick was idle too, so that the report has nothing to forget.
    pub(super) was_idle: bool,
    pub(super) modes_built: u32,
    pub(super) groups_built: u32,
    /// True if a contact has begun that some pad is not guarded for yet.
    pub(super) expects: bool,
    /// True if a hand has come or gone since the last tick.
    pub(super) hands_changed: bool,
    /// Modes of pads that have not been struck since the load; kept for idle ticks.
    pub(super) unstruck_modes: u32,
    /// Sum of the pads' retired amplitudes.
    pub(super) retired_amplitude: f32,
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
            && self.bus_stages_are_silent()
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
