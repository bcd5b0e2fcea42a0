//! What a tick did and what it left out.

use super::cost::Counts;
use crate::resonator::Shed;
use crate::voice::{FilterWork, PadWork, Ran, Voice};

/// Everything that ran in one tick, and what was skipped; modes above Nyquist are not built and appear nowhere.
///
/// Work is counted in frames: a mode that rings through a whole tick makes 32 mode-frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickReport {
    /// The tick's first frame.
    pub frame: u64,
    /// Mode-frames with input.
    pub driven_mode_frames: u32,
    /// Mode-frames ringing freely.
    pub free_mode_frames: u32,
    /// Mode-frames skipped because their pad has not been struck since the load.
    pub unstruck_mode_frames: u32,
    /// Mode-frames skipped because the modes, or all of their pad, have decayed, or because their gain at the
    /// struck position is 0.
    pub decayed_mode_frames: u32,
    /// Mode-frames of strikers' banks among those that ran.
    pub striker_mode_frames: u32,
    /// Pad-frames in which a force was there.
    pub force_frames: u32,
    /// Frames times contacts under way.
    pub contact_frames: u32,
    /// Frames in which an acceleration sound was computed, all pads.
    pub acceleration_frames: u32,
    /// Frames in which a direct force was taken in.
    pub direct_frames: u32,
    /// Strikes that began.
    pub strikes: u32,
    /// Contacts that a new one displaced, because all places were taken.
    pub displaced_contacts: u32,
    /// Strikes at a third position while contacts at two others were under way on the pad: they drive the nearer of these.
    pub merged_positions: u32,
    /// Guards beyond the one a tick.
    pub extra_guards: u32,
    /// Runs of register groups whose input was refused for want of headroom.
    pub refused_inputs: u32,
    /// Residuals, dynamic filters and biquads that strikes did not begin for want of time.
    pub refused_stages: u32,
    /// Modes that retired at this tick.
    pub retired_modes: u32,
    /// Bound of the amplitude that is missing by retirement, 1.0 = full scale; below 10^-5.
    pub retired_amplitude: f32,
    /// What was left out for want of time in this tick.
    pub shed: Shed,
    /// What the tick was made of, as far as it costs time; nothing without a budget.
    pub counts: Counts,
    /// Pads that ring at the tick's end.
    pub ringing_pads: u32,
    /// Contacts under way at the tick's end.
    pub contacts: u32,
    /// Frames of residuals that were rendered, all pads.
    pub residual_frames: u32,
    /// Frames of background that were rendered.
    pub background_frames: u32,
    /// Frames in which the room answered.
    pub room_frames: u32,
    /// Residuals that sound at the tick's end, the background among them.
    pub residuals: u32,
    /// Frames of dynamic filters that were rendered, all pads.
    pub filter_frames: u32,
    /// Frames times banded waveguides round dynamic filters that ran.
    pub loop_frames: u32,
    /// Frames times biquads that ran.
    pub biquad_frames: u32,
    /// Pads whose dynamic filter or biquads sound at the tick's end.
    pub filters: u32,
}

impl TickReport {
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
        direct_frames: 0,
        strikes: 0,
        displaced_contacts: 0,
        merged_positions: 0,
        extra_guards: 0,
        refused_inputs: 0,
        refused_stages: 0,
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

    /// Cycles that the tick was expected to take; 0 without a budget.
    pub fn predicted_cycles(&self) -> u32 {
        self.counts.cycles()
    }

    /// Mode-frames that ran.
    pub fn run_mode_frames(&self) -> u32 {
        self.driven_mode_frames + self.free_mode_frames
    }

    /// The next tick.
    pub(super) fn begin(&mut self, frame: u64) {
        // Counts are long, and there are none without a budget.
        self.forget_counts();
        *self = Self { frame, counts: self.counts, ..Self::EMPTY };
    }

    fn forget_counts(&mut self) {
        if self.counts.is_any() {
            self.counts = Counts::NONE;
        }
    }

    /// The next tick in which nothing runs.
    pub(super) fn begin_idle(&mut self, frame: u64) {
        (self.frame, self.unstruck_mode_frames, self.decayed_mode_frames) = (frame, 0, 0);
        self.forget_counts();
    }

    /// Frames in which nothing ran.
    pub(super) fn pass_idle(&mut self, unstruck_modes: u32, modes: u32, frames: usize) {
        self.unstruck_mode_frames += unstruck_modes * frames as u32;
        self.decayed_mode_frames += (modes - unstruck_modes) * frames as u32;
    }

    /// A pad without force, that ran so many mode-frames (object, strikers).
    pub(super) fn add_ringing(&mut self, voice: &Voice<'_, '_>, (object, strikers): (u32, u32), frames: usize) {
        let skipped = (voice.mode_count() * frames) as u32 - (object + strikers);
        match voice.was_struck() {
            true => self.decayed_mode_frames += skipped,
            false => self.unstruck_mode_frames += skipped,
        }
        self.free_mode_frames += object + strikers;
        self.striker_mode_frames += strikers;
    }

    /// A run of a pad whose filters had a part in it.
    pub(super) fn add_filtered(&mut self, voice: &Voice<'_, '_>, (ran, work): (Ran, FilterWork), frames: usize) {
        match ran {
            Ran::Driven(work) => self.add(voice, &work, frames),
            Ran::Ringing(object, strikers) => self.add_ringing(voice, (object, strikers), frames),
        }
        self.filter_frames += work.filter_frames;
        self.loop_frames += work.loop_frames;
        self.biquad_frames += work.biquad_frames;
    }

    pub(super) fn add(&mut self, voice: &Voice<'_, '_>, work: &PadWork, frames: usize) {
        let mut banks = work.object;
        banks += work.strikers;
        let run = banks.driven_mode_frames + banks.free_mode_frames;
        let skipped = ((voice.mode_count() * frames) as u32).saturating_sub(run);
        match voice.was_struck() {
            true => self.decayed_mode_frames += skipped,
            false => self.unstruck_mode_frames += skipped,
        }
        self.driven_mode_frames += banks.driven_mode_frames;
        self.free_mode_frames += banks.free_mode_frames;
        self.striker_mode_frames += work.strikers.driven_mode_frames + work.strikers.free_mode_frames;
        self.extra_guards += banks.extra_guards;
        self.refused_inputs += banks.refused;
        self.force_frames += work.force_frames;
        self.acceleration_frames += work.acceleration_frames;
        self.direct_frames += work.direct_frames;
    }
}
