//! What is recorded of a run besides the I2S's streams.

use super::rcc::ResetCause;

/// A reset of the chip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reset {
    /// When, in seconds from power-on.
    pub(crate) at_s: f64,
    /// Why.
    pub(crate) cause: ResetCause,
}

/// A LED that went on or off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LedChange {
    /// When, in seconds from power-on.
    pub(crate) at_s: f64,
    /// Which, in the order of [`crate::Wiring::leds`].
    pub(crate) led: usize,
    /// Whether it is lit from then on.
    pub(crate) lit: bool,
}

/// The converter behind the I2S became audible, or mute: by its mute pin, its reset pin or its registers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MuteChange {
    /// When, in seconds from power-on.
    pub(crate) at_s: f64,
    /// Whether it is mute from then on.
    pub(crate) mute: bool,
}

/// The audio DMA went on to the other half of its buffer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AudioHalf {
    pub(crate) cycle: u64,
    /// The program had not finished with the half that is played from here on: a flag of the last one was still set, or its interrupt
    /// was still being handled.
    pub(crate) late: bool,
}

/// Everything recorded so far.
#[derive(Debug, Default)]
pub(crate) struct Recording {
    pub(crate) resets: Vec<Reset>,
    pub(crate) leds: Vec<LedChange>,
    pub(crate) mutes: Vec<MuteChange>,
    /// What is not an error, and yet wrong; each once.
    pub(crate) warnings: Vec<String>,
    /// The moments at which the audio DMA went on to the other half of its buffer.
    pub(crate) audio_halves: Vec<AudioHalf>,
}

impl Recording {
    pub(crate) fn reset(&mut self, at_s: f64, cause: ResetCause) {
        self.resets.push(Reset { at_s, cause });
    }

    /// The LEDs as they are now, in their order.
    pub(crate) fn leds_changed(&mut self, at_s: f64, lit: impl Iterator<Item = bool>) {
        for (led, lit) in lit.enumerate() {
            let before = self.leds.iter().rev().find(|change| change.led == led).is_some_and(|change| change.lit);
            if lit != before {
                self.leds.push(LedChange { at_s, led, lit });
            }
        }
    }

    /// Whether the converter is mute now; it starts mute.
    pub(crate) fn mute_changed(&mut self, at_s: f64, mute: bool) {
        if mute != self.mutes.last().is_none_or(|change| change.mute) {
            self.mutes.push(MuteChange { at_s, mute });
        }
    }

    pub(crate) fn warn(&mut self, warning: &str) {
        if !self.warnings.iter().any(|known| known == warning) {
            self.warnings.push(warning.to_owned());
        }
    }
}
