//! The boards round the virtual core: runs an unmodified firmware image on a model of its chip and of what is wired to it, and shows what leaves
//! the I2S, what the LEDs do, what the program logs, and where its cycles went.
//!
//! ```text
//!  piezo WAV -> ADC1 --.                .-- I2S2/3 -> WAV at the board's true rate
//!  presses -> GPIO -> EXTI -> core <--> DMA1/2
//!  faults ------------'    |  '-- TIM2..5, IWDG, I2C1 -> CS43L22
//!                          '-- RTT -> defmt lines
//! ```
//!
//! Time is the cycle model of [`virtual_core`] at the core's clock, which like every other rate derives from the clock-tree registers that
//! the program writes. Peripherals act at the cycle at which their next event is due; a sleeping core skips to it. What a program does that the
//! reference manuals (RM0090, RM0383) forbid, or that is not modelled, ends the run with an error that names peripheral, register, instruction and time.
//!
//! What it cannot prove: analog behaviour, bus contention between core and DMA, silicon errata, the oscillators' tolerances, and the
//! cycle model itself, which has not been compared with a chip.

mod chip;
mod codec;
mod devices;
mod error;
mod frequency;
mod input;
mod run;
mod wiring;

pub use chip::Chip;
pub use devices::gpio::Pin;
pub use devices::i2s::Stream;
pub use error::{BoardError, Problem};
pub use frequency::Frequency;
pub use input::{Fault, PiezoSignal, Press};
pub use run::{
    AdcReport, AudioReport, FunctionReport, InterruptReport, LedReport, LogLine, MuteReport, Report, ResetReport,
    Setup, StreamReport, VirtualBoard,
};
pub use virtual_core::CycleCase;
pub use wiring::{Board, Led, Wiring};
