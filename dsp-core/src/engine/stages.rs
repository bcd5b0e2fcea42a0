//! Stages beside the modes: their strikes and chokes, their cost, and which of them sound.
//!
//! A stage of a voice has six methods. `strike` and `set_choked` tell it of events, `render` adds a
//! run to a bus, and `end_tick` works ahead if the stage needs to. `cycles` gives the cost of a
//! tick, and `is_active` is true while the stage sounds.

use super::load::{ROOM_BAND_TICK, ROOM_TICK};
use super::setup::CyclesLeft;
use super::stage::Stage;
use super::state::Engine;
use crate::built::Built;
use crate::fixed::ONE_Q27;
use crate::frames::{BLOCK_FRAMES, FrameMixer};
use crate::limiter;
use crate::room::{Room, Sample};
use crate::time::TICK_FRAMES;
use crate::voice::{Filters, Residual, Voice, nepers_per_frame};

/// Nominal cycles of a tick of a silent room.
const SILENT_ROOM_TICK: u32 = 520;

impl<S: Sample> Engine<'_, '_, S> {
    /// Strikes the residual and the filters of a pad, as far as there is time; `peak` is the peak
    /// force in bus steps.
    #[inline(never)] // must not weigh on kits without these stages
    pub(super) fn strike_stages(&mut self, pad: u8, peak: i32) {
        let sounding = if self.stage_cycles.is_some() { self.sounding_cycles() } else { 0 };
        let mut left = CyclesLeft::new(self.stage_cycles, sounding);
        let frame = (self.now % TICK_FRAMES as u64) as usize;
        let level = peak as f32 / ONE_Q27 as f32;
        let Some(voice) = self.voices.get_mut(usize::from(pad)) else { return };
        if let Some(residual) = voice.residual.as_deref_mut()
            && left.admits(residual.is_active(), residual.worst_cycles)
        {
            residual.strike(level, frame);
        }
        if let Some(filters) = voice.filters.as_deref_mut() {
            let ([has_dynamic, has_biquads], [dynamic_sounds, biquads_sound]) = (filters.parts(), filters.sounding());
            let [of_dynamic, of_biquads] = filters.worst_cycles;
            let dynamic = has_dynamic && left.admits(dynamic_sounds, of_dynamic);
            let biquads = has_biquads && left.admits(biquads_sound, of_biquads);
            filters.strike(level, frame, [dynamic, biquads]);
        }
        self.report.refused_stages += left.refused;
    }

    /// Worst cycles of the residuals, filters and contacts that go on.
    fn sounding_cycles(&self) -> u32 {
        // No pad has a striker of this number.
        self.sounding_cycles_beside((u8::MAX, u8::MAX))
    }

