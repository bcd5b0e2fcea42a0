//! Latency from a strike at a piezo to its sound, and its jitter. `cargo bench -p virtual-board
//! --bench jitter` measures both at a thousand places in a block.

use crate::common;
use crate::hits::signal;
use crate::timing::{kit, measure};
use virtual_board::{Board, Setup};

/// Contact time of most strikes, in seconds.
const CONTACT_S: f64 = 0.001;

/// Each strike falls into the end of the ring of the one before.
#[test]
fn strikes_sound_after_2_72_to_2_88_ms_and_within_0_05_ms_of_each_other() {
    for (board, count) in [(Board::Stm32f407gDisc1, 80), (Board::BlackpillF411, 40)] {
        let (smallest, largest) = measure(board, 0, count, 0.5, CONTACT_S);
        // docs/hardware.md: 2.76 to 2.87 ms.
        assert!(smallest >= 2.72e-3 && largest <= 2.88e-3 && largest - smallest < 0.05e-3, "{}", board.name());
    }
}

/// A soft strike of a yarn mallet has a tenth of its peak force after 0.032 contact times.
#[test]
fn a_contact_of_six_milliseconds_sounds_within_three_milliseconds() {
    for board in Board::ALL {
        let (_, largest) = measure(board, 0, 8, 0.5, 0.006);
        assert!(largest <= 3.0e-3, "{}: {largest}", board.name());
    }
}

#[test]
fn strikes_over_a_range_of_33_decibels_sound_within_three_milliseconds() {
    let spread: Vec<(f64, f64)> =
        [0.9, 0.09, 0.02].map(|peak| measure(Board::BlackpillF411, 0, 8, peak, CONTACT_S)).to_vec();
    assert!(spread.iter().all(|&(_, largest)| largest <= 3.0e-3), "{spread:?}");
}

#[test]
fn a_direct_force_is_on_the_pin_within_1_41_ms() {
    for board in Board::ALL {
        let (smallest, largest) = measure(board, 1, 16, 0.5, CONTACT_S);
        assert!(largest <= 1.41e-3 && largest - smallest < 0.05e-3, "{}", board.name());
    }
}

#[test]
fn the_sound_of_a_strike_lasts_as_long_as_the_contact_of_the_kit() {
    // The contact is half a sine of 1 ms, however long the piezo rings.
    let setup = Setup { piezos: vec![signal(0, 0.5, &[(0.3, 0.5)])], kit: kit(CONTACT_S), ..Setup::default() };
    let running = common::run(Board::BlackpillF411, &setup, 0.4);
    let streams = running.streams();
    let sounding = streams[0].frames.iter().filter(|frame| frame[0] != 0).count() as f64;
    let expected = 0.001 * streams[0].rate.as_f64();
    assert!((sounding - expected).abs() <= 2.0, "{sounding} frames");
}
