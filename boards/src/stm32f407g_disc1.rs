//! STM32F407G-DISC1: 128 KB of RAM, and 64 KB beside the core (CCM) that DMA cannot reach.
//!
//! | bytes | use | memory |
//! | --- | --- | --- |
//! | 36 712 | the engine: pads, modes; a block | beside the core |
//! | 2 272 | the inputs: triggers | beside the core |
//! | 26 432 | the room: 18 KB of delay, 8960 samples, and 8 KB of state | beside the core |
//! | 72 840 | three residuals, 24 280 each; the background counts as one | RAM |
//! | 29 400 | filters of three to four pads | RAM |
//! | 9 820 | DMA buffers, the log, tasks, USB | RAM |
//! | 17 792 | the stack, of which a storm uses 11 KB and a test keeps 4 KB free | RAM |
//!
//! `cargo test -p virtual-board --test boards -- --nocapture load::images stages` prints the sums.

use dsp_core::built::Built;
use dsp_core::memory::Words;

use crate::Board;

/// Board STM32F407G-DISC1.
#[derive(Clone, Copy, Debug)]
pub struct Stm32f407gDisc1;

impl Board for Stm32f407gDisc1 {
    const NAME: &'static str = "stm32f407g-disc1";
    const RATE: (u32, u32) = (86_000_000, 1792);
    const CORE_HZ: u32 = 168_000_000;
    /// Less than a half of the DMA buffer: at 168 MHz the budget is met well before a half is over.
    const LEAD_FRAMES: usize = 28;
    const INPUT_CYCLES: u32 = 16_000;
    const WORST_PERCENT: u32 = 192;
    const FRAME_WORST_PERCENT: u32 = 120;
    const STAGE_CYCLES: u32 = 48_500;
    const BUILT: Built = Built { biquads: true, room: true, scrapes: false };
    const WORDS: Words = Words { fast: 7_500, bulk: 12_780 };
    const ROOM_SAMPLES: usize = 8_960;
}
