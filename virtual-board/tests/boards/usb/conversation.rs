//! Conversations: a program that waits for the board's answer before it goes on.

use cable::Link;
use virtual_board::{Board, Setup};

use super::link::BoardLink;
use super::{CONFIGURED_S, assert_sound, host};
use crate::common;

/// Asks a board for its identity and returns its answer, up to the message's end.
fn identity(link: &mut BoardLink<'_>) -> Vec<u8> {
    link.send(&[0xf0, 0x7e, 0x7f, 0x06, 0x01, 0xf7]).unwrap();
    let until_ms = link.now_ms() + 100;
    let mut answer = Vec::new();
    while answer.last() != Some(&0xf7) {
        answer.push(link.receive(until_ms).unwrap().expect("the board answers within 100 ms"));
    }
    answer
}

#[test]
fn board_answers_a_program_that_waits_for_each_answer_before_it_asks_again() {
    for board in Board::ALL {
        let mut running = common::run(board, &Setup { usb: host(vec![]), ..Setup::default() }, CONFIGURED_S);
        let mut link = BoardLink::new(&mut running);
        let asked_ms = link.now_ms();
        let answers: Vec<_> = (0..10).map(|_| identity(&mut link)).collect();
        let took_ms = link.now_ms() - asked_ms;
        println!("{}: ten answers took {took_ms} ms", board.name());
        assert!(answers.iter().all(|answer| *answer == answers[0] && answer[..5] == [0xf0, 0x7e, 0x7f, 6, 2]));
        assert!((1..100).contains(&took_ms), "{took_ms} ms");
        // Nobody asks, and nothing comes.
        let until_ms = link.now_ms() + 20;
        assert_eq!(link.receive(until_ms).unwrap(), None);
        assert!(link.now_ms() >= until_ms);
        assert_sound(board, &running.report().unwrap());
    }
}
