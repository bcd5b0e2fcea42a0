//! One mode in frames, struck at a frame within a block.

use dsp_core::fixed::ONE_Q27;
use dsp_core::frames::BLOCK_FRAMES;

use super::Case;
use crate::frames::{FramesOnPc, HeardMode};
use crate::snr::Random;

/// Sound of a case over its frames, 1.0 = full scale, from the frame of its strike on.
///
/// The strike falls on a frame of the block that the case's frequency and decay draw at random.
pub fn render(case: &Case) -> Vec<f64> {
    let mode = HeardMode { frequency_hz: case.frequency_hz, t60_s: case.t60_s, sine: case.level, cosine: 0.0 };
    let seed = case.frequency_hz.to_bits() ^ case.t60_s.to_bits().rotate_left(7);
    let start = Random::new(seed).between(0.0, BLOCK_FRAMES as f64) as usize;
    let mut force = vec![0; start + case.frames()];
    force[start] = ONE_Q27;
    let sound = FramesOnPc::new(&[mode], case.rate, false).render(&force, 32);
    sound.into_iter().skip(start).map(|sample| f64::from(sample) / f64::from(ONE_Q27)).collect()
}
