//! Input of a board: signals at the pins of the piezos, presses of the button, and faults on
//! request.

use std::path::Path;

use crate::error::BoardError;

/// Signal at a piezo's pin, behind its clamp and bias.
#[derive(Debug, Clone, PartialEq)]
pub struct PiezoSignal {
    /// Number of the piezo, from 0 in the order of [`crate::Wiring::piezos`].
    pub piezo: usize,
    /// Time of the first sample, in seconds from power-on.
    pub start_s: f64,
    /// Sample rate in Hz.
    pub rate_hz: f64,
    /// Samples from -1 at 0 V to 1 at the supply. The clamp limits larger ones.
    pub samples: Vec<f32>,
}

impl PiezoSignal {
    /// Reads the first channel of a WAV file.
    ///
    /// # Errors
    /// [`BoardError::Wave`] if the file cannot be read, or holds a sample that is not finite.
    pub fn from_wav(piezo: usize, start_s: f64, path: &Path) -> Result<PiezoSignal, BoardError> {
        let wrong = |reason: String| BoardError::Wave { path: path.to_owned(), reason };
        let mut reader = hound::WavReader::open(path).map_err(|error| wrong(unreadable(&error)))?;
        let spec = reader.spec();
        let channels = usize::from(spec.channels);
        let samples: Result<Vec<f32>, hound::Error> = match spec.sample_format {
            hound::SampleFormat::Float => reader.samples::<f32>().step_by(channels).collect(),
            hound::SampleFormat::Int => {
                let scale = 1.0 / (1_u64 << (spec.bits_per_sample - 1)) as f32;
                reader
                    .samples::<i32>()
                    .step_by(channels)
                    .map(|sample| sample.map(|sample| sample as f32 * scale))
                    .collect()
            }
        };
        let samples = samples.map_err(|error| wrong(unreadable(&error)))?;
        if let Some(index) = samples.iter().position(|sample| !sample.is_finite()) {
            return Err(wrong(format!("sample {index} is not a finite number; write the file anew")));
        }
        Ok(PiezoSignal { piezo, start_s, rate_hz: f64::from(spec.sample_rate), samples })
    }

    /// Returns the signal at a time in seconds from power-on.
    ///
    /// It is interpolated linearly, and 0 before the first sample and after the last.
    pub(crate) fn at(&self, seconds: f64) -> f32 {
        let position = (seconds - self.start_s) * self.rate_hz;
        if position < 0.0 {
            return 0.0;
        }
        let index = position as usize;
        let Some(&sample) = self.samples.get(index) else { return 0.0 };
        let next = self.samples.get(index + 1).copied().unwrap_or(0.0);
        sample + (next - sample) * (position - index as f64) as f32
    }
}

/// Returns the reason for which a WAV file cannot be read.
fn unreadable(error: &hound::Error) -> String {
    match error {
        hound::Error::IoError(error) => format!("cannot be read: {error}"),
        _ => "is not a WAV file of PCM or floating-point samples; give one".to_owned(),
    }
}

/// Press of the board's button.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Press {
    /// Time of pressing, in seconds from power-on.
    pub at_s: f64,
    /// Time for which the button is held, in seconds.
    pub for_s: f64,
    /// Time for which the contacts bounce after pressing and after releasing, in seconds.
    pub bounce_s: f64,
}

impl Press {
    /// Returns the changes of the contact: a time in seconds, and true if the contact closes.
    ///
    /// Bouncing contacts open and close at irregular intervals from 0.05 to 0.6 ms, which do not
    /// differ from run to run.
    pub(crate) fn changes(&self) -> Vec<(f64, bool)> {
        let mut changes = Vec::new();
        for (start, closed) in [(self.at_s, true), (self.at_s + self.for_s, false)] {
            changes.push((start, closed));
            let mut random = 0x2545_f491_u32;
            let mut time = start;
            loop {
                let mut interval = || {
                    random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    50e-6 + f64::from(random >> 16) / 65_536.0 * 550e-6
                };
                let open = time + interval();
                let close = open + interval();
                if close >= start + self.bounce_s {
                    break;
                }
                changes.push((open, !closed));
                changes.push((close, closed));
                time = close;
            }
        }
        changes
    }
}

