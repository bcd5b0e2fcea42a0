//! Errors of images, builds and runs.

use std::path::PathBuf;

use thiserror::Error;

/// Reason for which a file is not an image that this core can run.
#[derive(Debug, Error)]
pub enum ImageError {
    /// The bytes are not an ELF file, or are a damaged one.
    #[error("the image cannot be read as ELF; give the whole file that the linker wrote, not a .bin or .hex")]
    NotElf(#[from] object::Error),
    /// The ELF file is for another processor.
    #[error("the image is for {found}; build it with --target thumbv7em-none-eabihf (32-bit little-endian Arm)")]
    WrongProcessor {
        /// Processor that the header of the file names.
        found: String,
    },
    /// No part of the file would be loaded.
    #[error("the image has no bytes to load; does its link script keep the wanted functions (KEEP, --undefined)?")]
    Empty,
    /// The file is shorter than its header says.
    #[error("the image ends before the {bytes} bytes for {address:#010x}; is the file complete?")]
    Truncated {
        /// Address of the segment's first byte.
        address: u32,
        /// Length of the segment in bytes.
        bytes: u32,
    },
    /// A segment lies outside the memory of the board.
    #[error(
        "the image puts {bytes} bytes at {address:#010x}, where there is no memory (flash 0x08000000 1 MB, RAM 0x20000000 \
         128 KB, CCM 0x10000000 64 KB); correct its link script"
    )]
    OutsideMemory {
        /// Address of the segment's first byte.
        address: u32,
        /// Length of the segment in bytes.
        bytes: u32,
    },
}

/// Reason for which a thumb program could not be built.
#[derive(Debug, Error)]
pub enum BuildError {
    /// The manifest cannot be read or names no package.
    #[error("{manifest}: {reason}; give the Cargo.toml of a no_std binary crate")]
    Manifest {
        /// Path of the Cargo.toml.
        manifest: PathBuf,
        /// Fault of the manifest.
        reason: String,
    },
    /// Cargo could not be started.
    #[error("cargo could not be started for {manifest}: {source}; is it in PATH, or named by the variable CARGO?")]
    Cargo {
        /// Path of the Cargo.toml.
        manifest: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// Cargo ended with an error.
    #[error("{manifest} does not build for thumbv7em-none-eabihf:\n{output}")]
    Failed {
        /// Path of the Cargo.toml.
        manifest: PathBuf,
        /// Output of cargo.
        output: String,
    },
    /// The folder of the build cannot be used, or the ELF file that cargo wrote cannot be read.
    #[error("the program {path} cannot be read: {source}")]
    Program {
        /// Path of the folder or the ELF file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
}

/// Kind of an access to memory.
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

/// Reason for which a run ended without a result.
///
/// Errors at an instruction name its address (`pc`) and its function.
#[derive(Debug, Error)]
pub enum RunError {
    /// The image has no function of that name.
    #[error("the image has no function {name}; is it #[unsafe(no_mangle)], and kept by the link script?")]
    NoFunction {
        /// Name of the function.
        name: String,
    },
    /// The vector table cannot start the image.
    #[error(
        "the image has no vector table at {address:#010x} (stack {stack:#010x}, reset {reset:#010x}); let its link script \
         put one there"
    )]
    NoVectorTable {
        /// Address of the vector table.
        address: u32,
        /// First word of the table, the stack pointer.
        stack: u32,
        /// Second word of the table, the address of the reset handler.
        reset: u32,
    },
    /// The arguments do not fit on the stack.
    #[error("{count} argument words do not fit on the stack; pass a pointer to memory instead")]
    TooManyArguments {
        /// Number of argument words.
        count: usize,
    },
    /// The Cortex-M4F does not define the opcode, or it is the permanently undefined `udf`, to
    /// which a panic or `unreachable` compiles.
    #[error(
        "undefined instruction {opcode:#010x} at {pc:#010x} in {function}; a `udf` is a panic or an unreachable place"
    )]
    Undefined {
        /// Address of the instruction.
        pc: u32,
        /// Bits of the instruction, 16 or 32, the first halfword high.
        opcode: u32,
        /// Function of the instruction.
        function: String,
    },
    /// Nothing answers at the address, or it does not permit the access: stores do not write flash.
    #[error("{access} {address:#010x}, where nothing answers, by the instruction at {pc:#010x} in {function}")]
    Address {
        /// Kind of the access.
        access: Access,
        /// Address that was accessed.
        address: u32,
        /// Address of the instruction; for a fetch, of the instruction that led there.
        pc: u32,
        /// Function of the instruction.
        function: String,
    },
    /// The processor raised another fault.
    #[error("{fault} at {pc:#010x} in {function}")]
    Fault {
        /// Name of the fault in the terms of the architecture.
        fault: &'static str,
        /// Address of the instruction.
        pc: u32,
        /// Function of the instruction.
        function: String,
    },
    /// A called function met a breakpoint before it returned.
    #[error("breakpoint #{number} at {pc:#010x} in {function}; a called function must return without one")]
    Breakpoint {
        /// Comment field of the instruction.
        number: u8,
        /// Address of the instruction.
        pc: u32,
        /// Function of the instruction.
        function: String,
    },
    /// The core sleeps (`wfi`, `wfe`) and nothing can wake it.
    #[error("the core sleeps for ever since {pc:#010x} in {function}; enable an interrupt that wakes it")]
    Asleep {
        /// Address after the `wfi`.
        pc: u32,
        /// Function of the `wfi`.
        function: String,
    },
    /// The limit of instructions was reached.
    #[error(
        "still running after {limit} instructions, at {pc:#010x} in {function}; an endless loop, or raise the limit"
    )]
    Limit {
        /// Number of instructions allowed.
        limit: u64,
        /// Address of the next instruction.
        pc: u32,
        /// Function of the next instruction.
        function: String,
    },
    /// The caller accessed an address outside memory.
    #[error(
        "{bytes} bytes at {address:#010x} are not in the memory of the board (flash 0x08000000 1 MB, RAM 0x20000000 128 KB, \
         CCM 0x10000000 64 KB)"
    )]
    NoMemory {
        /// Address of the first byte.
        address: u32,
        /// Number of bytes.
        bytes: usize,
    },
    /// The region of a peripheral overlaps memory or another peripheral.
    #[error("{bytes} bytes at {address:#010x} cannot be mapped: {reason}")]
    Mapping {
        /// Address of the first byte.
        address: u32,
        /// Number of bytes.
        bytes: u32,
        /// Reason that the address space gives.
        reason: String,
    },
}
