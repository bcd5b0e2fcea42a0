//! Boards round the virtual core, which run an unmodified firmware image.
//!
//! A board models the chip and what is wired to it. It reports what leaves the I2S, the LEDs, the
//! program's log, and where its cycles went.
//!
//! ```text
//!  piezo WAV -> ADC1 --.                .-- I2S2/3 -> WAV at the board's true rate
//!  presses -> GPIO -> EXTI -> core <--> DMA1/2
//!  faults ------------'    |  '-- TIM2..5, IWDG, I2C1 -> CS43L22
//!  MIDI <-> USB host <-----|-- OTG_FS
//!  power ------------------|-- FLASH -> contents for the next run
//!                          '-- RTT -> defmt lines
//! ```
//!
//! Time follows the cycle model of [`virtual_core`] at the core's clock. All rates, that of the
//! core included, derive from the clock-tree registers that the program writes. Peripherals act at
//! the cycle at which their next event is due, and a sleeping core skips to it. An access that the
//! reference manuals (RM0090, RM0383) forbid, or that is not modelled, ends the run with an error
//! that names peripheral, register, instruction and time.
//!
//! The board cannot prove analog behaviour, bus contention between core and DMA, silicon errata,
//! the tolerances of oscillators, or the cycle model, which has not been compared with a chip.

mod chip;
mod codec;
mod devices;
mod error;
mod flash;
mod frequency;
mod input;
mod run;
mod usb_host;
mod wiring;

pub use chip::{Chip, Sector};
pub use devices::gpio::Pin;
pub use devices::i2s::Stream;
pub use devices::pins::PiezoPin;
pub use error::{BoardError, Problem};
pub use flash::{FlashChange, FlashEnding, FlashHistory, FlashMemory, FlashOperation, FlashTimes};
pub use frequency::Frequency;
pub use input::{Fault, PiezoSignal, Press};
pub use run::{
    AdcReport, AudioReport, FlashReport, FunctionReport, InterruptReport, LedReport, LogLine, MuteReport, Report,
    ResetReport, Setup, StreamReport, VirtualBoard, VolumeReport,
};
pub use usb_host::{UsbAction, UsbHost, UsbReport, UsbTransfer};
pub use virtual_core::CycleCase;
pub use wiring::{Board, Led, Wiring};
