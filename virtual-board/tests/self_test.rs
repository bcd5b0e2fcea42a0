//! The self-test runs, and finds a virtual board in order.

mod common;

use virtual_board::{Board, Setup, VirtualBoard};

#[test]
fn scratch() {
    for board in Board::ALL {
        let setup = Setup { flash_waits: true, ..Setup::default() };
        let mut running = VirtualBoard::new(board, &common::program(board, "self-test"), &setup).unwrap();
        running.run_until(6.0).unwrap();
        let report = running.report().unwrap();
        for line in &report.log {
            println!("{:.3} {} {}", line.at_s, line.level, line.message);
        }
        println!("{:?}", report.resets);
    }
}
