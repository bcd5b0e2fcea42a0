//! What an engine is set up for, and which stages of a kit there is time for.

use super::error::LoadError;
use super::stage::Stage;
use crate::SampleRate;

/// What an engine leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Skipping {
    /// Everything that cannot be heard: pads at rest, input work without force, modes that have decayed.
    On,
    /// Nothing that was built: every mode runs with its input in every frame. For measuring.
    Off,
}

/// What an engine is set up for, beside its kit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// Sample rate.
    pub rate: SampleRate,
    /// What is left out while it plays.
    pub skipping: Skipping,
    /// Most samples in the delay lines of the room. A room with fewer keeps its decay, with fewer resonances.
    pub room_samples: usize,
    /// Ceiling of the limiter on the stereo sum in dB of full scale, -40 to 0; `None` for no limiter.
    pub ceiling_db: Option<f32>,
}

impl Setup {
    /// An engine that skips what cannot be heard, with a room as large as bands can use: 49 152 samples.
    pub const fn new(rate: SampleRate) -> Self {
        Self { rate, skipping: Skipping::On, room_samples: 49_152, ceiling_db: None }
    }
}

/// Worst cycles of a pad in the two runs of a tick with a strike, sounding or not.
const PAD_CYCLES: u32 = 1_600;

/// Time for the stages of a kit while it is loaded, and what becomes of a stage that does not fit.
///
/// The budget sheds modes, of which the quietest can go at any time. A stage is either there or not, and costs what it costs while it sounds. So a stage
/// is begun by a strike only where there is time for it beside those that sound already: a rule of the events alone, which needs no log to play to the same bits.
pub(super) struct Fitting<'f> {
    /// Cycles that are left; `None`: as many as it takes.
    cycles: Option<u32>,
    /// Is told of each stage that is left out; `None`: such a stage is an error.
    tell: Option<&'f mut dyn FnMut(LoadError)>,
}

impl<'f> Fitting<'f> {
    /// All stages, however long they take.
    pub(super) const ALL: Self = Self { cycles: None, tell: None };

    /// The stages for which there is time in so many cycles a tick, beside those of `pads` pads.
    pub(super) fn within(cycles: u32, pads: usize, tell: &'f mut dyn FnMut(LoadError)) -> Self {
        Self { cycles: Some(cycles.saturating_sub(pads as u32 * PAD_CYCLES)), tell: Some(tell) }
    }

    /// Leaves a stage out, which is told.
    ///
    /// # Errors
    /// The error given, where nobody is told.
    pub(super) fn leave_out(&mut self, error: LoadError) -> Result<(), LoadError> {
        match &mut self.tell {
            Some(tell) => {
                tell(error);
                Ok(())
            }
            None => Err(error),
        }
    }

    /// Worst cycles of a stage of so many nominal ones a tick, 0 without a limit. `None` where there is not even time for it alone, which is told.
    pub(super) fn afford(&mut self, stage: Stage, cycles: u32) -> Option<u32> {
        let Some(left) = self.cycles else { return Some(0) };
        let cycles = stage.worst_cycles(cycles);
        if left < cycles {
            if let Some(tell) = &mut self.tell {
                tell(LoadError::TooDear { stage, cycles, left });
            }
            return None;
        }
        Some(cycles)
    }

    /// Takes the time of a stage that sounds for good; false where there is none for it.
    pub(super) fn take(&mut self, stage: Stage, cycles: u32) -> bool {
        let afforded = self.afford(stage, cycles);
        if let Some(left) = &mut self.cycles {
            *left -= afforded.unwrap_or(0);
        }
        afforded.is_some()
    }

    /// Cycles that are left for stages that strikes begin; `None`: as many as they take.
    pub(super) fn left(&self) -> Option<u32> {
        self.cycles
    }
}

/// Cycles that are left for the stages that a strike begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Left {
    /// `None`: as many as it takes.
    cycles: Option<u32>,
    /// Number of stages that were not begun.
    pub(super) refused: u32,
}

impl Left {
    /// What `sounding` stages leave of `most` cycles.
    pub(super) fn new(most: Option<u32>, sounding: u32) -> Self {
        Self { cycles: most.map(|most| most.saturating_sub(sounding)), refused: 0 }
    }

    /// True if there is time for a stage of so many cycles, which are then taken. A stage that `sounds` already has its time.
    pub(super) fn admits(&mut self, sounds: bool, cycles: u32) -> bool {
        let Some(left) = self.cycles.as_mut().filter(|_| !sounds) else { return true };
        let admits = cycles <= *left;
        if admits {
            *left -= cycles;
        } else {
            self.refused += 1;
        }
        admits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strike_takes_time_only_for_what_does_not_sound_yet() {
        let mut left = Left::new(Some(10_000), 4_000);
        assert!(left.admits(true, 9_000), "it sounds, and has its time");
        assert!(left.admits(false, 5_000) && !left.admits(false, 1_001) && left.admits(false, 1_000));
        assert_eq!(left.refused, 1);
        let mut unlimited = Left::new(None, u32::MAX);
        assert!(unlimited.admits(false, u32::MAX) && unlimited.refused == 0);
    }

    #[test]
    fn a_stage_that_sounds_on_takes_its_time_for_good_and_one_too_dear_is_told() {
        let mut told = std::vec::Vec::new();
        let mut tell = |error| told.push(error);
        let mut fitting = Fitting::within(40_000 + 2 * PAD_CYCLES, 2, &mut tell);
        assert!(fitting.take(Stage::Room, 10_000));
        let left = 40_000 - Stage::Room.worst_cycles(10_000);
        assert_eq!(fitting.left(), Some(left));
        assert!(fitting.afford(Stage::Residual(1), 8_000).is_some() && fitting.left() == Some(left));
        assert!(fitting.afford(Stage::Biquads(0), 40_000).is_none());
        let cycles = Stage::Biquads(0).worst_cycles(40_000);
        assert_eq!(told, [LoadError::TooDear { stage: Stage::Biquads(0), cycles, left }]);
    }
}
