//! What can go wrong, each error naming what, where, and what to do.

use std::path::PathBuf;

use thiserror::Error;

/// Why a file is not an image that this core can run.
#[derive(Debug, Error)]
pub enum ImageError {
    /// The bytes are not an ELF file, or a damaged one.
    #[error("the image cannot be read as ELF: {0}; give the file that the linker wrote, not a .bin or .hex")]
    NotElf(#[from] object::Error),
    /// An ELF file for another processor.
    #[error("the image is for {found}; build it with --target thumbv7em-none-eabihf (32-bit little-endian Arm)")]
    WrongProcessor {
        /// What the file's header says.
        found: String,
    },
    /// Nothing in it would be loaded.
    #[error("the image has no bytes to load; does its link script keep the wanted functions (KEEP, --undefined)?")]
    Empty,
    /// The file is shorter than its header says.
    #[error("the image ends before the {bytes} bytes for {address:#010x}; is the file complete?")]
    Truncated {
        /// First byte of the segment.
        address: u32,
        /// Its length.
        bytes: u32,
    },
    /// A segment lies outside the memory of the board.
    #[error(
        "the image puts {bytes} bytes at {address:#010x}, where there is no memory (flash 0x08000000 1 MB, RAM 0x20000000 \
         128 KB, CCM 0x10000000 64 KB); correct its link script"
    )]
    OutsideMemory {
        /// First byte of the segment.
        address: u32,
        /// Its length.
        bytes: u32,
    },
}

/// Why a thumb program could not be built.
#[derive(Debug, Error)]
pub enum BuildError {
    /// The manifest is not readable or names no package.
    #[error("{manifest}: {reason}; give the Cargo.toml of a no_std binary crate")]
    Manifest {
        /// The Cargo.toml.
        manifest: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Cargo could not be started.
    #[error("cargo could not be started for {manifest}: {source}; is it in PATH, or named by the variable CARGO?")]
    Cargo {
        /// The Cargo.toml.
        manifest: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Cargo ended with an error.
    #[error("{manifest} does not build for thumbv7em-none-eabihf:\n{output}")]
    Failed {
        /// The Cargo.toml.
        manifest: PathBuf,
        /// What cargo printed.
        output: String,
    },
    /// The ELF that cargo wrote cannot be read.
    #[error("the program {path} cannot be read: {source}")]
    Program {
        /// Where the ELF was expected.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

/// Whether an access read, wrote or fetched an instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// A load.
    Read,
    /// A store.
    Write,
    /// An instruction fetch.
    Fetch,
}

impl std::fmt::Display for Access {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Access::Read => "read from",
            Access::Write => "write to",
            Access::Fetch => "instruction fetch from",
        })
    }
}

/// Why a run ended without a result. Every variant that happened at an instruction says which one (`pc`) and in which
/// function.
#[derive(Debug, Error)]
pub enum RunError {
    /// No symbol of that name.
    #[error("the image has no function {name}; is it #[unsafe(no_mangle)], and kept by the link script?")]
    NoFunction {
        /// The name that was asked for.
        name: String,
    },
    /// The vector table cannot start the image.
    #[error("the image has no vector table at {address:#010x} (stack {stack:#010x}, reset {reset:#010x})")]
    NoVectorTable {
        /// Where it was expected.
        address: u32,
        /// Its first word.
        stack: u32,
        /// Its second word.
        reset: u32,
    },
    /// More arguments than the stack has room for.
    #[error("{count} argument words do not fit on the stack; pass a pointer to memory instead")]
    TooManyArguments {
        /// How many were given.
        count: usize,
    },
    /// An opcode that the Cortex-M4F does not define, or a permanently undefined one (`udf`: a panic or `unreachable`).
    #[error(
        "undefined instruction {opcode:#010x} at {pc:#010x} in {function}; a `udf` is a panic or an unreachable place"
    )]
    Undefined {
        /// The instruction's address.
        pc: u32,
        /// Its 16 or 32 bits, first halfword high.
        opcode: u32,
        /// The function it is in.
        function: String,
    },
    /// An access to an address where nothing answers (or which does not permit it: flash is not written by stores).
    #[error("{access} {address:#010x}, where nothing answers, by the instruction at {pc:#010x} in {function}")]
    Address {
        /// Read, write or fetch.
        access: Access,
        /// The address.
        address: u32,
        /// The instruction's address; for a fetch, the instruction that led there.
        pc: u32,
        /// The function it is in.
        function: String,
    },
    /// Another fault of the processor.
    #[error("{fault} at {pc:#010x} in {function}")]
    Fault {
        /// Its name in the architecture's terms.
        fault: &'static str,
        /// The instruction's address.
        pc: u32,
        /// The function it is in.
        function: String,
    },
    /// A breakpoint where a function was expected to return.
    #[error("breakpoint #{number} at {pc:#010x} in {function}")]
    Breakpoint {
        /// The instruction's comment field.
        number: u8,
        /// The instruction's address.
        pc: u32,
        /// The function it is in.
        function: String,
    },
    /// The core sleeps (`wfi`, `wfe`) and nothing is there to wake it.
    #[error("the core sleeps for ever since {pc:#010x} in {function}: no interrupt is enabled and pending")]
    Asleep {
        /// The address after the `wfi`.
        pc: u32,
        /// The function it is in.
        function: String,
    },
    /// The limit of instructions was reached.
    #[error(
        "still running after {limit} instructions, at {pc:#010x} in {function}; an endless loop, or raise the limit"
    )]
    Limit {
        /// The limit.
        limit: u64,
        /// The next instruction's address.
        pc: u32,
        /// The function it is in.
        function: String,
    },
    /// Host access to an address outside memory.
    #[error("{bytes} bytes at {address:#010x} are not in the memory of the board")]
    NoMemory {
        /// First byte.
        address: u32,
        /// How many.
        bytes: usize,
    },
    /// A peripheral region that overlaps memory or another peripheral.
    #[error("{bytes} bytes at {address:#010x} cannot be mapped: {reason}")]
    Mapping {
        /// First byte.
        address: u32,
        /// How many.
        bytes: u32,
        /// What the address space said.
        reason: String,
    },
}
