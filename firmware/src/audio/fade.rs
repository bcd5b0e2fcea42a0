//! Way from sound to silence, and who holds the sound's state.

use core::sync::atomic::{AtomicBool, AtomicU8, Ordering};

use super::instrument::Instrument;

/// Who may use the sound's state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Holder {
    /// Nobody: the sound has not been started.
    Nobody = 0,
    /// Interrupt of the stream.
    Interrupt = 1,
    /// Task that asked for silence.
    Task = 2,
}

static HOLDER: AtomicU8 = AtomicU8::new(Holder::Nobody as u8);
/// True while a task waits for silence.
static WISH: AtomicBool = AtomicBool::new(false);

/// Asks for silence, or no more.
pub(super) fn wish(is_asked: bool) {
    WISH.store(is_asked, Ordering::Relaxed);
}

impl Holder {
    pub(super) fn get() -> Self {
        match HOLDER.load(Ordering::Acquire) {
            1 => Self::Interrupt,
            2 => Self::Task,
            _ => Self::Nobody,
        }
    }

    pub(super) fn set(self) {
        HOLDER.store(self as u8, Ordering::Release);
    }
}

/// Number of halves of the way to level 0: 20 ms, and one half.
const LEVEL_HALVES: u8 = 31;
/// Number of halves until the sound has ended and both halves of the buffer are silent.
const END_HALVES: u8 = LEVEL_HALVES + 9;

/// Way to silence: the number of halves since it began, 0 without one.
pub(super) struct Fade(u8);

impl Fade {
    /// Sound that goes on.
    pub(super) const NONE: Self = Self(0);

    /// Takes a step of a half; returns true if the sound fades.
    pub(super) fn step(&mut self, instrument: &mut Instrument) -> bool {
        if !WISH.load(Ordering::Relaxed) {
            return false;
        }
        match self.0 {
            0 => {
                instrument.forget_events();
                instrument.mute();
            }
            LEVEL_HALVES => instrument.end(),
            _ => {}
        }
        self.0 = self.0.saturating_add(1);
        true
    }

    /// Returns true if nothing sounds any more, and all that was rendered has been zeros.
    pub(super) fn is_over(&self) -> bool {
        self.0 >= END_HALVES
    }
}
