//! Run time against error: kernels and rivals on the virtual core and on the PC.
//!
//! ```text
//! grid of single modes --accuracy (PC)--------------------+
//!      a sample of it  --bits (PC against virtual core)   +--measure--> rows --report--> page
//! many modes together  --chip (virtual core), on_pc-------+
//! ```
//!
//! [`rivals`] come from the same source on both sides; [`words`] gives them their coefficients.

pub mod accuracy;
pub mod bits;
pub mod chip;
pub mod cycles_over_modes;
pub mod fixed_forms;
pub mod frames_rows;
pub mod measure;
pub mod on_pc;
mod over_modes_page;
pub mod report;
pub mod rivals;
pub mod rows;
pub mod verdict;
pub mod words;
