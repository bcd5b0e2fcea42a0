//! WeAct BlackPill F411: 128 KB of RAM in one piece.
//!
//! At 96 MHz it has no time for reverberation and biquads beside strikes, and no code for them; its
//! memory goes to long loops.
//!
//! | bytes | use |
//! | --- | --- |
//! | 36 712 | the engine: pads, modes; a block |
//! | 2 272 | the inputs: triggers |
//! | 24 280 | a residual; the background counts as one |
//! | 39 328 | filters of four pads |
//! | 11 172 | DMA buffers, the log, tasks, USB |
//! | 17 088 | the stack, of which a storm uses 11 KB and a test keeps 4 KB free |
//!
//! `cargo test -p virtual-board --test boards -- --nocapture load::images stages` prints the sums.

use dsp_core::built::Built;
use dsp_core::memory::Words;

use crate::Board;

/// Board WeAct BlackPill F411.
#[derive(Clone, Copy, Debug)]
pub struct BlackpillF411;

impl Board for BlackpillF411 {
    const NAME: &'static str = "blackpill-f411";
    const RATE: (u32, u32) = (48_000, 1);
    const CORE_HZ: u32 = 96_000_000;
    /// Less than a half of the DMA buffer, of which a tick with a strike takes most at 96 MHz.
    const LEAD_FRAMES: usize = 30;
    const INPUT_CYCLES: u32 = 11_000;
    const WORST_PERCENT: u32 = 190;
    const FRAME_WORST_PERCENT: u32 = 124;
    const STAGE_CYCLES: u32 = 17_600;
    /// Biquads and a room find too little time beside strikes at 96 MHz, and would take 69 of the
    /// 336 KB of flash.
    const BUILT: Built = Built { biquads: false, room: false, scrapes: false };
    const WORDS: Words = Words { fast: 12_320, bulk: 0 };
    const ROOM_SAMPLES: usize = 0;
}
