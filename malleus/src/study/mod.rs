//! Listening studies of scraping and rolling (scraping-rolling §3, §5), and a stand-in for the
//! listeners of Experiment 2.
//!
//! ```text
//! trials ──► scene: one pad, one striker ──► sound by each method ──┬──► page
//!                                                                   └──► recognition
//! ```

mod error;
mod page;
pub mod recognition;
mod scene;
mod trials;

pub use error::StudyError;
pub use page::{Rated, page_path, write_page};
pub use scene::{RATE, Scene};
pub use trials::{Experiment, Method, StudyTrial, methods, trials};
