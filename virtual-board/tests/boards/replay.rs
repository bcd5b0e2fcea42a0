//! Comparison of a board's sound with that of `malleus play`.

use dsp_core::event::{Action, Event};
use virtual_board::{Board, VirtualBoard};

use crate::played::{heard_and_rendered, rate};

/// Returns the number of strikes among events.
pub(crate) fn strikes(events: &[Event]) -> usize {
    events.iter().filter(|event| event.action == Action::Strike).count()
}

/// Asserts that a board's sound is that of `malleus play` for the events of its log; returns the
/// number of equal frames.
pub(crate) fn assert_same_bits(running: &VirtualBoard, board: Board, kit: &[u8]) -> usize {
    assert_same(board, heard_and_rendered(running, board, kit))
}

/// Asserts that heard and rendered frames are equal; returns the number of equal frames.
pub(crate) fn assert_same(board: Board, [heard, rendered]: [Vec<[i32; 2]>; 2]) -> usize {
    let same = heard.iter().zip(&rendered).take_while(|(a, b)| a == b).count();
    let compared = heard.len();
    // A strike of the last 10 ms may be missing in the log, whose line was not sent yet.
    let margin = (0.01 * rate(board).hz()) as usize;
    assert!(same + margin >= compared, "{}: frame {same} of {compared} differs", board.name());
    same
}
