//! Silence in which a task may change the kit or let the core stand still.
//!
//! ```text
//! task       hush() ............................................ drop(Hushed)
//! interrupt  level 0 ──20 ms──► silence ──4 ms──► zeros, Holder::Task   plays on
//! ```
//!
//! The sound goes to level 0 and then ends, by events that the log tells, so that the PC plays the
//! same. Strikes and notes of that time are not played.

use dsp_core::table::Kit;
use dsp_core::trigger::TriggerError;

use super::fade::{Fade, Holder, wish};
use super::i2s::{self, Told};
use super::instrument::Instrument;
use super::interrupt::{AUDIO, Audio};
use crate::half::HALF_FRAMES;
use crate::input::Overrides;
use crate::{cycles, watchdog};

/// Sound that is silent, held by a task until it is dropped.
pub struct Hushed(&'static mut Audio);

/// Waits until the sound has faded out, 27 ms, and takes it from its interrupt.
///
/// The watchdog then waits as long as while a kit is loaded. Returns `None` if there is no sound
/// yet, or another holder.
pub fn hush() -> Option<Hushed> {
    if Holder::get() != Holder::Interrupt {
        return None;
    }
    wish(true);
    while Holder::get() != Holder::Task {
        cortex_m::asm::wfi();
    }
    wish(false);
    watchdog::expect_loading();
    // SAFETY: the interrupt has given the state away, and takes it back only behind this value.
    Some(Hushed(unsafe { AUDIO.get() }))
}

impl Hushed {
    /// Instrument, which plays nothing.
    pub fn instrument(&mut self) -> &mut Instrument {
        self.0.instrument
    }

    /// Changes the settings of the inputs.
    ///
    /// # Errors
    /// [`TriggerError`] if a trigger or a button cannot be set as the kit says. Nothing changes
    /// then.
    pub fn set_inputs(&mut self, kit: &Kit<'static>, board: &Overrides) -> Result<(), TriggerError> {
        self.0.inputs.set(kit, board)
    }

    /// Changes the kit and the channel of the MIDI.
    pub fn set_keyboard(&mut self, kit: Kit<'static>, channel: Option<u8>) {
        self.0.midi.set(kit, channel);
    }
}

impl Drop for Hushed {
    fn drop(&mut self) {
        let audio = &mut *self.0;
        audio.fade = Fade::NONE;
        audio.instrument.forget_events();
        audio.instrument.restore_level();
        audio.midi.forget_waiting();
        // Samples and presses of the silence are not played.
        audio.inputs.forget_anchor();
        if audio.i2s.take() == Told::TransferError {
            audio.i2s.start();
        }
        (audio.last, audio.played, audio.silent_halves) = (cycles::now(), audio.i2s.half_played(), 0);
        watchdog::expect_sound();
        Holder::Interrupt.set();
    }
}

/// Waits until the next interrupt of the sound is at least `frames` away. Where the sound takes all
/// the time it waits for 100 ms at most.
pub fn wait_for_gap(frames: usize) {
    const PATIENCE_HALVES: usize = 150;
    for _ in 0..PATIENCE_HALVES {
        if HALF_FRAMES - i2s::position() % HALF_FRAMES >= frames {
            return;
        }
        // An interrupt of the stream comes each half.
        cortex_m::asm::wfi();
    }
}
