//! Errors of boards and of accesses to their peripherals.

use std::path::PathBuf;

use thiserror::Error;
use virtual_core::{ImageError, RunError};

/// Reason for which a program's access to a peripheral is wrong or cannot be answered.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
pub enum Problem {
    /// The peripheral has no register at the offset.
    #[error("no register of that offset is modelled")]
    Register,
    /// The virtual board does not have a feature of the peripheral.
    #[error("the virtual board does not model {what}")]
    Unmodelled {
        /// Name of the feature.
        what: String,
    },
    /// The clock of the peripheral is off.
    #[error("its clock is off; set {enable} first")]
    ClockOff {
        /// Register and bit that switch the clock on.
        enable: String,
    },
    /// The peripheral is held in reset.
    #[error("it is held in reset; clear its bit in {reset} first")]
    InReset {
        /// Register and bit that hold it in reset.
        reset: String,
    },
    /// The clock tree that the registers make exceeds the limits of the chip.
    #[error("{reason}")]
    ClockTree {
        /// Sentence that names the fault and the limit.
        reason: String,
    },
    /// The reference manual forbids the access.
    #[error("{reason}")]
    Misuse {
        /// Sentence that names the fault and the rule.
        reason: String,
    },
}

/// Reason for which a run on a virtual board could not begin or ended early.
#[derive(Debug, Error)]
pub enum BoardError {
    /// There is no board of that name.
    #[error("there is no board {name}; there are stm32f407g-disc1 and blackpill-f411")]
    NoSuchBoard {
        /// Name that was given.
        name: String,
    },
    /// The file is not an image.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The image does not fit the board's chip.
    #[error("the image puts bytes at {address:#010x}, which the {chip} does not have; was it built for another board?")]
    WrongChip {
        /// Address at which the chip has no memory.
        address: u32,
        /// Name of the chip.
        chip: &'static str,
    },
    /// The core cannot go on.
    #[error(transparent)]
    Run(#[from] RunError),
    /// An access to a peripheral was wrong.
    #[error(
        "{access} {register} ({address:#010x}) at {pc:#010x} in {function}, {time_s:.6} s after power-on: {problem}"
    )]
    Register {
        /// Kind of the access: "read from" or "write of 0x... to".
        access: String,
        /// Peripheral and offset of the register.
        register: String,
        /// Address of the register.
        address: u32,
        /// Reason for which the access is wrong.
        problem: Problem,
        /// Address of the instruction.
        pc: u32,
        /// Function of the instruction.
        function: String,
        /// Time of the access, in seconds from power-on.
        time_s: f64,
    },
    /// A peripheral failed between two accesses.
    #[error("{device}, {time_s:.6} s after power-on: {problem}")]
    Device {
        /// Name of the peripheral.
        device: &'static str,
        /// Reason for which it failed.
        problem: Problem,
        /// Time of the failure, in seconds from power-on.
        time_s: f64,
    },
    /// The program met a breakpoint.
    #[error("breakpoint #{number} {time_s:.6} s after power-on: on a board without a debugger that is a hard fault")]
    Breakpoint {
        /// Number of the breakpoint.
        number: u8,
        /// Time of the breakpoint, in seconds from power-on.
        time_s: f64,
    },
    /// There is no sound to write.
    #[error("no sound left the I2S, so that there is no WAV file to write; leave it out, and look into the log")]
    NoSound,
    /// A WAV file cannot be read.
    #[error("{}: {reason}", path.display())]
    Wave {
        /// Path of the file.
        path: PathBuf,
        /// Reason for which it cannot be read.
        reason: String,
    },
    /// The board does not have the piezo.
    #[error("the board has no piezo {piezo}; they count from 0 to {last}")]
    NoSuchPiezo {
        /// Number that was given.
        piezo: usize,
        /// Number of the board's last piezo.
        last: usize,
    },
    /// The kit does not fit its flash sector.
    #[error("the kit has {bytes} bytes, and the kit sector has {sector_bytes}; take modes or stages out of the kit")]
    KitTooLong {
        /// Length of the kit in bytes.
        bytes: usize,
        /// Length of the sector in bytes.
        sector_bytes: u32,
    },
    /// The chip has no flash at an address.
    #[error("the {chip} has no flash for {bytes} bytes at {address:#010x}")]
    NoFlash {
        /// Address of the first byte.
        address: u32,
        /// Number of bytes.
        bytes: usize,
        /// Name of the chip.
        chip: &'static str,
    },
    /// The flash belongs to another chip.
    #[error("the flash is that of a {found}, and the board has a {chip}")]
    OtherFlash {
        /// Name of the chip to which the flash belongs.
        found: &'static str,
        /// Name of the board's chip.
        chip: &'static str,
    },
    /// The log table of the image cannot be read.
    #[error("the image's defmt table cannot be read: {reason}")]
    LogTable {
        /// Reason that the decoder gives.
        reason: String,
    },
}
