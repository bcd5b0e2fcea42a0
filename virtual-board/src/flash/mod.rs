//! Flash memory as a whole: its contents outside a run, the times of its operations, and the record
//! of what a program did to it.

mod history;
mod memory;
mod random;
mod times;

pub use history::{FlashChange, FlashEnding, FlashHistory, FlashOperation};
pub use memory::FlashMemory;
pub use times::FlashTimes;

pub(crate) use times::Parallelism;
