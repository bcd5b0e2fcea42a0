//! Random variations of a trial.

use dsp_core::noise::Sfc32;

use super::scribble::uniform;
use super::shape::{Shape, Trial};

/// Latest delay of the touch in seconds.
const MOST_DELAY_S: f64 = 0.3;
/// Farthest place of the touch from the given one, in metres along each axis.
const MOST_SHIFT_M: f64 = 0.05;
/// Stream of the generator that draws the variations.
const STREAM: u32 = 0x7a21;

impl Trial {
    /// This trial with another length, speed, time and place of its beginning, each at random.
    ///
    /// Length and speed change by factors from 0.71 to 1.41, all logarithms equally likely. The
    /// touch comes up to 0.3 s later and within 0.05 m along each axis. Equal seeds give equal
    /// factors to all shapes, so that pairs keep their shared speeds.
    pub fn varied(&self, seed: u32) -> Self {
        varied(self, seed)
    }
}

fn varied(trial: &Trial, seed: u32) -> Trial {
    let mut random = Sfc32::new(seed, STREAM);
    let mut draw = || uniform(&mut random);
    let length = (draw() - 0.5).exp2();
    let speed = (draw() - 0.5).exp2();
    let start_s = trial.start_s + MOST_DELAY_S * draw();
    let place_m = trial.place_m.map(|place| place + MOST_SHIFT_M * (2.0 * draw() - 1.0));
    // A stroke's speed is its length by its time.
    let shape = match trial.shape {
        Shape::BackAndForth { length_m, period_s, strokes } => {
            Shape::BackAndForth { length_m: length_m * length, period_s: period_s * length / speed, strokes }
        }
        Shape::FourStrokes { length_m, period_s, strokes } => {
            Shape::FourStrokes { length_m: length_m * length, period_s: period_s * length / speed, strokes }
        }
        Shape::Circle { length_m, speed_m_per_s } => {
            Shape::Circle { length_m: length_m * length, speed_m_per_s: speed_m_per_s * speed }
        }
        Shape::Line { length_m, speed_m_per_s } => {
            Shape::Line { length_m: length_m * length, speed_m_per_s: speed_m_per_s * speed }
        }
        Shape::Scribble { length_m, speed_m_per_s, .. } => {
            Shape::Scribble { length_m: length_m * length, speed_m_per_s: speed_m_per_s * speed, seed }
        }
        Shape::Roll { length_m, speed_m_per_s, incline_deg } => {
            Shape::Roll { length_m: length_m * length, speed_m_per_s: speed_m_per_s * speed, incline_deg }
        }
    };
    Trial { shape, start_s, place_m }
}
