//! Report of a tick: the work that ran and the work that was skipped.

use super::cost::Counts;
use crate::resonator::Shed;
use crate::voice::{FilterWork, PadWork, Ran, Voice};

/// Work that ran in one tick, and work that was skipped.
///
/// Work is counted in frames: a mode that rings through a whole tick makes 32 mode-frames. Modes
/// above Nyquist are not built and appear nowhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickReport {
    /// First frame of the tick, counted from the engine's start.
    pub frame: u64,
    /// Mode-frames under a force.
    pub driven_mode_frames: u32,
    /// Mode-frames ringing freely.
    pub free_mode_frames: u32,
    /// Mode-frames that were skipped because their pad has not been struck since the load.
    pub unstruck_mode_frames: u32,
    /// Mode-frames that were skipped because their mode or their whole pad has decayed, or because
    /// their gain at the struck position is 0.
    pub decayed_mode_frames: u32,
    /// Mode-frames of strikers' banks among those that ran.
    pub striker_mode_frames: u32,
    /// Pad-frames under a force.
    pub force_frames: u32,
    /// Contact-frames: frames times contacts under way.
    pub contact_frames: u32,
    /// Pad-frames in which an acceleration sound was computed.
    pub acceleration_frames: u32,
    /// Frames of contacts that go on, summed over those that made any force.
    pub scrape_frames: u32,
    /// Frames in which a pad took in a direct force.
    pub direct_frames: u32,
    /// Number of strikes that began.
    pub strikes: u32,
    /// Number of contacts that a new one displaced, because all places were taken.
    pub displaced_contacts: u32,
    /// Number of strikes at a third position while contacts at two others were under way on the
    /// pad: they drive the slot whose position is nearer.
    pub merged_positions: u32,
    /// Number of guards beyond a tick's own, because a force outgrew its allowance.
    pub extra_guards: u32,
    /// Number of runs of register groups whose input was refused for want of headroom.
    pub refused_inputs: u32,
    /// Number of residuals, dynamic filters and banks of biquads that strikes did not begin for
    /// want of time.
    pub refused_stages: u32,
    /// Number of touches that were left out for want of time or of a place.
    pub refused_scrapes: u32,
    /// Number of modes that retired at this tick.
    pub retired_modes: u32,
    /// Bound of the amplitude that retired modes leave out, 1.0 = full scale; below 10^-5.
    pub retired_amplitude: f32,
    /// Modes and groups that this tick shed for want of time.
    pub shed: Shed,
    /// Work of the tick by kind, as its cost was predicted; [`Counts::NONE`] without a budget.
    pub counts: Counts,
    /// Number of pads whose modes ring at the tick's end.
    pub ringing_pads: u32,
    /// Number of contacts under way at the tick's end.
    pub contacts: u32,
    /// Frames of residuals that were rendered, summed over all pads.
    pub residual_frames: u32,
    /// Frames of background that were rendered.
    pub background_frames: u32,
    /// Frames in which the room sounded.
    pub room_frames: u32,
    /// Number of residuals that sound at the tick's end, the background included.
    pub residuals: u32,
    /// Frames of dynamic filters that were rendered, summed over all pads.
    pub filter_frames: u32,
    /// Loop-frames: frames of dynamic filters that ran times their loops.
    pub loop_frames: u32,
    /// Biquad-frames: frames times biquads that ran.
    pub biquad_frames: u32,
    /// Number of pads whose dynamic filter or biquads sound at the tick's end.
    pub filters: u32,
}

impl TickReport {
    /// Report of a tick without any work.
    pub(super) const EMPTY: Self = Self {
        frame: 0,
        driven_mode_frames: 0,
        free_mode_frames: 0,
        unstruck_mode_frames: 0,
        decayed_mode_frames: 0,
        striker_mode_frames: 0,
        force_frames: 0,
        contact_frames: 0,
        acceleration_frames: 0,
        scrape_frames: 0,
        direct_frames: 0,
        strikes: 0,
        displaced_contacts: 0,
        merged_positions: 0,
        extra_guards: 0,
        refused_inputs: 0,
        refused_stages: 0,
        refused_scrapes: 0,
        retired_modes: 0,
        retired_amplitude: 0.0,
        residual_frames: 0,
        background_frames: 0,
        room_frames: 0,
        residuals: 0,
        filter_frames: 0,
        loop_frames: 0,
        biquad_frames: 0,
        filters: 0,
        shed: Shed::NOTHING,
        counts: Counts::NONE,
        ringing_pads: 0,
        contacts: 0,
    };

