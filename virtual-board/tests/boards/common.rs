//! Images of the firmware, each built once for a test binary.

use std::path::Path;

use virtual_board::{Board, Setup, VirtualBoard};

const FIRMWARE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../firmware/Cargo.toml");

/// Returns the ELF file of the application for a board.
pub(crate) fn application(board: Board) -> Vec<u8> {
    let arguments = ["--no-default-features", "--features", board.name()];
    virtual_core::build_binary(Path::new(FIRMWARE), "percussion", &arguments).unwrap()
}

/// Runs a board with the application in its flash for `seconds` seconds.
pub(crate) fn run(board: Board, setup: &Setup, seconds: f64) -> VirtualBoard {
    let mut running = VirtualBoard::new(board, &application(board), setup).unwrap();
    running.run_until(seconds).unwrap();
    running
}
