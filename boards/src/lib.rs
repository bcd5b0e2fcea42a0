#![no_std]
#![doc = "What each board's engine has room for, beside the hardware: the firmware plays with it, and the PC that plays as a board does."]
//!
//! Contacts and modes are the same on all boards. What there is for noise, filters and the room is a board's own: [`Board`], one module each, with an
//! account of the chip's memory.
//!
//! What a kit has beyond that is left out and told, stage by stage: [`Engine::load_what_fits`].

pub mod blackpill_f411;
pub mod stm32f407g_disc1;

pub use blackpill_f411::BlackpillF411;
pub use stm32f407g_disc1::Stm32f407gDisc1;

use dsp_core::SampleRate;
use dsp_core::engine::{Engine, FilterRoom, LoadError, ResidualRoom, RoomStage, STANDARD_CONTACTS, Skipping};
use dsp_core::table::Kit;

/// Pads of an engine of the boards.
pub const PADS: usize = 16;
/// Banks: a pad's object, and its strikers up to the last one with modes.
pub const BANKS: usize = 32;
/// Modes, all pads together.
pub const MODES: usize = 640;
/// Register groups: a sixth of the modes, and up to six more a bank.
pub const GROUPS: usize = 224;
/// Modes that can be choked or have several positions.
pub const ORIGINS: usize = 512;

/// Cycles that the inputs take of the time to a tick's deadline at the dearest: four piezos that
/// ring.
const INPUT_CYCLES: u32 = 9_000;
/// Cycles that a tick may take with the cycle model's worst case and the waits of flash, in percent
/// of the engine's prediction, which is nominal and without waits; with a reserve for what a change
/// elsewhere moves in flash (virtual-board/tests/boards/load.rs).
const WORST_PERCENT: u32 = 180;

/// An engine of the boards with the stages `S`: 35 KB without them.
pub type BoardEngine<'k, S> = Engine<'k, PADS, BANKS, MODES, GROUPS, ORIGINS, STANDARD_CONTACTS, S>;

/// The stages of a board, as they are on the PC: in the engine itself.
pub type Stages<B> = (<B as Board>::Residuals, <B as Board>::Room, <B as Board>::Filters);

/// A board, as far as what it plays depends on it.
pub trait Board {
    /// As the project calls it.
    const NAME: &'static str;
    /// The sample rate on its I2S pins as a ratio, Hz.
    const RATE: (u32, u32);
    /// The core's clock in Hz.
    const CORE_HZ: u32;
    /// Frames from the interrupt that renders a tick to the tick's first frame on the I2S pins: the
    /// tick's deadline. At most a tick.
    const LEAD_FRAMES: usize;
    /// Cycles to the deadline of a tick.
    const LEAD_CYCLES: u32 =
        (Self::CORE_HZ as u64 * Self::LEAD_FRAMES as u64 * Self::RATE.1 as u64 / Self::RATE.0 as u64) as u32;
    /// The engine's [budget](Engine::set_budget): cycles that a tick may take as the engine
    /// predicts them. The time to the deadline without what the inputs take, by what the dearest
    /// tick takes of its prediction.
    const BUDGET_CYCLES: u32 = (Self::LEAD_CYCLES - INPUT_CYCLES) / WORST_PERCENT * 100;
    /// Cycles a tick that pads and stages may take together ([`Engine::load_what_fits`]), so that no half is missed where strikes come on all piezos at
    /// once (`cargo test -p virtual-board --test boards stages`).
    const STAGE_CYCLES: u32;
    /// Room for residuals and the background.
    type Residuals: ResidualRoom;
    /// The room's memory.
    type Room: RoomStage;
    /// Room for dynamic filters and biquads.
    type Filters: FilterRoom;

    /// [`RATE`](Self::RATE).
    fn rate() -> SampleRate {
        let (numerator, denominator) = Self::RATE;
        SampleRate::new(numerator, denominator).unwrap_or(SampleRate::HZ_48000)
    }

    /// Loads a kit as the board does; `tell` is told what is left out.
    ///
    /// # Errors
    /// A [`LoadError`]: the board refuses the kit.
    fn load<'k>(
        engine: &mut BoardEngine<'k, Stages<Self>>,
        kit: &Kit<'k>,
        tell: impl FnMut(LoadError),
    ) -> Result<(), LoadError>
    where
        Self: Sized,
    {
        engine.load_what_fits(kit, Self::rate(), Skipping::On, Self::STAGE_CYCLES, tell)
    }
}
