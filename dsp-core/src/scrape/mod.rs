//! Continuous contact: the force on an object that is scraped, or rolled over by a ball
//! (scraping-rolling §2, §4).
//!
//! ```text
//! motion (tick by tick) --> path: place on the surface --> slope: curvature, limited by tanh
//!                      \--> normal force: limit α                         |
//!                                              smoothing (Gaussian) <-----+
//!                                                  |
//!   force, Q4.27 <-- scraper: m S'' v² + β1 |v S'|^β2  (+ rolling: k ρ^1.5 + λ ρ^1.5 ρ')
//! ```
//!
//! A [`Scraper`] makes the force of one contact, a tick at a time; an engine has
//! [`STANDARD_SCRAPES`](crate::engine::STANDARD_SCRAPES) of them, which events lead.
//! [`table`](crate::table::Surface) holds the surface: its curvature, and the slope of the limited
//! path `S'` at three limits α, each in octaves of its own resolution.
//!
//! A slow contact reads the curvature and limits it as it goes. A fast one would alias: the limit
//! makes harmonics far above half the sample rate. So it reads the slope at both ends of a frame:
//! their difference is the mean of `S''` times the way. The slope comes from the octave whose
//! points lie about a frame apart.

mod cost;
mod curvature;
mod difference;
mod kernel;
mod limit;
mod motion;
mod path;
mod plane;
mod power;
mod ramp;
mod roll;
mod scale;
mod scraper;
mod slope;
mod smoothing;
mod sum;
mod tanh;
mod walk;
mod way;
mod work;

pub use motion::{MAX_SPEED_M_PER_S, Motion, MotionError};
pub use path::SEGMENT_STEPS;
pub use roll::Rolling;
pub use scraper::{Contact, Scraper};
