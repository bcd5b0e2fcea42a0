//! The board's sound against `malleus play`'s.

use dsp_core::event::{Action, Event};
use virtual_board::{Board, VirtualBoard};

use crate::played::{heard_and_rendered, rate};

pub(crate) fn strikes(events: &[Event]) -> usize {
    events.iter().filter(|event| event.action == Action::Strike).count()
}

/// The frames that were compared, from the first sound on, all of which must be the same.
pub(crate) fn assert_same_bits(running: &VirtualBoard, board: Board, kit: &[u8]) -> usize {
    assert_same(board, heard_and_rendered(running, board, kit))
}

/// The same of what was heard and what was rendered.
pub(crate) fn assert_same(board: Board, [heard, rendered]: [Vec<[i32; 2]>; 2]) -> usize {
    let same = heard.iter().zip(&rendered).take_while(|(a, b)| a == b).count();
    let compared = heard.len();
    // A strike whose line was still under way at the end is missing in the log.
    let margin = (0.01 * rate(board).hz()) as usize;
    assert!(same + margin >= compared, "{}: frame {same} of {compared} differs", board.name());
    same
}
