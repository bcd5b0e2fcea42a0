//! Continuous contact: the force on an object that is scraped, or rolled over by a ball.
//!
//! After *Sound synthesis of scraping and rolling* (Agarwal et al., 2021), eq. 1 to 7 and 15 to 19:
//! the path of the scraper has the curvature `S'' = tanh(α z'')/α` of the surface z, limited by a
//! length α that follows the normal force; the force is `f = m S'' v² + β1 |v S'|^β2`.
//!
//! The surface is given as the instrument holds it: curvature on a grid, and the slope of the
//! limited path at three limits, each in octaves. The same places are read in the same way, in
//! `f64`, so that the two can be compared sample by sample. How near both come to a continuous
//! path is measured by a test that follows the law itself, 32 times as fine.
//!
//! ```text
//! motion ──► path ──► slope: rise of S' in each frame ──► smoothing ──► scraper, roll ──► force
//! ```

mod path;
mod plane;
mod roll;
mod scraper;
mod slope;
mod smoothing;
mod surface;

pub use path::{InTable, POINT, Segments};
pub use roll::Rolling;
pub use scraper::{Contact, LEAK_POINTS, Motion, Scraper};
pub use slope::fade_curve;
pub use surface::{Map, Surface};

/// Frames of a tick, over which speed and limit go in a straight line.
pub const TICK_FRAMES: usize = 32;

/// Numbers at the end of each frame of a tick, on a straight line from the tick before.
fn ramp(from: f64, to: f64) -> impl Iterator<Item = f64> {
    (1..=TICK_FRAMES).map(move |frame| from + (to - from) * frame as f64 / TICK_FRAMES as f64)
}
