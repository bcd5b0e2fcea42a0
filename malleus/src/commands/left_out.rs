//! Lines for the user on the stages of a kit that a board leaves out.

use dsp_core::table::Kit;
use virtual_board::Board;

/// Lines that say which stages of a kit a board leaves out and why, or why it refuses the kit.
pub(super) fn left_out(kit: &str, board: Board, table: &Kit<'_>) -> Vec<String> {
    let name = board.name();
    match malleus::render::board::plan(board, table) {
        Ok(plan) => plan.left_out.iter().map(|reason| format!("{kit}: {name} leaves out: {reason}")).collect(),
        Err(error) => vec![format!("{kit}: {name} refuses it and plays its built-in kit: {error}")],
    }
}