    /// Cycles that the tick was predicted to take; 0 without a budget.
    pub fn predicted_cycles(&self) -> u32 {
        self.counts.cycles()
    }

    /// Mode-frames that ran.
    pub fn run_mode_frames(&self) -> u32 {
        self.driven_mode_frames + self.free_mode_frames
    }

    /// Begins the report of the next tick.
    pub(super) fn begin(&mut self, frame: u64) {
        // The counts are long; without a budget they are 0 already.
        self.forget_counts();
        *self = Self { frame, counts: self.counts, ..Self::EMPTY };
    }

    fn forget_counts(&mut self) {
        if self.counts.is_any() {
            self.counts = Counts::NONE;
        }
    }

    /// Begins the report of an idle tick behind an idle tick, after which all else is 0 already.
    pub(super) fn begin_idle(&mut self, frame: u64) {
        (self.frame, self.unstruck_mode_frames, self.decayed_mode_frames) = (frame, 0, 0);
        self.forget_counts();
    }

    /// Adds frames of modes that no run looked at.
    pub(super) fn pass_asleep(&mut self, unstruck_modes: u32, modes: u32, frames: usize) {
        self.unstruck_mode_frames += unstruck_modes * frames as u32;
        self.decayed_mode_frames += (modes - unstruck_modes) * frames as u32;
    }

    /// Adds a run of a pad without force, by the mode-frames of the object's and of the strikers'
    /// banks.
    pub(super) fn add_ringing(&mut self, voice: &Voice<'_, '_>, (object, strikers): (u32, u32), frames: usize) {
        self.add_skipped(voice, (voice.mode_count() * frames) as u32 - (object + strikers));
        self.free_mode_frames += object + strikers;
        self.striker_mode_frames += strikers;
    }

    /// Adds a run of a pad that may have been under a force.
    pub(super) fn add_ran(&mut self, voice: &Voice<'_, '_>, ran: Ran, frames: usize) {
        match ran {
            Ran::Driven(work) => self.add(voice, &work, frames),
            Ran::Ringing(object, strikers) => self.add_ringing(voice, (object, strikers), frames),
        }
    }

    /// Adds a run of a pad whose filters took part in it.
    pub(super) fn add_filtered(&mut self, voice: &Voice<'_, '_>, (ran, work): (Ran, FilterWork), frames: usize) {
        self.add_ran(voice, ran, frames);
        self.filter_frames += work.filter_frames;
        self.loop_frames += work.loop_frames;
        self.biquad_frames += work.biquad_frames;
    }

    /// Adds a run of a pad under a force, or of one that left nothing out.
    pub(super) fn add(&mut self, voice: &Voice<'_, '_>, work: &PadWork, frames: usize) {
        let mut banks = work.object;
        banks += work.strikers;
        let run = banks.driven_mode_frames + banks.free_mode_frames;
        self.add_skipped(voice, ((voice.mode_count() * frames) as u32).saturating_sub(run));
        self.driven_mode_frames += banks.driven_mode_frames;
        self.free_mode_frames += banks.free_mode_frames;
        self.striker_mode_frames += work.strikers.driven_mode_frames + work.strikers.free_mode_frames;
        self.extra_guards += banks.extra_guards;
        self.refused_inputs += banks.refused;
        self.force_frames += work.force_frames;
        self.acceleration_frames += work.acceleration_frames;
        self.direct_frames += work.direct_frames;
    }
    /// Adds mode-frames of a pad that were skipped.
    #[inline(always)] // as cheap as in its two places
    fn add_skipped(&mut self, voice: &Voice<'_, '_>, mode_frames: u32) {
        match voice.was_struck() {
            true => self.decayed_mode_frames += mode_frames,
            false => self.unstruck_mode_frames += mode_frames,
        }
    }
}
