//! Which of a kit's stages an engine has room for, where it is not to refuse the others, and which sound at once.
//!
//! The budget sheds modes, of which the quietest can go at any time. A stage is either there or not, and costs what it costs while it sounds. So a stage
//! is begun by a strike only where there is time for it beside those that sound already: a rule of the events alone, which needs no log to play to the same bits.

use core::fmt;

use super::LoadError;
use super::cost::{CYCLES, Part};
use crate::resonator::TICK_FRAMES;

/// What a kit has beside its pads' contacts and modes, in the order in which an engine makes room for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The residual of a pad's object.
    Residual(u8),
    /// The background.
    Background,
    /// The dynamic filter of a pad's object, with its loops.
    DynamicFilter(u8),
    /// The biquads of a pad's object.
    Biquads(u8),
    /// The room.
    Room,
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Residual(pad) => write!(f, "pad {pad}, residual of its object"),
            Self::Background => write!(f, "background"),
            Self::DynamicFilter(pad) => write!(f, "pad {pad}, dynamic filter of its object"),
            Self::Biquads(pad) => write!(f, "pad {pad}, biquads of its object"),
            Self::Room => write!(f, "the room"),
        }
    }
}

impl Stage {
    /// What the stage takes at the dearest, in a tick with a strike, where `cycles` are its own nominal ones: with what its pad does for it, and the cycle
    /// model's worst case and the waits of flash, by measurements on the virtual boards (`cargo test -p virtual-board --test boards stages`).
    fn worst_cycles(self, cycles: u32) -> u32 {
        let frames = TICK_FRAMES as u32;
        let (beside, percent) = match self {
            Self::Residual(_) | Self::Background => (of(Part::ResidualStrike) + of(Part::ResidualRun), 150),
            Self::DynamicFilter(_) => (2 * of(Part::BusPad) + frames * of(Part::BusFrame), 200),
            Self::Biquads(_) => {
                (of(Part::BusDrivenPad) + frames * (of(Part::DrivenFrame) + of(Part::ContactFrame)), 175)
            }
            Self::Room => (0, 115),
        };
        (cycles + beside) * percent / 100
    }
}

/// What a pad of the kit takes in the two runs of a tick with a strike, likewise, sounding or not.
const PAD_CYCLES: u32 = 1_600;

fn of(part: Part) -> u32 {
    CYCLES.get(part as usize).copied().unwrap_or(0)
}

/// Cycles that are left for what a strike begins.
#[derive(Clone, Copy, Debug)]
pub struct Left {
    /// `None`: as many as it takes.
    cycles: Option<u32>,
    /// Stages that were not begun.
    pub(super) refused: u32,
}

impl Left {
    /// Of `most` cycles, where `sounding` are taken.
    pub(super) fn new(most: Option<u32>, sounding: u32) -> Self {
        Self { cycles: most.map(|most| most.saturating_sub(sounding)), refused: 0 }
    }

    /// Whether there is time for a stage that takes so many, which are then taken. One that `sounds` already has its time.
    pub fn admits(&mut self, sounds: bool, cycles: u32) -> bool {
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

/// What becomes of stages for which there is no memory or no time: everything is asked for, or what fits within so many cycles.
pub trait Fitting {
    /// Whether somebody is told of what is left out: where nobody is, nothing looks for it.
    const TELLS: bool;

    /// A stage that cannot be: left out and told, or refused.
    ///
    /// # Errors
    /// What was given, where it is refused.
    fn leave_out(&mut self, error: LoadError) -> Result<(), LoadError>;

    /// A stage that the engine has neither memory nor code for.
    fn pass_over(&mut self, stage: Stage);

    /// What a stage of so many nominal cycles a tick takes while it sounds; where there is not even time for it alone, it is told, and left out.
    fn afford(&mut self, stage: Stage, cycles: u32) -> Option<u32>;

    /// The same for a stage that sounds on: what it takes is no more there for others.
    fn take(&mut self, stage: Stage, cycles: u32) -> bool;

    /// What is left for stages that strikes begin; `None`: all that they take.
    fn left(&self) -> Option<u32>;
}

/// All time; what finds no memory is refused, and what the engine has no code for is passed over.
pub(super) struct All;

impl Fitting for All {
    const TELLS: bool = false;

    fn leave_out(&mut self, error: LoadError) -> Result<(), LoadError> {
        Err(error)
    }

    fn pass_over(&mut self, _: Stage) {}

    fn afford(&mut self, _: Stage, _: u32) -> Option<u32> {
        Some(0)
    }

    fn take(&mut self, _: Stage, _: u32) -> bool {
        true
    }

    fn left(&self) -> Option<u32> {
        None
    }
}

/// What is left for stages, and who is told of what is left out.
pub(super) struct Within<'f> {
    cycles: u32,
    tell: &'f mut dyn FnMut(LoadError),
}

impl<'f> Within<'f> {
    /// So many cycles a tick beside what so many pads take.
    pub(super) fn new(cycles: u32, pads: usize, tell: &'f mut dyn FnMut(LoadError)) -> Self {
        Self { cycles: cycles.saturating_sub(pads as u32 * PAD_CYCLES), tell }
    }
}

impl Fitting for Within<'_> {
    const TELLS: bool = true;

    fn leave_out(&mut self, error: LoadError) -> Result<(), LoadError> {
        (self.tell)(error);
        Ok(())
    }

    fn pass_over(&mut self, stage: Stage) {
        (self.tell)(LoadError::NoPlace { stage });
    }

    fn afford(&mut self, stage: Stage, cycles: u32) -> Option<u32> {
        let cycles = stage.worst_cycles(cycles);
        if self.cycles < cycles {
            (self.tell)(LoadError::TooDear { stage, cycles, left: self.cycles });
            return None;
        }
        Some(cycles)
    }

    fn take(&mut self, stage: Stage, cycles: u32) -> bool {
        let afforded = self.afford(stage, cycles);
        self.cycles -= afforded.unwrap_or(0);
        afforded.is_some()
    }

    fn left(&self) -> Option<u32> {
        Some(self.cycles)
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
    fn what_sounds_on_takes_its_time_for_good_and_what_alone_is_too_dear_is_told() {
        let mut told = std::vec::Vec::new();
        let mut tell = |error| told.push(error);
        let mut fitting = Within::new(40_000 + 2 * PAD_CYCLES, 2, &mut tell);
        assert!(fitting.take(Stage::Room, 10_000));
        let left = 40_000 - Stage::Room.worst_cycles(10_000);
        assert_eq!(fitting.left(), Some(left));
        assert!(fitting.afford(Stage::Residual(1), 8_000).is_some() && fitting.left() == Some(left));
        assert!(fitting.afford(Stage::Biquads(0), 40_000).is_none());
        let cycles = Stage::Biquads(0).worst_cycles(40_000);
        assert_eq!(told, [LoadError::TooDear { stage: Stage::Biquads(0), cycles, left }]);
    }
}
