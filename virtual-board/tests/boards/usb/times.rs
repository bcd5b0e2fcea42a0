//! Times of transfers, as the firmware notes them for the sound.

use super::{CONFIGURED_S, assert_sound, host};
use crate::common;
use crate::hits::signal;
use virtual_board::{Board, Setup, UsbAction, VirtualBoard};

/// Number of single notes: fewer than the queue to the sound holds, which then still has them all.
const NOTES: usize = 60;

/// Returns the note's packet, unlike any other.
fn note(n: usize) -> [u8; 4] {
    [0x09, 0x99, n as u8, 123]
}

/// Returns the words beside the packets of the notes in the queue to the sound, `beside` words
/// behind each packet, or `None` if they lie outside.
fn words(running: &VirtualBoard, beside: isize) -> Option<Vec<u32>> {
    let queue = running.machine().symbol("firmware::usb::ends::INCOMING").unwrap();
    let mut bytes = vec![0; queue.bytes as usize];
    running.machine().read(queue.address, &mut bytes).unwrap();
    let words: Vec<u32> = bytes.as_chunks().0.iter().map(|&word| u32::from_le_bytes(word)).collect();
    let place = |n| words.iter().position(|&word| word.to_le_bytes() == note(n)).unwrap();
    (0..NOTES).map(|n| words.get(place(n).checked_add_signed(beside)?).copied()).collect()
}

#[test]
fn end_of_a_transfer_is_noted_to_20_us_whatever_the_sound_does() {
    for board in Board::ALL {
        // The places of the notes in a half move by 37 us from one to the next.
        let send = |n| (CONFIGURED_S + 0.1 + 0.003_37 * n as f64, UsbAction::Send(note(n).to_vec()));
        let piezos = (0..4).map(|piezo| {
            let strokes = (0..9).map(|n| (CONFIGURED_S + 0.035 * f64::from(n) + 0.003 * piezo as f64, 0.9));
            signal(piezo, 1.0, &strokes.collect::<Vec<_>>())
        });
        let setup = Setup { usb: host((0..NOTES).map(send).collect()), piezos: piezos.collect(), ..Setup::default() };
        let running = common::run(board, &setup, CONFIGURED_S + 0.35);
        let report = running.report().unwrap();
        assert_sound(board, &report);
        assert!(report.audio.worst_load.unwrap() > 0.3, "{}: the sound takes time", board.name());
        let ended = report.usb.sent.iter().map(|transfer| transfer.ended_s * report.core_hz);
        let ended: Vec<u32> = ended.map(|cycles| cycles as u64 as u32).collect();
        assert_eq!(ended.len(), NOTES);
        // The time lies before the packet in the queue, or behind it.
        let spreads = [-1, 1].into_iter().filter_map(|beside| words(&running, beside)).map(|noted| {
            let late = noted.iter().zip(&ended).map(|(noted, ended)| noted.wrapping_sub(*ended) as i32);
            let late: Vec<f64> = late.map(f64::from).collect();
            // The core's counter runs 42 ppm faster than the board's clock: the times lie round a
            // line.
            let slope = (late[NOTES - 1] - late[0]) / (NOTES - 1) as f64;
            let apart: Vec<f64> = (0..NOTES).map(|n| late[n] - late[0] - slope * n as f64).collect();
            apart.iter().copied().fold(0.0, f64::max) - apart.iter().copied().fold(0.0, f64::min)
        });
        let spread_us = 1e6 * spreads.fold(f64::INFINITY, f64::min) / report.core_hz;
        println!("{}: transfers are noted within {spread_us:.2} us", board.name());
        // Writing a line of the log holds all interrupts up.
        assert!(spread_us < 20.0, "{}: {spread_us} us", board.name());
    }
}
