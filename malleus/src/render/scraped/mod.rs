//! Force of a motion: what is scraped or rolled over becomes the force on a pad.
//!
//! ```text
//! motion ──► contacts: scrapers, tick by tick ──┬──► trace: force, normal force, speed, distance
//!                                               └──► parts: direct forces on pads
//! ```

mod contacts;
mod error;
mod parts;
mod without;

pub use contacts::{Renderer, Scraped, Source, Trace, render};
pub use error::ScrapedError;
pub use parts::{direct, force, parts};
pub use without::{Ablation, without};
