#![no_std]
//! The boards as far as sound depends on them: the stages of each board's engine, its sample rate,
//! and its time. The firmware uses them, and so does the PC when it plays as a board.
//!
//! Each board has a module, with a [`Board`] and an account of the chip's memory.
//!
//! Stages of a kit that exceed a board's memory or time are left out and reported, one by one:
//! [`Engine::new_within`].

pub mod blackpill_f411;
pub mod stm32f407g_disc1;

pub use blackpill_f411::BlackpillF411;
pub use stm32f407g_disc1::Stm32f407gDisc1;

use dsp_core::SampleRate;
use dsp_core::built::Built;
use dsp_core::engine::{Engine, LoadError, Plan, Setup};
use dsp_core::memory::{Memory, Words};
use dsp_core::table::Kit;
use dsp_core::time::TICK_FRAMES;

/// Maximum number of pads of a kit on a board: the firmware has counters for so many.
pub const PADS: usize = 16;

/// Capacity of a slot for kits in bytes, on every board: one sector of the chip's flash.
pub const SLOT_BYTES: usize = 128 << 10;

/// Board as far as its sound depends on it.
pub trait Board {
    /// Name of the board in the project, such as in `--board`.
    const NAME: &'static str;
    /// Sample rate on the I2S pins in Hz, as a ratio.
    const RATE: (u32, u32);
    /// Clock of the core in Hz.
    const CORE_HZ: u32;
    /// Number of frames from the interrupt that renders a tick to the tick's deadline, its first
    /// frame on the I2S pins; at most a tick.
    const LEAD_FRAMES: usize;
    /// Cycles from the interrupt that renders a tick to the tick's deadline.
    const LEAD_CYCLES: u32 =
        (Self::CORE_HZ as u64 * Self::LEAD_FRAMES as u64 * Self::RATE.1 as u64 / Self::RATE.0 as u64) as u32;
    /// Most cycles that the inputs take of the time to a tick's deadline: with four ringing piezos,
    /// MIDI, and the notes of times above the sound.
    const INPUT_CYCLES: u32;
    /// Most cycles that a tick takes beyond those of the inputs, in percent of the engine's
    /// prediction, which is nominal and without the waits of flash.
    ///
    /// It covers the cycle model's worst case with those waits, and a reserve for code that a
    /// change elsewhere moves in flash (`cargo test -p virtual-board --test boards load`).
    const WORST_PERCENT: u32;
    /// [Budget](Engine::set_budget) of the engine: predicted cycles that a tick may take.
    ///
    /// It is the time to the deadline, less the time of the inputs, divided by the largest ratio of
    /// a tick's cycles to their prediction.
    const BUDGET_CYCLES: u32 = (Self::LEAD_CYCLES - Self::INPUT_CYCLES) / Self::WORST_PERCENT * 100;
    /// Cycles per tick that pads and stages may take together ([`Engine::new_within`]).
    ///
    /// With these no half of the DMA buffer is late when all piezos are struck at once (`cargo test
    /// -p virtual-board --test boards stages`).
    const STAGE_CYCLES: u32;
    /// Most cycles that a tick with a strike takes on pads in frames, and on the loops of the
    /// modes' kernels, in percent of their nominal ones.
    ///
    /// It covers the cycle model's worst case, the waits of flash, and the program round the engine
    /// (`cargo test -p virtual-board --test boards frames -- --nocapture`).
    const FRAME_WORST_PERCENT: u32;
    /// Cycles a frame that pads in frames may take: the time to the deadline, less that of the
    /// inputs, divided by [`FRAME_WORST_PERCENT`](Self::FRAME_WORST_PERCENT).
    const FRAME_CYCLES: u32 =
        (Self::LEAD_CYCLES - Self::INPUT_CYCLES) * 100 / Self::FRAME_WORST_PERCENT / TICK_FRAMES as u32;
    /// Optional stages that the board's program contains.
    const BUILT: Built;
    /// Cycles that a strike may spend on moving its pad to another position: what the
    /// [budget](Self::BUDGET_CYCLES) leaves beside a strike and a choice of modes to leave out.
    const POSITION_CYCLES: u32 = Self::BUDGET_CYCLES - 21_000;
    /// Words of memory that the board lends its engine.
    const WORDS: Words;
    /// Maximum number of samples in the delay lines of the reverberation, 2 bytes each.
    const ROOM_SAMPLES: usize;
    /// Ceiling of the limiter on the stereo sum in dB of full scale; `None` for no limiter.
    const CEILING_DB: Option<f32> = None;

    /// Sample rate on the I2S pins: [`RATE`](Self::RATE).
    fn rate() -> SampleRate {
        let (numerator, denominator) = Self::RATE;
        SampleRate::new(numerator, denominator).unwrap_or(SampleRate::HZ_48000)
    }

    /// Setup of the board's engine.
    fn setup() -> Setup {
        Setup {
            built: Self::BUILT,
            room_samples: Self::ROOM_SAMPLES,
            frame_cycles: Some(Self::FRAME_CYCLES),
            position_cycles: Some(Self::POSITION_CYCLES),
            position_step: 1.0 / 128.0,
            frame_worst_percent: Self::FRAME_WORST_PERCENT,
            loop_percent: 100 * Self::FRAME_WORST_PERCENT / Self::WORST_PERCENT,
            ceiling_db: Self::CEILING_DB,
            ..Setup::new(Self::rate())
        }
    }

    /// Makes the engine of a kit as the board does; `tell` gets the reason for each stage that is
    /// left out.
    ///
    /// # Errors
    /// [`LoadError`] if the board refuses the kit as a whole.
    fn engine<'k, 'm>(
        kit: &Kit<'k>,
        memory: Memory<'m>,
        tell: &mut dyn FnMut(LoadError),
    ) -> Result<Engine<'k, 'm>, LoadError> {
        Self::refuse(kit)?;
        Engine::new_within(kit, Self::setup(), memory, Self::STAGE_CYCLES, tell)
    }

    /// Plans the memory and time of a kit on the board; `tell` gets the reason for each stage that
    /// is left out.
    ///
    /// # Errors
    /// [`LoadError`] if the board refuses the kit as a whole.
    fn plan(kit: &Kit<'_>, tell: &mut dyn FnMut(LoadError)) -> Result<Plan, LoadError> {
        Self::refuse(kit)?;
        Plan::within::<i16>(kit, Self::setup(), Self::WORDS, Self::STAGE_CYCLES, tell)
    }

    /// Refuses a kit with more pads than the firmware has queues for.
    ///
    /// # Errors
    /// [`LoadError::TooManyPads`].
    fn refuse(kit: &Kit<'_>) -> Result<(), LoadError> {
        match kit.pads().len() {
            pads if pads > PADS => Err(LoadError::TooManyPads { pads, capacity: PADS }),
            _ => Ok(()),
        }
    }
}
