//! What can go wrong, each error naming what, where, and what to do.

use std::path::PathBuf;

use thiserror::Error;
use virtual_core::{ImageError, RunError};

/// Why a program's access to a peripheral is wrong, or cannot be answered.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
pub enum Problem {
    /// No such register.
    #[error("no register of that offset is modelled")]
    Register,
    /// A feature of a peripheral that the virtual board does not have.
    #[error("the virtual board does not model {what}")]
    Unmodelled {
        /// The feature.
        what: String,
    },
    /// The peripheral's clock is off.
    #[error("its clock is off; set {enable} first")]
    ClockOff {
        /// The register and its bit.
        enable: String,
    },
    /// The peripheral is held in reset.
    #[error("it is held in reset; clear its bit in {reset} first")]
    InReset {
        /// The register and its bit.
        reset: String,
    },
    /// The clocks that the registers ask for cannot be.
    #[error("{reason}")]
    ClockTree {
        /// What is wrong.
        reason: String,
    },
    /// The reference manual forbids it.
    #[error("{reason}")]
    Misuse {
        /// What is wrong.
        reason: String,
    },
}

/// Why a run on a virtual board ended early.
#[derive(Debug, Error)]
pub enum BoardError {
    /// No board of that name.
    #[error("there is no board {name}; there are stm32f407g-disc1 and blackpill-f411")]
    NoSuchBoard {
        /// The name that was given.
        name: String,
    },
    /// The file is no image for the board.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The image does not fit the board's chip.
    #[error("the image puts bytes at {address:#010x}, which the {chip} does not have; was it built for another board?")]
    WrongChip {
        /// The address.
        address: u32,
        /// The chip.
        chip: &'static str,
    },
    /// The program did something that the core does not know.
    #[error(transparent)]
    Run(#[from] RunError),
    /// An access to a peripheral was wrong.
    #[error(
        "{access} {register} ({address:#010x}) at {pc:#010x} in {function}, {time_s:.6} s after power-on: {problem}"
    )]
    Register {
        /// "read from" or "write of 0x... to".
        access: String,
        /// Peripheral and offset.
        register: String,
        /// Its address.
        address: u32,
        /// What is wrong.
        problem: Problem,
        /// The instruction's address.
        pc: u32,
        /// The function it is in.
        function: String,
        /// When.
        time_s: f64,
    },
    /// Something went wrong in a peripheral between two accesses.
    #[error("{device}, {time_s:.6} s after power-on: {problem}")]
    Device {
        /// The peripheral.
        device: &'static str,
        /// What is wrong.
        problem: Problem,
        /// When.
        time_s: f64,
    },
    /// The program met a breakpoint.
    #[error("breakpoint #{number} {time_s:.6} s after power-on: on a board without a debugger that is a hard fault")]
    Breakpoint {
        /// Its number.
        number: u8,
        /// When.
        time_s: f64,
    },
    /// The core sleeps and nothing will wake it.
    #[error("the core sleeps for ever from {time_s:.6} s after power-on on: no peripheral has anything to come")]
    Asleep {
        /// When.
        time_s: f64,
    },
    /// A WAV file cannot be read or written.
    #[error("{}: {reason}", path.display())]
    Wave {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A piezo that the board does not have.
    #[error("the board has no piezo {piezo}; they count from 0 to {last}")]
    NoSuchPiezo {
        /// The number that was given.
        piezo: usize,
        /// The last one.
        last: usize,
    },
    /// A kit that does not fit its flash sector.
    #[error("the kit has {bytes} bytes; the kit sector has {room}")]
    KitTooLong {
        /// Its length.
        bytes: usize,
        /// The sector's.
        room: u32,
    },
    /// The image's log table cannot be read.
    #[error("the image's defmt table cannot be read: {reason}")]
    LogTable {
        /// Why.
        reason: String,
    },
}
