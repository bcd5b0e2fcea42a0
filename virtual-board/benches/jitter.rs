//! Latency of a waveform at a thousand places in a block, on both boards: `cargo bench -p
//! virtual-board --bench jitter` (minutes).

#[path = "../tests/boards/common.rs"]
mod common;
#[path = "../tests/boards/timing.rs"]
mod timing;

use virtual_board::Board;

fn main() {
    for board in Board::ALL {
        // Runs of slightly different peaks cross the threshold at different places in a block.
        let runs = [0.5, 0.501, 0.502, 0.503].map(|peak| timing::measure(board, 0, 250, peak, 0.001));
        let smallest = runs.iter().fold(f64::INFINITY, |least, run| least.min(run.0));
        let largest = runs.iter().fold(0.0, |most: f64, run| most.max(run.1));
        println!(
            "{}: 1000 strikes: {:.3} to {:.3} ms, jitter {:.3} ms",
            board.name(),
            1e3 * smallest,
            1e3 * largest,
            1e3 * (largest - smallest)
        );
        assert!(largest <= 3.0e-3 && largest - smallest < 0.05e-3);
    }
}
