//! The force of a stick that is drawn there and back over the bowl's surface, and of a ball that
//! then rolls over it: the bowl of the shipped kit `scrapes`.

use dsp_core::SampleRate;
use dsp_core::table::Kit;

use super::error::DemoError;
use crate::motion::csv;
use crate::motion::trials::{Shape, Trial};
use crate::render::scraped::{self, Renderer};

/// Shipped kit whose surfaces are scraped.
const KIT: &str = "scrapes";
/// Strokes of the stick: there and back.
const STROKES: Trial = Trial {
    shape: Shape::BackAndForth { length_m: 0.15, period_s: 1.1, strokes: 2 },
    start_s: 9.2,
    place_m: [-0.07, 0.0],
};
/// Way of the ball.
const ROLL: Trial = Trial {
    shape: Shape::Roll { length_m: 0.2, speed_m_per_s: 0.15, incline_deg: -3.0 },
    start_s: 10.4,
    place_m: [-0.1, 0.0],
};

/// Samples of the force in Q4.27, from the start of the piece.
///
/// # Errors
/// [`DemoError`] if the shipped kit has no such pad, surface or striker.
pub(super) fn force(pad: &str, rate: SampleRate) -> Result<Vec<i32>, DemoError> {
    let loaded = kit::open(KIT)?;
    let table = Kit::parse(&loaded.binary)?;
    let (stick, ball) = (STROKES.draw()?.csv(pad, "stick"), ROLL.draw()?.csv(pad, "ball"));
    // Both in one file, with one header.
    let file = stick + ball.split_once('\n').map_or("", |(_, lines)| lines);
    let motion = csv::parse(file.as_bytes(), &table, rate)?;
    let scraped = scraped::render(&motion, &table, rate, (Renderer::Instrument, false), |_| {})?;
    Ok(scraped::force(&scraped))
}
