//! Level of a sound before the step to 24 bits, and the number of samples that the step clips.

use dsp_core::fixed::{FULL_SCALE_24_BIT, ONE_Q27};
use dsp_core::output::Panner;
use dsp_core::table::{Kit, Pad};

/// Level of a sound before the step to 24 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Level {
    /// Largest magnitude of a sample, 1.0 = full scale.
    pub peak: f64,
    /// Number of samples, left and right counted apart, that the step to 24 bits clips.
    pub clipped_samples: u64,
    /// Number of samples at the end of the bus, +24 dBFS, at which the bus clips; 0 for a sound of
    /// the reference, which has no bus.
    pub saturated_samples: u64,
    /// Number of frames that are a single pad's sound at its end, ±16 before the pad's level, at
    /// which it clips ([`held_frames`]).
    pub held_frames: u64,
}

/// Number of frames of a stereo bus, Q4.27, that are one pad's sound at its end and nothing else.
///
/// A pad's sound clips at ±16 before its level, which may be far below full scale. What clips while
/// other pads or a room sound is not counted.
pub fn held_frames(table: &Kit<'_>, bus: &[[i32; 2]]) -> u64 {
    let of_pad = |pad: Pad<'_>| {
        let mut ends = [[0; 2]; 2];
        Panner::new(pad.level_db(), pad.pan()).render(&[i32::MAX, i32::MIN], &mut ends);
        ends
    };
    let ends: Vec<[i32; 2]> = table.pads().flat_map(of_pad).filter(|end| *end != [0, 0]).collect();
    bus.iter().filter(|frame| ends.contains(frame)).count() as u64
}

impl Level {
    /// Level of stereo bus samples, Q4.27.
    pub fn of_bus(frames: &[[i32; 2]]) -> Self {
        frames.iter().flatten().fold(Self::default(), |level, &sample| {
            let magnitude = f64::from(sample.unsigned_abs()) / f64::from(ONE_Q27);
            // Rounds as the step to 24 bits does, without its clipping.
            let clips = is_beyond_24_bits((i64::from(sample) + 8) >> 4);
            level.with(magnitude, clips, sample == i32::MAX || sample == i32::MIN)
        })
    }

    /// Level of stereo samples of the reference, 1.0 = full scale.
    pub fn of_reference(frames: &[[f64; 2]]) -> Self {
        frames.iter().flatten().fold(Self::default(), |level, &sample| {
            // `as` saturates only far beyond 24 bits.
            let steps = (sample * f64::from(FULL_SCALE_24_BIT) + 0.5).floor() as i64;
            level.with(sample.abs(), is_beyond_24_bits(steps), false)
        })
    }

    /// Peak in dBFS; `None` for silence.
    pub fn peak_dbfs(&self) -> Option<f64> {
        (self.peak > 0.0).then(|| 20.0 * self.peak.log10())
    }

    fn with(self, magnitude: f64, clips: bool, saturates: bool) -> Self {
        Self {
            peak: self.peak.max(magnitude),
            clipped_samples: self.clipped_samples + u64::from(clips),
            saturated_samples: self.saturated_samples + u64::from(saturates),
            ..self
        }
    }
}

fn is_beyond_24_bits(steps: i64) -> bool {
    !(-i64::from(FULL_SCALE_24_BIT)..i64::from(FULL_SCALE_24_BIT)).contains(&steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exactly_the_samples_that_the_step_to_24_bits_clips_are_counted() {
        for bus in [0, ONE_Q27 - 9, ONE_Q27 - 8, ONE_Q27, -ONE_Q27 - 8, -ONE_Q27 - 9, i32::MAX, i32::MIN] {
            let mut stepped = [[bus, 0]];
            dsp_core::output::to_24_bit(&mut stepped);
            let level = Level::of_bus(&[[bus, 0]]);
            let clips = i64::from(stepped[0][0]) != (i64::from(bus) + 8) >> 4;
            assert_eq!(level.clipped_samples, u64::from(clips), "{bus}");
            assert_eq!(level.saturated_samples, u64::from(bus == i32::MAX || bus == i32::MIN), "{bus}");
            let reference = Level::of_reference(&[[f64::from(bus) / f64::from(ONE_Q27), 0.0]]);
            assert_eq!((reference.clipped_samples, reference.peak), (level.clipped_samples, level.peak), "{bus}");
        }
        assert_eq!(Level::of_bus(&[[i32::MIN, 0]]).peak_dbfs(), Some(20.0 * 16f64.log10()));
        assert_eq!(Level::of_bus(&[[0, 0]]).peak_dbfs(), None);
    }
}
