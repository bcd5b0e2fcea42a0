//! State of an engine, and what a caller can ask it between blocks.

use super::awake::Awake;
use super::fader::Fader;
use super::held::Held;
use super::report::TickReport;
use super::scrapes::Scrapes;
use super::setup::Skipping;
use crate::SampleRate;
use crate::built::Built;
use crate::contact::ActiveContacts;
use crate::frames::FrameMixer;
use crate::limiter::Limiter;
use crate::memory::Words;
use crate::output::Panner;
use crate::resonator::{Audience, Bank};
use crate::room::{Room, Sample};
use crate::table::Kit;
use crate::time::TICK_FRAMES;
use crate::voice::{Form, Residual, Voice};

/// Hearing of a pad in the tick's rest, for the budget.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hearing {
    pub(super) audience: Audience,
    /// True if a force acts on the object.
    pub(super) is_driven: bool,
    /// True if a direct force does.
    pub(super) is_direct: bool,
    /// True if groups at rest are to be guarded for the force.
    pub(super) expects: bool,
}

/// Maximum number of impacts under way at once, in every engine: one more displaces the one
/// nearest to its end. 42 are 650 strikes a second on each of eight pads with contacts of 8 ms.
pub const STANDARD_CONTACTS: usize = 42;

/// A force that excites a pad directly, sample by sample.
#[derive(Clone, Copy, Debug)]
pub struct Direct<'a> {
    /// Pad that the force acts on, counted from 0.
    pub pad: u8,
    /// Force in Q4.27, 1.0 = the object's reference force; as long as the block.
    pub force: &'a [i32],
}

/// Bound of the sum of a direct force over the coming tick, in bus steps; 0 for another pad.
pub(super) fn direct_input(direct: Option<Direct<'_>>, pad: u8) -> f32 {
    let Some(Direct { force, .. }) = direct.filter(|direct| direct.pad == pad) else { return 0.0 };
    force.iter().take(TICK_FRAMES).map(|x| x.unsigned_abs() as f32).sum()
}

/// A whole instrument with its kit, in lent memory ([`Engine::new`]).
///
/// `S` is the sample type of the room's delay lines: `i16` on boards, `i32` where memory is cheap.
#[derive(Debug)]
pub struct Engine<'k, 'm, S: Sample = i16> {
    pub(super) kit: Kit<'k>,
    /// Voices of the kit's pads.
    pub(super) voices: &'m mut [Voice<'k, 'm>],
    /// Pads that are awake: all others have nothing to do.
    pub(super) awake: Awake<'m>,
    pub(super) contacts: ActiveContacts<'m>,
    /// Contacts that go on.
    pub(super) scrapes: Scrapes<'k, 'm>,
    /// Work and sound of all pads in frames; `None` if there is none.
    pub(super) frames: Option<&'m mut FrameMixer<'m>>,
    pub(super) background: Option<&'m mut Residual<'m>>,
    /// Level and pan of the background.
    pub(super) centre: Panner,
    pub(super) room: Option<&'m mut Room<'m, S>>,
    pub(super) fader: Fader,
    /// Strikes that wait for the end of the sound before them.
    pub(super) held: Held,
    pub(super) limiter: Option<&'m mut Limiter>,
    /// Scratch of the budget: how each pad is heard, `None` if it will not sound.
    pub(super) hearings: &'m mut [Option<Hearing>],
    /// Scratch of the budget: for each pad a bit for each striker by which a known event will have
    /// struck it.
    pub(super) struck: &'m mut [u8],
    pub(super) rate: SampleRate,
    pub(super) skipping: Skipping,
    /// Least change of place at which the gains follow a contact that goes on.
    pub(super) position_step: f32,
    /// Optional stages that are loaded.
    pub(super) built: Built,
    pub(super) room_samples: usize,
    /// True if memory for the mixer of the pads in frames has been taken.
    pub(super) has_mixer: bool,
    /// Bound of the amplitude that retired modes in frames leave out, 1.0 = full scale.
    pub(super) retired_in_frames: f32,
    /// Cycles that the pads in frames count for in this tick, their heads aside.
    pub(super) frames_tick_cycles: u32,
    /// Percent of their cycles that the loops over modes count for in the budget.
    pub(super) loop_percent: u32,
    /// Nominal cycles a frame that are left for further pads in frames; `None` without a limit.
    pub(super) frame_cycles: Option<u32>,
    pub(super) words: Words,
    pub(super) now: u64,
    /// Cycles that a tick may take; `None` without a limit.
    pub(super) budget: Option<u32>,
    /// Cycles a tick that stages which strikes begin may take together; `None` without a limit.
    pub(super) stage_cycles: Option<u32>,
    /// True if any residual or background has been loaded: other kits spend no cycle on noise.
    pub(super) noisy: bool,
    /// True if any pad has a dynamic filter or biquads.
    pub(super) filtered: bool,
    pub(super) report: TickReport,
    /// True if nothing sounds, no contact is under way and no retired mode is accounted for: until
    /// an event or a direct force, a tick has nothing to do.
    pub(super) idle: bool,
    /// True if the last tick was idle, so that its report needs hardly any clearing.
    pub(super) was_idle: bool,
    pub(super) modes_built: u32,
    pub(super) groups_built: u32,
    /// Cycles of the prediction that [`postpone`](Self::postpone) has made of the tick to come.
    pub(super) cycles_ahead: u32,
    /// Number of ticks up to now in which all strikes have waited.
    pub(super) ticks_without_strike: u32,
    /// True if a contact has begun that its pad is not guarded for yet.
    pub(super) expects: bool,
    /// True if a pad has been choked or released since the last tick.
    pub(super) chokes_changed: bool,
    /// Number of modes of pads that have not been struck since the load; kept for idle ticks.
    pub(super) unstruck_modes: u32,
    /// Number of modes of pads that sleep.
    pub(super) asleep_modes: u32,
    /// Number of modes of pads that sleep and have not been struck since the load.
    pub(super) asleep_unstruck_modes: u32,
    /// Sum of the pads' retired amplitudes, 1.0 = full scale.
    pub(super) retired_amplitude: f32,
}

