//! Setup of an engine, and the choice of stages that there is time for.

use super::error::LoadError;
use super::stage::Stage;
use crate::SampleRate;
use crate::built::Built;
use crate::time::TICK_FRAMES;

/// Work that an engine skips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Skipping {
    /// Skips what cannot be heard: pads at rest, input work without force, modes that have decayed.
    On,
    /// Skips nothing: every mode runs with its input in every frame. For measuring.
    Off,
}

/// Settings of an engine, beside its kit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// Sample rate.
    pub rate: SampleRate,
    /// Optional stages that the engine loads. Those that are not [`Built::HERE`] are left out too.
    pub built: Built,
    /// Work that the engine skips while it plays.
    pub skipping: Skipping,
    /// Maximum number of samples in the delay lines of the room. A room that would need more keeps
    /// its decay, with fewer resonances.
    pub room_samples: usize,
    /// Maximum number of nominal cycles a frame for all pads in frames, each in the dearest tick of
    /// a strike, with 375 for each other pad of the kit. A pad whose trigger is direct counts with
    /// a force that never rests. Pads that find no room stay in the fixed-point bank, whose modes
    /// the [budget](crate::engine::Engine::set_budget) can shed; it cannot shed modes in frames.
    /// `None` means no limit; an engine with a budget needs one. Without one smaller pads play in
    /// frames too: those of [`FEWEST_MODES_OF_SEVERAL`](crate::frames::FEWEST_MODES_OF_SEVERAL) if
    /// they have [`FEWEST_MODES`](crate::frames::FEWEST_MODES) together.
    pub frame_cycles: Option<u32>,
    /// Most nominal cycles that a strike may spend on moving to another position
    /// ([`CostItem::MovedMode`](super::CostItem::MovedMode) a mode,
    /// [`CostItem::MovedGroup`](super::CostItem::MovedGroup) a group); pads that need more are
    /// struck at position 0. `None` means no limit.
    pub position_cycles: Option<u32>,
    /// Least change of a contact's place along its object, of 0 to 1, beyond which the gains follow
    /// it as it scrapes: each time they are all derived anew.
    pub position_step: f32,
    /// Most cycles that frames take, in percent of their nominal ones: what they leave of
    /// `frame_cycles` limits the stages of [`Engine::new_within`](super::Engine::new_within) too.
    pub frame_worst_percent: u32,
    /// Percent of their cycles that the loops over modes, in frames and in kernels, count for in
    /// the [budget](crate::engine::Engine::set_budget): the reserve that it has for the worst case
    /// of straight code is more than loops need, which wait little for flash.
    pub loop_percent: u32,
    /// Ceiling of the limiter on the stereo sum in dB of full scale, -40 to 0; `None` for no
    /// limiter.
    pub ceiling_db: Option<f32>,
}

impl Setup {
    /// Settings that skip what cannot be heard and allow the largest room that bands can use:
    /// 49 152 samples. There is no limit to pads in frames.
    pub const fn new(rate: SampleRate) -> Self {
        Self {
            rate,
            built: Built::HERE,
            skipping: Skipping::On,
            room_samples: 49_152,
            frame_cycles: None,
            position_cycles: None,
            position_step: 0.0,
            frame_worst_percent: 100,
            loop_percent: 100,
            ceiling_db: None,
        }
    }
}

/// Nominal cycles a frame of a pad in the tick of its strike, beside its modes: 12 000 a tick
/// (`cargo test -p host-tests --test on_chip storm -- --nocapture`, all modes shed).
pub(super) const STRUCK_PAD_FRAME: u32 = 375;

/// Worst cycles of a pad, sounding or not, in the two runs of a tick with a strike.
const PAD_CYCLES: u32 = 1_600;

/// Time for the stages of a kit while it is loaded, and the fate of a stage that does not fit.
///
/// The budget sheds modes, of which the quietest can go at any time. A stage is either there or
/// not, and has its full cost while it sounds. So a strike begins a stage only if there is time for
/// it beside those that sound already. This rule depends on the events alone: a recording plays to
/// the same bits without a log of refusals.
pub(super) struct Fitting<'f> {
    /// Cycles a tick that are left; `None` without a limit.
    cycles: Option<u32>,
    /// Worst cycles of pads in frames in percent of nominal ones; `None` without such pads.
    frame_percent: Option<u32>,
    /// Receiver of an error for each stage that is left out; `None` if loading is to fail with it.
    tell: Option<&'f mut dyn FnMut(LoadError)>,
}

