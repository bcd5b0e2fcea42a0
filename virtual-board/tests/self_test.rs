//! The self-test runs, and finds a virtual board in order.

use std::path::Path;

use virtual_board::{Board, Setup, VirtualBoard};

const FIRMWARE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../firmware/Cargo.toml");

#[test]
fn scratch() {
    for board in Board::ALL {
        let arguments = ["--no-default-features", "--features", board.name()];
        let elf = virtual_core::build_binary(Path::new(FIRMWARE), "self-test", &arguments).unwrap();
        let setup = Setup { flash_waits: true, ..Setup::default() };
        let mut running = VirtualBoard::new(board, &elf, &setup).unwrap();
        running.run_until(6.0).unwrap();
        let report = running.report().unwrap();
        for line in &report.log {
            println!("{:.3} {} {}", line.at_s, line.level, line.message);
        }
        println!("{:?}", report.resets);
    }
}
