//! The demo piece: strikes from `tables/demo-piece.csv` on the shipped kit, and a bowl that a stick
//! scrapes and a ball rolls over.

mod error;
mod scrape;

use dsp_core::SampleRate;
use dsp_core::table::Kit;

use crate::events;
use crate::render::Performance;

pub use error::DemoError;

/// Name of the shipped kit that plays the piece.
pub const KIT: &str = "demo";
/// Name of the pad that a scraping force drives directly.
pub const SCRAPED_PAD: &str = "bowl";
/// Sample rate of the piece.
pub const RATE: SampleRate = SampleRate::HZ_48000;

const PIECE: &str = include_str!("../../../tables/demo-piece.csv");
/// Time from the last strike to the end of the sound, in seconds.
const TAIL_S: f64 = 3.0;

/// The demo piece as a performance for a kit, given as its binary `table` and its content `kit`.
///
/// # Errors
/// [`DemoError`] if the kit lacks a pad or striker of the piece. The shipped kit [`KIT`] has all.
pub fn piece(table: &Kit<'_>, kit: &kit::Kit) -> Result<Performance, DemoError> {
    let list = events::csv::parse(PIECE.as_bytes(), table, RATE)?;
    let scraped = (0u8..=254).zip(&kit.pads).find(|(_, pad)| pad.name == SCRAPED_PAD).map(|(index, _)| index);
    let direct = scraped.map(|pad| Ok::<_, DemoError>((pad, scrape::force(SCRAPED_PAD, RATE)?))).transpose()?;
    Ok(Performance::new(list.events, direct, kit, RATE, Some(TAIL_S)))
}

/// The events and the direct force of one pad of a performance, in a performance of equal length.
pub fn solo(performance: &Performance, pad: u8) -> Performance {
    Performance {
        events: performance.events.iter().copied().filter(|event| event.pad == pad).collect(),
        direct: performance.direct.clone().filter(|(driven, _)| *driven == pad),
        frames: performance.frames,
    }
}