impl<S: Sample> Engine<'_, '_, S> {
    /// First frame of the next block, counted from the load.
    pub fn now(&self) -> u64 {
        self.now
    }

    /// Sample rate of the output.
    pub fn rate(&self) -> SampleRate {
        self.rate
    }

    /// Words of memory that the engine has taken.
    pub fn words(&self) -> Words {
        self.words
    }

    /// Number of pads of the kit.
    pub fn pad_count(&self) -> usize {
        self.voices.len()
    }

    /// Number of modes of a pad and its strikers, without those at or above Nyquist.
    pub fn mode_count(&self, pad: usize) -> usize {
        self.voices.get(pad).map_or(0, Voice::mode_count)
    }

    /// Form in which the modes of a pad's object are played; `None` for a pad that the kit does not
    /// have.
    pub fn form(&self, pad: usize) -> Option<Form> {
        self.voices.get(pad).map(|voice| voice.form)
    }

    /// Number of a pad's modes that are shed until the pad's next strike.
    pub fn shed_mode_count(&self, pad: usize) -> usize {
        let banks = self.voices.get(pad).map_or(&[] as &[Bank<'_>], Voice::banks);
        banks.iter().map(Bank::shed_mode_count).sum()
    }

    /// True if nothing sounds and no contact is under way: until the next event or direct force,
    /// the output is exact silence and a core may sleep.
    pub fn is_silent(&self) -> bool {
        self.contacts.count() == 0
            && !self.scrapes.are_due()
            && !self.voices.iter().any(|voice| voice.is_ringing() || voice.sounds_in_frames())
            && self.noises() == 0
            && self.active_filters() == 0
            && self.bus_stages_are_silent()
    }

    /// Lets a tick of silence pass without a block to write to.
    ///
    /// It does what rendering a tick without events and direct force would do, but for the report.
    /// False, with nothing done, if anything sounds or a tick is under way.
    pub fn pass_silent_tick(&mut self) -> bool {
        let passes =
            self.idle && !self.chokes_changed && !self.scrapes.are_due() && self.now.is_multiple_of(TICK_FRAMES as u64);
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
    fn mode_and_group_take_24_bytes_origin_16_and_contact_48() {
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
            (24, 24, 16, 48)
        );
    }
}
