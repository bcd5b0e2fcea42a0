//! A Cortex-M4F on the PC, which measures and tests the cost of firmware without a board.
//!
//! It runs code built for thumbv7em-none-eabihf, counts its instructions exactly and charges cycles
//! by a published model ([`cycle`]).
//!
//! ```text
//! Cargo.toml of a no_std crate --build--> ELF --Image--> Machine --call / run_image--> value, Cost
//!                                                  |
//!   cpu: executes (common instructions itself, all others by rsemu)
//!                                                  |
//!   decode: kind, registers, target ---------------|
//!   cycle: cost alone + hazards + flash waits -----'
//! ```
//!
//! It runs up to 48 million instructions per second with cycles charged in a loop of
//! multiply-accumulates, and up to 39 million in a loop of float instructions (optimised build;
//! `cargo bench -p virtual-core --bench speed`), where `rsemu` alone runs 9 million.
//!
//! An instruction or address that the machine does not know ends the run with an error that names
//! it.
//!
//! ```no_run
//! use virtual_core::{Image, Machine};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let elf = virtual_core::build("tests/kernels/Cargo.toml".as_ref())?;
//! let mut machine = Machine::new(&Image::from_elf(&elf)?)?;
//! let call = machine.call("sum", &[0x2000_4000, 48])?;
//! let cost = call.cost;
//! println!("{} in {} cycles ({} to {})", call.value, cost.nominal, cost.best, cost.worst);
//! # Ok(())
//! # }
//! ```

pub mod cpu;
pub mod cycle;
pub mod decode;
mod error;
mod image;
mod machine;
mod memory;
mod program;

pub use cpu::Core;
pub use cycle::Cost;
pub use error::{Access, BuildError, ImageError, RunError};
pub use image::{Image, Symbol};
pub use machine::{Call, Clock, CycleCase, ExceptionChange, FunctionCost, Loop, Machine, Pace, Run, Stop};
pub use memory::{CCM_ADDRESS, CCM_BYTES, FLASH_ADDRESS, FLASH_BYTES, Peripheral, RAM_ADDRESS, RAM_BYTES, ReadTrap};
pub use program::{build, build_binary, build_one_of};
