//! WeAct BlackPill F411: 128 KB of RAM in one. A room is more than its 96 MHz can pay for beside strikes; the memory goes to long loops.
//!
//! | bytes | what |
//! | --- | --- |
//! | 36 712 | the engine: pads, modes; a block |
//! | 2 272 | the inputs: triggers |
//! | 24 280 | a residual; the background counts as one |
//! | 39 328 | filters of four pads |
//! | 5 232 | DMA buffers, the log, tasks |
//! | 22 400 | the stack, of which loading a kit uses 10 KB and a test keeps 4 KB free |
//!
//! `cargo test -p virtual-board --test boards -- --nocapture load::images stages` prints the sums.

use dsp_core::engine::{Filters, NoRoom, Residuals};

use crate::Board;

/// The board.
#[derive(Clone, Copy, Debug)]
pub struct BlackpillF411;

impl Board for BlackpillF411 {
    const NAME: &'static str = "blackpill-f411";
    const RATE: (u32, u32) = (48_000, 1);
    const CORE_HZ: u32 = 96_000_000;
    /// At most a half: a tick with a strike takes most of a half at 96 MHz.
    const LEAD_FRAMES: usize = 27;
    const STAGE_CYCLES: u32 = 17_600;
    type Residuals = Residuals<1>;
    type Room = NoRoom;
    /// 32 breakpoints, 16 loops of up to 1023 frames (21 ms), two pairs of biquads.
    type Filters = Filters<4, 32, 16, 1024, 2>;
}
