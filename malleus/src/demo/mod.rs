//! The demo piece: strikes from `tables/demo-piece.csv` on the shipped kit, and a scraped force on one pad.

mod scrape;

use dsp_core::SampleRate;
use dsp_core::table::Kit;

use crate::events::{self, EventsFault};
use crate::render::Performance;

/// The kit that the piece is for.
pub const KIT: &str = "demo";
/// The pad that is driven directly.
pub const SCRAPED_PAD: &str = "bowl";
/// The sample rate of the piece.
pub const RATE: SampleRate = SampleRate::HZ_48000;

const PIECE: &str = include_str!("../../../tables/demo-piece.csv");
/// The sound ends this long after the last strike.
const TAIL_S: f64 = 3.0;

/// The piece for the shipped kit.
///
/// # Errors
/// [`EventsFault`] if the piece names what the kit does not have; never for the two as they ship.
pub fn piece(table: &Kit<'_>, kit: &kit::Kit) -> Result<Performance, EventsFault> {
    let list = events::csv::parse(PIECE.as_bytes(), table, RATE)?;
    let scraped = (0u8..=254).zip(&kit.pads).find(|(_, pad)| pad.name == SCRAPED_PAD).map(|(index, _)| index);
    let direct = scraped.map(|pad| (pad, scrape::force(RATE)));
    Ok(Performance::new(list.events, direct, kit, RATE, Some(TAIL_S)))
}

/// What of a performance concerns one pad; the same length.
pub fn solo(performance: &Performance, pad: u8) -> Performance {
    Performance {
        events: performance.events.iter().copied().filter(|event| event.pad == pad).collect(),
        direct: performance.direct.clone().filter(|(driven, _)| *driven == pad),
        frames: performance.frames,
    }
}