impl<'f> Fitting<'f> {
    /// Time without a limit. A stage that cannot be loaded is an error.
    pub(super) const ALL: Self = Self { cycles: None, frame_percent: None, tell: None };

    /// Time of `cycles` a tick, less those of `pads` pads.
    pub(super) fn within(cycles: u32, pads: usize, tell: &'f mut dyn FnMut(LoadError)) -> Self {
        Self { cycles: Some(cycles.saturating_sub(pads as u32 * PAD_CYCLES)), frame_percent: None, tell: Some(tell) }
    }

    /// Limits the time that is left, if there is a limit, to nominal cycles a frame that pads in
    /// frames leave; they may take so many percent.
    pub(super) fn limit_beside_frames(&mut self, frame_cycles: u32, percent: u32) {
        let cycles = frame_cycles.saturating_mul(TICK_FRAMES as u32 * percent) / 100;
        self.cycles = self.cycles.map(|left| left.min(cycles));
        self.frame_percent = Some(percent);
    }

    /// Leaves a stage out and tells the receiver why.
    ///
    /// # Errors
    /// The given error if there is no receiver.
    pub(super) fn leave_out(&mut self, error: LoadError) -> Result<(), LoadError> {
        match &mut self.tell {
            Some(tell) => {
                tell(error);
                Ok(())
            }
            None => Err(error),
        }
    }

    /// Worst cycles of a stage of `cycles` nominal ones a tick; 0 without a limit.
    ///
    /// `None` if fewer are left; the receiver is then told.
    pub(super) fn afford(&mut self, stage: Stage, cycles: u32) -> Option<u32> {
        self.afford_worst(stage, stage.worst_cycles(cycles))
    }

    /// Worst cycles of a stage in a tick that pads in frames make dear, as [`afford`](Self::afford)
    /// gives them; `None` without such pads.
    pub(super) fn afford_beside_frames(&mut self, stage: Stage, cycles: u32) -> Option<Option<u32>> {
        let percent = self.frame_percent?;
        Some(self.afford_worst(stage, stage.worst_at(cycles, percent)))
    }

    fn afford_worst(&mut self, stage: Stage, cycles: u32) -> Option<u32> {
        let Some(left) = self.cycles else { return Some(0) };
        if left < cycles {
            if let Some(tell) = &mut self.tell {
                tell(LoadError::TooDear { stage, cycles, left });
            }
            return None;
        }
        Some(cycles)
    }

    /// Takes the time of a stage for good; false if there is too little.
    pub(super) fn take(&mut self, stage: Stage, cycles: u32) -> bool {
        let afforded = self.afford(stage, cycles);
        if let Some(left) = &mut self.cycles {
            *left -= afforded.unwrap_or(0);
        }
        afforded.is_some()
    }

    /// Cycles a tick that are left for stages that strikes begin; `None` without a limit.
    pub(super) fn left(&self) -> Option<u32> {
        self.cycles
    }
}

/// Cycles a tick that are left for the stages that a strike begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct CyclesLeft {
    /// Cycles a tick that are left; `None` without a limit.
    cycles: Option<u32>,
    /// Number of stages that found no time.
    pub(super) refused: u32,
}

impl CyclesLeft {
    /// Cycles that are left of `most` beside those of the stages that sound.
    pub(super) fn new(most: Option<u32>, sounding: u32) -> Self {
        Self { cycles: most.map(|most| most.saturating_sub(sounding)), refused: 0 }
    }

    /// True if there is time for a stage of `cycles`, which are then taken. A stage that sounds
    /// already has its time.
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
    fn strike_takes_time_only_for_stages_that_do_not_sound_yet() {
        let mut left = CyclesLeft::new(Some(10_000), 4_000);
        assert!(left.admits(true, 9_000), "it sounds, and has its time");
        assert!(left.admits(false, 5_000) && !left.admits(false, 1_001) && left.admits(false, 1_000));
        assert_eq!(left.refused, 1);
        let mut unlimited = CyclesLeft::new(None, u32::MAX);
        assert!(unlimited.admits(false, u32::MAX) && unlimited.refused == 0);
    }

    #[test]
    fn taken_time_is_gone_for_good_and_a_stage_too_dear_is_told() {
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
