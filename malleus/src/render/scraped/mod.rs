//! Force of a motion: what is scraped or rolled over becomes the force on a pad.
//!
//! ```text
//! motion ─┬─► events: touches, motions, lifts ─► the instrument's engine
//!         └─► contacts: scrapers, tick by tick ─┬─► trace: force, normal force, speed, distance
//!                                               └─► parts: direct forces, for the reference
//! ```

mod beyond;
mod contacts;
mod error;
mod events;
mod parts;
mod without;

pub use beyond::{Beyond, beyond};
pub use contacts::{Renderer, Scraped, Source, Trace, render};
pub use error::ScrapedError;
pub use events::{events, merged};
pub use parts::{direct, force, parts};
pub use without::{Ablation, without};
