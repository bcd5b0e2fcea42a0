//! Length of a half of the DMA buffer, the step in which inputs and sound are processed.

/// Number of frames of a half of the DMA buffer: one tick of the engine.
pub const HALF_FRAMES: usize = 32;
