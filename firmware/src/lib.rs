#![no_std]
//! Malleus on a board: piezos and buttons in, I2S out.
//!
//! ```text
//! input ──► audio ──► I2S        board: clocks and wiring of the chosen board
//!             │                  hardware: sets them up at the start
//!             └──► tasks: log, report, LEDs, watchdog
//! ```

pub mod audio;
pub mod board;
pub mod clock;
pub mod codec;
pub mod counters;
pub mod cycles;
pub mod dfu;
pub mod faults;
pub mod half;
pub mod hardware;
pub mod input;
pub mod journal;
pub mod kits;
pub mod last_words;
pub mod owned;
mod queue;
pub mod refusal;
pub mod restart;
mod rtt;
pub mod storage;
pub mod sysex;
pub mod tasks;
pub mod usb;
pub mod volume;
pub mod watchdog;

#[cfg(all(feature = "stm32f407g-disc1", feature = "blackpill-f411"))]
compile_error!("choose one board: --no-default-features --features blackpill-f411, or the default");
