//! Recording of a run, besides the streams of the I2S.

use super::rcc::ResetCause;

/// Reset of the chip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reset {
    /// Time of the reset, in seconds from power-on.
    pub(crate) at_s: f64,
    /// Cause of the reset.
    pub(crate) cause: ResetCause,
}

/// Change of a LED.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LedChange {
    /// Time of the change, in seconds from power-on.
    pub(crate) at_s: f64,
    /// Number of the LED in the order of [`crate::Wiring::leds`].
    pub(crate) led: usize,
    /// True if the LED is lit from then on.
    pub(crate) lit: bool,
}

/// Change of the converter behind the I2S between audible and mute, by its mute pin, its reset pin
/// or its registers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MuteChange {
    /// Time of the change, in seconds from power-on.
    pub(crate) at_s: f64,
    /// True if the converter is mute from then on.
    pub(crate) mute: bool,
}

/// Change of the level at which the codec's headphones play.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct VolumeChange {
    /// Time of the change, in seconds from power-on.
    pub(crate) at_s: f64,
    /// Level of left and right in dB from then on, `None` for a side that is mute.
    pub(crate) headphones_db: [Option<f64>; 2],
}

/// Step of the audio DMA to the other half of its buffer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AudioHalf {
    /// Cycle of the step.
    pub(crate) cycle: u64,
    /// True if the flag of the half before was still set, so that the program had not finished with
    /// the half that is played from then on.
    pub(crate) late: bool,
}

/// Recording of a run so far.
#[derive(Debug, Default)]
pub(crate) struct Recording {
    pub(crate) resets: Vec<Reset>,
    pub(crate) leds: Vec<LedChange>,
    pub(crate) mutes: Vec<MuteChange>,
    pub(crate) volumes: Vec<VolumeChange>,
    /// Faults of the program that a chip would let pass, each once.
    pub(crate) warnings: Vec<String>,
    /// Steps of the audio DMA to the other half of its buffer.
    pub(crate) audio_halves: Vec<AudioHalf>,
}

impl Recording {
    /// Records a reset.
    pub(crate) fn reset(&mut self, at_s: f64, cause: ResetCause) {
        self.resets.push(Reset { at_s, cause });
    }

    /// Records changes of the LEDs. `lit` tells for each LED if it is lit now.
    pub(crate) fn leds_changed(&mut self, at_s: f64, lit: impl Iterator<Item = bool>) {
        for (led, lit) in lit.enumerate() {
            let before = self.leds.iter().rev().find(|change| change.led == led).is_some_and(|change| change.lit);
            if lit != before {
                self.leds.push(LedChange { at_s, led, lit });
            }
        }
    }

    /// Records if the converter is mute now. It is mute at power-on.
    pub(crate) fn mute_changed(&mut self, at_s: f64, mute: bool) {
        if mute != self.mutes.last().is_none_or(|change| change.mute) {
            self.mutes.push(MuteChange { at_s, mute });
        }
    }

    /// Records the level of the codec's headphones. They are mute at power-on.
    pub(crate) fn volume_changed(&mut self, at_s: f64, headphones_db: [Option<f64>; 2]) {
        if headphones_db != self.volumes.last().map_or([None; 2], |change| change.headphones_db) {
            self.volumes.push(VolumeChange { at_s, headphones_db });
        }
    }

    /// Records a warning once.
    pub(crate) fn warn(&mut self, warning: &str) {
        if !self.warnings.iter().any(|known| known == warning) {
            self.warnings.push(warning.to_owned());
        }
    }
}