/// Fault that happens on request.
#[derive(Debug, Clone, PartialEq)]
pub enum Fault {
    /// The DMA does not fetch one conversion of the ADC in time, which then overruns.
    AdcOverrun {
        /// Time of the fault, in seconds from power-on.
        at_s: f64,
    },
    /// The DMA stream of the I2S ends with a transfer error behind its next item.
    AudioDmaError {
        /// Time of the fault, in seconds from power-on.
        at_s: f64,
    },
    /// The DMA stream of the ADC ends with a transfer error behind its next item.
    AdcDmaError {
        /// Time of the fault, in seconds from power-on.
        at_s: f64,
    },
    /// The codec does not acknowledge anything.
    CodecSilent,
    /// The crystal does not start.
    CrystalDead,
    /// The debug probe does not fetch the log for a while.
    ProbeAway {
        /// Time at which the probe goes, in seconds from power-on.
        at_s: f64,
        /// Time for which the probe is away, in seconds.
        for_s: f64,
    },
    /// Most of the stack is used up at once, as by calls that never return.
    StackUsedUp {
        /// Time of the fault, in seconds from power-on.
        at_s: f64,
        /// Number of bytes that are left.
        left_bytes: u32,
    },
    /// The core executes nothing for a while, as when flash is erased. The peripherals go on.
    CoreStalled {
        /// Beginning of the fault, in seconds from power-on.
        at_s: f64,
        /// Length of the fault, in seconds.
        for_s: f64,
    },
    /// A debugger halts the core for a while. The peripherals go on, but for those that the program
    /// has told to halt with it (DBGMCU).
    Halted {
        /// Beginning of the halt, in seconds from power-on.
        at_s: f64,
        /// Length of the halt, in seconds.
        for_s: f64,
    },
    /// The interrupt of the audio DMA stream does not reach the core.
    AudioInterruptLost {
        /// Beginning of the fault, in seconds from power-on.
        at_s: f64,
        /// Length of the fault, in seconds.
        for_s: f64,
    },
    /// The pin of a piezo is at the supply.
    PiezoAtRail {
        /// Number of the piezo, from 0.
        piezo: usize,
        /// Beginning of the fault, in seconds from power-on.
        at_s: f64,
    },
    /// The program panics.
    ///
    /// The core goes on at `core::panicking::panic` with the message "injected" at
    /// `virtual-board.rs:1:1`.
    Panic {
        /// Time of the fault, in seconds from power-on.
        at_s: f64,
    },
    /// An operation on flash is refused with an error flag (WRPERR), and has no effect.
    FlashError {
        /// Number of the operation since power-on, from 0.
        nth: u64,
    },
    /// Power is lost for the rest of the run. An operation on flash that goes on is broken off.
    PowerLost {
        /// Time of the fault, in seconds from power-on.
        at_s: f64,
        /// Seed of what the operation leaves.
        seed: u64,
    },
    /// Power is lost within an operation on flash, for the rest of the run.
    PowerLostInFlash {
        /// Number of the operation since power-on, from 0.
        nth: u64,
        /// Share of the operation's time after which power is lost, 0 to 1.
        share: f64,
        /// Seed of what the operation leaves.
        seed: u64,
    },
    /// The core goes on at an undefined instruction, which makes a hard fault.
    HardFault {
        /// Time of the fault, in seconds from power-on.
        at_s: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_press_bounces_as_long_as_told_and_ends_released() {
        let press = Press { at_s: 1.0, for_s: 0.1, bounce_s: 5e-3 };
        let changes = press.changes();
        assert!(changes.len() > 10, "{changes:?}");
        assert!(changes.is_sorted_by(|a, b| a.0 <= b.0));
        assert!(changes.iter().all(|(time, _)| (1.0..1.0051).contains(time) || (1.1..1.1051).contains(time)));
        assert_eq!(changes.iter().rfind(|(time, _)| *time < 1.05).map(|change| change.1), Some(true));
        assert_eq!(changes.last().map(|change| change.1), Some(false));
        assert_eq!(Press { bounce_s: 0.0, ..press }.changes(), [(1.0, true), (1.1, false)]);
    }

    #[test]
    fn a_signal_is_a_line_between_samples_and_zero_outside() {
        let signal = PiezoSignal { piezo: 0, start_s: 0.5, rate_hz: 1000.0, samples: vec![1.0, 0.0, -0.5] };
        for (time, expected) in
            [(0.4999, 0.0), (0.5, 1.0), (0.50025, 0.75), (0.5015, -0.25), (0.5025, -0.25), (0.6, 0.0)]
        {
            assert!((signal.at(time) - expected).abs() < 1e-4, "{time}: {}", signal.at(time));
        }
    }
}
