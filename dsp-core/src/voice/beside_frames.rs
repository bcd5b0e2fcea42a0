//! Rendering of a pad whose object's modes are in frames: what it does sample by sample.

use super::render::{Ran, take_force};
use super::residual::Residual;
use super::state::{PadWork, Run, Voice};
use crate::contact::ActiveContacts;
use crate::frames::{FrameBank, InFrames};
use crate::time::TICK_FRAMES;

impl Voice<'_, '_> {
    /// Adds a run of a pad whose object's modes are in frames to the stereo bus: its heads, and its
    /// strikers' banks.
    #[inline(never)] // most kits have none
    pub fn render_beside_frames(
        &mut self,
        run: Run<'_>,
        contacts: &mut ActiveContacts<'_>,
        out: &mut [[i32; 2]],
    ) -> Ran {
        match run.has_force || !run.skip {
            true => Ran::Driven(self.drive_beside_frames(run, contacts, out)),
            false => {
                let (object, strikers) = self.ring_beside_frames(run.frames, run.odd_start, out);
                Ran::Ringing(object, strikers)
            }
        }
    }

    /// Adds a run of a pad whose object's modes are in frames to the stereo bus, as
    /// [`Voice::drive`] does.
    fn drive_beside_frames(
        &mut self,
        run: Run<'_>,
        contacts: &mut ActiveContacts<'_>,
        out: &mut [[i32; 2]],
    ) -> PadWork {
        self.wake();
        let mut work = PadWork::default();
        let frames = run.frames.min(TICK_FRAMES);
        let mut force = [0; TICK_FRAMES];
        let Some(force) = force.get_mut(..frames) else { return work };
        if run.has_force {
            self.struck = true;
            work.force_frames = frames as u32;
            work.direct_frames = if run.direct.is_some() { frames as u32 } else { 0 };
        }
        if self.has_second_in_frames(run.direct, contacts) {
            self.drive_both_on_bus(run, contacts, force, out, &mut work);
            return work;
        }
        if self.banks.len() == 1 {
            take_force(self.number, run.direct, contacts, force);
        }
        self.drive_on_bus(run, contacts, force, out, &mut work);
        work
    }

    /// True if the residual goes to the pad's own bus, to be panned with the heads of modes in
    /// frames: panning once takes 14 to 26 cycles a frame less.
    pub(super) fn pans_noise_with_modes(&self) -> bool {
        self.frames.is_some() && self.filters.is_none()
    }

    /// Adds the residual of a pad in frames to the pad's own bus.
    #[inline(always)]
    pub(super) fn add_noise_of_frames(&mut self, bus: &mut [i32]) {
        if self.pans_noise_with_modes()
            && let Some(residual) = self.residual.as_deref_mut()
        {
            residual.render(bus);
        }
    }

    /// True if a force acts at the position of slot 1 of an object in frames.
    pub(super) fn has_second_in_frames(&self, direct: Option<&[i32]>, contacts: &ActiveContacts<'_>) -> bool {
        self.frames.as_deref().is_some_and(FrameBank::has_positions)
            && (contacts.is_any_in(self.number, 1) || direct.is_some() && self.direct_slot() == 1)
    }

    /// Adds a run without force of a pad whose object's modes are in frames to the stereo bus.
    /// Gives its mode-frames as [`Voice::ring`] does.
    fn ring_beside_frames(&mut self, frames: usize, odd_start: bool, out: &mut [[i32; 2]]) -> (u32, u32) {
        let striker_modes = self.banks.iter().map(|bank| bank.running_modes(true)).sum::<u32>();
        let Some(object) = self.frames.as_deref() else { return (0, 0) };
        let (object_modes, is_head_active) = (object.running_modes(), object.is_head_active());
        let has_noise = self.pans_noise_with_modes() && self.residual.as_deref().is_some_and(Residual::is_active);
        if is_head_active || striker_modes > 0 || has_noise {
            self.ring_on_bus(frames, odd_start, out);
        }
        (object_modes * frames as u32, striker_modes * frames as u32)
    }
}

impl<'m> InFrames<'m> for Voice<'_, 'm> {
    fn frames(&self) -> Option<&FrameBank<'m>> {
        self.frames.as_deref()
    }

    fn frames_mut(&mut self) -> Option<&mut FrameBank<'m>> {
        self.frames.as_deref_mut()
    }
}