    /// Worst cycles of the residuals, filters and contacts that go on, without that of a pad's
    /// striker.
    pub(super) fn sounding_cycles_beside(&self, touching: (u8, u8)) -> u32 {
        let of_residual = |residual: &Residual<'_>| if residual.is_active() { residual.worst_cycles } else { 0 };
        let of_filters = |filters: &Filters<'_>| {
            let parts = filters.sounding().into_iter().zip(filters.worst_cycles);
            parts.map(|(sounds, cycles)| if sounds { cycles } else { 0 }).sum()
        };
        let of_voice = |voice: &Voice<'_, '_>| -> u32 {
            voice.residual.as_deref().map_or(0, of_residual) + voice.filters.as_deref().map_or(0, of_filters)
        };
        let scrapes = self.scrapes.dearest_ticks(touching).map(|cycles| Stage::Scrapes.worst_cycles(cycles));
        let of_scrapes: u32 = if cfg!(feature = "scrapes") { scrapes.sum() } else { 0 };
        self.voices.iter().map(of_voice).sum::<u32>() + of_scrapes
    }

    /// Chokes the residual and the filters of a pad, or releases them, on a tick.
    #[inline(never)] // must not weigh on kits without these stages
    pub(super) fn choke_stages(&mut self, number: u8, is_choked: bool) {
        let pad = self.kit.pads().nth(usize::from(number));
        let t60_s = pad.map_or(0.0, |pad| pad.choke_t60_s());
        let is_choked = is_choked && t60_s > 0.0;
        let rate = self.rate;
        let Some(voice) = self.voices.get_mut(usize::from(number)) else { return };
        if let Some(residual) = voice.residual.as_deref_mut() {
            residual.set_choked(is_choked);
        }
        if let Some(filters) = voice.filters.as_deref_mut() {
            filters.set_choked(is_choked.then(|| nepers_per_frame(t60_s, rate)));
        }
    }

    /// Renders a run of the stages that work on the stereo bus: background, residuals, room,
    /// limiter.
    #[inline(always)]
    pub(super) fn render_bus_stages(&mut self, out: &mut [[i32; 2]]) {
        if self.frames.is_some() {
            self.render_frames(out);
        }
        self.render_noise(out);
        self.render_room(out);
        self.fader.render(out);
        if let Some(limiter) = &mut self.limiter {
            limiter.render((self.now % TICK_FRAMES as u64) as usize, out);
        }
    }

    /// Begins a block of the pads in frames, where one begins.
    #[inline(never)] // must not weigh on kits without frames
    pub(super) fn begin_frames_tick(&mut self) {
        if let Some(mixer) =
            self.frames.as_deref_mut().filter(|_| !self.idle && self.now.is_multiple_of(BLOCK_FRAMES as u64))
        {
            mixer.begin_block(self.voices);
        }
        self.frames_tick_cycles = self.frames.as_deref().map_or(0, FrameMixer::tick_cycles) * self.loop_percent / 100;
    }

    /// Adds the block of the pads in frames that plays to a run of the stereo bus.
    #[inline(never)] // its registers must not weigh on kits without frames
    fn render_frames(&mut self, out: &mut [[i32; 2]]) {
        if let Some(mixer) = &self.frames {
            mixer.render((self.now % BLOCK_FRAMES as u64) as usize, out);
        }
    }

    /// Works on the next block of the pads in frames, and counts the pads that sound; `now` is the
    /// frame behind the tick.
    #[inline(never)]
    pub(super) fn end_frames_tick(&mut self) {
        let Some(mixer) = &mut self.frames else { return };
        let tick = (self.now.wrapping_sub(1) % BLOCK_FRAMES as u64) as usize / TICK_FRAMES;
        let retired_beside = self.voices.iter().map(Voice::retired_amplitude).sum();
        self.report.retired_modes += mixer.end_tick(tick, retired_beside, self.voices);
        self.retired_in_frames = self.voices.iter().map(Voice::retired_in_frames).sum();
        // A pad whose striker's bank rings has been counted.
        let sound = |voice: &&Voice<'_, '_>| voice.sounds_in_frames() && !voice.is_ringing();
        self.report.ringing_pads += self.voices.iter().filter(sound).count() as u32;
    }

    /// True if no block in frames has any sound.
    #[inline(always)]
    pub(super) fn frames_are_silent(&self) -> bool {
        self.frames.as_deref().is_none_or(FrameMixer::is_silent)
    }

    /// True if no stage on the stereo bus gives any sound until something goes in.
    #[inline(always)]
    pub(super) fn bus_stages_are_silent(&self) -> bool {
        self.frames_are_silent()
            && self.room_is_silent()
            && self.limiter.as_ref().is_none_or(|limiter| limiter.is_silent())
    }

    /// Nominal cycles of noise, room, filters and limiter in this tick.
    #[inline(always)]
    pub(super) fn stage_cycles_ahead(&self) -> u32 {
        let limiter = if self.limiter.is_some() { limiter::TICK_CYCLES } else { 0 };
        self.frames_tick_cycles
            + self.noise_cycles()
            + self.room_cycles()
            + self.filter_cycles()
            + self.fader.cycles()
            + limiter
    }

    /// Adds background and residuals to a run of the stereo bus.
    #[inline(always)]
    fn render_noise(&mut self, out: &mut [[i32; 2]]) {
        if self.noisy {
            self.add_noise(out);
        }
    }

    #[inline(never)] // its buffer and registers must not weigh on kits without noise
    fn add_noise(&mut self, out: &mut [[i32; 2]]) {
        if let Some(background) = self.background.as_deref_mut() {
            let mut sound = [0; TICK_FRAMES];
            if let Some(sound) = sound.get_mut(..out.len()) {
                background.render(sound);
                self.centre.render(sound, out);
                self.report.background_frames += out.len() as u32;
            }
        }
        for voice in &mut *self.voices {
            self.report.residual_frames += voice.render_residual(out);
        }
    }

    /// Background and residuals that have been loaded.
    fn noise(&self) -> impl Iterator<Item = &Residual<'_>> {
        let residuals = self.voices.iter().filter_map(|voice| voice.residual.as_deref());
        self.background.as_deref().into_iter().chain(residuals)
    }

    /// Works on noise to come, at a tick's end.
    #[inline(always)]
    pub(super) fn end_noise_tick(&mut self) {
        if self.noisy {
            self.work_on_noise();
        }
    }

    #[inline(never)]
    fn work_on_noise(&mut self) {
        let dear_ticks = self.dear_ticks();
        if let Some(background) = self.background.as_deref_mut() {
            background.end_tick(dear_ticks);
        }
        for residual in self.voices.iter_mut().filter_map(|voice| voice.residual.as_deref_mut()) {
            residual.end_tick(dear_ticks);
        }
        self.report.residuals = self.noises() as u32;
    }

    /// Number of ticks, from this one on, that pads in frames make dear, for noise to wait; 0 where
    /// several noises sound, which together would take too much of the ticks behind.
    fn dear_ticks(&self) -> u32 {
        match &self.frames {
            Some(mixer) if self.count_noises() < 2 => mixer.dear_ticks(self.voices),
            _ => 0,
        }
    }

    /// Number of residuals that sound, the background included.
    #[inline(always)]
    pub(super) fn noises(&self) -> usize {
        if self.noisy { self.count_noises() } else { 0 }
    }

    #[inline(never)]
    fn count_noises(&self) -> usize {
        self.noise().filter(|residual| residual.is_active()).count()
    }

    /// Nominal cycles of this tick's work on noise to come.
    #[inline(always)]
    fn noise_cycles(&self) -> u32 {
        if self.noisy { self.cycles_of_noise() } else { 0 }
    }

    #[inline(never)]
    fn cycles_of_noise(&self) -> u32 {
        let dear_ticks = self.dear_ticks();
        self.noise().map(|residual| residual.cycles(dear_ticks)).sum()
    }

    /// True if a strike of a pad begins noise.
    #[inline(always)]
    pub(super) fn has_noise(&self, pad: u8) -> bool {
        self.noisy && self.voices.get(usize::from(pad)).is_some_and(|voice| voice.residual.is_some())
    }

    /// Filters of a pad; `None` if it has none.
    #[inline(always)]
    fn filters_of(&self, pad: u8) -> Option<&Filters<'_>> {
        self.voices.get(usize::from(pad))?.filters.as_deref()
    }

    /// Number of pads whose filters sound.
    #[inline(always)]
    pub(super) fn active_filters(&self) -> u32 {
        if self.filtered { self.count_active_filters() } else { 0 }
    }

    #[inline(never)]
    fn count_active_filters(&self) -> u32 {
        let filters = self.voices.iter().filter_map(|voice| voice.filters.as_deref());
        filters.filter(|filters| filters.is_active()).count() as u32
    }

    /// Nominal cycles of this tick of the filters that sound.
    #[inline(always)]
    fn filter_cycles(&self) -> u32 {
        if self.filtered { self.cycles_of_filters() } else { 0 }
    }

    #[inline(never)]
    fn cycles_of_filters(&self) -> u32 {
        let filters = self.voices.iter().filter_map(|voice| voice.filters.as_deref());
        filters.filter(|filters| filters.is_active()).map(|filters| filters.cycles(false)).sum()
    }

    /// Nominal cycles that a strike of a pad adds to the tick of the pad's filters.
    #[inline(always)]
    pub(super) fn filter_strike_cycles(&self, pad: u8) -> u32 {
        self.filters_of(pad).map_or(0, |filters| {
            let active = if filters.is_active() { filters.cycles(false) } else { 0 };
            filters.cycles(true).saturating_sub(active)
        })
    }

    /// Nominal cycles that a choke or a release adds to the tick of a pad's filters.
    #[inline(always)]
    pub(super) fn filter_choke_cycles(&self, pad: u8) -> u32 {
        self.filters_of(pad).map_or(0, Filters::choke_cycles)
    }

    /// Adds the room's answer to a run of the stereo bus.
    #[inline(always)]
    fn render_room(&mut self, out: &mut [[i32; 2]]) {
        if Built::HERE.room && self.room.is_some() {
            self.add_room(out);
        }
    }

    #[inline(never)] // its registers must not weigh on kits without a room
    fn add_room(&mut self, out: &mut [[i32; 2]]) {
        if let Some(room) = self.room.as_deref_mut() {
            room.render(out);
            self.report.room_frames += if room.is_silent() { 0 } else { out.len() as u32 };
        }
    }

    /// True if the room's output is silent until something comes in.
    #[inline(always)]
    fn room_is_silent(&self) -> bool {
        self.room.as_deref().is_none_or(Room::is_silent)
    }

    /// Lets frames of silence pass in a silent room.
    #[inline(always)]
    pub(super) fn pass_room_silence(&mut self, frames: usize) {
        if Built::HERE.room && self.room.is_some() {
            self.pass_silence_of_room(frames);
        }
    }

    #[inline(never)] // its registers must not weigh on kits without a room
    fn pass_silence_of_room(&mut self, frames: usize) {
        if let Some(room) = self.room.as_deref_mut() {
            room.pass_silence(frames);
        }
    }

    /// Nominal cycles of this tick of the room.
    #[inline(always)]
    fn room_cycles(&self) -> u32 {
        match self.room.as_deref() {
            None => 0,
            Some(room) if room.is_silent() && self.is_silent() => SILENT_ROOM_TICK,
            Some(room) => ROOM_TICK + room.band_count() as u32 * ROOM_BAND_TICK,
        }
    }
}
